//! The plane at its place in the picture, with the camera's perspective, and the handle that moves it.
//!
//! A textured quad of [`N`]² pieces, projected here: within a piece the texture is laid on without perspective, which
//! at 48 pieces is off by less than a pixel unless the camera stands in the plane. It lies over the picture as glass
//! does: what of the medium stands before it does not hide it.

use egui::{
    Color32, CursorIcon, Mesh, Pos2, Rect, Response, Sense, Shape, Stroke, Ui, WidgetInfo, WidgetType, vec2,
};

use super::Slice;
use crate::editor::viewport::lens::{self, Lens};
use crate::editor::viewport::overlay;
use crate::graph::Document;

/// Pieces along a side.
const N: usize = 48;
/// How much of the picture shows through.
const OPACITY: f32 = 0.88;
/// Half of the handle's side, in points.
const GRIP: f32 = 9.0;

/// Draws the plane over a picture that lies at `rect`, its legend and its handle; where a value is told.
pub fn show(
    slice: &mut Slice,
    ui: &mut Ui,
    (area, rect): (Rect, Rect),
    response: &Response,
    lens: &Lens,
    document: &Document,
) -> Option<Rect> {
    slice.develop(ui);
    if let Some(problem) = &slice.problem {
        overlay::problem(ui, area, "The slice plane", problem);
    }
    let (Some(cut), Some((_, texture))) = (&slice.cut, &slice.texture) else { return None };
    let plane = cut.plane;
    let corners = [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]];
    let mut mesh = Mesh::with_texture(texture.id());
    let mut seen = Vec::new();
    for idx in 0..(N + 1) * (N + 1) {
        let share = [idx % (N + 1), idx / (N + 1)].map(|n| n as f64 / N as f64);
        let at = lens.project(plane.at(share));
        seen.push(at.is_some());
        let uv = egui::pos2(share[0] as f32, share[1] as f32);
        let color = Color32::WHITE.gamma_multiply(OPACITY);
        mesh.vertices.push(egui::epaint::Vertex { pos: at.unwrap_or(Pos2::ZERO), uv, color });
    }
    for idx in (0..N * N).map(|idx| idx % N + idx / N * (N + 1)) {
        let piece = [idx, idx + 1, idx + N + 1, idx + N + 2];
        // Behind the camera there is no place.
        if piece.iter().all(|corner| seen[*corner]) {
            let [a, b, c, d] = piece.map(|corner| corner as u32);
            mesh.add_triangle(a, b, c);
            mesh.add_triangle(b, c, d);
        }
    }
    let painter = ui.painter().with_clip_rect(area.intersect(rect));
    painter.add(Shape::mesh(mesh));
    let outline: Option<Vec<Pos2>> = corners.iter().map(|share| lens.project(plane.at(*share))).collect();
    if let Some(outline) = outline {
        painter.add(Shape::closed_line(outline, Stroke::new(1.0, Color32::from_white_alpha(150))));
    }
    let share = response.hover_pos().filter(|at| rect.contains(*at)).and_then(|at| plane.hit(lens.ray(at)));
    let told = slice.tell(ui, area, document, cut, share, 40.0);
    handle(slice, ui, area.intersect(rect), lens);
    told
}

/// A knob in the middle of the plane, on an arrow along its normal.
fn handle(slice: &mut Slice, ui: &mut Ui, area: Rect, lens: &Lens) {
    let Some(cut) = &slice.cut else { return };
    let plane = cut.plane;
    let normal = slice.axis.normal();
    let position = slice.position.unwrap_or(plane.position);
    // While the plane follows, the knob is where it will be.
    let middle = plane.at([0.5, 0.5]) + (position - plane.position) * normal;
    let Some(knob) = lens.project(middle).filter(|at| area.contains(*at)) else { return };
    let id = ui.id().with("slice handle");
    let response = ui.interact(Rect::from_center_size(knob, vec2(2.0 * GRIP, 2.0 * GRIP)), id, Sense::drag());
    response.widget_info(|| WidgetInfo::labeled(WidgetType::Slider, true, "Slice handle"));
    let is_lit = response.hovered() || response.dragged();
    let ink = if is_lit { crate::editor::theme::ACCENT } else { Color32::WHITE };
    let painter = ui.painter().with_clip_rect(area);
    let reach = 0.12 * (plane.extent[1] - plane.extent[0]);
    for way in [reach, -reach] {
        if let Some(tip) = lens.project(middle + way * normal) {
            painter.arrow(knob, tip - knob, Stroke::new(2.0, ink));
        }
    }
    painter.circle(knob, 6.0, ink, Stroke::new(1.5, Color32::from_black_alpha(160)));
    if is_lit {
        ui.ctx().set_cursor_icon(CursorIcon::Grab);
    }
    if response.drag_stopped() {
        slice.grip = None;
        return;
    }
    let Some(at) = response.interact_pointer_pos().filter(|_| response.dragged()) else { return };
    // Where the plane was taken, so that it does not jump to the cursor, nor run away from it.
    let along = |from: f64| lens::along(middle + (from - position) * normal, normal, lens.ray(at));
    if response.drag_started() || slice.grip.is_none() {
        slice.grip = along(position).map(|offset| (position, offset));
    }
    let moved = slice.grip.and_then(|(from, offset)| Some(from + along(from)? - offset));
    // Along the view, up is away.
    let up = -f64::from(response.drag_delta().y / area.height().max(1.0));
    slice.move_to(moved.unwrap_or(position + up * (plane.extent[1] - plane.extent[0])));
}
