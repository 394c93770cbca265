//! The plane flat in the viewport: a drag up or down, or the wheel, moves it through the field.

use egui::{Align2, Color32, FontId, PointerButton, Rect, Response, Stroke, StrokeKind, Ui, pos2, vec2};

use super::Slice;
use crate::editor::viewport::{hand, overlay};
use crate::graph::Document;

/// Share of the field that a notch of the wheel (40 points) moves the plane.
const NOTCH: f64 = 0.02;

/// Draws the plane, and takes gestures on it.
pub fn show(slice: &mut Slice, ui: &mut Ui, area: Rect, response: &Response, document: &Document) {
    slice.develop(ui);
    let (Some(cut), Some((_, texture))) = (&slice.cut, &slice.texture) else {
        let text = match &slice.problem {
            Some(problem) => problem.clone(),
            None if slice.field(document).is_none() => {
                "Nothing can be cut yet: add a volume or a medium".to_owned()
            }
            None => "The slice is on its way …".to_owned(),
        };
        overlay::note(ui, area, &text);
        return;
    };
    let plane = cut.plane;
    let rect = slice.place.rect(area.shrink(16.0), plane.size);
    let painter = ui.painter().with_clip_rect(area);
    let whole = Rect::from_min_max(pos2(0.0, 0.0), pos2(1.0, 1.0));
    painter.image(texture.id(), rect, whole, Color32::WHITE);
    let line = Stroke::new(1.0, ui.visuals().weak_text_color());
    painter.rect_stroke(rect, 0.0, line, StrokeKind::Outside);
    axes(ui, area, plane.axes());
    let points_per_m = f64::from(rect.width()) / (plane.step[0].length() * plane.size[0] as f64);
    let share = response.hover_pos().map(|at| {
        let share = (at - rect.min) / rect.size();
        [f64::from(share.x), f64::from(share.y)]
    });
    let told = slice.tell(ui, area, document, cut, share, 10.0);
    overlay::scale_bar(ui, area, points_per_m, ui.visuals().text_color(), told.as_slice());
    if let Some(problem) = &slice.problem {
        overlay::problem(ui, area, "The slice plane", problem);
    }
    if hand::place(&mut slice.place, ui, response, area.shrink(16.0), plane.size) {
        return;
    }
    let [from, to] = plane.extent;
    let mut shares = 0.0;
    if response.dragged_by(PointerButton::Primary) {
        shares -= f64::from(response.drag_delta().y / area.height().max(1.0));
    }
    if response.hovered() {
        shares += NOTCH * f64::from(ui.input(|input| input.smooth_scroll_delta().y)) / 40.0;
    }
    if shares != 0.0 {
        let now = slice.position.unwrap_or(plane.position);
        slice.move_to(now + shares * (to - from));
    }
}

/// Which axes of the world go right and up.
fn axes(ui: &Ui, area: Rect, [right, up]: [String; 2]) {
    let Some(corner) = overlay::axes_at(area) else { return };
    let painter = ui.painter();
    let ink = ui.visuals().text_color();
    overlay::say_axes(ui, corner, &format!("Axes of the slice: {right} to the right, {up} up"));
    for (way, name) in [(vec2(22.0, 0.0), right), (vec2(0.0, -22.0), up)] {
        painter.arrow(corner, way, Stroke::new(1.5, ink));
        painter.text(corner + way * 1.4, Align2::CENTER_CENTER, name, FontId::proportional(11.0), ink);
    }
}
