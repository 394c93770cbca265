//! Gestures on the picture: they move the wired camera, the picture's place, or the wipe's divider.

use egui::{Id, Key, PointerButton, Rect, Response, Ui};
use glam::DVec3;
use serde_json::{Value as Json, json};

use super::{Place, Scene, Viewport, Wipe, eye};
use crate::camera::Camera;
use crate::editor::Project;

/// Points around the divider that take hold of it.
const GRIP: f32 = 8.0;

/// Applies this frame's gestures.
pub fn take(
    viewport: &mut Viewport,
    ui: &Ui,
    response: &Response,
    project: &mut Project,
    scene: &Scene,
    (area, rect, size): (Rect, Rect, [usize; 2]),
) {
    let now = ui.input(|input| input.time);
    if response.drag_stopped() {
        viewport.moves_divider = false;
        project.end_gesture();
    }
    if viewport.wheeled.is_some() && !viewport.is_moving(now) {
        viewport.wheeled = None;
        project.end_gesture();
    }
    let (control, shift) = ui.input(|input| (input.modifiers.command, input.modifiers.shift));
    let delta = response.drag_delta();
    if response.drag_started_by(PointerButton::Primary) && viewport.wipe != Wipe::Off {
        let x = rect.left() + viewport.divider * rect.width();
        let start = ui.input(|input| input.pointer.press_origin());
        viewport.moves_divider = start.is_some_and(|at| (at.x - x).abs() < GRIP);
    }
    if viewport.moves_divider {
        if let Some(at) = response.interact_pointer_pos() {
            viewport.divider = ((at.x - rect.left()) / rect.width()).clamp(0.0, 1.0);
        }
        return;
    }
    if control && response.dragged() {
        viewport.place = viewport.place.moved(area, size, delta);
        return;
    }
    if response.hovered() {
        let (wheel, zoom) = ui.input(|input| (input.smooth_scroll_delta().y, input.zoom_delta()));
        if zoom != 1.0 {
            let at = response.hover_pos().unwrap_or(area.center());
            viewport.place = viewport.place.zoomed(area, size, at, zoom);
        } else if wheel != 0.0
            && let Some(camera) = scene.camera
        {
            viewport.wheeled = Some(now);
            write(project, scene, Some("dolly"), "come nearer", eye::dolly(camera, f64::from(wheel) / 40.0));
            ui.ctx().request_repaint_after_secs(0.35);
        }
    }
    let Some(camera) = scene.camera else { return };
    let share = f64::from(1.0 / rect.height().max(1.0));
    let [x, y] = [f64::from(delta.x) * share, f64::from(delta.y) * share];
    let pans =
        response.dragged_by(PointerButton::Middle) || (shift && response.dragged_by(PointerButton::Primary));
    if pans {
        write(project, scene, Some("pan"), "pan", eye::pan(camera, -x, y));
    } else if response.dragged_by(PointerButton::Primary) && delta != egui::Vec2::ZERO {
        // Half a turn a height.
        let turn = std::f64::consts::PI;
        write(project, scene, Some("orbit"), "orbit", eye::orbit(camera, -x * turn, y * turn));
    } else if response.dragged_by(PointerButton::Secondary) {
        let turned = eye::turn(camera, -x, y);
        let step = f64::from(ui.input(|input| input.stable_dt)).min(0.1);
        let key = |plus: Key, minus: Key| {
            let is_down = |key| f64::from(u8::from(ui.input(|input| input.key_down(key))));
            (is_down(plus) - is_down(minus)) * step
        };
        let [ahead, right, up] = [key(Key::W, Key::S), key(Key::D, Key::A), key(Key::E, Key::Q)];
        let flown = eye::fly(turned, ahead, right, up);
        if flown != camera {
            write(project, scene, Some("fly"), "fly", flown);
        }
        // Keys are held without any event.
        ui.ctx().request_repaint();
    }
}

/// Writes position and target into the camera's node.
pub fn write(project: &mut Project, scene: &Scene, gesture: Option<&str>, label: &str, camera: Camera) {
    let Some(name) = scene.look.and_then(|look| look.camera.clone()) else { return };
    let change = |document: &mut crate::graph::Document| {
        if let Some(node) = document.node_mut(&name) {
            for (param, place) in [("position", camera.position), ("look_at", camera.look_at)] {
                node.params.insert(param.to_owned(), json(place));
            }
        }
    };
    match gesture {
        Some(gesture) => project.edit_during(Id::new(("camera", gesture)), label, change),
        None => project.edit(label, change),
    }
}

/// Seven digits are enough for a hand, and can be read.
fn json(v: DVec3) -> Json {
    let short = |x: f64| format!("{x:.6e}").parse::<f64>().unwrap_or(x);
    json!([short(v.x), short(v.y), short(v.z)])
}

/// Percent of a pixel that a point is, for the bar.
pub fn percent(place: Place, pixels_per_point: f32) -> Option<f32> {
    match place {
        Place::Fit => None,
        Place::Free { zoom, .. } => Some(100.0 * zoom * pixels_per_point),
    }
}
