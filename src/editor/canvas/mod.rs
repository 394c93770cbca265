//! The canvas: the nodes of the document, their wires, and the gestures that change them.

use super::{Project, Selection, Statuses};

/// What the canvas remembers between frames and the document does not hold.
#[derive(Debug, Default)]
pub struct Canvas;

/// What the canvas asks of the rest of the editor.
#[derive(Debug, Clone, PartialEq)]
pub enum Request {
    /// To show this node's picture.
    Show(String),
}

impl Canvas {
    /// Draws the document and applies gestures to it.
    pub fn show(
        &mut self,
        ui: &mut egui::Ui,
        project: &mut Project,
        selection: &mut Selection,
        statuses: &Statuses,
    ) -> Vec<Request> {
        for name in project.document().nodes.keys() {
            let state = statuses.get(name).map(|status| &status.state);
            if ui.selectable_label(selection.nodes.contains(name), format!("{name} {state:?}")).clicked() {
                selection.only(name);
            }
        }
        Vec::new()
    }
}
