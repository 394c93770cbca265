//! Opening and saving: dialogs, dropped files, presets, and the question before work is lost.

use std::path::{Path, PathBuf};

use egui::{Ui, ViewportCommand};
use egui_file_dialog::{DialogState, FileDialog};

use super::App;
use crate::editor::dialog;
use crate::editor::panels::unsaved::{self, Answer};
use crate::editor::{Project, Selection, Statuses};
use crate::graph::{Document, node_name_from};
use crate::template;
use crate::volume::vdb;

/// How the names of graphs end.
const GRAPH_ENDINGS: &[&str] = &["json"];

/// What a dialog is for.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Purpose {
    Graph,
    /// A graph becomes a group of the one that is open.
    Insert,
    Volume,
    Save,
    /// A group is written to a file of its own.
    Preset,
}

/// What comes after the question whether to save.
#[derive(Debug, Clone, PartialEq)]
pub enum Goal {
    /// The start page.
    Start,
    /// The end.
    Quit,
    /// A graph or volume.
    Open(PathBuf),
    /// A preset by its place in the list.
    Preset(usize),
}

/// What is being asked.
#[derive(Default)]
pub struct Files {
    dialog: Option<(FileDialog, Purpose)>,
    /// What waits for the answer whether to save.
    waiting: Option<Goal>,
    /// Saving was asked for on the way to this goal.
    after_save: Option<Goal>,
    may_close: bool,
    /// The group that is to be written as a preset.
    preset: Option<Document>,
    /// The title that the window has.
    title: String,
}

impl Files {
    /// Whether the user has agreed to the end of the window.
    pub fn is_closing(&self) -> bool {
        self.may_close
    }

    /// Whether a dialog or the question whether to save has the keyboard.
    pub fn is_asking(&self) -> bool {
        self.dialog.is_some() || self.waiting.is_some()
    }

    /// Ends the window without a question.
    pub fn close(&mut self) {
        self.may_close = true;
    }

    /// Asks for a graph, to open or to insert.
    pub fn ask_graph(&mut self, folder: Option<&Path>, inserts: bool) {
        let (title, purpose) = match inserts {
            true => ("Insert a graph as a group", Purpose::Insert),
            false => ("Open a graph", Purpose::Graph),
        };
        self.dialog = Some((dialog::to_open(title, folder, GRAPH_ENDINGS), purpose));
    }

    /// Asks for a volume.
    pub fn ask_volume(&mut self, folder: Option<&Path>) {
        self.dialog = Some((dialog::to_open("Open a VDB", folder, vdb::ENDINGS), Purpose::Volume));
    }

    /// Asks where to save.
    pub fn ask_save(&mut self, folder: Option<&Path>, project: &Project) {
        let name = project.file().and_then(Path::file_name).map(|name| name.to_string_lossy().into_owned());
        let name = name.unwrap_or("graph.json".to_owned());
        let dialog = dialog::to_save("Save the graph", folder, &name, GRAPH_ENDINGS);
        self.dialog = Some((dialog, Purpose::Save));
    }
}

impl App {
    /// Name of the graph, with a mark where it is in no file.
    pub(super) fn title(&self) -> String {
        if !self.is_open {
            return String::new();
        }
        let mark = if self.project.is_unsaved() { " •" } else { "" };
        self.name() + mark
    }

    fn name(&self) -> String {
        let name = self.project.file().and_then(Path::file_name);
        name.map_or("untitled".to_owned(), |name| name.to_string_lossy().into_owned())
    }

    /// Goes on to something else, but asks first where work would be lost.
    pub(super) fn leave_for(&mut self, goal: Goal) {
        match self.is_open && self.project.is_unsaved() {
            true => self.files.waiting = Some(goal),
            false => self.go(goal),
        }
    }

    fn go(&mut self, goal: Goal) {
        self.give_up();
        match goal {
            Goal::Start => self.is_open = false,
            Goal::Quit => self.files.may_close = true,
            Goal::Open(path) => self.open_now(&path),
            Goal::Preset(idx) => self.open_preset_now(idx),
        }
    }

    /// Where files are looked for first: at the graph that is open, else where the last one was.
    pub(super) fn folder(&self) -> Option<PathBuf> {
        let file = self.project.file().filter(|_| self.is_open);
        let of_file = file.and_then(|file| std::path::absolute(file).ok()?.parent().map(Path::to_owned));
        of_file.or_else(|| self.settings.folder.clone())
    }

    /// Opens a graph, or a graph for a volume.
    pub(super) fn open(&mut self, path: &Path) {
        self.leave_for(Goal::Open(path.to_owned()));
    }

    /// Opens a copy of a preset.
    pub(super) fn open_preset(&mut self, idx: usize) {
        self.leave_for(Goal::Preset(idx));
    }

    fn open_now(&mut self, path: &Path) {
        let folder = if path.is_dir() { Some(path) } else { path.parent() };
        self.settings.folder = folder.map(|folder| std::path::absolute(folder).unwrap_or(folder.to_owned()));
        if path.extension().is_some_and(|ending| ending == "json") {
            match Project::load(path) {
                Ok(project) => {
                    self.settings.opened(path);
                    self.remember();
                    self.show(project);
                }
                Err(error) => self.toasts.complain(format!("{}: {error}", path.display())),
            }
            return;
        }
        match template::measure(path, true) {
            Ok(volume) => {
                let document = template::new_graph(&volume);
                let scale = document.nodes["medium"].params["density_scale"].clone();
                self.toasts.say(format!(
                    "Grid '{}', density scale {scale}: {} optical depths through the middle",
                    volume.grid,
                    template::TAU
                ));
                self.show(Project::new(document));
            }
            Err(error) => self.toasts.complain(error),
        }
    }

    fn open_preset_now(&mut self, idx: usize) {
        let Some(preset) = self.presets.get(idx) else { return };
        match preset.open() {
            Ok(document) => self.show(Project::new(template::absolute(document))),
            Err(error) => self.toasts.complain(error),
        }
    }

    /// Another graph: nothing of the one before is left.
    pub(super) fn show(&mut self, project: Project) {
        self.project = project;
        self.keep_safe();
        self.is_open = true;
        self.selection = Selection::default();
        self.statuses = Statuses::default();
        self.canvas = Default::default();
        self.viewport.fit();
        self.pictures.clear();
        self.thumbnails.clear();
        (self.chosen, self.look, self.bounds) = (None, None, None);
        (self.asked, self.spanned, self.flat) = (None, None, None);
        self.player = Default::default();
        // Of a graph that is gone; device and cache are the same.
        (self.figures.picture_ms, self.figures.preview_ms) = (None, None);
    }

    /// Asks where to write a group as a graph of its own.
    pub(super) fn ask_preset(&mut self, name: &str) {
        let Some(inside) = self.project.document().inside(name).cloned() else { return };
        let file = format!("{}.json", name.replace('/', "_"));
        let folder = self.folder();
        let dialog = dialog::to_save("Save the group as a preset", folder.as_deref(), &file, GRAPH_ENDINGS);
        let base = self.project.document().base.clone();
        self.files.preset = Some(template::absolute(Document { base, ..inside }));
        self.files.dialog = Some((dialog, Purpose::Preset));
    }

    /// Adds a graph, or a group that was saved as a preset, to the graph that is open.
    fn insert(&mut self, path: &Path) {
        match Document::load(path) {
            Ok(preset) => {
                let stem = path.file_stem().unwrap_or_default().to_string_lossy();
                let name = node_name_from(&stem);
                self.canvas.insert_graph(&mut self.project, &mut self.selection, &preset, &name);
            }
            Err(error) => self.toasts.complain(format!("{}: {error}", path.display())),
        }
    }

    /// Saves to the graph's file, or asks for one; whether it was saved.
    pub(super) fn save(&mut self) -> bool {
        match self.project.file().map(Path::to_owned) {
            Some(file) => self.save_to(&file),
            None => {
                self.files.ask_save(self.folder().as_deref(), &self.project);
                false
            }
        }
    }

    fn save_to(&mut self, path: &Path) -> bool {
        let path = if path.extension().is_none() { path.with_extension("json") } else { path.to_owned() };
        match self.project.save_as(&path) {
            Ok(()) => {
                self.settings.opened(&path);
                self.remember();
                self.toasts.say(format!("Saved {}", path.display()));
                true
            }
            Err(error) => {
                self.toasts.complain(error);
                false
            }
        }
    }

    /// Dialogs, dropped files, and the closing of the window.
    pub(super) fn files(&mut self, ui: &Ui) {
        self.dialogs(ui);
        let dropped =
            ui.ctx().input(|input| input.raw.dropped_files.first().map(|file| file.path().to_owned()));
        if let Some(path) = dropped {
            self.open(&path);
        }
        if !ui.ctx().input(|input| input.raw.hovered_files.is_empty()) {
            drop_here(ui);
        }
        self.question(ui);
        if ui.ctx().input(|input| input.viewport().close_requested()) && !self.files.may_close {
            if self.is_open && self.project.is_unsaved() {
                ui.ctx().send_viewport_cmd(ViewportCommand::CancelClose);
                self.files.waiting = Some(Goal::Quit);
            } else {
                self.files.may_close = true;
            }
        }
        if self.files.may_close {
            ui.ctx().send_viewport_cmd(ViewportCommand::Close);
        }
        let title = if self.is_open { format!("{} – Tyndall", self.title()) } else { "Tyndall".to_owned() };
        if title != self.files.title {
            ui.ctx().send_viewport_cmd(ViewportCommand::Title(title.clone()));
            self.files.title = title;
        }
    }

    fn dialogs(&mut self, ui: &Ui) {
        let Some((dialog, purpose)) = &mut self.files.dialog else { return };
        // In a field the dialog's own takes the keyboard from it alone.
        if ui.input_mut(|input| input.consume_key(egui::Modifiers::NONE, egui::Key::Escape)) {
            (self.files.dialog, self.files.after_save) = (None, None);
            return;
        }
        dialog::update(dialog, ui);
        let purpose = *purpose;
        if let Some(path) = dialog.take_picked() {
            self.files.dialog = None;
            match purpose {
                Purpose::Save => {
                    let saved = self.save_to(&path);
                    if let Some(goal) = self.files.after_save.take().filter(|_| saved) {
                        self.go(goal);
                    }
                }
                Purpose::Preset => {
                    let text =
                        self.files.preset.take().map(|document| document.to_json()).unwrap_or_default();
                    match crate::image::atomic::write(&path, text.as_bytes()) {
                        Ok(()) => self.toasts.say(format!("Saved {}", path.display())),
                        Err(error) => self.toasts.complain(error),
                    }
                }
                Purpose::Graph | Purpose::Volume => self.open(&path),
                Purpose::Insert => self.insert(&path),
            }
        } else if !matches!(dialog.state(), DialogState::Open) {
            self.files.dialog = None;
            self.files.after_save = None;
        }
    }

    fn question(&mut self, ui: &Ui) {
        let Some(goal) = self.files.waiting.clone() else { return };
        let Some(answer) = unsaved::show(ui, &self.name()) else { return };
        self.files.waiting = None;
        match answer {
            Answer::Stay => {}
            Answer::Discard => self.go(goal),
            Answer::Save => match self.project.file().is_some() {
                true => {
                    if self.save() {
                        self.go(goal);
                    }
                }
                false => {
                    self.save();
                    self.files.after_save = Some(goal);
                }
            },
        }
    }

    /// The graph that is open, for tests.
    #[cfg(test)]
    pub(super) fn document(&self) -> &Document {
        self.project.document()
    }
}

/// Says what dropping does.
fn drop_here(ui: &Ui) {
    let painter = ui.ctx().layer_painter(egui::LayerId::new(egui::Order::Foreground, egui::Id::new("drop")));
    let rect = ui.ctx().content_rect();
    painter.rect_filled(rect, 0.0, egui::Color32::from_black_alpha(170));
    let font = egui::FontId::proportional(20.0);
    let text = "Drop a volume to light it, or a graph to open it";
    painter.text(rect.center(), egui::Align2::CENTER_CENTER, text, font, egui::Color32::WHITE);
}
