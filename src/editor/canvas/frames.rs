//! Frames: comments behind nodes, which go where their frame goes.

use egui::{
    Align2, Color32, CornerRadius, CursorIcon, Id, PointerButton, Rect, Sense, Stroke, StrokeKind, Vec2,
};
use egui::{WidgetInfo, WidgetType, pos2, vec2};

use super::desk::Desk;
use super::gesture::Gesture;
use super::paint::Brush;
use super::{Canvas, Chosen};
use crate::graph::Frame;

/// The height of a frame's title, and the least size of a frame, in points of the canvas.
const TITLE: f32 = 26.0;
const LEAST: f32 = 48.0;
const MARGIN: f32 = 20.0;

fn rect_of(frame: &Frame) -> Rect {
    let [[x, y], [width, height]] = [frame.at, frame.size].map(|pair| pair.map(|x| x as f32));
    Rect::from_min_size(pos2(x, y), vec2(width, height))
}

impl Canvas {
    /// A frame around the selected nodes, whose title is asked for.
    pub(super) fn add_frame(&mut self, desk: &mut Desk) {
        let around = self.scene.bounds(&desk.selection.nodes);
        let around = match around.is_positive() {
            true => around.expand(MARGIN),
            false => Rect::from_min_size(self.view.from_screen(self.pointer), vec2(320.0, 200.0)),
        };
        let around = Rect::from_min_max(around.min - vec2(0.0, TITLE), around.max);
        let whole = |pair: Vec2| [pair.x.round(), pair.y.round()].map(f64::from);
        let (at, size) = (whole(around.min.to_vec2()), whole(around.size()));
        desk.edit("Frame", |document| {
            document.frames.push(Frame { title: "comment".to_owned(), at, size, color: None });
        });
        let idx = desk.document().frames.len() - 1;
        self.chosen = Some(Chosen::Frame(idx));
        self.open_title_field(idx, "comment");
    }

    pub(super) fn frame_rect(&self, desk: &Desk, idx: usize) -> Option<Rect> {
        desk.document().frames.get(idx).map(rect_of)
    }

    /// Draws the frames; their titles are dragged, their lower right corners resize them.
    pub(super) fn frames(&mut self, ui: &egui::Ui, brush: &Brush, desk: &mut Desk) {
        for (idx, frame) in desk.document().frames.clone().iter().enumerate() {
            let rect = brush.view.rect_to_screen(rect_of(frame));
            if !rect.intersects(brush.painter.clip_rect()) {
                continue;
            }
            let color = frame.color.map_or(brush.theme.weak, |[r, g, b]| {
                let [r, g, b] = [r, g, b].map(|x| (x * 255.0).round() as u8);
                Color32::from_rgb(r, g, b)
            });
            let is_chosen = self.chosen == Some(Chosen::Frame(idx));
            let edge = if is_chosen { brush.theme.accent } else { color.gamma_multiply(0.5) };
            let corners = CornerRadius::same(8);
            brush.painter.rect(
                rect,
                corners,
                color.gamma_multiply(0.1),
                Stroke::new(1.0, edge),
                StrokeKind::Inside,
            );
            let zoom = brush.view.zoom;
            let title = Rect::from_min_size(rect.min, vec2(rect.width(), (TITLE * zoom).max(14.0)));
            brush.painter.rect_filled(
                title,
                CornerRadius { sw: 0, se: 0, ..corners },
                color.gamma_multiply(0.18),
            );
            let size = (14.0 * zoom).max(10.0);
            let at = title.left_center() + vec2(10.0 * zoom, 0.0);
            brush.text(at, Align2::LEFT_CENTER, &frame.title, size, brush.theme.text, title.width() - 12.0);
            let id = Id::new(("canvas frame", idx));
            let head = ui.interact(title, id, Sense::CLICK | Sense::DRAG);
            head.widget_info(|| {
                WidgetInfo::labeled(WidgetType::Other, true, format!("frame {}", frame.title))
            });
            if head.clicked() || head.secondary_clicked() {
                self.chosen = Some(Chosen::Frame(idx));
                desk.selection.nodes.clear();
            }
            if head.double_clicked() {
                self.open_title_field(idx, &frame.title);
            }
            head.context_menu(|ui| self.frame_menu(ui, idx, &frame.title, desk));
            let corner = Rect::from_center_size(rect.max - vec2(6.0, 6.0), Vec2::splat(14.0));
            let grip =
                ui.interact(corner, id.with("size"), Sense::DRAG).on_hover_cursor(CursorIcon::ResizeNwSe);
            let label = || format!("size of frame {}", frame.title);
            grip.widget_info(|| WidgetInfo::labeled(WidgetType::Other, true, label()));
            for step in [4.0, 8.0] {
                let stroke = Stroke::new(1.0, color.gamma_multiply(0.8));
                let [a, b] = [vec2(step, 2.0), vec2(2.0, step)].map(|inset| rect.max - inset);
                brush.painter.line_segment([a, b], stroke);
            }
            let press = ui.input(|input| input.pointer.press_origin()).unwrap_or(self.pointer);
            let from = self.view.from_screen(press);
            if self.was_busy {
                continue;
            }
            if head.drag_started_by(PointerButton::Primary) {
                let area = rect_of(frame);
                let held = self.scene.nodes.iter().filter(|node| area.contains_rect(node.rect));
                let starts = held.map(|node| (node.name.clone(), node.rect.min.to_vec2())).collect();
                self.gesture = Gesture::Move { starts, frame: Some((idx, area.min.to_vec2())), from };
            } else if grip.drag_started_by(PointerButton::Primary) {
                self.gesture = Gesture::Resize { frame: idx, size: rect_of(frame).size(), from };
            }
        }
    }

    pub(super) fn resize_frame(&self, idx: usize, size: Vec2, desk: &mut Desk) {
        let size = size.max(Vec2::splat(LEAST)).round();
        desk.edit_during(Self::move_id(), "Resize a frame", |document| {
            if let Some(frame) = document.frames.get_mut(idx) {
                frame.size = [size.x, size.y].map(f64::from);
            }
        });
    }

    pub(super) fn remove_frame(desk: &mut Desk, idx: usize) {
        desk.edit("Remove a frame", |document| {
            if idx < document.frames.len() {
                document.frames.remove(idx);
            }
        });
    }
}
