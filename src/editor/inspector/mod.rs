//! The inspector: the parameters of the active node, made from its spec alone.

use super::{Project, Selection};

/// Shows the parameters of the active node and applies what is changed.
pub fn show(ui: &mut egui::Ui, project: &mut Project, selection: &Selection) {
    let Some(name) = selection.active() else {
        ui.weak("Select a node.");
        return;
    };
    ui.heading(name);
    ui.label(&project.document().nodes[name].type_id);
}
