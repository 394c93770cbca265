//! Wires: drawing, replacing, refusing, pulling off, dropping in the empty, inserting.

use egui::vec2;

use super::*;

fn toast(harness: &Harness<Bench>, text: &str) -> bool {
    harness.query_by_label(text).is_some()
}

#[test]
fn a_wire_is_drawn_from_either_end() {
    let mut harness = window(SCENE);
    drag_labels(&mut harness, "output moon.light", "input split.lights");
    assert_eq!(harness.state().wires()[2], "moon.light -> split.lights", "an input that takes many appends");
    undo(&mut harness);
    let mut harness =
        window(&SCENE.replace("\"camera.camera -> march.camera\"", "\"sun.light -> split.lights\"").replace(
            "\"sun.light -> split.lights\", \"sun.light -> split.lights\"",
            "\"sun.light -> split.lights\"",
        ));
    drag_labels(&mut harness, "input march.camera", "output camera.camera");
    assert_eq!(harness.state().wires(), ["sun.light -> split.lights", "camera.camera -> march.camera"]);
}

#[test]
fn two_clicks_draw_a_wire_too() {
    let mut harness = window(SCENE);
    click(&mut harness, "output moon.light");
    click(&mut harness, "input split.lights");
    assert_eq!(harness.state().wires()[2], "moon.light -> split.lights");
    harness.run_steps(2);
    assert!(matches!(harness.state().canvas.gesture, super::super::Gesture::None));
}

#[test]
fn an_input_that_takes_one_is_replaced() {
    let mut harness =
        window(&SCENE.replace("\"moon\": {\"type\": \"sun\"}", "\"moon\": {\"type\": \"camera\"}"));
    drag_labels(&mut harness, "output moon.camera", "input march.camera");
    assert_eq!(harness.state().wires(), ["sun.light -> split.lights", "moon.camera -> march.camera"]);
}

#[test]
fn what_does_not_fit_is_dim_and_says_why() {
    let mut harness = window(SCENE);
    let (from, to) = (at(&harness, "output moon.light"), at(&harness, "input march.medium"));
    drag_to(&mut harness, from, to);
    let scene = harness.state().canvas.scene.clone();
    let look = |text: &str| {
        let port = scene.nodes.iter().flat_map(|node| &node.ports).find(|port| port.port.label() == text);
        harness.state().canvas.port_look(port.unwrap())
    };
    use super::super::node::PortLook::{Dim, Hot, Plain};
    assert_eq!((look("input march.medium"), look("input split.lights")), (Dim, Plain));
    assert_eq!((look("output moon.light"), look("output sun.light")), (Hot, Dim));
    harness.drop_at(to);
    harness.run_steps(3);
    assert!(toast(&harness, "march.medium takes medium, not light"));
    assert_eq!(harness.state().wires().len(), 2);
    assert_eq!(harness.state_mut().project.undo(), None);
}

#[test]
fn a_cycle_is_refused_with_its_path() {
    let text = r#"{"tyndall": 1, "nodes": {"a": {"type": "tone_map"}, "b": {"type": "tone_map"}},
        "wires": ["a.image -> b.image"], "layout": {"a": [0, 0], "b": [300, 60]}}"#;
    let mut harness = window(text);
    drag_labels(&mut harness, "output b.image", "input a.image");
    assert_eq!(harness.state().wires(), ["a.image -> b.image"]);
    let reason =
        "'b.image -> a.image' would close the cycle a -> b -> a; wire it from a node that does not read 'a'";
    assert!(toast(&harness, reason));
}

#[test]
fn a_wire_is_pulled_off_and_put_elsewhere() {
    let two = SCENE
        .replace("\"camera\": {\"type\": \"camera\"}", "\"camera\": {\"type\": \"light_decomposition\"}");
    let two = two.replace(", \"camera.camera -> march.camera\"", "");
    let mut harness = window(&two);
    drag_labels(&mut harness, "input split.lights", "input camera.lights");
    assert_eq!(harness.state().wires(), ["sun.light -> camera.lights"]);
    let from = at(&harness, "input camera.lights");
    drag(&mut harness, from, EMPTY);
    assert_eq!(harness.state().wires(), [] as [&str; 0]);
    assert!(harness.query_by_label("add sun").is_none());
    harness.hover_at(EMPTY);
    undo(&mut harness);
    undo(&mut harness);
    assert_eq!(harness.state().wires(), ["sun.light -> split.lights"]);
    let from = at(&harness, "input split.lights");
    drag(&mut harness, from, from);
    assert_eq!(harness.state().wires(), ["sun.light -> split.lights"]);
}

#[test]
fn a_wire_on_a_node_finds_its_port() {
    let mut harness = window(SCENE);
    let from = at(&harness, "output moon.light");
    let to = rect(&harness, "node split").center_top() + vec2(0.0, 10.0);
    drag(&mut harness, from, to);
    assert_eq!(harness.state().wires()[2], "moon.light -> split.lights");
    let from = at(&harness, "output moon.light");
    let to = rect(&harness, "node march").center_top() + vec2(0.0, 10.0);
    drag(&mut harness, from, to);
    assert!(toast(&harness, "nothing of march takes light"));
}

#[test]
fn a_wire_in_the_empty_offers_what_fits() {
    let mut harness = window(SCENE);
    let from = at(&harness, "output moon.light");
    drag(&mut harness, from, EMPTY);
    assert!(harness.query_by_label("add camera").is_none());
    assert!(harness.query_by_label("add light_decomposition").is_some());
    harness.event(Event::Text("spher".to_owned()));
    harness.run_steps(2);
    press(&mut harness, Modifiers::NONE, Key::Enter);
    assert_eq!(harness.state().wires()[2], "moon.light -> spherical_propagation.lights");
    assert_eq!(harness.state().selected(), ["spherical_propagation"]);
    // Node and wire are one step.
    harness.hover_at(EMPTY);
    undo(&mut harness);
    assert_eq!((harness.state().wires().len(), harness.state().names().len()), (2, 5));
}

/// Two tone maps in a row and one aside.
pub const TONES: &str = r#"{"tyndall": 1, "nodes": {"a": {"type": "tone_map"}, "b": {"type": "tone_map"},
    "c": {"type": "tone_map"}}, "wires": ["a.image -> b.image"],
    "layout": {"a": [0, 0], "b": [500, 0], "c": [250, 250]}}"#;

#[test]
fn a_node_dropped_on_a_wire_is_inserted() {
    let mut harness = window(TONES);
    let from = rect(&harness, "node c").center_top() + vec2(0.0, 8.0);
    let up = at(&harness, "wire a.image -> b.image") - rect(&harness, "node c").center();
    drag(&mut harness, from, from + up);
    assert_eq!(harness.state().wires(), ["a.image -> c.image", "c.image -> b.image"]);
    harness.hover_at(EMPTY);
    undo(&mut harness);
    assert_eq!(harness.state().wires(), ["a.image -> b.image"]);
    assert_eq!(harness.state().project.document().layout["c"], [250.0, 250.0]);
}

#[test]
fn a_wire_is_chosen_cut_and_led_through_a_node() {
    let mut harness = window(TONES);
    let name = "wire a.image -> b.image";
    // Away from its middle, where its handle is not.
    let off = at(&harness, name) + vec2(60.0, 0.0);
    for pressed in [true, false] {
        harness.hover_at(off);
        harness.step();
        let button = egui::PointerButton::Primary;
        harness.event(Event::PointerButton { pos: off, button, pressed, modifiers: Modifiers::NONE });
        harness.step();
    }
    press(&mut harness, Modifiers::NONE, Key::Delete);
    assert_eq!(harness.state().wires(), [] as [&str; 0]);
    undo(&mut harness);
    click(&mut harness, name);
    press(&mut harness, Modifiers::NONE, Key::Backspace);
    harness.run_steps(2);
    assert_eq!(harness.state().wires(), [] as [&str; 0]);
    undo(&mut harness);
    harness.get_by_label(name).click_secondary();
    harness.run_steps(3);
    harness.get_by_label("Insert a node…").click();
    harness.run_steps(3);
    assert!(harness.query_by_label("add sun").is_none());
    harness.get_by_label("add tone_map").click();
    harness.run_steps(3);
    assert_eq!(harness.state().wires(), ["a.image -> tone_map.image", "tone_map.image -> b.image"]);
}
