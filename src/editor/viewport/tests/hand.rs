//! Moving the camera, the picture in its place, and the wipe's divider.

use egui::Key;
use serde_json::json;

use super::*;

const NONE: Modifiers = Modifiers::NONE;

fn distance(camera: Camera) -> f64 {
    camera.position.distance(camera.look_at)
}

#[test]
fn each_gesture_on_the_picture_is_one_step() {
    type Keeps = fn(Camera, Camera) -> bool;
    // Numbers are written with seven digits.
    let orbit: Keeps = |a, b| {
        a.look_at == b.look_at && a.position != b.position && (distance(a) / distance(b) - 1.0).abs() < 1e-5
    };
    let pan: Keeps = |a, b| {
        let way = |camera: Camera| camera.look_at - camera.position;
        a.position != b.position && way(a).distance(way(b)) < 1e-5
    };
    let turn: Keeps = |a, b| a.position == b.position && a.look_at != b.look_at;
    let gestures = [
        (PointerButton::Primary, NONE, orbit),
        (PointerButton::Primary, Modifiers::SHIFT, pan),
        (PointerButton::Middle, NONE, pan),
        (PointerButton::Secondary, NONE, turn),
    ];
    let mut harness = window();
    for (button, modifiers, keeps) in gestures {
        let before = harness.state().camera();
        let from = at(&harness, "Picture");
        drag(&mut harness, from, vec2(60.0, 25.0), button, modifiers);
        let after = harness.state().camera();
        assert!(keeps(before, after), "{button:?} {modifiers:?}: {before:?} {after:?}");
        assert!(harness.state_mut().project.undo().is_some());
        assert_eq!(harness.state().camera(), before);
        assert!(!harness.state().project.can_undo(), "{button:?} {modifiers:?}");
    }
}

#[test]
fn the_wheel_comes_nearer_and_flying_goes_ahead() {
    let mut harness = window();
    let before = harness.state().camera();
    let middle = at(&harness, "Picture");
    wheel(&mut harness, middle, 3.0, NONE);
    let near = harness.state().camera();
    assert!(distance(near) < 0.9 * distance(before) && near.look_at == before.look_at);
    // A wheel is a gesture until it has rested: another one is another step.
    wheel(&mut harness, middle, -3.0, NONE);
    assert!(harness.state_mut().project.undo().is_some());
    assert_eq!(harness.state().camera(), near);
    assert!(harness.state_mut().project.undo().is_some());
    assert_eq!(harness.state().camera(), before);

    // The pointer rests: keys alone fly.
    let press = |pressed| Event::PointerButton {
        pos: middle,
        button: PointerButton::Secondary,
        pressed,
        modifiers: NONE,
    };
    harness.hover_at(middle);
    harness.step();
    harness.event(press(true));
    harness.key_down(Key::W);
    harness.run_steps(30);
    harness.key_up(Key::W);
    harness.key_down(Key::E);
    harness.run_steps(30);
    harness.key_up(Key::E);
    harness.event(press(false));
    harness.run_steps(2);
    let flown = harness.state().camera();
    let way = flown.position - before.position;
    // Half a second each of the distance a second.
    assert!(way.dot(before.look_at - before.position) > 1.0 && way.y > 0.1, "{way}");
    assert!((flown.look_at - before.look_at).distance(way) < 1e-4);
    assert!(harness.state_mut().project.undo().is_some());
    assert_eq!(harness.state().camera(), before);
}

#[test]
fn a_camera_with_keys_gets_one_at_the_frame() {
    let mut harness = window();
    let keys = json!({ "keys": [[1, [0.0, 1.0, 6.0]], [21, [4.0, 1.0, 6.0]]] });
    harness.state_mut().project.edit("keys", |document| {
        document.nodes["camera"].params.insert("position".to_owned(), keys.clone());
    });
    harness.state_mut().project.look_at(Some(11));
    harness.run_steps(2);
    assert_eq!(harness.state().camera().position, DVec3::new(2.0, 1.0, 6.0));
    assert!(has(&harness, "a move sets a key at frame 11"));
    let from = at(&harness, "Picture");
    plain_drag(&mut harness, from, vec2(50.0, 0.0));
    let moved = harness.state().param("camera", "position").unwrap().clone();
    let frames: Vec<_> = moved["keys"].as_array().unwrap().iter().map(|key| key[0].clone()).collect();
    assert_eq!(frames, [1, 11, 21]);
    // The others are as they were, and the target, which has no keys and did not move, is plain.
    assert_eq!((&moved["keys"][0], &moved["keys"][2]), (&keys["keys"][0], &keys["keys"][1]));
    assert_eq!(harness.state().param("camera", "look_at"), Some(&json!([0, 0, 0])));
    assert!(has(&harness, "key at frame 11") && !has(&harness, "a move sets"));
    // A key that is there is moved; a pan moves the target too, which is plain.
    drag(&mut harness, from, vec2(30.0, 0.0), PointerButton::Middle, NONE);
    let panned = harness.state().param("camera", "position").unwrap().clone();
    assert_eq!(panned["keys"].as_array().unwrap().len(), 3);
    assert_ne!(panned["keys"][1], moved["keys"][1]);
    assert!(harness.state().param("camera", "look_at").unwrap().is_array());
    assert_eq!(harness.state_mut().project.undo().as_deref(), Some("pan, key at frame 11"));
    assert_eq!(harness.state().param("camera", "position"), Some(&moved));
    assert_eq!(harness.state_mut().project.undo().as_deref(), Some("orbit, key at frame 11"));
    assert_eq!(harness.state().param("camera", "position"), Some(&keys));
}

#[test]
fn with_ctrl_the_picture_is_moved_and_zoomed_in_its_place() {
    let mut harness = window();
    let before = harness.state().camera();
    let middle = at(&harness, "Picture");
    drag(&mut harness, middle, vec2(40.0, -20.0), PointerButton::Primary, Modifiers::COMMAND);
    let Place::Free { offset, zoom } = harness.state().viewport.place else { panic!("moved") };
    assert!((offset - vec2(40.0, -20.0)).length() < 1e-3);
    wheel(&mut harness, middle, 3.0, Modifiers::COMMAND);
    let Place::Free { zoom: nearer, .. } = harness.state().viewport.place else { panic!("zoomed") };
    assert!(nearer > 1.1 * zoom);
    click(&mut harness, "1:1");
    assert_eq!(harness.state().viewport.place, Place::one_to_one(1.0));
    assert!(has(&harness, "100 %"));
    click(&mut harness, "Fit");
    assert_eq!(harness.state().viewport.place, Place::Fit);
    assert_eq!(harness.state().camera(), before);
    assert!(!harness.state().project.can_undo());
}

#[test]
fn the_volume_is_framed() {
    let mut harness = window();
    click(&mut harness, "Frame");
    let framed = harness.state().camera();
    assert_eq!(framed.look_at, DVec3::ZERO);
    // The sphere around the box touches the picture's edge.
    let half = (0.5 * framed.fov_y_deg).to_radians();
    assert!((3f64.sqrt() / distance(framed) - half.sin()).abs() < 1e-5);
    assert_eq!(harness.state_mut().project.undo().as_deref(), Some("frame the volume"));
    // Without a volume there is nothing to be framed, and nothing is.
    harness.state_mut().bounds = None;
    harness.run_steps(2);
    let before = harness.state().camera();
    click(&mut harness, "Frame");
    assert_eq!(harness.state().camera(), before);
    assert!(!harness.state().project.can_undo());
}

#[test]
fn the_divider_moves_between_two_pictures() {
    let mut harness = window();
    let before = harness.state().camera();
    assert!(harness.query_by_label("Wipe divider").is_none());
    click(&mut harness, "Wipe");
    click(&mut harness, "Store picture A");
    assert_eq!(harness.state().viewport.wipe, Wipe::Stored(0));
    // Each side says what it is.
    assert!(has(&harness, "march") && has(&harness, "stored A"));
    let from = at(&harness, "Wipe divider");
    plain_drag(&mut harness, from, vec2(-120.0, 15.0));
    let width = 96.0 / 64.0 * harness.get_by_label("Picture").rect().height();
    let expected = 0.5 - 120.0 / width;
    assert!(
        (harness.state().viewport.divider - expected).abs() < 0.02,
        "{}",
        harness.state().viewport.divider
    );
    click(&mut harness, "Wipe");
    click(&mut harness, "With other");
    assert_eq!(harness.state().viewport.wipe, Wipe::Node("other".to_owned()));
    assert!(harness.query_by_label("Wipe divider").is_some() && has(&harness, "other"));
    // Beside the divider a drag still orbits.
    let beside = at(&harness, "Picture") + vec2(150.0, 0.0);
    plain_drag(&mut harness, beside, vec2(40.0, 0.0));
    assert_ne!(harness.state().camera(), before);
    click(&mut harness, "Wipe");
    click(&mut harness, "No wipe");
    assert!(harness.query_by_label("Wipe divider").is_none());
}
