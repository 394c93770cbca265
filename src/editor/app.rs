//! The window: panels, and what passes between them.

mod files;
mod layout;
mod safety;
mod solving;

use std::collections::HashMap;
use std::path::{Path, PathBuf};
use std::rc::Rc;

use egui::{CentralPanel, Panel, TextureHandle, Ui};
use glam::DVec3;

use super::action::{self, Action};
use super::canvas::Canvas;
use super::look::{self, Look, Matter};
use super::panels::palette::Palette;
use super::panels::start::Start;
use super::panels::status_bar::{self, Figures};
use super::panels::toasts::Toasts;
use super::panels::{Marks, Possible, menu};
use super::player::Player;
use super::presets::{self, Preset};
use super::settings::{Settings, ThemeChoice};
use super::viewport::{Picture, Scene, Viewport};
use super::{Project, Selection, Statuses, Worker, theme};
use crate::gpu::AdapterChoice;
use crate::graph::{Document, flatten};
use crate::nodes::catalog;
use crate::template;
use files::Files;
use safety::Safety;

/// The editor.
pub struct App {
    project: Project,
    /// Without a graph there is the start page.
    is_open: bool,
    selection: Selection,
    statuses: Statuses,
    worker: Worker,
    canvas: Canvas,
    viewport: Viewport,
    start: Start,
    palette: Palette,
    toasts: Toasts,
    player: Player,
    files: Files,
    safety: Safety,
    figures: Figures,
    settings: Settings,
    /// Where they are kept.
    settings_file: Option<PathBuf>,
    presets: Vec<Preset>,
    shows_shortcuts: bool,
    /// The node whose picture was chosen.
    chosen: Option<String>,
    look: Option<Look>,
    flat: Option<Flat>,
    pictures: HashMap<String, Picture>,
    /// Small pictures of what nodes give, by name.
    thumbnails: HashMap<String, TextureHandle>,
    /// What is shown fills this box, in meters.
    bounds: Option<(Matter, [DVec3; 2])>,
    asked: Option<solving::Asked>,
    /// The revision that was last looked through for frames.
    spanned: Option<u64>,
    pictures_seen: PicturesSeen,
    /// The device is to be opened anew.
    restarts: bool,
    /// The inspector is to have the keyboard.
    inspects: bool,
}

/// The document without groups.
struct Flat {
    /// The revision and frame of which it was made.
    of: (u64, Option<i64>),
    document: Rc<Document>,
}

/// What a benchmark counts.
#[derive(Debug, Clone, Copy, Default)]
pub struct PicturesSeen {
    /// Pictures of the node that is looked at, of whatever level.
    pub count: u64,
    /// The last one was computed whole.
    pub is_whole: bool,
}

impl App {
    /// On a graph, or on the start page. What is not saved is kept in `state`, the program's own folder.
    pub fn new(
        context: &egui::Context,
        project: Option<Project>,
        adapter: &AdapterChoice,
        state: Option<PathBuf>,
    ) -> Self {
        let settings_file = Settings::file();
        let settings = Settings::load(settings_file.as_deref());
        theme::apply(context, settings.theme.into());
        context.set_zoom_factor(settings.scale);
        let waker = context.clone();
        let mut app = Self {
            is_open: project.is_some(),
            project: project.unwrap_or_default(),
            selection: Selection::default(),
            statuses: Statuses::default(),
            worker: Worker::start(adapter, move || waker.request_repaint()),
            canvas: Canvas::default(),
            viewport: Viewport::default(),
            start: Start::default(),
            palette: Palette::default(),
            toasts: Toasts::default(),
            player: Player::default(),
            files: Files::default(),
            safety: Safety::new(state),
            figures: Figures::default(),
            settings,
            settings_file,
            presets: template::presets().map(|folder| presets::list(&folder)).unwrap_or_default(),
            shows_shortcuts: false,
            chosen: None,
            look: None,
            flat: None,
            pictures: HashMap::new(),
            thumbnails: HashMap::new(),
            bounds: None,
            asked: None,
            spanned: None,
            pictures_seen: PicturesSeen::default(),
            restarts: false,
            inspects: false,
        };
        if let Some(file) = app.project.file().map(Path::to_owned) {
            app.settings.opened(&file);
            app.remember();
        }
        app.keep_safe();
        app
    }

    /// What has come of the node that is looked at.
    pub fn pictures_seen(&self) -> PicturesSeen {
        self.pictures_seen
    }

    /// Does what was asked for.
    pub fn perform(&mut self, context: &egui::Context, action: Action) {
        let now = context.input(|input| input.time);
        match action {
            Action::Undo => self.say_step("Undo", Project::undo),
            Action::Redo => self.say_step("Redo", Project::redo),
            Action::Start => self.leave_for(files::Goal::Start),
            Action::Quit => self.leave_for(files::Goal::Quit),
            Action::Open => self.files.ask_graph(self.folder().as_deref(), false),
            Action::Insert => self.files.ask_graph(self.folder().as_deref(), true),
            Action::OpenVolume => self.files.ask_volume(self.folder().as_deref()),
            Action::SaveAs => self.files.ask_save(self.folder().as_deref(), &self.project),
            Action::Save => drop(self.save()),
            Action::Revert => self.revert(),
            Action::Versions => self.safety.toggle_versions(),
            Action::Palette => self.palette.toggle(),
            Action::Shortcuts => self.shows_shortcuts = !self.shows_shortcuts,
            Action::FitPicture => self.viewport.fit(),
            Action::ActualSize => self.viewport.one_to_one(context),
            Action::Histogram => self.viewport.toggle_histogram(),
            Action::Slice => self.viewport.slice.toggle(),
            Action::FrameVolume => {
                let framed = self.with_scene(|viewport, project, scene| viewport.frame(project, scene));
                framed.unwrap_or_else(|why| self.toasts.say(why));
            }
            Action::StoreA => self.with_scene(|viewport, _, scene| viewport.store(0, scene)),
            Action::StoreB => self.with_scene(|viewport, _, scene| viewport.store(1, scene)),
            Action::Play => self.player.toggle(now),
            Action::NextFrame => self.player.go_to(self.player.frame.saturating_add(1)),
            Action::PreviousFrame => self.player.go_to(self.player.frame.saturating_sub(1)),
            Action::OtherPart if self.canvas.is_focused() => self.inspects = true,
            Action::OtherPart => self.canvas.take_keyboard(&mut self.selection),
            Action::Larger => self.scale_to(context, self.settings.scale + 0.1),
            Action::Smaller => self.scale_to(context, self.settings.scale - 0.1),
            Action::NormalSize => self.scale_to(context, 1.0),
            Action::Dark => self.theme_to(context, ThemeChoice::Dark),
            Action::Light => self.theme_to(context, ThemeChoice::Light),
            Action::System => self.theme_to(context, ThemeChoice::System),
            Action::Retry => self.retry(),
            Action::Canvas(command) => self.canvas.ask(command),
        }
    }

    fn say_step(&mut self, word: &str, step: impl FnOnce(&mut Project) -> Option<String>) {
        if let Some(label) = step(&mut self.project) {
            self.toasts.say(format!("{word}: {label}"));
        }
    }

    fn scale_to(&mut self, context: &egui::Context, scale: f32) {
        self.settings.scale = ((scale * 10.0).round() / 10.0).clamp(0.5, 3.0);
        context.set_zoom_factor(self.settings.scale);
    }

    fn theme_to(&mut self, context: &egui::Context, choice: ThemeChoice) {
        self.settings.theme = choice;
        self.remember();
        theme::apply(context, choice.into());
    }

    /// Keeps the settings, which a kill would otherwise take with it.
    fn remember(&self) {
        self.settings.save(self.settings_file.as_deref());
    }

    fn possible(&self) -> Possible {
        Possible {
            graph: self.is_open,
            undo: self.is_open && self.project.can_undo(),
            redo: self.is_open && self.project.can_redo(),
            frames: self.has_frames(),
        }
    }

    fn marks(&self) -> Marks {
        Marks {
            snaps: self.canvas.snaps(),
            minimap: self.canvas.shows_minimap(),
            histogram: self.viewport.shows_histogram(),
            slice: self.viewport.slice.is_on(),
            theme: self.settings.theme,
        }
    }

    fn has_frames(&self) -> bool {
        self.is_open && self.player.has_frames()
    }

    /// The frame that is looked at, where there are several.
    fn asks_frame(&self) -> Option<i64> {
        self.has_frames().then_some(self.player.frame)
    }

    /// The document without groups, made anew where it is another.
    fn flat(&mut self) -> Rc<Document> {
        let document = self.project.document();
        let of = (self.project.revision(), document.frame);
        let made = self.flat.take().filter(|flat| flat.of == of);
        let flat =
            made.unwrap_or_else(|| Flat { of, document: Rc::new(flatten(document, catalog()).into_owned()) });
        let flat = self.flat.insert(flat);
        Rc::clone(&flat.document)
    }

    /// Calls `body` with what the viewport shows.
    fn with_scene<T>(&mut self, body: impl FnOnce(&mut Viewport, &mut Project, &Scene) -> T) -> T {
        let camera =
            self.look.as_ref().and_then(|look| look::camera(self.project.document(), look.camera.as_ref()?));
        let slices = self.viewport.slice.is_on();
        let flat = slices.then(|| self.flat());
        let scene = Scene {
            look: self.look.as_ref(),
            pictures: &self.pictures,
            camera,
            bounds: self.bounds(),
            problem: self.problem(),
            is_busy: self.figures.running.is_some() || self.figures.adapter.is_none(),
            flat: flat.as_deref(),
        };
        body(&mut self.viewport, &mut self.project, &scene)
    }

    fn follow_frames(&mut self, ui: &Ui) {
        if self.spanned != Some(self.project.revision()) {
            self.spanned = Some(self.project.revision());
            let flat = self.flat();
            let changed = self.asked.as_ref().map(|asked| look::changed(&asked.document, &flat));
            let as_it_was = |node: &str| {
                changed.as_ref().is_some_and(|changed| !changed.contains(node))
                    && flat.nodes.contains_key(node)
            };
            self.player.set_span(super::player::span(&flat), as_it_was);
        }
        self.player.advance(ui.input(|input| input.time), self.settings.fps);
        if self.player.is_playing() {
            ui.ctx().request_repaint_after_secs((0.5 / self.settings.fps) as f32);
        }
        // What has keys is shown and set as it is at the frame.
        self.project.look_at(self.asks_frame());
    }
}

impl eframe::App for App {
    fn ui(&mut self, ui: &mut Ui, _: &mut eframe::Frame) {
        let context = ui.ctx().clone();
        if self.hands_over(&context) {
            return;
        }
        self.listen(&context);
        for action in action::pressed(&context, self.is_open && self.canvas.has_keys()) {
            if self.possible().is(action) {
                self.perform(&context, action);
            }
        }
        self.follow_frames(ui);
        self.look = if self.is_open { look::look(&self.flat(), self.chosen.as_deref()) } else { None };
        self.over(ui);
        let title = self.title();
        let asked =
            Panel::top("menu").show(ui, |ui| menu::show(ui, self.possible(), self.marks(), &title)).inner;
        asked.into_iter().for_each(|action| self.perform(&context, action));
        self.offer(ui);
        let retries = Panel::bottom("status").show(ui, |ui| status_bar::show(ui, &self.figures)).inner;
        if retries {
            self.perform(&context, Action::Retry);
        }
        if self.is_open {
            self.editor(ui);
        } else {
            CentralPanel::default().show(ui, |ui| self.page(ui));
        }
        self.safety(ui);
        self.toasts.show(ui);
        if self.is_open {
            self.ask(&context);
        }
    }

    fn on_exit(&mut self) {
        self.remember();
        self.end();
    }
}

#[cfg(test)]
mod tests;
