//! The slice plane by its controls, its handle, and the gestures on it while it is flat.

use super::*;
use crate::editor::viewport::slice::{Slice, tests::with_cut_of};

/// A plane that is there, in the picture.
pub fn with_cut() -> Slice {
    with_cut_of(1)
}

fn slicing() -> Harness<'static, Bench> {
    let mut harness = window();
    harness.state_mut().viewport.slice = with_cut();
    harness.run_steps(3);
    harness
}

fn position(harness: &Harness<Bench>) -> f64 {
    harness.state().viewport.slice.position().unwrap()
}

#[test]
fn a_button_shows_it_and_hides_it() {
    let mut harness = window();
    assert!(harness.query_by_label("Slice field").is_none());
    click(&mut harness, "Slice");
    assert!(harness.query_by_label("Slice field").is_some());
    assert!(harness.state().viewport.slice.node(harness.state().project.document()).is_some());
    click(&mut harness, "Slice");
    assert!(harness.query_by_label("Slice field").is_none());
    assert!(harness.state().viewport.slice.node(harness.state().project.document()).is_none());
    assert!(!harness.state().project.can_undo());
}

#[test]
fn its_handle_moves_it_along_its_normal_and_nothing_else() {
    let mut harness = slicing();
    let camera = harness.state().camera();
    assert!(has(&harness, "Legend: sigma_t from 0 to 8.000 1/m"));
    // Seen from (0, 1, 6) +x is to the right.
    let (from, before) = (at(&harness, "Slice handle"), position(&harness));
    plain_drag(&mut harness, from, vec2(30.0, 0.0));
    let after = position(&harness);
    assert!(after > before + 0.05, "{before} {after}");
    // The plane is where the hand is: the knob went as far as the pointer. Its normal is seen nearly across.
    let moved = at(&harness, "Slice handle") - from;
    assert!((moved.x - 30.0).abs() < 1.5, "{moved:?}");
    // Not beyond the field.
    let from = at(&harness, "Slice handle");
    plain_drag(&mut harness, from, vec2(250.0, 0.0));
    assert_eq!(position(&harness), 3.0);
    assert_eq!(harness.state().camera(), camera);
    assert!(!harness.state().project.can_undo());
}

#[test]
fn flat_a_drag_and_the_wheel_move_it() {
    let mut harness = slicing();
    click(&mut harness, "Flat");
    let middle = at(&harness, "Flat slice");
    let before = position(&harness);
    plain_drag(&mut harness, middle, vec2(0.0, -80.0));
    // As much of its 5 m as of the height, but for the first of four steps, before which it could be a click.
    let height = f64::from(harness.get_by_label("Flat slice").rect().height());
    let moved = (position(&harness) - before) / (80.0 / height * 5.0);
    assert!((0.74..1.01).contains(&moved), "{moved}");
    let before = position(&harness);
    wheel(&mut harness, middle, 2.0, Modifiers::NONE);
    assert!(position(&harness) > before + 0.1);
    assert!(has(&harness, "sigma_t"));
    click(&mut harness, "In the picture");
    assert!(harness.query_by_label("Picture").is_some());
}

#[test]
fn what_is_under_the_cursor_is_told() {
    let mut harness = slicing();
    click(&mut harness, "Flat");
    let middle = at(&harness, "Flat slice");
    harness.hover_at(middle + vec2(1.0, 1.0));
    harness.run_steps(2);
    // Of 4 × 2 pixels the third of the lower row.
    assert!(has(&harness, "sigma_t 6.000 1/m   at 1.000"));
}

#[test]
fn axis_colors_and_range_are_asked_for() {
    let mut harness = slicing();
    let asked = |harness: &Harness<Bench>, name: &str| {
        let (node, _) = harness.state().viewport.slice.node(harness.state().project.document()).unwrap();
        node.params.get(name).cloned()
    };
    click(&mut harness, "Slice across y");
    assert_eq!((asked(&harness, "axis"), asked(&harness, "position")), (Some("y".into()), None));
    click(&mut harness, "Slice colors");
    click(&mut harness, "magma");
    assert_eq!(asked(&harness, "colormap"), Some("magma".into()));
    assert_eq!(asked(&harness, "range"), None);
    click(&mut harness, "Slice range of the data");
    assert_eq!(asked(&harness, "range"), Some(serde_json::json!([0.0, 8.0])));
    let from = at(&harness, "Slice highest value");
    plain_drag(&mut harness, from, vec2(-60.0, 0.0));
    assert!(asked(&harness, "range").unwrap()[1].as_f64().unwrap() < 7.0);
    click(&mut harness, "Slice field");
    click(&mut harness, "ball · grid");
    assert_eq!((asked(&harness, "grid"), asked(&harness, "range")), (Some("density".into()), None));
    // Of another field nothing is there yet.
    assert!(harness.query_by_label("Slice handle").is_none());
}
