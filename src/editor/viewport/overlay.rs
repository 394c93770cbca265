//! What is drawn over the picture: scale bar, axes, value under the cursor, histogram, messages.
//!
//! Nothing is cut and nothing covers another: where there is no room, things go in the order in which they can be done
//! without. First the legend of a slice, then the axes, what is said at the upper edge, the histogram, and the scale
//! bar; the value under the cursor, which takes the place of the guides, and the message of what failed stay. Tested
//! over all heights.

use std::collections::BTreeSet;

use egui::{
    Align2, Color32, FontId, Painter, Pos2, Rect, Sense, Stroke, Ui, Vec2, WidgetInfo, WidgetType, pos2, vec2,
};
use glam::DVec3;

use super::Scene;
use super::display::{Histogram, luminance};
use super::lens::Lens;
use super::place::{length_text, lower_left, pixel_at, round_length};
use crate::camera::Camera;
use crate::image::{DEPTH, Image};

/// On [`SHADE`], whatever the theme: both lie on a picture.
pub const INK: Color32 = Color32::from_rgb(235, 238, 242);
/// Behind text.
pub const SHADE: Color32 = Color32::from_black_alpha(150);

/// Tells a screen reader what is drawn at a place.
fn say(ui: &Ui, id: &str, rect: Rect, text: &str) {
    let response = ui.interact(rect, ui.id().with(id), Sense::hover());
    response.widget_info(|| WidgetInfo::labeled(WidgetType::Label, true, text));
}

/// A line of text on a dark pill; where it stands.
pub fn pill(ui: &Ui, id: &str, at: Pos2, anchor: Align2, text: &str) -> Rect {
    let galley = ui.painter().layout_no_wrap(text.to_owned(), FontId::monospace(11.5), INK);
    let rect = anchor.anchor_size(at, galley.size() + vec2(14.0, 8.0));
    ui.painter().rect_filled(rect, 4.0, SHADE);
    ui.painter().galley(rect.min + vec2(7.0, 4.0), galley, INK);
    say(ui, id, rect, text);
    rect
}

/// Side of the square that the axes' letters reach, in points.
const AXES: f32 = 68.0;
/// Height that the scale bar needs, and that a line at the upper edge needs to stand clear of two lines of values below.
const LOWEST: [f32; 2] = [40.0, 96.0];

/// Where the world's axes stand in what is seen of a picture; `None` where they would hide much of it.
pub fn axes_at(seen: Rect) -> Option<Pos2> {
    (seen.width().min(seen.height()) >= 2.0 * AXES).then(|| lower_left(seen) + Vec2::new(0.5, -0.5) * AXES)
}

/// Whether nothing is told there.
fn is_free(place: Rect, told: &[Rect]) -> bool {
    !told.iter().any(|rect| rect.intersects(place))
}

/// Tells a screen reader of the axes.
pub fn say_axes(ui: &Ui, at: Pos2, text: &str) {
    say(ui, "axes", Rect::from_center_size(at, Vec2::splat(AXES)), text);
}

/// Lines that are seen on any picture: light ones have a dark rim.
fn lines(painter: &Painter, lines: &[[Pos2; 2]], width: f32, ink: Color32) {
    let rim = rim_of(ink).map(|rim| Stroke::new(width + 2.5, rim));
    for stroke in rim.into_iter().chain([Stroke::new(width, ink)]) {
        for line in lines {
            painter.line_segment(*line, stroke);
        }
    }
}

/// Letters with a shadow of that color: all around it would fill them.
fn letters(painter: &Painter, at: Pos2, anchor: Align2, text: &str, ink: Color32) {
    let font = FontId::proportional(11.0);
    if let Some(rim) = rim_of(ink) {
        painter.text(at + vec2(1.0, 1.0), anchor, text, font.clone(), rim);
    }
    painter.text(at, anchor, text, font, ink);
}

/// Dark ink stands on a light ground that the window chose itself.
fn rim_of(ink: Color32) -> Option<Color32> {
    (ink.intensity() > 0.4).then_some(Color32::from_black_alpha(120))
}

/// A round length, at most some 110 points long, right of the axes, where no value is told.
pub fn scale_bar(ui: &Ui, seen: Rect, points_per_m: f64, ink: Color32, told: &[Rect]) {
    let from = 16.0 + axes_at(seen).map_or(0.0, |_| AXES + 2.0);
    let longest = (seen.width() - from - 16.0).min(110.0);
    let length_m = round_length(f64::from(longest) / points_per_m);
    let length = (length_m * points_per_m) as f32;
    if length <= 4.0 || seen.height() < LOWEST[0] {
        return;
    }
    let text = length_text(length_m);
    let at = lower_left(seen) + vec2(from, -16.0);
    let rect = Rect::from_min_max(at + vec2(0.0, -18.0), at + vec2(length, 4.0));
    if !is_free(rect, told) {
        return;
    }
    let ends = [0.0, length].map(|x| [at + vec2(x, -4.0), at + vec2(x, 4.0)]);
    lines(ui.painter(), &[[at, at + vec2(length, 0.0)], ends[0], ends[1]], 1.5, ink);
    letters(ui.painter(), at + vec2(0.5 * length, -5.0), Align2::CENTER_BOTTOM, &text, ink);
    say(ui, "scale bar", rect, &format!("Scale bar: {text}"));
}

/// A line in the middle, where there is nothing else.
pub fn note(ui: &mut Ui, area: Rect, text: &str) {
    let rect = Rect::from_center_size(area.center(), vec2(420.0_f32.min(area.width()), 60.0));
    let mut place = ui.new_child(egui::UiBuilder::new().max_rect(rect));
    place.vertical_centered(|ui| ui.label(egui::RichText::new(text).size(14.0).weak()));
}

/// Where there is no picture: what to do, or why.
pub fn placeholder(ui: &mut Ui, area: Rect, scene: &Scene) {
    if let Some((name, message)) = &scene.problem {
        problem(ui, area, name, message);
        return;
    }
    let text = match (scene.look, scene.is_busy) {
        (None, _) => "No node gives a picture yet. Add a raymarch, and wire a medium and a camera to it.",
        (_, true) => "The first picture is on its way …",
        (_, false) => "No picture yet.",
    };
    note(ui, area, text);
}

/// A node that failed, in plain words.
pub fn problem(ui: &mut Ui, area: Rect, name: &str, message: &str) {
    let width = (area.width() - 40.0).clamp(120.0, 560.0);
    let at = Rect::from_min_size(pos2(area.center().x - 0.5 * width, area.top() + 16.0), vec2(width, 10.0));
    let mut place = ui.new_child(egui::UiBuilder::new().max_rect(at));
    egui::Frame::new()
        .fill(Color32::from_rgba_unmultiplied(64, 26, 28, 235))
        .corner_radius(6.0)
        .inner_margin(12.0)
        .show(&mut place, |ui| {
            ui.set_width(width - 24.0);
            ui.label(
                egui::RichText::new(format!("{name} failed"))
                    .strong()
                    .color(Color32::from_rgb(255, 180, 170)),
            );
            ui.label(egui::RichText::new(message).color(INK));
        });
}

/// What stands on each side of the wipe's divider, which is at `x`.
pub fn sides(ui: &Ui, area: Rect, x: f32, [left, right]: [&str; 2]) {
    if !has_upper(area) {
        return;
    }
    // Above the line of the readout.
    let y = area.bottom() - 42.0;
    pill(ui, "wipe left", pos2(x - 8.0, y), Align2::RIGHT_BOTTOM, left);
    pill(ui, "wipe right", pos2(x + 8.0, y), Align2::LEFT_BOTTOM, right);
}

/// Whether there is room for a line above the lines of values.
fn has_upper(area: Rect) -> bool {
    area.height() >= LOWEST[1]
}

/// The picture is a preview.
pub fn refining(ui: &Ui, area: Rect) {
    if !has_upper(area) {
        return;
    }
    pill(ui, "refining", area.right_top() + vec2(-10.0, 10.0), Align2::RIGHT_TOP, "refining …");
}

/// A camera with keys: which frame a move changes.
pub fn keys(ui: &Ui, area: Rect, frames: &BTreeSet<i64>, frame: i64) {
    if !has_upper(area) {
        return;
    }
    let text = match frames.contains(&frame) {
        true => format!("key at frame {frame}"),
        false => format!("a move sets a key at frame {frame}"),
    };
    pill(ui, "keys", area.center_top() + vec2(0.0, 10.0), Align2::CENTER_TOP, &text);
}

/// Scale bar at the target's distance, and the world's axes, where no value is told.
pub fn guides(ui: &Ui, area: Rect, rect: Rect, camera: Option<Camera>, told: &[Rect]) {
    let Some((camera, Ok([forward, right, up]))) = camera.map(|camera| (camera, camera.frame())) else {
        return;
    };
    let seen = rect.intersect(area);
    let corner = axes_at(seen).filter(|at| is_free(Rect::from_center_size(*at, Vec2::splat(AXES)), told));
    if let Some(corner) = corner {
        let (right_unit, up_unit) = (right.normalize(), up.normalize());
        let mut axes = [
            (DVec3::X, "x", (236, 104, 96)),
            (DVec3::Y, "y", (126, 200, 110)),
            (DVec3::Z, "z", (104, 156, 240)),
        ];
        // The nearest last, over the others.
        axes.sort_by(|a, b| b.0.dot(forward).total_cmp(&a.0.dot(forward)));
        for (axis, name, (r, g, b)) in axes {
            let way = vec2(axis.dot(right_unit) as f32, -axis.dot(up_unit) as f32) * 20.0;
            let color = Color32::from_rgb(r, g, b);
            lines(ui.painter(), &[[corner, corner + way]], 2.0, color);
            letters(ui.painter(), corner + way * 1.35, Align2::CENTER_CENTER, name, color);
        }
        say_axes(ui, corner, "Axes of the world");
    }
    let height_m = 2.0 * up.length() * camera.position.distance(camera.look_at);
    scale_bar(ui, seen, f64::from(rect.height()) / height_m, INK, told);
}

/// Radiance, luminance, depth and place of the pixel under the cursor; where it stands.
pub fn readout(
    ui: &Ui,
    area: Rect,
    rect: Rect,
    at: Pos2,
    image: &Image,
    camera: Option<Camera>,
    layer: &str,
) -> Option<Rect> {
    let [x, y] = pixel_at(rect, [image.width, image.height], at)?;
    let idx = y * image.width + x;
    let shown = image.layers.get(layer)?;
    let of = &shown.data[idx * shown.channels..][..shown.channels];
    let mut text = match *of {
        [r, g, b] => {
            format!("{layer} {} {} {}   Y {}", short(r), short(g), short(b), short(luminance([r, g, b])))
        }
        [v] => format!("{layer} {}", short(v)),
        _ => return None,
    };
    let depth = image.layers.get(DEPTH).map_or(0.0, |depth| depth.data[idx]);
    if depth > 0.0 {
        text += &format!("   depth {} m", short(depth));
        if let Some(lens) = camera.and_then(|camera| Lens::new(camera, rect)) {
            let [eye, ray] = lens.ray(at);
            let p = eye + ray * f64::from(depth);
            text += &format!("   at {} {} {} m", short(p.x as f32), short(p.y as f32), short(p.z as f32));
        }
    }
    Some(pill(ui, "value", area.right_bottom() + vec2(-10.0, -10.0), Align2::RIGHT_BOTTOM, &text))
}

/// Four digits.
pub fn short(x: f32) -> String {
    match x.abs() {
        0.0 => "0".to_owned(),
        a if (1e-3..1e5).contains(&a) => {
            let digits = (3.0 - a.max(1e-3).log10().floor()).clamp(0.0, 6.0) as usize;
            format!("{x:.digits$}")
        }
        _ => format!("{x:.3e}"),
    }
}

/// Counts by stops, the display's white marked, in the corner of `area`; the picture lies at `rect`.
pub fn histogram(ui: &Ui, area: Rect, rect: Rect, histogram: &Histogram, layer: &str) {
    let seen = rect.intersect(area);
    let at = area.left_top() + vec2(10.0, 10.0);
    // Above the axes, or above the scale bar where there is no room for them.
    let below = if axes_at(seen).is_some() { AXES } else { LOWEST[0] };
    let size = vec2(240.0, (seen.bottom() - below - at.y).min(84.0));
    if size.y < 44.0 {
        return;
    }
    let rect = Rect::from_min_size(at, size);
    let painter = ui.painter();
    painter.rect_filled(rect, 4.0, SHADE);
    let inside = rect.shrink2(vec2(8.0, 14.0));
    let largest = histogram.counts.iter().copied().max().unwrap_or(0).max(1) as f32;
    let step = inside.width() / histogram.counts.len() as f32;
    for (idx, &count) in histogram.counts.iter().enumerate() {
        // The root, so that a sky does not hide the rest.
        let height = (count as f32 / largest).sqrt() * inside.height();
        let x = inside.left() + idx as f32 * step;
        let bar =
            Rect::from_min_max(pos2(x, inside.bottom() - height), pos2(x + step * 0.9, inside.bottom()));
        painter.rect_filled(bar, 0.0, Color32::from_rgb(150, 180, 215));
    }
    let one = inside.left() - Histogram::LOWEST / Histogram::STOPS as f32 * inside.width();
    painter.vline(one, inside.y_range(), Stroke::new(1.0, Color32::from_white_alpha(110)));
    let font = FontId::proportional(10.0);
    painter.text(pos2(one, rect.bottom() - 1.0), Align2::CENTER_BOTTOM, "1", font.clone(), INK);
    let mut text = layer.to_owned();
    if histogram.n_odd > 0 {
        text += &format!(" · {} pixels are not finite", histogram.n_odd);
    }
    painter.text(rect.left_top() + vec2(8.0, 2.0), Align2::LEFT_TOP, &text, font, INK);
    say(ui, "histogram", rect, &format!("Histogram of {text}"));
}
