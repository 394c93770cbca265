//! The panels of the window, and what is asked of one by another.

use egui::{CentralPanel, Frame, Panel, Sense, Ui, UiBuilder};

use super::App;
use crate::editor::canvas::Request;
use crate::editor::inspector;
use crate::editor::panels::{palette, shortcuts, start, timeline};
use crate::editor::viewport::Viewport;

/// What the canvas has of the window's height, where the user did not choose.
const CANVAS_SHARE: f32 = 0.4;

impl App {
    /// Palette, pages and dialogs, which stand over the panels: drawn before them, so that their keys are their own.
    pub(super) fn over(&mut self, ui: &Ui) {
        let is_asking = |app: &Self| app.palette.is_open() || app.shows_shortcuts || app.files.is_asking();
        let was_asking = is_asking(self);
        match self.palette.show(ui, self.possible(), &self.presets) {
            Some(palette::Choice::Action(action)) => self.perform(&ui.ctx().clone(), action),
            Some(palette::Choice::Preset(idx)) => self.open_preset(idx),
            None => {}
        }
        shortcuts::show(ui, &mut self.shows_shortcuts);
        self.files(ui);
        self.canvas.stay_behind(was_asking || is_asking(self));
    }

    /// Where no graph is open.
    pub(super) fn page(&mut self, ui: &mut Ui) {
        let choice = self.start.show(ui, &self.presets, &self.settings.recent);
        match choice {
            Some(start::Choice::Preset(idx)) => self.open_preset(idx),
            Some(start::Choice::Recent(path)) => self.open(&path),
            Some(start::Choice::Action(action)) => self.perform(&ui.ctx().clone(), action),
            None => {}
        }
    }

    /// Timeline, inspector, canvas and viewport.
    pub(super) fn editor(&mut self, ui: &mut Ui) {
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
