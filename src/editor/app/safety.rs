//! Work is never lost: what is not saved is written down, found again after a kill, and offered; what was saved
//! before can be had back.

use std::path::PathBuf;
use std::time::{Instant, SystemTime};

use egui::{Grid, Panel, Ui, Window, vec2};

use super::App;
use crate::editor::project::{Autosave, Recoverable, recoverable, versions};
use crate::editor::window;
use crate::gpu::Faults;

/// What was not saved, and what was saved before.
pub struct Safety {
    /// The program's own folder; without one nothing is kept.
    state: Option<PathBuf>,
    autosave: Option<Autosave>,
    /// What another program left when it ended without saving.
    found: Vec<Recoverable>,
    shows_versions: bool,
    /// Of the window's own device, and where to leave the graph when it is gone.
    device: Option<(Faults, window::Place)>,
}

impl Safety {
    /// In the program's own folder.
    pub fn new(state: Option<PathBuf>) -> Self {
        let found = state.as_deref().map(recoverable).unwrap_or_default();
        Self {
            autosave: state.as_deref().map(Autosave::new),
            found,
            state,
            shows_versions: false,
            device: None,
        }
    }

    /// Shows the earlier versions, or hides them.
    pub fn toggle_versions(&mut self) {
        self.shows_versions = !self.shows_versions;
    }
}

impl App {
    /// Watches the window's own device.
    pub fn watch(&mut self, faults: Faults, place: window::Place) {
        self.safety.device = Some((faults, place));
    }

    /// Says that this window stands in place of one whose device was lost.
    pub fn tell_lost(&mut self, why: &str) {
        // Not every driver says why.
        let why = if why.is_empty() { String::new() } else { format!(" ({why})") };
        self.toasts.complain(format!(
            "The window's GPU was lost{why} and opened anew. The graph and its history are as they were."
        ));
    }

    /// Writes down what is not saved where the window before this one did.
    pub fn go_on_with(&mut self, autosave: Option<Autosave>) {
        if autosave.is_some() {
            self.safety.autosave = autosave;
        }
    }

    /// Whether the window's device is gone. Then its graph is left to the next one, it closes, and nothing is to be
    /// drawn: egui-wgpu ends the program where it cannot hand on what is. What is written down stays until the end.
    pub(super) fn hands_over(&mut self, context: &egui::Context) -> bool {
        let Some((faults, place)) = &self.safety.device else { return false };
        let Some(why) = faults.look() else {
            if let Some(error) = faults.take_error() {
                self.toasts.complain(format!("The window was not drawn as it should be: {error}"));
            }
            return false;
        };
        if !self.files.is_closing() {
            let project = self.is_open.then(|| std::mem::take(&mut self.project));
            // Held by this window still, it is not offered to the next as what another program left.
            let autosave = self.safety.autosave.take();
            *place.borrow_mut() = Some(window::Left { project, why: Some(why), autosave });
            self.is_open = false;
            self.files.close();
        }
        context.send_viewport_cmd(egui::ViewportCommand::Close);
        true
    }

    /// Writes down what is not saved, and asks what to do with what was not.
    pub(super) fn safety(&mut self, ui: &Ui) {
        if let Some(autosave) = self.safety.autosave.as_mut().filter(|_| self.is_open) {
            if let Some(wrong) = autosave.tick(&self.project, Instant::now()) {
                self.toasts.complain(wrong);
            }
            if self.project.is_unsaved() {
                // A last change is written down though nothing else happens.
                ui.ctx().request_repaint_after(crate::editor::project::EVERY);
            }
        }
        if let Some(warning) = self.project.take_warning() {
            self.toasts.complain(warning);
        }
        self.versions(ui);
    }

    /// From now on this graph's versions are kept, and what it was opened without is told.
    pub(super) fn keep_safe(&mut self) {
        if let Some(state) = &self.safety.state {
            self.project.keep_versions(state);
        }
        if !self.project.left_out().is_empty() {
            let lines = self.project.left_out().join("\n· ");
            let what =
                "Not understood, and left out when you save; Earlier versions then keeps the file as it is:";
            self.toasts.complain(format!("{what}\n· {lines}"));
        }
        self.safety.shows_versions = false;
    }

    /// The graph is given up or saved: nothing of it is to be found again.
    pub(super) fn give_up(&mut self) {
        if let Some(autosave) = &mut self.safety.autosave {
            autosave.forget();
        }
    }

    /// The window ends. Where nobody agreed to that (the display is gone), what is not saved stays written down.
    pub(super) fn end(&mut self) {
        if self.files.is_closing() {
            self.give_up();
        }
    }

    /// Goes back to the file, as a step of undo.
    pub(super) fn revert(&mut self) {
        match self.project.revert() {
            Ok(true) => self.toasts.say("Back to the file; Undo takes it back"),
            Ok(false) => self.toasts.complain("This graph has no file yet"),
            Err(error) => self.toasts.complain(error),
        }
    }

    /// Offers what was not saved when its program ended; drawn above everything else.
    pub(super) fn offer(&mut self, ui: &mut Ui) {
        let Some(found) = self.safety.found.first() else { return };
        let name = found
            .file
            .as_ref()
            .map_or("a graph without a file".to_owned(), |file| file.display().to_string());
        let text = format!("Tyndall ended {} with changes in {name} that were not saved.", ago(found.time));
        let answer = Panel::top("recovery").show(ui, |ui| {
            ui.horizontal(|ui| {
                ui.label(text);
                let recovers = ui.button("Recover").clicked();
                (recovers, ui.button("Discard").clicked())
            })
            .inner
        });
        match (answer.inner, &mut self.safety.autosave) {
            ((true, _), _) if self.is_open && self.project.is_unsaved() => {
                self.toasts.say("Save what is open first");
            }
            ((true, _), Some(autosave)) => {
                let project = autosave.recover(self.safety.found.remove(0));
                self.show(project);
            }
            ((_, true), _) => self.safety.found.remove(0).discard(),
            _ => {}
        }
    }

    fn versions(&mut self, ui: &Ui) {
        let (Some(state), Some(file)) = (&self.safety.state, self.project.file()) else {
            if std::mem::take(&mut self.safety.shows_versions) {
                self.toasts.say("There are versions once the graph is saved");
            }
            return;
        };
        if !self.safety.shows_versions || !self.is_open {
            return;
        }
        let listed = versions::list(state, file);
        let mut chosen = None;
        let mut is_open = true;
        // Clear of the menu that it was asked from, and of the graph.
        let place = ui.ctx().content_rect().center_top() + vec2(-130.0, 60.0);
        let window = Window::new("Earlier versions").open(&mut is_open).default_pos(place);
        window.resizable(false).collapsible(false).default_width(260.0).show(ui.ctx(), |ui| {
            if listed.is_empty() {
                ui.weak("None yet: one is kept at each save.");
            }
            Grid::new("versions").num_columns(2).spacing(vec2(24.0, 6.0)).show(ui, |ui| {
                for version in &listed {
                    ui.label(format!("{}. written {}", version.number, ago(version.time)));
                    if ui.button(format!("Restore version {}", version.number)).clicked() {
                        chosen = Some(version.clone());
                    }
                    ui.end_row();
                }
            });
        });
        self.safety.shows_versions = is_open;
        if let Some(version) = chosen {
            match self.project.restore(&version) {
                Ok(()) => self.toasts.say(format!("Back to version {}; Undo takes it back", version.number)),
                Err(error) => self.toasts.complain(error),
            }
        }
    }
}

/// "3 minutes ago".
fn ago(time: SystemTime) -> String {
    let secs = SystemTime::now().duration_since(time).map_or(0, |passed| passed.as_secs());
    let (count, unit) = match secs {
        0..60 => return "just now".to_owned(),
        60..3600 => (secs / 60, "minute"),
        3600..86_400 => (secs / 3600, "hour"),
        _ => (secs / 86_400, "day"),
    };
    format!("{count} {unit}{} ago", if count == 1 { "" } else { "s" })
}

#[cfg(test)]
mod tests {
    use std::time::Duration;

    use super::*;

    #[test]
    fn times_as_people_say_them() {
        let before = |secs| ago(SystemTime::now() - Duration::from_secs(secs));
        assert_eq!(before(5), "just now");
        assert_eq!(before(61), "1 minute ago");
        assert_eq!(before(7300), "2 hours ago");
        assert_eq!(before(200_000), "2 days ago");
    }
}
