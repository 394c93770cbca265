//! What draws: text in a width, the grid, wires.
//!
//! Sizes of text go in steps of half a point, because each size fills a part of the font's atlas; a zoom
//! that goes on would fill it.

use egui::epaint::text::{LayoutJob, TextFormat, TextWrapping};
use egui::{Align2, Color32, FontId, Painter, Pos2, Rect, Shape, Stroke, pos2};

use super::scene::{self, WireShape};
use super::theme::Theme;
use super::view::View;

/// Points of the canvas between dots of the grid, and what moved nodes snap to.
pub const GRID: f32 = 24.0;
/// Text below this many points of the screen cannot be read.
const SMALLEST: f32 = 6.0;

/// A painter that knows the view.
pub struct Brush<'a> {
    pub painter: &'a Painter,
    pub view: View,
    pub theme: &'static Theme,
}

impl Brush<'_> {
    /// Text of a size on the screen, cut to a width with an ellipsis; its rectangle.
    pub fn text(&self, at: Pos2, align: Align2, text: &str, size: f32, color: Color32, width: f32) -> Rect {
        if size < SMALLEST || width < size {
            return Rect::from_pos(at);
        }
        let mut job = LayoutJob::single_section(text.to_owned(), TextFormat::simple(font(size), color));
        job.wrap = TextWrapping { max_rows: 1, break_anywhere: true, ..TextWrapping::wrap_at_width(width) };
        job.break_on_newline = false;
        let galley = self.painter.layout_job(job);
        let rect = align.anchor_size(at, galley.size());
        self.painter.galley(rect.min, galley, color);
        rect
    }

    /// The first of several texts that has room in a width; the last, cut, where none has.
    pub fn first_that_fits(
        &self,
        at: Pos2,
        align: Align2,
        texts: &[String],
        size: f32,
        color: Color32,
        width: f32,
    ) {
        let has_room = |text: &&String| self.width(text, size) <= width;
        if let Some(text) = texts.iter().find(has_room).or(texts.last()) {
            self.text(at, align, text, size, color, width);
        }
    }

    /// How wide text of a size is on the screen.
    pub fn width(&self, text: &str, size: f32) -> f32 {
        self.painter.layout_no_wrap(text.to_owned(), font(size), Color32::PLACEHOLDER).size().x
    }

    /// Dots, farther apart when seen from afar.
    pub fn grid(&self, screen: Rect) {
        let mut step = GRID * self.view.zoom;
        while step < 18.0 {
            step *= 4.0;
        }
        let offset = self.view.origin + self.view.pan - screen.min;
        let first = pos2(offset.x.rem_euclid(step), offset.y.rem_euclid(step));
        let radius = (1.1 * self.view.zoom.sqrt()).max(0.8);
        let mut dots = Vec::new();
        let mut y = screen.min.y + first.y;
        while y < screen.max.y {
            let mut x = screen.min.x + first.x;
            while x < screen.max.x {
                // A square is two triangles; of a circle there would be dozens.
                let dot = Rect::from_center_size(pos2(x, y), egui::Vec2::splat(2.0 * radius));
                dots.push(Shape::rect_filled(dot, 0.0, self.theme.grid));
                x += step;
            }
            y += step;
        }
        self.painter.extend(dots);
    }

    /// A wire between points of the screen.
    pub fn curve(&self, points: &[Pos2], width: f32, color: Color32) {
        let n_segments = if self.view.zoom > 0.35 { 24 } else { 12 };
        let line = scene::curve(points, self.view.zoom, n_segments);
        self.painter.add(Shape::line(line, Stroke::new(width, color)));
    }

    /// A wire of the document, if it is on the screen.
    pub fn wire(&self, wire: &WireShape, screen: Rect, look: WireLook) {
        if !self.view.rect_to_screen(wire.bounds()).intersects(screen) {
            return;
        }
        let points: Vec<Pos2> = wire.points.iter().map(|point| self.view.to_screen(*point)).collect();
        let width = (2.2 * self.view.zoom).clamp(1.2, 4.0);
        let color = self.theme.port(wire.kind);
        match look {
            WireLook::Plain => self.curve(&points, width, color.gamma_multiply(0.85)),
            WireLook::Dim => self.curve(&points, width, color.gamma_multiply(0.25)),
            WireLook::Hot => {
                self.curve(&points, width + 4.0, color.gamma_multiply(0.3));
                self.curve(&points, width + 0.8, color);
            }
        }
        for bend in points.iter().take(points.len() - 1).skip(1) {
            self.painter.circle_filled(*bend, (4.5 * self.view.zoom).max(2.5), color);
        }
    }
}

fn font(size: f32) -> FontId {
    FontId::proportional((size * 2.0).round() / 2.0)
}

/// How a wire is drawn.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum WireLook {
    Plain,
    /// While another is connected.
    Dim,
    /// Under the pointer, chosen, or at a chosen node.
    Hot,
}
