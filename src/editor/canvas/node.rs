//! What a node looks like: header, ports, state, cost, what was left out.
//!
//! From near it shows everything; below half size the labels of ports go; below a third its name, its state and
//! its time are left, over the whole of it. Text of the foot stays as large as can be read while its row has the
//! room, and says less where there is less. Tested by what is said at each zoom (`told`) and by pictures.

use egui::{Align2, Color32, CornerRadius, Pos2, Rect, Shape, Stroke, StrokeKind, Vec2, pos2, vec2};

use super::super::{NodeState, NodeStatus};
use super::paint::Brush;
use super::scene::{FOOTER, NodeShape, PortShape, ROW, THUMBNAIL, WIDTH};
use super::told::{foot, left_out};
use crate::graph::Side;

/// How a node is drawn besides what it tells.
#[derive(Debug, Clone, Copy, Default)]
pub struct NodeLook {
    pub is_selected: bool,
    pub is_hovered: bool,
    pub is_focused: bool,
    /// Drawn behind what can be connected.
    pub is_dim: bool,
    pub time: f64,
}

/// What of a port is not the document's.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum PortLook {
    Plain,
    Hot,
    /// A wire that is being drawn does not fit.
    Dim,
}

impl Brush<'_> {
    /// The node but for its ports.
    pub fn node(
        &self,
        node: &NodeShape,
        status: &NodeStatus,
        look: NodeLook,
        picture: Option<egui::TextureId>,
    ) {
        let zoom = self.view.zoom;
        let rect = self.view.rect_to_screen(node.rect);
        let radius = (7.0 * zoom).round().clamp(1.0, 16.0) as u8;
        let corners = CornerRadius::same(radius);
        let opacity = if look.is_dim {
            0.35
        } else if node.mute {
            0.45
        } else {
            1.0
        };
        if zoom > 0.3 && !look.is_dim {
            let shadow = egui::epaint::Shadow {
                offset: [0, (3.0 * zoom) as i8],
                blur: (14.0 * zoom) as u8,
                spread: 0,
                color: self.theme.shadow,
            };
            self.painter.add(shadow.as_shape(rect, corners));
        }
        let body = if look.is_hovered {
            self.theme.node.lerp_to_gamma(self.theme.text, 0.03)
        } else {
            self.theme.node
        };
        let head_color = self.theme.header(node);
        let head_color = head_color.gamma_multiply(opacity);
        let body = body.gamma_multiply(opacity);
        let head = Rect::from_min_size(rect.min, vec2(rect.width(), node.header * zoom));
        if zoom < NEAR_NAMES {
            self.painter.rect_filled(rect, corners, head_color);
        } else {
            self.painter.rect_filled(rect, corners, body);
            self.painter.rect_filled(head, CornerRadius { sw: 0, se: 0, ..corners }, head_color);
        }
        self.outline(rect, radius, status, look);
        let white = Color32::WHITE.gamma_multiply(opacity);
        let inset = 10.0 * zoom;
        let state = self.state_rect(node);
        if zoom < NEAR_NAMES {
            return self.head_alone(node, status, look, white);
        }
        // From afar there is no room for a second line, and the name has the header to itself.
        let has_type = node.type_id != node.name && zoom > NEAR_TYPES;
        let type_size = (10.5 * zoom).max(8.0);
        let line = if has_type { head.height() - type_size - 3.0 * zoom } else { head.height() };
        let size = (13.0 * zoom).max((11.0_f32).min(line - 4.0));
        let width = state.left() - head.left() - 1.5 * inset;
        let middle = pos2(head.left() + inset, head.top() + line / 2.0);
        self.text(middle, Align2::LEFT_CENTER, &node.name, size, white, width);
        if has_type {
            let at = pos2(head.left() + inset, head.bottom() - 3.0 * zoom);
            let faint = Color32::from_white_alpha(200).gamma_multiply(opacity);
            self.text(at, Align2::LEFT_BOTTOM, &node.type_id, type_size, faint, head.width() - 2.0 * inset);
        }
        self.state(state, status, look.time);
        if node.has_picture {
            let top = rect.bottom() - (FOOTER + THUMBNAIL + 2.0) * zoom;
            let size = vec2(rect.width() - 12.0 * zoom, (THUMBNAIL - 4.0) * zoom);
            let place = Rect::from_min_size(pos2(rect.left() + 6.0 * zoom, top), size);
            let uv = Rect::from_min_max(Pos2::ZERO, pos2(1.0, 1.0));
            match picture {
                Some(picture) => {
                    self.painter.image(picture, place, uv, Color32::WHITE.gamma_multiply(opacity));
                }
                None => {
                    let empty = self.theme.background.gamma_multiply(opacity);
                    self.painter.rect_filled(place, 2.0 * zoom, empty);
                }
            }
        }
        self.foot(node, status, opacity);
        if node.bypass && !node.mute {
            self.through(node);
        }
    }

    /// Its name, and below that its time where there is room for it.
    fn head_alone(&self, node: &NodeShape, status: &NodeStatus, look: NodeLook, color: Color32) {
        let zoom = self.view.zoom;
        let rect = self.view.rect_to_screen(node.rect);
        let size = (30.0 * zoom).clamp(8.0, 11.0);
        let width = rect.width() - 4.0;
        let text = foot(status).pop().filter(|_| rect.height() > 2.6 * size).unwrap_or_default();
        let shift = if text.is_empty() { 0.0 } else { 0.6 * size };
        let [above, below] = [-shift, shift].map(|dy| rect.center() + vec2(0.0, dy));
        self.text(above, Align2::CENTER_CENTER, &node.name, size, color, width);
        let faint = color.gamma_multiply(0.8);
        self.text(below, Align2::CENTER_CENTER, &text, (size - 1.0).max(7.0), faint, width);
        if rect.width() > 24.0 {
            let disk = Rect::from_center_size(rect.right_top() + vec2(-5.5, 5.5), Vec2::splat(8.0));
            self.state(disk, status, look.time);
        }
    }

    /// State, cost, and how much was left out.
    fn foot(&self, node: &NodeShape, status: &NodeStatus, opacity: f32) {
        let zoom = self.view.zoom;
        let rect = self.view.rect_to_screen(node.rect);
        let row = Rect::from_min_max(pos2(rect.left(), rect.bottom() - FOOTER * zoom), rect.max);
        let row = row.shrink2(vec2(8.0 * zoom, 0.0));
        let size = (10.5 * zoom).max(LEGIBLE.min(0.82 * row.height()));
        let weak = self.theme.weak.gamma_multiply(opacity);
        let mut width = row.width();
        let n_left_out = left_out(status).count();
        if n_left_out > 0 {
            let badge = self.badge_rect(node);
            let faint = self.theme.weak.gamma_multiply(0.22 * opacity);
            self.painter.rect_filled(badge, badge.height() / 2.0, faint);
            let long = format!("{n_left_out} left out");
            let texts = [long, format!("−{n_left_out}")];
            self.first_that_fits(
                badge.center(),
                Align2::CENTER_CENTER,
                &texts,
                size - 0.5,
                weak,
                badge.width() - 4.0,
            );
            width = badge.left() - row.left() - 4.0;
        }
        let silent = [(node.mute, "muted"), (node.bypass, "bypassed")].into_iter().find(|(is, _)| *is);
        let color = match &status.state {
            _ if silent.is_some() => self.theme.stale,
            NodeState::Failed(_) | NodeState::Skipped(_) => self.theme.bad,
            NodeState::Stale => self.theme.stale,
            NodeState::Running => self.theme.accent,
            _ => weak,
        };
        let texts = silent.map_or_else(|| foot(status), |(_, word)| vec![word.to_owned()]);
        self.first_that_fits(row.left_center(), Align2::LEFT_CENTER, &texts, size, color, width);
    }

    /// A line from the first input to the first output of its type, as the value goes.
    fn through(&self, node: &NodeShape) {
        for output in node.side(Side::Output) {
            let input = node.side(Side::Input).find(|input| input.kind == output.kind && input.is_wired);
            let Some(input) = input else { continue };
            let ends = [input.at, output.at].map(|at| self.view.to_screen(at));
            let color = self.theme.port(output.kind).gamma_multiply(0.6);
            self.curve(&ends, (2.0 * self.view.zoom).max(1.0), color);
        }
    }

    fn outline(&self, rect: Rect, radius: u8, status: &NodeStatus, look: NodeLook) {
        let stroke = match &status.state {
            _ if look.is_selected => Stroke::new(2.0, self.theme.accent),
            NodeState::Failed(_) => Stroke::new(2.0, self.theme.bad),
            NodeState::Running => Stroke::new(1.5, self.theme.accent.gamma_multiply(0.6)),
            _ => Stroke::new(1.0, self.theme.outline),
        };
        self.painter.rect_stroke(rect, CornerRadius::same(radius), stroke, StrokeKind::Outside);
        if look.is_selected && matches!(status.state, NodeState::Failed(_)) {
            let stroke = Stroke::new(1.5, self.theme.bad);
            self.painter.rect_stroke(rect, CornerRadius::same(radius), stroke, StrokeKind::Inside);
        }
        if look.is_focused {
            let stroke = Stroke::new(1.0, self.theme.text);
            let corners = CornerRadius::same(radius.saturating_add(3));
            self.painter.rect_stroke(rect.expand(4.0), corners, stroke, StrokeKind::Middle);
        }
    }

    /// Where the state is drawn, on the screen.
    pub fn state_rect(&self, node: &NodeShape) -> Rect {
        let rect = self.view.rect_to_screen(node.rect);
        let at = rect.right_top() + vec2(-14.0, super::scene::HEADER / 2.0) * self.view.zoom;
        Rect::from_center_size(at, Vec2::splat(14.0 * self.view.zoom))
    }

    /// Where it stands how much was left out, on the screen: in words from near, else as a number.
    pub fn badge_rect(&self, node: &NodeShape) -> Rect {
        let rect = self.view.rect_to_screen(node.rect);
        let zoom = self.view.zoom;
        let width = if zoom > NEAR_WORDS { 60.0 * zoom } else { (34.0 * zoom).max(16.0) };
        let height = 15.0 * zoom;
        let corner = rect.right_bottom() - vec2(6.0, 2.5) * zoom;
        Rect::from_min_size(corner - vec2(width, height), vec2(width, height))
    }

    fn state(&self, rect: Rect, status: &NodeStatus, time: f64) {
        let (at, radius) = (rect.center(), rect.width() * 0.33);
        // Headers are of any hue, so the state stands on a disk of its own.
        self.painter.circle_filled(at, rect.width() * 0.5, Color32::from_black_alpha(70));
        let width = (1.6 * self.view.zoom).max(1.0);
        let ring = |color| self.painter.circle_stroke(at, radius, Stroke::new(width, color));
        let dot = |color| self.painter.circle_filled(at, radius, color);
        let white = Color32::from_white_alpha(130);
        // The colors of the dark table, because the disk is dark in both.
        let [good, stale, bad] = [
            Color32::from_rgb(124, 221, 142),
            Color32::from_rgb(255, 205, 92),
            Color32::from_rgb(255, 128, 122),
        ];
        match &status.state {
            NodeState::Idle => drop(ring(white)),
            NodeState::Stale => drop(ring(stale)),
            NodeState::Done if status.cached => {
                ring(good);
                self.painter.circle_filled(at, radius * 0.45, good);
            }
            NodeState::Done => drop(dot(good)),
            NodeState::Failed(_) => {
                dot(bad);
                self.text(at, Align2::CENTER_CENTER, "!", 11.0 * self.view.zoom, Color32::BLACK, 40.0);
            }
            NodeState::Skipped(_) => {
                let bar = vec2(radius, 0.0);
                self.painter.line_segment([at - bar, at + bar], Stroke::new(width, white));
            }
            NodeState::Running => {
                let start = (time * 5.0) as f32;
                let arc = (0..=14).map(|i| at + Vec2::angled(start + i as f32 * 0.3) * radius);
                self.painter.add(Shape::line(arc.collect(), Stroke::new(width, Color32::WHITE)));
            }
        }
    }

    /// Size of a port's name, and the width that it may take. Where two in a row have no room both are smaller, and cut
    /// only where they could not be read.
    pub(super) fn label_room(&self, port: &PortShape) -> (f32, f32) {
        let zoom = self.view.zoom;
        let size = (11.5 * zoom).max((8.0_f32).min(ROW * zoom));
        let room = (WIDTH - 2.0 * LABEL_INSET) * zoom;
        let Some(beside) = &port.beside else { return (size, room) };
        let [own, other] = [&port.port.end.port, beside].map(|text| self.width(text, size));
        let free = room - LABEL_GAP;
        if own + other <= free {
            return (size, own + 1.0);
        }
        let smaller = (size * free / (own + other)).max(6.5);
        ((2.0 * smaller).floor() / 2.0, free * own / (own + other))
    }

    /// A port and its name.
    pub fn port(&self, port: &PortShape, look: PortLook) {
        let zoom = self.view.zoom;
        if zoom < NEAR_PORTS {
            return;
        }
        let at = self.view.to_screen(port.at);
        let dim = if look == PortLook::Dim { 0.25 } else { 1.0 };
        let color = self.theme.port(port.kind).gamma_multiply(dim);
        let radius = (5.0 * zoom).max(2.5) + if look == PortLook::Hot { 1.5 } else { 0.0 };
        // An input that takes many is as tall as several.
        let tall = if port.many { radius * 0.8 } else { 0.0 };
        let rect = Rect::from_center_size(at, vec2(2.0 * radius, 2.0 * (radius + tall)));
        let fill = if port.is_wired { color } else { self.theme.node };
        if look == PortLook::Hot {
            self.painter.rect_filled(rect.expand(5.0 * zoom), radius + 6.0, color.gamma_multiply(0.3));
        }
        self.painter.rect_filled(rect, radius, fill);
        let ring = if port.is_wired { self.theme.outline } else { color };
        self.painter.rect_stroke(rect, radius, Stroke::new((1.6 * zoom).max(1.0), ring), StrokeKind::Inside);
        if zoom < NEAR_LABELS {
            return;
        }
        let (align, dx) = match port.port.side {
            Side::Input => (Align2::LEFT_CENTER, LABEL_INSET),
            Side::Output => (Align2::RIGHT_CENTER, -LABEL_INSET),
        };
        // What must be wired and is not stands out.
        let missing = port.is_required && !port.is_wired;
        let text = if missing { self.theme.text } else { self.theme.weak }.gamma_multiply(dim);
        let (size, width) = self.label_room(port);
        self.text(at + vec2(dx * zoom, 0.0), align, &port.port.end.port, size, text, width);
    }
}

/// From a port to its name, in points of the canvas.
const LABEL_INSET: f32 = 11.0;
/// Between the names of two ports in a row, in points of the screen.
const LABEL_GAP: f32 = 6.0;

/// Zooms from which names, ports, their labels, types, and words of badges are drawn.
const NEAR_NAMES: f32 = 0.34;
pub const NEAR_PORTS: f32 = 0.22;
const NEAR_LABELS: f32 = 0.42;
const NEAR_TYPES: f32 = 0.5;
const NEAR_WORDS: f32 = 0.75;
/// Points of the screen that text of the foot has at least, where its row is high enough.
const LEGIBLE: f32 = 9.0;
