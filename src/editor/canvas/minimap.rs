//! The map in the corner: all nodes, and the part that is seen. A click or a drag goes there.

use egui::{CornerRadius, Pos2, Rect, Sense, Stroke, StrokeKind, Vec2, WidgetInfo, WidgetType, vec2};

use super::Canvas;
use super::paint::Brush;
use super::scene::Scene;
use super::view::View;
use crate::editor::Selection;

const SIZE: Vec2 = vec2(168.0, 108.0);

/// The map's own view: nodes and what is seen, in the middle of `rect`.
fn view(scene: &Scene, seen: Rect, rect: Rect) -> View {
    let content = scene.all_bounds().union(seen).expand(20.0);
    let ratio = (rect.size() - Vec2::splat(8.0)) / content.size();
    let zoom = ratio.min_elem();
    View { origin: rect.min, pan: rect.size() / 2.0 - content.center().to_vec2() * zoom, zoom }
}

impl Canvas {
    pub(super) fn minimap(&mut self, ui: &egui::Ui, brush: &Brush, selection: &Selection) {
        let screen = brush.painter.clip_rect();
        if screen.width() < 3.0 * SIZE.x || screen.height() < 2.0 * SIZE.y || self.scene.nodes.is_empty() {
            return;
        }
        let rect = Rect::from_min_size(screen.right_bottom() - SIZE - Vec2::splat(10.0), SIZE);
        let seen = brush.view.rect_from_screen(screen);
        let map = view(&self.scene, seen, rect);
        let theme = brush.theme;
        brush.painter.rect(
            rect,
            6.0,
            theme.background.gamma_multiply(0.92),
            Stroke::new(1.0, theme.outline),
            StrokeKind::Inside,
        );
        let painter = brush.painter.with_clip_rect(rect.shrink(2.0));
        for node in &self.scene.nodes {
            let place = map.rect_to_screen(node.rect);
            let place = Rect::from_center_size(place.center(), place.size().max(Vec2::splat(1.5)));
            let is_selected = selection.nodes.contains(&node.name);
            let color = theme.header(node);
            painter.rect_filled(place, 1.0, if is_selected { theme.accent } else { color });
        }
        let frame = map.rect_to_screen(seen).intersect(rect.shrink(2.0));
        let corners = CornerRadius::same(2);
        painter.rect(
            frame,
            corners,
            theme.text.gamma_multiply(0.07),
            Stroke::new(1.0, theme.weak),
            StrokeKind::Inside,
        );
        let response = ui.interact(rect, egui::Id::new("canvas minimap"), Sense::click_and_drag());
        response.widget_info(|| WidgetInfo::labeled(WidgetType::Other, true, "minimap"));
        if let Some(at) = response.interact_pointer_pos().filter(|_| response.clicked() || response.dragged())
        {
            self.center_on(map.from_screen(at));
        }
    }

    fn center_on(&mut self, point: Pos2) {
        let size = self.screen.map_or(Vec2::ZERO, |screen| screen.size());
        self.view.pan = size / 2.0 - point.to_vec2() * self.view.zoom;
    }
}
