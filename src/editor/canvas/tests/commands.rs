//! Keys, menus, clipboard, search and renaming.

use super::*;

fn paste(harness: &mut Harness<Bench>, text: &str) {
    harness.event(Event::Paste(text.to_owned()));
    harness.run_steps(3);
}

#[test]
fn nodes_are_copied_and_pasted_with_their_wires() {
    let mut harness = window(SCENE);
    click(&mut harness, "node sun");
    click_with(&mut harness, "node split", Modifiers::SHIFT);
    let text = copied(&mut harness, Event::Copy).unwrap();
    let mut part = Document::default();
    part.paste_text(crate::nodes::catalog(), &text, [0.0; 2]).unwrap();
    assert_eq!((part.nodes.len(), part.wires.len()), (2, 1));
    harness.hover_at(EMPTY);
    harness.step();
    paste(&mut harness, &text);
    assert_eq!(harness.state().names()[5..], ["sun_2", "split_2"]);
    assert_eq!(harness.state().wires()[2], "sun_2.light -> split_2.lights");
    assert_eq!(harness.state().selected(), ["sun_2", "split_2"]);
    let view = harness.state().canvas.view;
    let layout = &harness.state().project.document().layout;
    let at = view.to_canvas(EMPTY);
    // Places are whole points.
    assert!((layout["sun_2"][0] - f64::from(at.x)).abs() <= 0.5);
    assert_eq!(layout["split_2"][0] - layout["sun_2"][0], 280.0);
    undo(&mut harness);
    assert_eq!(harness.state().names().len(), 5);
    paste(&mut harness, "what is this");
    let told = harness.state().canvas.toast.is_some();
    assert!(told && harness.state().names().len() == 5);
}

#[test]
fn cut_duplicate_and_delete() {
    let mut harness = window(SCENE);
    click(&mut harness, "node sun");
    assert!(copied(&mut harness, Event::Cut).is_some());
    assert_eq!(harness.state().names(), ["moon", "split", "camera", "march"]);
    assert_eq!(harness.state().wires(), ["camera.camera -> march.camera"]);
    undo(&mut harness);
    click(&mut harness, "node camera");
    press(&mut harness, Modifiers::COMMAND, Key::D);
    assert_eq!(harness.state().selected(), ["camera_2"]);
    assert_eq!(harness.state().project.document().layout["camera_2"], [312.0, 282.0]);
    press(&mut harness, Modifiers::NONE, Key::Delete);
    assert_eq!(harness.state().names().len(), 5);
    press(&mut harness, Modifiers::COMMAND, Key::A);
    press(&mut harness, Modifiers::NONE, Key::Delete);
    assert!(harness.state().names().is_empty() && harness.state().wires().is_empty());
    undo(&mut harness);
    assert_eq!((harness.state().names().len(), harness.state().wires().len()), (5, 2));
}

#[test]
fn a_node_is_found_and_added() {
    let mut harness = window(SCENE);
    press(&mut harness, Modifiers::NONE, Key::Tab);
    harness.event(Event::Text("o".to_owned()));
    harness.event(Event::Text("i".to_owned()));
    harness.event(Event::Text("n".to_owned()));
    harness.event(Event::Text("t".to_owned()));
    harness.run_steps(2);
    press(&mut harness, Modifiers::NONE, Key::Enter);
    assert_eq!(harness.state().names()[5..], ["point_light"]);
    press(&mut harness, Modifiers::NONE, Key::Space);
    assert!(harness.query_by_label("add sun").is_some());
    press(&mut harness, Modifiers::NONE, Key::ArrowDown);
    press(&mut harness, Modifiers::NONE, Key::Enter);
    assert_eq!(harness.state().names()[6..], ["shape"]);
    press(&mut harness, Modifiers::NONE, Key::Tab);
    press(&mut harness, Modifiers::NONE, Key::Escape);
    assert!(harness.query_by_label("add sun").is_none());
    press(&mut harness, Modifiers::NONE, Key::Tab);
    click(&mut harness, "add sun");
    assert_eq!(harness.state().names()[7..], ["sun_2"]);
}

#[test]
fn a_node_is_renamed() {
    let mut harness = window(SCENE);
    click(&mut harness, "node sun");
    press(&mut harness, Modifiers::NONE, Key::F2);
    harness.event(Event::Text("dawn".to_owned()));
    harness.run_steps(2);
    press(&mut harness, Modifiers::NONE, Key::Enter);
    assert_eq!(harness.state().names()[0], "dawn");
    assert_eq!(harness.state().wires()[0], "dawn.light -> split.lights");
    assert_eq!(harness.state().selected(), ["dawn"]);
    press(&mut harness, Modifiers::NONE, Key::F2);
    harness.event(Event::Text("moon".to_owned()));
    harness.run_steps(2);
    press(&mut harness, Modifiers::NONE, Key::Enter);
    assert!(harness.query_by_label("there is a node 'moon' already; 'moon_2' is free").is_some());
    assert_eq!(harness.state().names()[0], "dawn");
}

#[test]
fn arrows_walk_and_enter_asks_for_the_inspector() {
    let mut harness = window(SCENE);
    click(&mut harness, "node sun");
    press(&mut harness, Modifiers::NONE, Key::ArrowRight);
    assert_eq!(harness.state().selected(), ["split"]);
    press(&mut harness, Modifiers::NONE, Key::ArrowDown);
    assert_eq!(harness.state().selected(), ["camera"]);
    assert!(harness.get_by_label("node camera").is_focused());
    press(&mut harness, Modifiers::NONE, Key::Enter);
    assert_eq!(harness.state().requests, [Request::Inspect("camera".to_owned())]);
}

#[test]
fn all_or_what_is_selected_is_shown() {
    let mut harness = window(SCENE);
    let screen = Rect::from_min_size(Pos2::ZERO, Vec2::new(1000.0, 700.0));
    click(&mut harness, "node sun");
    press(&mut harness, Modifiers::NONE, Key::F);
    // As large as life and in the middle; to within the rounding of f32.
    assert!((at(&harness, "node sun") - screen.center()).length() < 0.1);
    assert_eq!(harness.state().canvas.view.zoom, 1.0);
    press(&mut harness, Modifiers::NONE, Key::Home);
    for name in ["sun", "moon", "split", "camera", "march"] {
        assert!(screen.contains_rect(rect(&harness, &format!("node {name}"))));
    }
}

#[test]
fn nodes_without_places_stand_in_order_and_keep_them() {
    let layout = SCENE.find(",\n    \"layout\"").unwrap();
    let mut harness = window(&format!("{}}}", &SCENE[..layout]));
    let x = |name: &str| rect(&harness, name).left();
    assert!(x("node sun") < x("node split") && x("node camera") < x("node march"));
    assert!(harness.state().project.document().layout.is_empty(), "to look at it changes nothing");
    let march = rect(&harness, "node march");
    click(&mut harness, "node sun");
    press(&mut harness, Modifiers::NONE, Key::Delete);
    assert_eq!(rect(&harness, "node march"), march);
    press(&mut harness, Modifiers::NONE, Key::L);
    assert_eq!(harness.state().project.document().layout.len(), 4);
    undo(&mut harness);
}

#[test]
fn menus_do_what_keys_do() {
    let mut harness = window(SCENE);
    harness.get_by_label("node camera").click_secondary();
    harness.run_steps(3);
    harness.get_by_label_contains("Duplicate").click();
    harness.run_steps(3);
    assert_eq!(harness.state().names()[5..], ["camera_2"]);
}
