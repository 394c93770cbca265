//! The map in a corner: all nodes, and the part that is seen. A click or a drag goes there.
//!
//! It is there while something is out of sight, in the corner where it covers the fewest nodes; it changes the
//! corner only while nothing is dragged, so that it does not flee the hand. Tested by a gesture and by corners.

use egui::{CornerRadius, Pos2, Rect, Sense, Stroke, StrokeKind, Vec2, WidgetInfo, WidgetType, vec2};

use super::Canvas;
use super::gesture::Gesture;
use super::paint::Brush;
use super::scene::Scene;
use super::view::View;
use crate::editor::Selection;

const SIZE: Vec2 = vec2(168.0, 108.0);
const MARGIN: f32 = 10.0;

/// A corner of the canvas; the upper left one is that of the way back out of a group.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub enum Corner {
    #[default]
    RightBottom,
    LeftBottom,
    RightTop,
}

impl Corner {
    /// Where the map is.
    fn rect(self, screen: Rect) -> Rect {
        let inside = screen.shrink(MARGIN);
        match self {
            Self::RightBottom => Rect::from_min_size(inside.right_bottom() - SIZE, SIZE),
            Self::LeftBottom => Rect::from_min_size(inside.left_bottom() - vec2(0.0, SIZE.y), SIZE),
            Self::RightTop => Rect::from_min_size(inside.right_top() - vec2(SIZE.x, 0.0), SIZE),
        }
    }

    /// The corner with the fewest nodes, itself among equals.
    fn best(self, screen: Rect, view: View, scene: &Scene) -> Self {
        let covers = |corner: &Self| {
            let rect = view.rect_to_canvas(corner.rect(screen).expand(4.0));
            scene.nodes.iter().filter(|node| node.rect.intersects(rect)).count()
        };
        let all = [self, Self::RightBottom, Self::LeftBottom, Self::RightTop];
        all.into_iter().min_by_key(covers).unwrap_or(self)
    }
}

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
        let seen = brush.view.rect_to_canvas(screen);
        if seen.contains_rect(self.scene.all_bounds()) {
            return;
        }
        if matches!(self.gesture, Gesture::None) && !ui.input(|input| input.pointer.any_down()) {
            self.minimap_corner = self.minimap_corner.best(screen, brush.view, &self.scene);
        }
        let rect = self.minimap_corner.rect(screen);
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
            self.center_on(map.to_canvas(at));
        }
    }

    fn center_on(&mut self, point: Pos2) {
        let size = self.screen.map_or(Vec2::ZERO, |screen| screen.size());
        self.view.pan = size / 2.0 - point.to_vec2() * self.view.zoom;
    }
}

#[cfg(test)]
mod tests {
    use std::collections::HashSet;

    use super::*;
    use crate::graph::Document;
    use crate::nodes::catalog;

    #[test]
    fn it_goes_where_no_node_is() {
        let screen = Rect::from_min_size(Pos2::ZERO, vec2(900.0, 500.0));
        let scene = |places: &[[f64; 2]]| {
            let mut document = Document::default();
            for place in places {
                document.add_node("sun", crate::graph::Node::new("sun"), *place);
            }
            Scene::new(&document, catalog(), &HashSet::new())
        };
        let best = |corner: Corner, places: &[[f64; 2]]| corner.best(screen, View::default(), &scene(places));
        assert_eq!(best(Corner::RightBottom, &[]), Corner::RightBottom);
        assert_eq!(best(Corner::RightBottom, &[[700.0, 400.0]]), Corner::LeftBottom);
        assert_eq!(best(Corner::RightBottom, &[[700.0, 400.0], [0.0, 400.0]]), Corner::RightTop);
        // Where it is as good as elsewhere it stays.
        assert_eq!(best(Corner::RightTop, &[[0.0, 0.0]]), Corner::RightTop);
        let everywhere = [[700.0, 400.0], [0.0, 400.0], [700.0, 10.0]];
        assert_eq!(best(Corner::LeftBottom, &everywhere), Corner::LeftBottom);
    }
}
