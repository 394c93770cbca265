//! What a node is wired to, and what it said of its run.

use egui::{RichText, Ui};

use super::number::named;
use crate::editor::panels::status_bar::{size, time};
use crate::editor::{NodeState, NodeStatus, Project};
use crate::graph::{Decision, Document, End, NodeSpec, PortSpec, Side, Wire};
use crate::nodes::catalog;

/// What the menu of a port asks for.
enum Change {
    Connect(Wire),
    Unplug(Wire),
    Expose(Side, End),
}

/// Inputs and outputs, and what they are wired to, as links; a menu at each wires it, for those who use no mouse.
/// Gives the node of the link that was clicked.
pub fn ports(ui: &mut Ui, project: &mut Project, path: &str, spec: &NodeSpec) -> Option<String> {
    let (group, name) = path.rsplit_once('/').unwrap_or(("", path));
    let mut asked = None;
    let mut change = None;
    let level = project.document().inside(group)?;
    let inputs = spec.inputs.iter().map(|port| (Side::Input, port));
    for (side, port) in inputs.chain(spec.outputs.iter().map(|port| (Side::Output, port))) {
        let own = End::new(name, port.name);
        let wires: Vec<&Wire> = level.wires.iter().filter(|wire| *end_at(wire, side) == own).collect();
        ui.horizontal_wrapped(|ui| {
            let opened = ui.menu_button("⏷", |ui| {
                change = menu(ui, level, !group.is_empty(), (side, &own)).or(change.take());
            });
            named(&opened.response, &format!("wires of {side} {own}"));
            let about = format!("{}: {}", port.kind, port.doc);
            ui.label(RichText::new(port.name).strong()).on_hover_text(about);
            match level.group_port_of(side, &own) {
                Some(port) => drop(ui.label(format!("{side} of the group: {port}"))),
                None if wires.is_empty() => empty(ui, side, port),
                None => {}
            }
            if !wires.is_empty() {
                ui.weak(if side == Side::Input { "from" } else { "to" });
            }
            for wire in wires {
                asked = link(ui, group, other_end(wire, side)).or(asked.take());
            }
        });
    }
    if let Some(change) = change {
        apply(project, group, change);
    }
    asked
}

fn end_at(wire: &Wire, side: Side) -> &End {
    if side == Side::Input { &wire.to } else { &wire.from }
}

fn other_end(wire: &Wire, side: Side) -> &End {
    if side == Side::Input { &wire.from } else { &wire.to }
}

/// What can be done with a port: wires that fit, those that are there, and a port of the group.
fn menu(ui: &mut Ui, level: &Document, is_in_group: bool, (side, own): (Side, &End)) -> Option<Change> {
    let mut change = None;
    let mut line = |ui: &mut Ui, text: String, is: Change| {
        if ui.button(text).clicked() {
            change = Some(is);
            ui.close();
        }
    };
    for wire in level.wires.iter().filter(|wire| end_at(wire, side) == own) {
        line(ui, format!("Unplug {}", other_end(wire, side)), Change::Unplug(wire.clone()));
    }
    for (name, node) in &level.nodes {
        let ports = if side == Side::Input { node.outputs(catalog()) } else { node.inputs(catalog()) };
        for port in ports.unwrap_or_default() {
            let other = End::new(name, port.name);
            let (from, to) =
                if side == Side::Input { (other.clone(), own.clone()) } else { (own.clone(), other.clone()) };
            let wire = Wire { from, to };
            if !level.wires.contains(&wire) && level.fits(catalog(), &wire.from, &wire.to).is_ok() {
                line(ui, format!("Connect {other}"), Change::Connect(wire));
            }
        }
    }
    if is_in_group && level.can_expose(catalog(), side, own).is_ok() {
        line(ui, "Expose as a port of the group".to_owned(), Change::Expose(side, own.clone()));
    }
    change
}

fn apply(project: &mut Project, group: &str, change: Change) {
    let label = match &change {
        Change::Connect(_) => "Connect",
        Change::Unplug(_) => "Unplug",
        Change::Expose(..) => "Add a port",
    };
    project.edit(label, |document| {
        // Refused is only what closes a cycle outside of the group; the wire is then not there.
        let _ = document.wire_inside(group, |inside| match change {
            Change::Connect(wire) => inside.connect(catalog(), wire),
            Change::Unplug(wire) => {
                inside.disconnect(&wire);
                Ok(())
            }
            Change::Expose(side, end) => inside.expose(catalog(), side, &end).map(drop),
        });
    });
}

/// A link to the node at the other end of a wire, as `group/inner`.
pub fn link(ui: &mut Ui, group: &str, end: &End) -> Option<String> {
    let response = ui.link(end.to_string()).on_hover_text("Go to this node");
    let path = if group.is_empty() { end.node.clone() } else { format!("{group}/{}", end.node) };
    response.clicked().then_some(path)
}

fn empty(ui: &mut Ui, side: Side, port: &PortSpec) {
    match (side, port.absent) {
        (Side::Input, Some(meaning)) => drop(ui.weak(format!("empty: {meaning}"))),
        (Side::Input, None) => {
            drop(ui.colored_label(
                ui.visuals().error_fg_color,
                format!("empty: wire an output of type {} to it", port.kind),
            ));
        }
        (Side::Output, _) => drop(ui.weak("read by nothing")),
    }
}

/// State, cost and decisions of the last run.
pub fn run(ui: &mut Ui, status: &NodeStatus) {
    let error = ui.visuals().error_fg_color;
    match &status.state {
        NodeState::Idle => ui.weak("It has not run: no picture that is shown needs it."),
        NodeState::Stale => ui.weak("Something that it depends on changed since it ran."),
        NodeState::Running => ui.label("It runs."),
        NodeState::Done => ui.label(cost(status)),
        NodeState::Failed(message) => ui.colored_label(error, message),
        NodeState::Skipped(because) => {
            ui.colored_label(error, format!("It waits for '{because}', which failed."))
        }
    };
    if let Some([x, y, z]) = status.report.cells {
        ui.weak(format!("{x} x {y} x {z} cells"));
    }
    for decision in &status.report.decisions {
        told(ui, decision);
    }
}

/// As far as it is known: what was found in the cache under a new name took its time under another.
fn cost(status: &NodeStatus) -> String {
    let cached = if status.cached { ", from the cache" } else { "" };
    let size = size(status.bytes);
    let is_known = |ms: f64| ms >= 0.05;
    let times = match [status.cpu_ms, status.gpu_ms] {
        [cpu_ms, gpu_ms] if is_known(gpu_ms) && cpu_ms >= gpu_ms => {
            format!("{}, of these {} on the GPU; ", time(cpu_ms), time(gpu_ms))
        }
        [_, gpu_ms] if is_known(gpu_ms) => format!("{} on the GPU; ", time(gpu_ms)),
        [cpu_ms, _] if is_known(cpu_ms) => format!("{}; ", time(cpu_ms)),
        _ => String::new(),
    };
    format!("{times}{size}{cached}")
}

fn told(ui: &mut Ui, decision: &Decision) {
    let Decision { kept, what, reason, data, .. } = decision;
    let what = if *kept { RichText::new(what) } else { RichText::new(format!("left out: {what}")).strong() };
    ui.horizontal_wrapped(|ui| {
        ui.label(what).on_hover_text(data);
        ui.weak(reason);
    });
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_cost_is_told_as_far_as_it_is_known() {
        let cost_of = |cpu_ms, gpu_ms, cached| {
            cost(&NodeStatus { cpu_ms, gpu_ms, cached, bytes: 3 << 20, ..NodeStatus::default() })
        };
        assert_eq!(
            cost_of(4500.0, 4100.0, true),
            "4.5 s, of these 4.1 s on the GPU; 3.0 MiB, from the cache"
        );
        assert_eq!(cost_of(12.0, 0.0, false), "12 ms; 3.0 MiB");
        // Of a preview, which the clock of the node has not seen.
        assert_eq!(cost_of(0.0, 30.0, true), "30 ms on the GPU; 3.0 MiB, from the cache");
        assert_eq!(cost_of(0.0, 0.0, true), "3.0 MiB, from the cache");
        // A lamp is not of 0.0 MiB.
        assert_eq!(cost(&NodeStatus { bytes: 80, ..NodeStatus::default() }), "80 B");
    }
}
