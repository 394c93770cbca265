//! Directions: a ball that is turned by dragging, and the three numbers.
//!
//! The ball is seen from the front: x to the right, y up, z towards the viewer. The needle is filled where it points
//! towards the viewer, hollow where it points away. Across turns it about y, up and down lifts it; its length stays.

use egui::{Sense, Stroke, Ui, vec2};

use super::number::named;
use super::row::{LETTER, column, component};
use super::slot::Slot;

const SIZE: f32 = 72.0;
/// Half a turn across the ball.
const RADIANS_PER_POINT: f64 = std::f64::consts::PI / SIZE as f64;
/// A needle that is straight up has no way to turn about.
const HIGHEST: f64 = 0.4999 * std::f64::consts::PI;

/// The ball and the numbers.
pub fn show(ui: &mut Ui, slot: &mut Slot) -> Option<String> {
    let mut message = None;
    ui.horizontal(|ui| {
        message = ball(ui, slot);
        ui.vertical(|ui| {
            for (part, label) in ["x", "y", "z"].into_iter().enumerate() {
                ui.horizontal(|ui| {
                    let width = column(ui, 1) - LETTER;
                    let changed = component(ui, slot, part, label, width);
                    message = message.take().or(changed);
                });
            }
        });
    });
    message
}

fn ball(ui: &mut Ui, slot: &mut Slot) -> Option<String> {
    let (response, painter) = ui.allocate_painter(vec2(SIZE, SIZE), Sense::drag());
    let response = response.on_hover_cursor(egui::CursorIcon::Grab);
    named(&response, &format!("{} ball", slot.name()));
    let values = slot.numbers();
    let v = [values[0], values[1], values[2]];
    let mut message = None;
    let moved = response.drag_delta();
    if response.dragged() && moved != vec2(0.0, 0.0) {
        let turned = turn(v, RADIANS_PER_POINT * f64::from(moved.x), -RADIANS_PER_POINT * f64::from(moved.y));
        message =
            slot.set_numbers(&turned.map(|x| (x * 1e4).round() / 1e4), Some(slot.id().with("ball"))).err();
    }
    let radius = 0.5 * SIZE - 2.0;
    let center = response.rect.center();
    let visuals = ui.visuals();
    let faint = Stroke::new(1.0, visuals.weak_text_color());
    painter.circle(center, radius, visuals.extreme_bg_color, faint);
    painter.line_segment([center - vec2(radius, 0.0), center + vec2(radius, 0.0)], faint);
    painter.line_segment([center - vec2(0.0, radius), center + vec2(0.0, radius)], faint);
    let length = v.iter().map(|x| x * x).sum::<f64>().sqrt().max(1e-300);
    let tip = center + radius * vec2((v[0] / length) as f32, -(v[1] / length) as f32);
    let needle = visuals.selection.stroke.color;
    painter.line_segment([center, tip], Stroke::new(2.0, needle));
    match v[2] >= 0.0 {
        true => painter.circle_filled(tip, 4.0, needle),
        false => painter.circle(tip, 4.0, visuals.extreme_bg_color, Stroke::new(2.0, needle)),
    };
    message
}

/// Turned about y and lifted by these angles.
fn turn(v: [f64; 3], about_y: f64, lift: f64) -> [f64; 3] {
    let length = v.iter().map(|x| x * x).sum::<f64>().sqrt();
    if length == 0.0 {
        return [0.0, 0.0, 1.0];
    }
    let longitude = v[0].atan2(v[2]) + about_y;
    let latitude = ((v[1] / length).asin() + lift).clamp(-HIGHEST, HIGHEST);
    let (x, z) = longitude.sin_cos();
    [x * latitude.cos(), latitude.sin(), z * latitude.cos()].map(|x| length * x)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_quarter_turn_and_the_poles() {
        let quarter = 0.5 * std::f64::consts::PI;
        let near = |found: [f64; 3], expected: [f64; 3]| {
            // A dozen roundings of numbers up to 2; at the poles 1e-4 of a quarter turn is left.
            assert!(found.iter().zip(expected).all(|(a, b)| (a - b).abs() < 1e-3), "{found:?}");
        };
        near(turn([0.0, 0.0, 2.0], quarter, 0.0), [2.0, 0.0, 0.0]);
        near(turn([0.0, 0.0, 2.0], 0.0, 9.0), [0.0, 2.0, 0.0]);
        near(turn([0.0, 2.0, 0.0], 0.0, -quarter), [0.0, 0.0, 2.0]);
    }
}
