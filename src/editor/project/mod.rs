//! The graph that is open: its document, its undo, its file. No window: everything here is tested without.
//!
//! Work is never lost: a file appears whole or not at all, and a disk that fails is told and changes nothing;
//! [`Autosave`] writes what is not saved beside the state of the program, and [`recoverable`] finds it after a
//! kill; [`versions`] keeps what was saved before.
//!
//! A change is a whole new document, and undo keeps the old one: graphs are small (a node is some hundred
//! bytes), so a step costs less than the bookkeeping of a difference would. A gesture that goes on over
//! many frames (a drag) is one step: edits with the same gesture are merged until it is another's turn.

mod autosave;
mod file;
pub mod versions;

use std::path::{Path, PathBuf};

use crate::graph::Document;

pub use autosave::{Autosave, EVERY, Recoverable, recoverable};

/// Where recovery and versions of this user's graphs are kept; `None` where the system names no such folder.
pub fn state_folder() -> Option<PathBuf> {
    Some(dirs::state_dir().or_else(dirs::data_local_dir)?.join("tyndall"))
}

/// A graph and its history.
#[derive(Debug, Default)]
pub struct Project {
    document: Document,
    /// Where it is saved.
    file: Option<PathBuf>,
    undo: Vec<Step>,
    redo: Vec<Step>,
    /// Of the last edit, while it goes on.
    gesture: Option<egui::Id>,
    /// Counts changes of the document.
    revision: u64,
    saved: Option<Document>,
    /// What of its file was not understood.
    left_out: Vec<String>,
    /// Where versions are kept.
    state: Option<PathBuf>,
    /// What went wrong beside the saving.
    warning: Option<String>,
}

#[derive(Debug)]
struct Step {
    label: String,
    /// The document on the other side of the step.
    document: Document,
}

impl Project {
    /// A new graph that has no file yet.
    pub fn new(document: Document) -> Self {
        Self { document, ..Self::default() }
    }

    /// The graph as it is now.
    pub fn document(&self) -> &Document {
        &self.document
    }

    /// Where it is saved.
    pub fn file(&self) -> Option<&Path> {
        self.file.as_deref()
    }

    /// Another number after each change.
    pub fn revision(&self) -> u64 {
        self.revision
    }

    /// Whether it differs from its file.
    pub fn is_unsaved(&self) -> bool {
        !self.saved.as_ref().is_some_and(|saved| saved.is_as(&self.document))
    }

    /// Looks at another frame, which changes nothing that is saved or undone.
    pub fn look_at(&mut self, frame: Option<i64>) {
        self.document.frame = frame;
        if let Some(saved) = &mut self.saved {
            saved.frame = frame;
        }
    }

    /// Changes the graph, as one step of undo. What changes nothing is no step.
    pub fn edit(&mut self, label: &str, change: impl FnOnce(&mut Document)) {
        self.gesture = None;
        self.apply(label, change);
    }

    /// Changes the graph as part of a gesture: all edits of one gesture, without another between, are one step.
    pub fn edit_during(&mut self, gesture: egui::Id, label: &str, change: impl FnOnce(&mut Document)) {
        if self.gesture == Some(gesture) {
            change(&mut self.document);
            self.revision += 1;
        } else if self.apply(label, change) {
            self.gesture = Some(gesture);
        }
    }

    /// Ends the gesture that goes on: the next edit is a step of its own.
    pub fn end_gesture(&mut self) {
        self.gesture = None;
    }

    /// Takes the last step back and says which.
    pub fn undo(&mut self) -> Option<String> {
        let step = self.undo.pop()?;
        let label = step.label.clone();
        let back = self.swap(step);
        self.redo.push(back);
        Some(label)
    }

    /// Does the last step that was taken back again and says which.
    pub fn redo(&mut self) -> Option<String> {
        let step = self.redo.pop()?;
        let label = step.label.clone();
        let back = self.swap(step);
        self.undo.push(back);
        Some(label)
    }

    /// Whether a step can be taken back.
    pub fn can_undo(&self) -> bool {
        !self.undo.is_empty()
    }

    /// Whether a step can be done again.
    pub fn can_redo(&self) -> bool {
        !self.redo.is_empty()
    }

    fn swap(&mut self, mut step: Step) -> Step {
        self.gesture = None;
        self.revision += 1;
        // The frame is no part of the step.
        step.document.frame = self.document.frame;
        Step { label: step.label, document: std::mem::replace(&mut self.document, step.document) }
    }

    /// Whether something changed.
    fn apply(&mut self, label: &str, change: impl FnOnce(&mut Document)) -> bool {
        let before = self.document.clone();
        change(&mut self.document);
        if self.document.is_as(&before) {
            return false;
        }
        self.undo.push(Step { label: label.to_owned(), document: before });
        self.redo.clear();
        self.revision += 1;
        true
    }
}

#[cfg(test)]
mod tests;
