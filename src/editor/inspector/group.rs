//! The ports of a group: what they are called, in which order they stand, what they stand for.

use egui::{RichText, Ui};

use super::number::{entry, named};
use super::report::link;
use crate::editor::Project;
use crate::graph::{Document, End, Side};
use crate::nodes::catalog;

/// What is done to a port.
enum Change {
    Up,
    Down,
    Remove,
}

/// Shows the ports of a group and applies what is changed. Gives the node of the link that was clicked.
pub fn show(ui: &mut Ui, project: &mut Project, path: &str) -> Option<String> {
    let inside = project.document().inside(path)?.clone();
    ui.label(RichText::new("group").monospace());
    ui.label("Nodes that are one node from outside.");
    ui.separator();
    let mut asked = None;
    let inputs = inside.inputs.iter().map(|(port, ends)| (Side::Input, port.as_str(), ends.clone()));
    let outputs = inside.outputs.iter().map(|(port, end)| (Side::Output, port.as_str(), vec![end.clone()]));
    for (title, ports) in [("Inputs", inputs.collect::<Vec<_>>()), ("Outputs", outputs.collect())] {
        ui.strong(title);
        if ports.is_empty() {
            ui.weak("none yet: open the group and drag a wire to its edge");
        }
        for (side, port, ends) in ports {
            asked = row(ui, project, path, &inside, (side, port), &ends).or(asked);
        }
        ui.add_space(6.0);
    }
    asked
}

fn row(
    ui: &mut Ui,
    project: &mut Project,
    path: &str,
    inside: &Document,
    (side, port): (Side, &str),
    ends: &[End],
) -> Option<String> {
    let label = format!("{path} {side} {port}");
    let kind = match side {
        Side::Input => ends.first().and_then(|end| inside.input(catalog(), end)),
        Side::Output => ends.first().and_then(|end| inside.output(catalog(), end)),
    };
    let mut change = None;
    let mut asked = None;
    let refused = ui.horizontal(|ui| {
        let id = egui::Id::new(("inspector group", &label));
        let refused = entry(ui, id, &label, port, 110.0, |text| {
            let mut done = Ok(());
            project
                .edit("Rename a port", |document| done = document.rename_port(path, side, port, text.trim()));
            done
        });
        for (sign, what, is) in
            [("⏶", "up", Change::Up), ("⏷", "down", Change::Down), ("×", "remove", Change::Remove)]
        {
            let button = ui.small_button(sign);
            named(&button, &format!("{label} {what}"));
            if button.clicked() {
                change = Some(is);
            }
        }
        refused
    });
    if let Some(reason) = refused.inner {
        ui.colored_label(ui.visuals().error_fg_color, reason);
    }
    // Lines after the first begin where it does.
    ui.horizontal(|ui| {
        ui.add_space(4.0);
        ui.horizontal_wrapped(|ui| {
            let kind = kind.map_or("unknown".to_owned(), |spec| spec.kind.to_string());
            ui.weak(format!("{kind}, stands for"));
            for end in ends {
                asked = link(ui, path, end).or(asked.take());
            }
        });
    });
    if let Some(change) = change {
        apply(project, path, side, port, &change);
    }
    asked
}

fn apply(project: &mut Project, path: &str, side: Side, port: &str, change: &Change) {
    let label = if matches!(change, Change::Remove) { "Remove a port" } else { "Move a port" };
    project.edit(label, |document| {
        document.edit_inside(path, |inside| match change {
            Change::Remove => inside.remove_port(side, port),
            Change::Up => inside.shift_port(side, port, -1).is_ok(),
            Change::Down => inside.shift_port(side, port, 1).is_ok(),
        });
    });
}
