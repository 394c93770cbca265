//! The inspector: the parameters of the active node, made from its spec alone.
//!
//! A new parameter needs nothing here, a new kind of parameter an arm in [`row`]. Selected nodes of the
//! active one's kind are edited together. Of a group it shows the ports ([`group`]). Every control is named `NODE.PARAM` for screen readers and tests. What the
//! inspector remembers between frames (text that is being typed, the file dialog, names of grids) lives in
//! egui's memory. Tested by gestures on each kind of parameter.

use egui::{CollapsingHeader, RichText, ScrollArea, Sense, Ui};

use super::{Project, Selection, Statuses};
use crate::graph::NodeSpec;
use crate::nodes::catalog;
use number::{in_role, named};
use slot::Slot;

pub use grids::choices as grid_choices;
pub use slot::put_key;

mod color;
mod curve;
mod direction;
mod expression;
mod grids;
mod group;
mod number;
mod path;
mod report;
mod row;
mod slot;
#[cfg(test)]
mod tests;

/// What of the editor it looks at.
#[derive(Debug)]
pub struct Context<'a> {
    /// The nodes that it is about, `group/inner` for one in a group.
    pub selection: &'a Selection,
    /// What they said of their runs.
    pub statuses: &'a Statuses,
    /// The group that is opened on the canvas; empty for none.
    pub opened: &'a str,
    /// The frame that is looked at, where there are several.
    pub frame: Option<i64>,
    /// Whether it is to have the keyboard from now on.
    pub takes_keyboard: bool,
}

/// Shows the active node, or the opened group where there is none, and applies what is changed. Gives the node
/// that is to be shown instead, where one was asked for.
pub fn show(ui: &mut Ui, project: &mut Project, context: &Context) -> Option<String> {
    let opened = Some(context.opened).filter(|group| !group.is_empty());
    let named_node = |name| Some((name, project.document().node(name)?));
    let Some((name, node)) = context.selection.active().or(opened).and_then(named_node) else {
        ui.weak("Select a node to see what it does and to change it.");
        return None;
    };
    let heading =
        ui.add(egui::Label::new(RichText::new(name).heading()).sense(Sense::focusable_noninteractive()));
    named(&heading, &format!("inspector of {name}"));
    in_role(&heading, egui::accesskit::Role::Heading);
    if context.takes_keyboard {
        heading.request_focus();
    }
    let mut asked = None;
    if node.inside.is_some() {
        ScrollArea::vertical().auto_shrink(false).show(ui, |ui| asked = group::show(ui, project, name));
        return asked;
    }
    let Some(spec) = catalog().find(&node.type_id) else {
        ui.colored_label(ui.visuals().error_fg_color, format!("'{}' is no kind of node", node.type_id));
        return None;
    };
    let nodes = edited_together(project, context.selection, spec, name);
    ScrollArea::vertical().auto_shrink(false).show(ui, |ui| {
        head(ui, spec, nodes.len());
        for param in spec.params {
            row::show(ui, &mut Slot::new(project, &nodes, param, context.frame));
        }
        ui.separator();
        asked = report::ports(ui, project, &nodes[0], spec);
        if let Some(status) = context.statuses.get(&nodes[0]) {
            ui.separator();
            report::run(ui, status);
        }
    });
    path::dialog(ui);
    if ui.input(|input| input.pointer.any_released()) {
        project.end_gesture();
    }
    asked
}

/// The active node, then the others of its kind that are selected.
fn edited_together(project: &Project, selection: &Selection, spec: &NodeSpec, active: &str) -> Vec<String> {
    let document = project.document();
    let is_alike =
        |name: &&String| *name != active && document.node(name).is_some_and(|node| node.type_id == spec.id);
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
