//! The question before work would be lost.

use egui::{Id, Modal, Ui};

/// What was answered.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Answer {
    /// Write it first.
    Save,
    /// It may go.
    Discard,
    /// Stay.
    Stay,
}

/// Asks; `None` until there is an answer.
pub fn show(ui: &Ui, name: &str) -> Option<Answer> {
    let modal = Modal::new(Id::new("unsaved")).show(ui.ctx(), |ui| {
        ui.set_width(340.0);
        ui.heading("Save the changes?");
        ui.add_space(4.0);
        ui.label(format!("'{name}' has changes that are in no file yet."));
        ui.add_space(12.0);
        ui.horizontal(|ui| {
            let answers =
                [("Save", Answer::Save), ("Do not save", Answer::Discard), ("Cancel", Answer::Stay)];
            let clicked = answers.into_iter().filter(|(label, _)| ui.button(*label).clicked());
            clicked.last().map(|(_, answer)| answer)
        })
        .inner
    });
    modal.inner.or(modal.should_close().then_some(Answer::Stay))
}
