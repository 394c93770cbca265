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
        let mut requests = Vec::new();
        for name in project.document().nodes.keys() {
            let state = statuses.get(name).map(|status| &status.state);
            let label = ui.selectable_label(selection.nodes.contains(name), format!("{name} {state:?}"));
            if label.clicked() {
                selection.only(name);
            }
            if label.double_clicked() {
                requests.push(Request::Show(name.clone()));
            }
        }
        requests
    }
}
