//! Groups, muting and bypassing, frames and bends.

use egui::vec2;

use super::*;

/// Two tone maps in a group, one muted, one bypassed, in a frame with a comment; a bend in a wire.
pub const GROUPS: &str = r#"{"tyndall": 1, "nodes": {
    "march": {"type": "raymarch"}, "a": {"type": "tone_map"}, "b": {"type": "tone_map", "bypass": true},
    "c": {"type": "tone_map", "mute": true}, "group": {"type": "group", "nodes": {
        "x": {"type": "tone_map"}, "y": {"type": "tone_map"}}, "wires": ["x.image -> y.image"],
        "layout": {"x": [0, 0], "y": [280, 40]}, "inputs": {"image": "x.image"}, "outputs": {"image": "y.image"}}},
    "wires": ["march.image -> a.image", "a.image -> b.image", "b.image -> group.image"],
    "layout": {"march": [0, 0], "a": [300, 0], "b": [600, 0], "c": [600, 150], "group": [900, 0]},
    "bends": {"a.image -> b.image": [[540, -40]]},
    "frames": [{"title": "tones", "at": [270, -80], "size": [540, 340]}]}"#;

pub fn double_click(harness: &mut Harness<Bench>, at: Pos2) {
    harness.hover_at(at);
    harness.run_steps(30);
    for pressed in [true, false, true, false] {
        let button = egui::PointerButton::Primary;
        harness.event(Event::PointerButton { pos: at, button, pressed, modifiers: Modifiers::NONE });
        harness.step();
    }
    harness.run_steps(3);
}

pub fn document(harness: &Harness<Bench>) -> Document {
    harness.state().project.document().clone()
}

#[test]
fn a_selection_becomes_a_group_and_again_nodes() {
    let mut harness = window(GROUPS);
    let before = document(&harness);
    click(&mut harness, "node a");
    click_with(&mut harness, "node b", Modifiers::SHIFT);
    press(&mut harness, Modifiers::COMMAND, Key::G);
    assert_eq!(harness.state().selected(), ["group_2"]);
    assert!(harness.query_by_label("input group_2.image").is_some());
    assert!(harness.state().wires().contains(&"march.image -> group_2.image".to_owned()));
    press(&mut harness, Modifiers::COMMAND | Modifiers::SHIFT, Key::G);
    assert_eq!(harness.state().selected(), ["a", "b"]);
    press(&mut harness, Modifiers::COMMAND, Key::Z);
    undo(&mut harness);
    assert_eq!(document(&harness), before);
}

#[test]
fn a_group_is_entered_changed_and_left() {
    let mut harness = window(GROUPS);
    let body = at(&harness, "node group");
    double_click(&mut harness, body);
    assert!(harness.query_by_label("node x").is_some() && harness.query_by_label("node march").is_none());
    click(&mut harness, "node y");
    assert_eq!(harness.state().selected(), ["group/y"]);
    press(&mut harness, Modifiers::NONE, Key::Enter);
    assert_eq!(harness.state().requests, [Request::Inspect("group/y".to_owned())]);
    press(&mut harness, Modifiers::COMMAND, Key::D);
    assert_eq!(harness.state().selected(), ["group/y_2"]);
    assert_eq!(document(&harness).inside("group").unwrap().nodes.len(), 3);
    undo(&mut harness);
    click(&mut harness, "Graph");
    assert!(harness.query_by_label("node march").is_some());
    click(&mut harness, "node group");
    press(&mut harness, Modifiers::COMMAND, Key::ArrowDown);
    assert!(harness.query_by_label("node x").is_some());
    press(&mut harness, Modifiers::COMMAND, Key::ArrowUp);
    assert!(harness.query_by_label("node march").is_some());
}

#[test]
fn nodes_are_muted_and_bypassed() {
    let mut harness = window(GROUPS);
    click(&mut harness, "node a");
    click_with(&mut harness, "node c", Modifiers::SHIFT);
    let muted = |harness: &Harness<Bench>| ["a", "c"].map(|name| document(harness).nodes[name].mute);
    press(&mut harness, Modifiers::NONE, Key::M);
    assert_eq!(muted(&harness), [true, true]);
    press(&mut harness, Modifiers::NONE, Key::M);
    assert_eq!(muted(&harness), [false, false]);
    press(&mut harness, Modifiers::NONE, Key::B);
    assert!(document(&harness).nodes["a"].bypass);
    undo(&mut harness);
    assert!(!document(&harness).nodes["a"].bypass);
}

#[test]
fn nodes_in_a_group_are_muted_and_pasted() {
    let mut other = window(SCENE);
    click(&mut other, "node sun");
    let text = copied(&mut other, Event::Copy).unwrap();
    let mut harness = window(GROUPS);
    let body = at(&harness, "node group");
    double_click(&mut harness, body);
    click(&mut harness, "node y");
    press(&mut harness, Modifiers::NONE, Key::M);
    assert!(document(&harness).node("group/y").unwrap().mute);
    press(&mut harness, Modifiers::NONE, Key::B);
    assert!(document(&harness).node("group/y").unwrap().bypass);
    harness.hover_at(EMPTY);
    harness.step();
    harness.event(Event::Paste(text));
    harness.run_steps(3);
    assert_eq!(harness.state().selected(), ["group/sun"]);
    assert_eq!(document(&harness).node("group/sun").unwrap().type_id, "sun");
}

#[test]
fn a_group_is_saved_as_a_preset() {
    let mut harness = window(GROUPS);
    harness.get_by_label("node group").click_secondary();
    harness.run_steps(3);
    click(&mut harness, "Save as a preset…");
    assert_eq!(harness.state().requests, [Request::SavePreset("group".to_owned())]);
}

#[test]
fn a_wire_is_bent_and_straightened() {
    let mut harness = window(GROUPS);
    let wire: Wire = "march.image -> a.image".parse().unwrap();
    let middle = at(&harness, "wire march.image -> a.image");
    double_click(&mut harness, middle);
    assert_eq!(document(&harness).bends[&wire].len(), 1);
    let label = "bend 1 of wire march.image -> a.image";
    let from = at(&harness, label);
    drag(&mut harness, from, from + vec2(0.0, -60.0));
    let zoom = f64::from(harness.state().canvas.view.zoom);
    let place = document(&harness).bends[&wire][0];
    let expected = harness.state().canvas.view.to_canvas(from + vec2(0.0, -60.0));
    // Whole points.
    assert!((place[1] - f64::from(expected.y)).abs() <= 1.0 / zoom + 0.5, "{place:?} {expected:?}");
    harness.hover_at(EMPTY);
    harness.run_steps(2);
    press(&mut harness, Modifiers::NONE, Key::Delete);
    assert!(!document(&harness).bends.contains_key(&wire));
    assert_eq!(harness.state().wires().len(), 3);
}

#[test]
fn a_frame_goes_with_what_it_holds() {
    let mut harness = window(GROUPS);
    let places = |harness: &Harness<Bench>| {
        let document = document(harness);
        (document.frames[0].at, document.layout["a"], document.layout["march"])
    };
    let title = rect(&harness, "frame tones").left_center() + vec2(20.0, 0.0);
    let (frame, a, march) = places(&harness);
    drag(&mut harness, title, title + vec2(0.0, 40.0));
    let moved = (40.0 / f64::from(harness.state().canvas.view.zoom)).round();
    assert_eq!(places(&harness), ([frame[0], frame[1] + moved], [a[0], a[1] + moved], march));
    harness.hover_at(EMPTY);
    undo(&mut harness);
    assert_eq!(places(&harness), (frame, a, march));
    let size = document(&harness).frames[0].size;
    let corner = at(&harness, "size of frame tones");
    drag(&mut harness, corner, corner + vec2(30.0, 20.0));
    let wider = document(&harness).frames[0].size;
    assert!(wider[0] > size[0] && wider[1] > size[1]);
    let title = rect(&harness, "frame tones").left_center() + vec2(20.0, 0.0);
    double_click(&mut harness, title);
    harness.event(Event::Text("what the eye gets".to_owned()));
    harness.run_steps(2);
    press(&mut harness, Modifiers::NONE, Key::Enter);
    assert_eq!(document(&harness).frames[0].title, "what the eye gets");
}

#[test]
fn a_frame_is_drawn_around_the_selection_and_removed() {
    let mut harness = window(SCENE);
    click(&mut harness, "node sun");
    press(&mut harness, Modifiers::COMMAND | Modifiers::SHIFT, Key::F);
    press(&mut harness, Modifiers::NONE, Key::Enter);
    let frame = document(&harness).frames[0].clone();
    assert!(frame.at[0] < 0.0 && frame.at[1] < 0.0 && frame.size[0] > 184.0);
    click(&mut harness, "frame comment");
    press(&mut harness, Modifiers::NONE, Key::Delete);
    assert!(document(&harness).frames.is_empty());
    assert_eq!(harness.state().names().len(), 5);
}
