//! The file of a graph: opened leniently, written whole or not at all.

use std::path::{Path, PathBuf};
use std::time::SystemTime;

use super::{Project, Step, versions};
use crate::graph::{Document, DocumentError};
use crate::image::atomic::{self, WriteError};
use crate::nodes::catalog;

impl Project {
    /// The graph of a file. What of it is not understood, because a later version wrote it, is in
    /// [`Self::left_out`]; the graph then counts as unsaved.
    ///
    /// # Errors
    /// Where the file cannot be read or is no graph.
    pub fn load(path: &Path) -> Result<Self, DocumentError> {
        let text = std::fs::read_to_string(path)
            .map_err(|source| DocumentError::Read { path: path.to_owned(), source })?;
        let (mut document, mut left_out) = Document::open_leniently(&text, &folder(path))?;
        // A file that is understood in full keeps its mistakes, which are its author's to mend.
        if !left_out.is_empty() {
            left_out.extend(document.leave_out_unknown(catalog()));
        }
        let saved = left_out.is_empty().then(|| document.clone());
        Ok(Self { saved, document, left_out, file: Some(path.to_owned()), ..Self::default() })
    }

    /// A graph that was not saved to its file, if it has one.
    pub(super) fn unsaved(document: Document, file: Option<PathBuf>) -> Self {
        let saved = file.as_ref().and_then(|file| Document::load(file).ok());
        Self { document, file, saved, ..Self::default() }
    }

    /// What of the file was not understood, a line each; saving the graph writes it without.
    pub fn left_out(&self) -> &[String] {
        &self.left_out
    }

    /// Keeps versions in this folder from now on, at each save.
    pub fn keep_versions(&mut self, state: &Path) {
        self.state = Some(state.to_owned());
    }

    /// What went wrong beside the last saving, once: the version could not be kept.
    pub fn take_warning(&mut self) -> Option<String> {
        self.warning.take()
    }

    /// Writes the graph to its file; `false` where it has none.
    ///
    /// # Errors
    /// Where the file cannot be written; it and the graph are then as they were.
    pub fn save(&mut self) -> Result<bool, WriteError> {
        match self.file.clone() {
            Some(file) => self.save_as(&file).map(|()| true),
            None => Ok(false),
        }
    }

    /// Writes the graph to a file, which is its own from now on. Relative paths lead to the same files from
    /// the new folder.
    ///
    /// # Errors
    /// Where the file cannot be written; it and the graph are then as they were.
    pub fn save_as(&mut self, path: &Path) -> Result<(), WriteError> {
        let folder = folder(path);
        let mut document = self.document.clone();
        document.rebase(catalog(), &folder);
        let text = document.to_json();
        let state = self.state.clone();
        let keep = |text: &str| {
            let written = std::fs::metadata(path).and_then(|file| file.modified());
            let then = written.unwrap_or_else(|_| SystemTime::now());
            state.as_ref().and_then(|state| versions::keep(state, path, text, then).err())
        };
        // What somebody else wrote there is a version too.
        let before = std::fs::read_to_string(path).ok().and_then(|before| keep(&before));
        atomic::write(path, text.as_bytes())?;
        let after = keep(&text);
        let failed = before.or(after);
        self.warning = failed.map(|error| format!("saved, but the version was not kept: {error}"));
        if document != self.document {
            self.document = document;
            self.revision += 1;
        }
        // An older state that is taken back must lead to the same files too.
        for Step { document, .. } in self.undo.iter_mut().chain(&mut self.redo) {
            document.rebase(catalog(), &folder);
        }
        self.gesture = None;
        self.saved = Some(self.document.clone());
        self.file = Some(path.to_owned());
        self.left_out.clear();
        Ok(())
    }

    /// Goes back to the file as it is now, as one step of undo; `false` where there is none.
    ///
    /// # Errors
    /// Where the file cannot be read or is no graph; the graph is then as it was.
    pub fn revert(&mut self) -> Result<bool, DocumentError> {
        let Some(file) = &self.file else {
            return Ok(false);
        };
        let Self { document, saved, left_out, .. } = Self::load(file)?;
        let frame = self.document.frame;
        self.edit("revert to the file", |now| *now = Document { frame, ..document });
        (self.saved, self.left_out) = (saved.map(|saved| Document { frame, ..saved }), left_out);
        Ok(true)
    }

    /// Goes back to a version of its file, as one step of undo.
    ///
    /// # Errors
    /// Where the version cannot be read; the graph is then as it was.
    pub fn restore(&mut self, version: &versions::Version) -> Result<(), DocumentError> {
        let Self { document, .. } = Self::load(&version.path)?;
        // Its relative paths start at the graph, not at the version.
        let Document { base, frame, .. } = self.document.clone();
        self.edit("restore a version", |now| *now = Document { base, frame, ..document });
        Ok(())
    }
}

/// The folder of a graph, absolute, so that it stays the same if the working directory changes.
fn folder(path: &Path) -> PathBuf {
    let folder = path.parent().unwrap_or(Path::new(""));
    match std::path::absolute(path) {
        Ok(path) => path.parent().unwrap_or(folder).to_owned(),
        Err(_) => folder.to_owned(),
    }
}
