//! Short messages that go away by themselves; errors stay until they are clicked.

use egui::{Align2, Area, Color32, Frame, Id, Order, Ui, vec2};

use crate::editor::theme;

const SECONDS: f64 = 4.0;

#[derive(Debug)]
struct Toast {
    text: String,
    is_error: bool,
    /// When it is gone, in seconds of the window; set when it is first seen.
    until: Option<f64>,
}

/// What is shown now.
#[derive(Debug, Default)]
pub struct Toasts(Vec<Toast>);

impl Toasts {
    /// Says something that was done.
    pub fn say(&mut self, text: impl Into<String>) {
        self.0.push(Toast { text: text.into(), is_error: false, until: None });
    }

    /// Says what went wrong, once for as long as it stands there.
    pub fn complain(&mut self, text: impl ToString) {
        let text = text.to_string();
        if !self.0.iter().any(|toast| toast.is_error && toast.text == text) {
            self.0.push(Toast { text, is_error: true, until: None });
        }
    }

    /// Draws them in the corner.
    pub fn show(&mut self, ui: &Ui) {
        let now = ui.input(|input| input.time);
        for toast in self.0.iter_mut().filter(|toast| !toast.is_error) {
            let until = *toast.until.get_or_insert(now + SECONDS);
            ui.ctx().request_repaint_after_secs((until - now).max(0.0) as f32);
        }
        self.0.retain(|toast| toast.until.is_none_or(|until| now < until));
        let mut clicked = None;
        let area = Area::new(Id::new("toasts"))
            .order(Order::Foreground)
            .anchor(Align2::RIGHT_BOTTOM, vec2(-14.0, -36.0));
        area.show(ui.ctx(), |ui| {
            for (idx, toast) in self.0.iter().enumerate() {
                let edge = if toast.is_error { theme::BAD } else { theme::ACCENT };
                let frame = Frame::popup(ui.style()).stroke((1.0, edge)).inner_margin(10.0);
                frame.show(ui, |ui| {
                    ui.set_max_width(420.0);
                    ui.horizontal_top(|ui| {
                        ui.add(egui::Label::new(&toast.text).wrap());
                        let close =
                            egui::Button::new("×").fill(Color32::TRANSPARENT).frame_when_inactive(false);
                        if toast.is_error && ui.add(close).on_hover_text("Dismiss").clicked() {
                            clicked = Some(idx);
                        }
                    });
                });
            }
        });
        if let Some(idx) = clicked {
            self.0.remove(idx);
        }
    }
}
