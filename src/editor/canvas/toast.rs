//! A line at the foot of the canvas that says why something was not done, for some seconds.

use std::time::Duration;

use egui::{Align2, Area, Frame, Id, Label, Order, RichText, vec2};

use super::Canvas;
use super::theme::Theme;

const SHOWN_SECS: f64 = 5.0;

/// What is said, and until when on egui's clock.
#[derive(Debug)]
pub struct Toast {
    text: String,
    until: f64,
}

impl Canvas {
    pub(super) fn tell(&mut self, ui: &egui::Ui, text: String) {
        let until = ui.input(|input| input.time) + SHOWN_SECS;
        self.toast = Some(Toast { text, until });
    }

    pub(super) fn show_toast(&mut self, ui: &egui::Ui) {
        let now = ui.input(|input| input.time);
        self.toast.take_if(|toast| toast.until < now);
        let (Some(toast), Some(screen)) = (&self.toast, self.screen) else { return };
        let area = Area::new(Id::new("canvas toast")).order(Order::Foreground).interactable(false);
        let area = area.pivot(Align2::CENTER_BOTTOM).fixed_pos(screen.center_bottom() - vec2(0.0, 16.0));
        area.show(ui.ctx(), |ui| {
            Frame::popup(ui.style()).show(ui, |ui| {
                let text = RichText::new(&toast.text).color(Theme::of(ui).bad);
                ui.add(Label::new(text).selectable(false));
            });
        });
        ui.ctx().request_repaint_after(Duration::from_secs_f64((toast.until - now).max(0.05)));
    }
}
