//! Gestures on the picture: they move the wired camera, the picture's place, or the wipe's divider.
//!
//! A camera whose place has keys gets one at the frame that is looked at, or has the one that is there moved.

use std::collections::BTreeSet;

use egui::{CursorIcon, Id, Key, PointerButton, Rect, Response, Sense, Ui, WidgetInfo, WidgetType};
use glam::DVec3;
use serde_json::{Value as Json, json};

use super::{Place, Scene, Viewport, eye};
use crate::camera::Camera;
use crate::editor::Project;
use crate::editor::inspector::put_key;
use crate::graph::Document;

/// Points around the divider that take hold of it.
const GRIP: f32 = 8.0;

/// With Ctrl a drag moves the picture in its area, and the wheel makes it larger; whether it did.
pub fn place(place: &mut Place, ui: &Ui, response: &Response, area: Rect, size: [usize; 2]) -> bool {
    if ui.input(|input| input.modifiers.command) && response.dragged() {
        *place = place.moved(area, size, response.drag_delta());
        return true;
    }
    let zoom = ui.input(|input| input.zoom_delta());
    if response.hovered() && zoom != 1.0 {
        let at = response.hover_pos().unwrap_or(area.center());
        *place = place.zoomed(area, size, at, zoom);
        return true;
    }
    false
}

/// The line between two pictures that lie at `rect`.
pub fn divider(viewport: &mut Viewport, ui: &Ui, area: Rect, rect: Rect) {
    let x = rect.left() + viewport.divider * rect.width();
    let visible = rect.intersect(area);
    let line = Rect::from_x_y_ranges(x - GRIP..=x + GRIP, visible.y_range());
    let response = ui.interact(line, ui.id().with("divider"), Sense::drag());
    response.widget_info(|| WidgetInfo::labeled(WidgetType::Slider, true, "Wipe divider"));
    if response.hovered() || response.dragged() {
        ui.ctx().set_cursor_icon(CursorIcon::ResizeHorizontal);
    }
    if let Some(at) = response.interact_pointer_pos().filter(|_| response.dragged()) {
        viewport.divider = ((at.x - rect.left()) / rect.width()).clamp(0.0, 1.0);
    }
}

/// Applies this frame's gestures on the picture.
pub fn take(
    viewport: &mut Viewport,
    ui: &Ui,
    response: &Response,
    project: &mut Project,
    scene: &Scene,
    (area, rect, size): (Rect, Rect, [usize; 2]),
) {
    let now = ui.input(|input| input.time);
    if ui.input(|input| input.pointer.any_released()) {
        project.end_gesture();
    }
    if viewport.wheeled.is_some() && !viewport.is_moving(now) {
        viewport.wheeled = None;
        project.end_gesture();
    }
    if place(&mut viewport.place, ui, response, area, size) {
        return;
    }
    let Some(camera) = scene.camera else { return };
    let delta = response.drag_delta();
    let (wheel, shift) = ui.input(|input| (input.smooth_scroll_delta().y, input.modifiers.shift));
    if response.hovered() && wheel != 0.0 {
        viewport.wheeled = Some(now);
        write(project, scene, Some("dolly"), "come nearer", eye::dolly(camera, f64::from(wheel) / 40.0));
        ui.ctx().request_repaint_after_secs(0.35);
    }
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
    } else if response.is_pointer_button_down_on() && ui.input(|input| input.pointer.secondary_down()) {
        // Not only once it is a drag: keys fly while the pointer rests.
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

/// The parameters that a hand moves.
const MOVED: [&str; 2] = ["position", "look_at"];

/// Frames at which a camera's place has keys, and the frame at which a move sets one: the one that is looked at, or
/// where none is the first, whose value then holds. `None` for a camera without keys.
pub fn keys(document: &Document, camera: &str) -> Option<(BTreeSet<i64>, i64)> {
    let node = document.node(camera)?;
    let keys = MOVED.iter().filter_map(|param| node.params.get(*param)?.get("keys")?.as_array());
    let frames: BTreeSet<i64> = keys.flatten().filter_map(|key| key.get(0)?.as_i64()).collect();
    let first = *frames.first()?;
    Some((frames, document.frame.unwrap_or(first)))
}

/// Writes position and target into the camera's node, each as far as it has moved; what has keys gets one at the
/// frame.
pub fn write(project: &mut Project, scene: &Scene, gesture: Option<&str>, label: &str, camera: Camera) {
    let (Some(name), Some(before)) = (scene.look.and_then(|look| look.camera.clone()), scene.camera) else {
        return;
    };
    let at = keys(project.document(), &name).map(|(_, frame)| frame);
    let label = match at {
        Some(frame) => format!("{label}, key at frame {frame}"),
        None => label.to_owned(),
    };
    let change = |document: &mut Document| {
        let Some(node) = document.node_mut(&name) else { return };
        let places = [(before.position, camera.position), (before.look_at, camera.look_at)];
        for (param, (before, place)) in MOVED.iter().zip(places) {
            if before == place {
                continue;
            }
            let given = node.params.get(*param).and_then(|given| given.get("keys")?.as_array().cloned());
            let value = match (given, at) {
                (Some(mut keys), Some(frame)) => {
                    put_key(&mut keys, frame, json(place));
                    json!({ "keys": keys })
                }
                _ => json(place),
            };
            node.params.insert((*param).to_owned(), value);
        }
    };
    match gesture {
        // Another frame is another key, and so another step.
        Some(gesture) => project.edit_during(Id::new(("camera", gesture, at)), &label, change),
        None => project.edit(&label, change),
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
