//! The ports of the opened group, by wires and by menus.

use super::groups::{GROUPS, document, double_click};
use super::*;
use crate::graph::End;

/// The inside of the group of [`GROUPS`]: the input of `x` and the output of `y` are its ports.
fn opened() -> Harness<'static, Bench> {
    let mut harness = window(GROUPS);
    let body = at(&harness, "node group");
    double_click(&mut harness, body);
    harness.hover_at(EMPTY);
    harness.run_steps(2);
    harness
}

fn inside(harness: &Harness<Bench>) -> Document {
    document(harness).inside("group").unwrap().clone()
}

fn ends(ends: &[End]) -> Vec<String> {
    ends.iter().map(End::to_string).collect()
}

fn choose(harness: &mut Harness<Bench>, port: &str, line: &str) {
    harness.get_by_label(port).click_secondary();
    harness.run_steps(3);
    click(harness, line);
}

#[test]
fn a_wire_to_the_edge_makes_a_port() {
    let mut harness = opened();
    let before = document(&harness);
    drag_labels(&mut harness, "output x.image", "new group output");
    assert_eq!(inside(&harness).outputs["x_image"].to_string(), "x.image");
    assert!(harness.query_by_label("group output x_image").is_some());
    harness.hover_at(EMPTY);
    undo(&mut harness);
    assert_eq!(document(&harness), before);
    // From the edge, too; what is wired says so.
    drag_labels(&mut harness, "new group input", "input y.image");
    let reason = "'y.image' takes one wire and has 'x.image -> y.image'; unplug it first";
    assert!(harness.query_by_label(reason).is_some());
    let middle = at(&harness, "input y.image");
    drag(&mut harness, middle, EMPTY);
    drag_labels(&mut harness, "new group input", "input y.image");
    assert_eq!(ends(&inside(&harness).inputs["y_image"]), ["y.image"]);
    // Outside it can be wired.
    click(&mut harness, "Graph");
    assert!(harness.query_by_label("input group.y_image").is_some());
}

#[test]
fn a_port_stands_for_more_and_for_less() {
    let mut harness = opened();
    drag_labels(&mut harness, "group input image", "input y.image");
    assert_eq!(ends(&inside(&harness).inputs["image"]), ["x.image", "y.image"]);
    assert!(inside(&harness).wires.is_empty(), "an input that takes one is replaced");
    // Pulled off, a link goes; with the last the port, and what was wired to it outside.
    let from = at(&harness, "input y.image");
    drag(&mut harness, from, EMPTY);
    assert_eq!(ends(&inside(&harness).inputs["image"]), ["x.image"]);
    let before = document(&harness);
    let from = at(&harness, "input x.image");
    drag(&mut harness, from, EMPTY);
    assert!(inside(&harness).inputs.is_empty());
    assert_eq!(harness.state().wires(), ["march.image -> a.image", "a.image -> b.image"]);
    harness.hover_at(EMPTY);
    undo(&mut harness);
    assert_eq!(document(&harness), before);
    // Led elsewhere in one step it stays.
    drag_labels(&mut harness, "input x.image", "input y.image");
    assert_eq!(ends(&inside(&harness).inputs["image"]), ["y.image"]);
    assert_eq!(harness.state().wires().len(), 3);
}

#[test]
fn a_link_is_chosen_and_deleted() {
    let mut harness = opened();
    click(&mut harness, "wire y.image -> outputs of the group.image");
    press(&mut harness, Modifiers::NONE, Key::Delete);
    assert!(inside(&harness).outputs.is_empty());
}

#[test]
fn a_wire_from_a_port_of_the_group_offers_what_fits() {
    let mut harness = opened();
    let from = at(&harness, "group input image");
    drag(&mut harness, from, EMPTY);
    assert!(harness.query_by_label("add sun").is_none());
    click(&mut harness, "add tone_map");
    assert_eq!(ends(&inside(&harness).inputs["image"]), ["x.image", "tone_map.image"]);
    harness.hover_at(EMPTY);
    undo(&mut harness);
    assert_eq!(inside(&harness).nodes.len(), 2);
}

#[test]
fn ports_are_exposed_renamed_moved_and_removed_by_menu() {
    let mut harness = opened();
    choose(&mut harness, "output x.image", "Expose as a port of the group");
    let outputs = |harness: &Harness<Bench>| inside(harness).outputs.keys().cloned().collect::<Vec<_>>();
    assert_eq!(outputs(&harness), ["image", "x_image"]);
    choose(&mut harness, "group output x_image", "Move up");
    assert_eq!(outputs(&harness), ["x_image", "image"]);
    choose(&mut harness, "group output x_image", "Rename");
    harness.event(Event::Text("raw".to_owned()));
    harness.run_steps(2);
    press(&mut harness, Modifiers::NONE, Key::Enter);
    assert_eq!(outputs(&harness), ["raw", "image"]);
    choose(&mut harness, "group output raw", "Remove the port");
    assert_eq!(outputs(&harness), ["image"]);
    // The same from outside, where the wires follow.
    click(&mut harness, "Graph");
    choose(&mut harness, "input group.image", "Rename");
    harness.event(Event::Text("light".to_owned()));
    harness.run_steps(2);
    press(&mut harness, Modifiers::NONE, Key::Enter);
    assert_eq!(harness.state().wires()[2], "b.image -> group.light");
    choose(&mut harness, "input group.light", "Remove the port");
    assert_eq!(harness.state().wires().len(), 2);
}

/// Outside, `o` reads the group's `x` and gives to its `b`.
const AROUND: &str = r#"{"tyndall": 1, "nodes": {"o": {"type": "tone_map"}, "group": {"type": "group",
      "nodes": {"x": {"type": "tone_map"}, "y": {"type": "tone_map"}}, "wires": [],
      "layout": {"x": [0, 0], "y": [280, 40]}, "inputs": {"a": "x.image", "b": "y.image"},
      "outputs": {"x": "x.image", "y": "y.image"}}},
    "wires": ["group.x -> o.image", "o.image -> group.b"], "layout": {"o": [300, 0], "group": [0, 0]}}"#;

#[test]
fn a_cycle_through_the_outside_is_refused_with_its_path() {
    let mut harness = window(AROUND);
    harness.state_mut().canvas.reveal("group/x");
    harness.run_steps(2);
    drag_labels(&mut harness, "output y.image", "input x.image");
    let reason = "that would close the cycle group/x -> o -> group/y -> group/x; what is outside of the group counts \
                  too";
    assert!(harness.query_by_label(reason).is_some());
    assert!(inside(&harness).wires.is_empty());
    assert_eq!(harness.state_mut().project.undo(), None);
}
