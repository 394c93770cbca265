//! The points through which a wire is led: set by a double click, dragged, deleted.

use egui::{Id, PointerButton, Pos2, Rect, Sense, Stroke, Vec2, WidgetInfo, WidgetType};

use super::desk::Desk;
use super::gesture::Gesture;
use super::paint::Brush;
use super::scene::{WireShape, curve, distance};
use super::{Canvas, Chosen};
use crate::graph::Wire;

impl WireShape {
    /// Between which of its points the wire passes nearest to a place.
    fn nearest_part(&self, at: Pos2) -> usize {
        let parts = self.points.windows(2).enumerate();
        let far = parts.map(|(idx, pair)| (distance(&curve(pair, 1.0, 24), at), idx));
        far.min_by(|a, b| a.0.total_cmp(&b.0)).map_or(0, |(_, idx)| idx)
    }
}

impl Canvas {
    /// Leads a wire through the place of the pointer.
    pub(super) fn add_bend(&mut self, wire: &Wire, desk: &mut Desk) {
        if super::edge::is_link(wire) {
            return;
        }
        let at = self.view.to_canvas(self.pointer).round();
        let Some(shape) = self.scene.wires.iter().find(|shape| shape.wire == *wire) else { return };
        let idx = shape.nearest_part(at);
        desk.edit("Bend a wire", |document| {
            document.bends.entry(wire.clone()).or_default().insert(idx, [at.x, at.y].map(f64::from));
        });
        self.chosen = Some(Chosen::Bend(wire.clone(), idx));
    }

    pub(super) fn remove_bend(desk: &mut Desk, wire: &Wire, idx: usize) {
        desk.edit("Straighten a wire", |document| {
            if let Some(bends) = document.bends.get_mut(wire).filter(|bends| idx < bends.len()) {
                bends.remove(idx);
                if bends.is_empty() {
                    document.bends.shift_remove(wire);
                }
            }
        });
    }

    /// The widgets of a wire's bends.
    pub(super) fn bends(&mut self, ui: &egui::Ui, brush: &Brush, shape: &WireShape, desk: &mut Desk) {
        let last = shape.points.len() - 1;
        for (idx, point) in shape.points[1..last].iter().enumerate() {
            let at = brush.view.to_screen(*point);
            if !brush.painter.clip_rect().contains(at) {
                continue;
            }
            let rect = Rect::from_center_size(at, Vec2::splat(14.0));
            let id = Id::new(("canvas bend", &shape.wire, idx));
            let response = ui.interact(rect, id, Sense::CLICK | Sense::DRAG);
            let label = || format!("bend {} of {}", idx + 1, shape.label());
            response.widget_info(|| WidgetInfo::labeled(WidgetType::Other, true, label()));
            let this = Chosen::Bend(shape.wire.clone(), idx);
            if self.chosen.as_ref() == Some(&this) || response.hovered() {
                brush.painter.circle_stroke(at, 7.0, Stroke::new(1.5, brush.theme.accent));
            }
            if response.clicked() || response.drag_started_by(PointerButton::Primary) {
                desk.selection.nodes.clear();
                self.chosen = Some(this);
            }
            if !self.was_busy && response.drag_started_by(PointerButton::Primary) {
                self.gesture = Gesture::Bend { wire: shape.wire.clone(), idx };
            }
        }
    }

    pub(super) fn move_bend(&self, wire: &Wire, idx: usize, at: Pos2, desk: &mut Desk) {
        let at = at.round();
        desk.edit_during(Self::move_id(), "Move a bend", |document| {
            if let Some(bend) = document.bends.get_mut(wire).and_then(|bends| bends.get_mut(idx)) {
                *bend = [at.x, at.y].map(f64::from);
            }
        });
    }
}
