//! The window: panels, and what passes between them.

mod files;
mod safety;
mod solving;

use std::collections::HashMap;
use std::path::{Path, PathBuf};

use egui::{CentralPanel, Frame, Panel, Sense, TextureHandle, Ui, UiBuilder};

use super::action::{self, Action};
use super::canvas::{Canvas, Request};
use super::look::{self, Look};
use super::panels::palette::{self, Palette};
use super::panels::start::{self, Start};
use super::panels::status_bar::{self, Figures};
use super::panels::toasts::Toasts;
use super::panels::{Possible, menu, shortcuts, timeline};
use super::player::Player;
use super::presets::{self, Preset};
use super::settings::{Settings, ThemeChoice};
use super::viewport::{Picture, Scene, Viewport};
use super::{Project, Selection, Statuses, Worker, inspector, theme};
use crate::gpu::AdapterChoice;
use crate::graph::flatten;
use crate::nodes::catalog;
use crate::template;
use crate::volume::Lattice;
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
    presets: Vec<Preset>,
    shows_shortcuts: bool,
    /// The node whose picture was chosen.
    chosen: Option<String>,
    look: Option<Look>,
    pictures: HashMap<String, Picture>,
    /// Small pictures of what nodes give, by name.
    thumbnails: HashMap<String, TextureHandle>,
    lattice: Option<Lattice>,
    asked: Option<solving::Asked>,
    /// The revision that was last looked through for frames.
    spanned: Option<u64>,
    pictures_seen: PicturesSeen,
    /// The device is to be opened anew.
    restarts: bool,
    /// The inspector is to have the keyboard.
    inspects: bool,
}

/// What a benchmark counts.
#[derive(Debug, Clone, Copy, Default)]
pub struct PicturesSeen {
    /// Pictures of the node that is looked at, of whatever level.
    pub count: u64,
    /// The last one was computed whole.
    pub is_whole: bool,
}

/// What the canvas has of the window's height, where the user did not choose.
const CANVAS_SHARE: f32 = 0.4;

impl App {
    /// On a graph, or on the start page. What is not saved is kept in `state`, the program's own folder.
    pub fn new(
        context: &egui::Context,
        project: Option<Project>,
        adapter: &AdapterChoice,
        state: Option<PathBuf>,
    ) -> Self {
        let settings = Settings::load(Settings::file().as_deref());
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
            presets: template::presets().map(|folder| presets::list(&folder)).unwrap_or_default(),
            shows_shortcuts: false,
            chosen: None,
            look: None,
            pictures: HashMap::new(),
            thumbnails: HashMap::new(),
            lattice: None,
            asked: None,
            spanned: None,
            pictures_seen: PicturesSeen::default(),
            restarts: false,
            inspects: false,
        };
        if let Some(file) = app.project.file().map(Path::to_owned) {
            app.settings.opened(&file);
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
            Action::Open => self.files.ask_graph(self.settings.folder.as_deref()),
            Action::OpenVolume => self.files.ask_volume(self.settings.folder.as_deref()),
            Action::SaveAs => self.files.ask_save(self.settings.folder.as_deref(), &self.project),
            Action::Save => drop(self.save()),
            Action::Revert => self.revert(),
            Action::Versions => self.safety.toggle_versions(),
            Action::Palette => self.palette.toggle(),
            Action::Shortcuts => self.shows_shortcuts = !self.shows_shortcuts,
            Action::FitPicture => self.viewport.fit(),
            Action::ActualSize => self.viewport.one_to_one(context),
            Action::Histogram => self.viewport.toggle_histogram(),
            Action::Slice => self.viewport.slice.toggle(),
            Action::FrameMedium => self.with_scene(|viewport, project, scene| viewport.frame(project, scene)),
            Action::StoreA => self.with_scene(|viewport, _, scene| viewport.store(0, scene)),
            Action::StoreB => self.with_scene(|viewport, _, scene| viewport.store(1, scene)),
            Action::Play => self.player.toggle(now),
            Action::NextFrame => self.player.go_to(self.player.frame.saturating_add(1)),
            Action::PreviousFrame => self.player.go_to(self.player.frame.saturating_sub(1)),
            Action::OtherPart if self.canvas.is_focused() => self.inspects = true,
            Action::OtherPart => self.canvas.take_keyboard(&self.selection),
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
        theme::apply(context, choice.into());
    }

    fn possible(&self) -> Possible {
        Possible {
            graph: self.is_open,
            undo: self.is_open && self.project.can_undo(),
            redo: self.is_open && self.project.can_redo(),
            frames: self.has_frames(),
        }
    }

    fn has_frames(&self) -> bool {
        self.is_open && self.player.has_frames()
    }

    /// The frame that is looked at, where there are several.
    fn asks_frame(&self) -> Option<i64> {
        self.has_frames().then_some(self.player.frame)
    }

    /// Calls `body` with what the viewport shows.
    fn with_scene(&mut self, body: impl FnOnce(&mut Viewport, &mut Project, &Scene)) {
        let camera =
            self.look.as_ref().and_then(|look| look::camera(self.project.document(), look.camera.as_ref()?));
        let slices = self.viewport.slice.is_on();
        let flat = slices.then(|| flatten(self.project.document(), catalog()).into_owned());
        let scene = Scene {
            look: self.look.as_ref(),
            pictures: &self.pictures,
            camera,
            bounds: self.lattice.as_ref().map(solving::bounds),
            problem: self.problem(),
            is_busy: self.figures.running.is_some() || self.figures.adapter.is_none(),
            flat: flat.as_ref(),
        };
        body(&mut self.viewport, &mut self.project, &scene);
    }

    fn follow_frames(&mut self, ui: &Ui) {
        if self.spanned != Some(self.project.revision()) {
            self.spanned = Some(self.project.revision());
            let flat = flatten(self.project.document(), catalog());
            self.player.set_span(super::player::span(&flat));
        }
        self.player.advance(ui.input(|input| input.time), self.settings.fps);
        if self.player.is_playing() {
            ui.ctx().request_repaint_after_secs((0.5 / self.settings.fps) as f32);
        }
        // What has keys is shown and set as it is at the frame.
        self.project.look_at(self.asks_frame());
    }

    fn page(&mut self, ui: &mut Ui) {
        let choice = self.start.show(ui, &self.presets, &self.settings.recent);
        match choice {
            Some(start::Choice::Preset(idx)) => self.open_preset(idx),
            Some(start::Choice::Recent(path)) => self.open(&path),
            Some(start::Choice::Action(action)) => self.perform(&ui.ctx().clone(), action),
            None => {}
        }
    }

    fn editor(&mut self, ui: &mut Ui) {
        if self.has_frames() {
            Panel::bottom("timeline").show(ui, |ui| {
                timeline::show(ui, &mut self.player, &mut self.settings.fps);
            });
        }
        let width = self.settings.inspector_width;
        let panel = Panel::right("inspector").resizable(true).default_size(width).min_size(200.0);
        let context = inspector::Context {
            selection: &self.selection,
            statuses: &self.statuses,
            opened: self.canvas.group(),
            frame: self.asks_frame(),
            takes_keyboard: std::mem::take(&mut self.inspects),
        };
        let shown = panel.show(ui, |ui| {
            // What is too wide is cut: a panel that grew with it would move the canvas with each selection.
            let (rect, _) = ui.allocate_exact_size(ui.available_size(), Sense::hover());
            let mut inside = ui.new_child(UiBuilder::new().max_rect(rect));
            inside.set_clip_rect(rect.expand(4.0).intersect(ui.clip_rect()));
            inspector::show(&mut inside, &mut self.project, &context)
        });
        self.settings.inspector_width = shown.response.rect.width();
        if let Some(name) = shown.inner {
            self.selection.only(&name);
            self.canvas.reveal(&name);
        }
        // Of the window's height enough for a graph of seven layers to be read.
        let usual = (CANVAS_SHARE * ui.ctx().content_rect().height()).round();
        let height = self.settings.canvas_height.unwrap_or(usual);
        let panel = Panel::bottom("canvas").resizable(true).default_size(height).min_size(120.0);
        let shown = panel.frame(Frame::new()).show(ui, |ui| {
            let (project, selection) = (&mut self.project, &mut self.selection);
            self.canvas.show(ui, project, selection, &self.statuses, &self.thumbnails)
        });
        let height = shown.response.rect.height();
        if (height - usual).abs() > 1.0 && ui.input(|input| input.pointer.any_down()) {
            self.settings.canvas_height = Some(height);
        }
        for request in shown.inner {
            match request {
                Request::Show(name) => self.chosen = Some(name),
                Request::Inspect(name) => {
                    self.selection.only(&name);
                    self.canvas.reveal(&name);
                    self.inspects = true;
                }
                Request::SavePreset(name) => self.ask_preset(&name),
            }
        }
        let frame = Frame::central_panel(ui.style()).inner_margin(6.0);
        CentralPanel::default().frame(frame).show(ui, |ui| {
            let before = self.project.revision();
            self.with_scene(|viewport, project, scene| viewport.show(ui, project, scene));
            // A hand on a camera with keys sets one, at a frame that stands.
            let camera = self.look.as_ref().and_then(|look| look.camera.as_ref());
            if before != self.project.revision()
                && camera.is_some_and(|name| Viewport::has_keys(self.project.document(), name))
            {
                self.player.stop();
            }
        });
    }
}

impl eframe::App for App {
    fn ui(&mut self, ui: &mut Ui, _: &mut eframe::Frame) {
        let context = ui.ctx().clone();
        self.listen(&context);
        for action in action::pressed(&context, self.is_open && self.canvas.has_keys()) {
            if self.possible().is(action) {
                self.perform(&context, action);
            }
        }
        self.follow_frames(ui);
        self.look = if self.is_open {
            look::look(&flatten(self.project.document(), catalog()), self.chosen.as_deref())
        } else {
            None
        };
        let title = self.title();
        let asked = Panel::top("menu").show(ui, |ui| menu::show(ui, self.possible(), &title)).inner;
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
        match self.palette.show(ui, self.possible(), &self.presets) {
            Some(palette::Choice::Action(action)) => self.perform(&context, action),
            Some(palette::Choice::Preset(idx)) => self.open_preset(idx),
            None => {}
        }
        shortcuts::show(ui, &mut self.shows_shortcuts);
        self.files(ui);
        self.safety(ui);
        self.toasts.show(ui);
        if self.is_open {
            self.ask(&context);
        }
    }

    fn on_exit(&mut self) {
        self.settings.save(Settings::file().as_deref());
        self.end();
    }
}

#[cfg(test)]
mod tests;
