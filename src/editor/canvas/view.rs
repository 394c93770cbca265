//! Which part of the canvas is seen: the map from its points to those of the screen.
//!
//! screen = origin + pan + zoom · point. Tested by the round trip, and by what zooming and fitting keep.

use egui::{Pos2, Rect, Vec2, pos2};

/// How far one may zoom; below, nodes are specks, above, a node fills the screen.
pub const ZOOM: std::ops::RangeInclusive<f32> = 0.1..=2.5;

/// The map.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct View {
    /// The canvas' upper left corner on the screen.
    pub origin: Pos2,
    /// Where the point (0, 0) stands from there, in points of the screen.
    pub pan: Vec2,
    /// Points of the screen per point of the canvas.
    pub zoom: f32,
}

impl View {
    pub fn to_screen(self, point: Pos2) -> Pos2 {
        self.origin + self.pan + point.to_vec2() * self.zoom
    }

    pub fn to_canvas(self, point: Pos2) -> Pos2 {
        ((point - self.origin - self.pan) / self.zoom).to_pos2()
    }

    pub fn rect_to_screen(self, rect: Rect) -> Rect {
        Rect::from_min_max(self.to_screen(rect.min), self.to_screen(rect.max))
    }

    pub fn rect_to_canvas(self, rect: Rect) -> Rect {
        Rect::from_min_max(self.to_canvas(rect.min), self.to_canvas(rect.max))
    }

    /// Nearer by `factor`, so far as is allowed; what is under `at` stays there.
    pub fn zoom_at(&mut self, at: Pos2, factor: f32) {
        let fixed = self.to_canvas(at);
        self.zoom = (self.zoom * factor).clamp(*ZOOM.start(), *ZOOM.end());
        self.pan += at - self.to_screen(fixed);
    }

    /// All of `content` in the middle of a screen of `size`, not larger than life.
    pub fn fit(&mut self, content: Rect, size: Vec2) {
        const MARGIN: f32 = 16.0;
        if !content.is_positive() || size.min_elem() <= 2.0 * MARGIN {
            return;
        }
        let ratio = (size - Vec2::splat(2.0 * MARGIN)) / content.size();
        self.zoom = ratio.min_elem().clamp(*ZOOM.start(), 1.0);
        self.pan = size / 2.0 - content.center().to_vec2() * self.zoom;
    }

    /// Shows `rect`, as large as can be read: from afar it comes near.
    pub fn come_near(&mut self, rect: Rect, size: Vec2) {
        const LEGIBLE: f32 = 0.5;
        if self.zoom < LEGIBLE {
            self.zoom_at(self.to_screen(rect.center()), LEGIBLE / self.zoom);
        }
        self.reveal(rect, size);
    }

    /// Moves no farther than it takes to see `rect`.
    pub fn reveal(&mut self, rect: Rect, size: Vec2) {
        let seen = Rect::from_min_size(self.origin, size).shrink(16.0);
        let rect = self.rect_to_screen(rect);
        let shift = |low: f32, high: f32, from: f32, to: f32| {
            if low < from { from - low } else { (to - high).min(0.0) }
        };
        self.pan.x += shift(rect.min.x, rect.max.x, seen.min.x, seen.max.x);
        self.pan.y += shift(rect.min.y, rect.max.y, seen.min.y, seen.max.y);
    }
}

impl Default for View {
    fn default() -> Self {
        Self { origin: pos2(0.0, 0.0), pan: Vec2::ZERO, zoom: 1.0 }
    }
}

#[cfg(test)]
mod tests {
    use egui::vec2;

    use super::*;

    // Coordinates below 1e3 carry errors of about 1e-4 in f32, after few operations.
    fn near(a: Pos2, b: Pos2) -> bool {
        (a - b).length() < 1e-3
    }

    fn view() -> View {
        View { origin: pos2(10.0, 20.0), pan: vec2(-30.0, 7.0), zoom: 0.5 }
    }

    #[test]
    fn there_and_back() {
        let point = pos2(123.0, -45.0);
        assert!(near(view().to_screen(point), pos2(10.0 - 30.0 + 61.5, 20.0 + 7.0 - 22.5)));
        assert!(near(view().to_canvas(view().to_screen(point)), point));
    }

    #[test]
    fn what_is_under_the_pointer_stays() {
        let (mut view, at) = (view(), pos2(200.0, 100.0));
        let fixed = view.to_canvas(at);
        view.zoom_at(at, 3.0);
        assert!(near(view.to_screen(fixed), at) && view.zoom == 1.5);
        view.zoom_at(at, 100.0);
        assert!(near(view.to_screen(fixed), at) && view.zoom == *ZOOM.end());
    }

    #[test]
    fn what_is_fitted_is_seen() {
        let (mut view, size) = (view(), vec2(800.0, 400.0));
        let screen = Rect::from_min_size(view.origin, size);
        for content in [[0.0, 0.0, 3000.0, 200.0], [-50.0, 60.0, 100.0, 900.0], [5.0, 5.0, 6.0, 6.0]] {
            let content = Rect::from_min_max(pos2(content[0], content[1]), pos2(content[2], content[3]));
            view.fit(content, size);
            let seen = view.rect_to_screen(content);
            assert!(screen.contains_rect(seen) && near(seen.center(), screen.center()));
        }
        let before = view;
        view.fit(Rect::NOTHING, size);
        assert_eq!(view, before);
        let far = Rect::from_min_size(pos2(5000.0, -3000.0), vec2(100.0, 50.0));
        view.reveal(far, size);
        assert!(screen.contains_rect(view.rect_to_screen(far)));
        let before = view;
        view.reveal(far, size);
        assert_eq!(view, before);
        view.come_near(far, size);
        assert_eq!(view, before);
        view.zoom = 0.1;
        view.come_near(far, size);
        assert!(view.zoom == 0.5 && screen.contains_rect(view.rect_to_screen(far)));
    }
}
