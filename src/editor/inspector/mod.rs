//! The inspector: the parameters of the active node, made from its spec alone.
//!
//! A new parameter needs nothing here, a new kind of parameter an arm in [`row`]. Selected nodes of the
//! active one's kind are edited together. Every control is named `NODE.PARAM` for screen readers and tests. What the
//! inspector remembers between frames (text that is being typed, the file dialog, names of grids) lives in
//! egui's memory. Tested by gestures on each kind of parameter.

use egui::{CollapsingHeader, RichText, ScrollArea, Ui};

use super::{Project, Selection, Statuses};
use crate::graph::NodeSpec;
use crate::nodes::catalog;
use slot::Slot;

pub use grids::choices as grid_choices;
pub use slot::put_key;

mod color;
mod curve;
mod direction;
mod expression;
mod grids;
mod number;
mod path;
mod report;
mod row;
mod slot;
#[cfg(test)]
mod tests;

/// Shows the active node and applies what is changed.
pub fn show(ui: &mut Ui, project: &mut Project, selection: &Selection, statuses: &Statuses) {
    let known = selection.active().and_then(|name| Some((name, project.document().nodes.get(name)?)));
    let Some((name, node)) = known else {
        ui.weak("Select a node to see what it does and to change it.");
        return;
    };
    ui.heading(name);
    let Some(spec) = catalog().find(&node.type_id) else {
        ui.colored_label(ui.visuals().error_fg_color, format!("'{}' is no kind of node", node.type_id));
        return;
    };
    let nodes = edited_together(project, selection, spec, name);
    ScrollArea::vertical().auto_shrink(false).show(ui, |ui| {
        head(ui, spec, nodes.len());
        for param in spec.params {
            row::show(ui, &mut Slot::new(project, &nodes, param));
        }
        ui.separator();
        report::ports(ui, project.document(), &nodes[0], spec);
        if let Some(status) = statuses.get(&nodes[0]) {
            ui.separator();
            report::run(ui, status);
        }
    });
    path::dialog(ui);
    if ui.input(|input| input.pointer.any_released()) {
        project.end_gesture();
    }
}

/// The active node, then the others of its kind that are selected.
fn edited_together(project: &Project, selection: &Selection, spec: &NodeSpec, active: &str) -> Vec<String> {
    let nodes = &project.document().nodes;
    let is_alike =
        |name: &&String| *name != active && nodes.get(*name).is_some_and(|node| node.type_id == spec.id);
    let others = selection.nodes.iter().filter(is_alike).cloned();
    [active.to_owned()].into_iter().chain(others).collect()
}

fn head(ui: &mut Ui, spec: &NodeSpec, count: usize) {
    ui.horizontal_wrapped(|ui| {
        ui.label(RichText::new(spec.id).monospace());
        if count > 1 {
            ui.label(RichText::new(format!("{count} nodes are edited together")).strong());
        }
    });
    ui.label(spec.purpose);
    if !spec.doc.is_empty() {
        let id = ("inspector doc", spec.id);
        CollapsingHeader::new("More").id_salt(id).show(ui, |ui| ui.weak(spec.doc));
    }
    ui.separator();
}
