//! Gestures on each kind of parameter, found by their names.

mod files;
mod looks;
mod wires;

use std::sync::Arc;

use egui::accesskit::Role;
use egui::{Event, Key, Modifiers, PointerButton, Pos2, vec2};
use egui_kittest::kittest::Queryable;
use egui_kittest::{Harness, Node};
use serde_json::{Value as Json, json};

use super::{Context, show};
use crate::editor::{NodeState, NodeStatus, Project, Selection, Statuses};
use crate::graph::{Decision, Document, Report};

#[derive(Default)]
struct Desk {
    project: Project,
    selection: Selection,
    statuses: Statuses,
    opened: String,
    takes_keyboard: bool,
    /// The node that a link asked for last.
    asked: Option<String>,
}

impl Desk {
    fn undo(&mut self) {
        self.project.undo().expect("a step");
    }

    fn show(&mut self, ui: &mut egui::Ui) {
        let context = Context {
            selection: &self.selection,
            statuses: &self.statuses,
            opened: &self.opened,
            takes_keyboard: std::mem::take(&mut self.takes_keyboard),
        };
        self.asked = show(ui, &mut self.project, &context).or(self.asked.take());
    }
}

type Inspector = Harness<'static, Desk>;

fn inspector(nodes: Json, wires: Json, selected: &[&str]) -> Inspector {
    let text = json!({ "tyndall": 1, "nodes": nodes, "wires": wires }).to_string();
    let base = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("graphs");
    let document = Document::parse(&text, &base).unwrap();
    let mut selection = Selection::default();
    selection.nodes.extend(selected.iter().map(|name| (*name).to_owned()));
    let mut project = Project::new(document);
    project.look_at(Some(12));
    let desk = Desk { project, selection, ..Desk::default() };
    let size = vec2(320.0, 1400.0);
    Harness::builder().with_size(size).build_ui_state(|ui, desk: &mut Desk| desk.show(ui), desk)
}

/// The inspector on one node with this type and these parameters, named `n`.
fn on(node: Json) -> Inspector {
    inspector(json!({ "n": node }), json!([]), &["n"])
}

fn param(harness: &Inspector, name: &str) -> Json {
    harness.state().project.document().nodes["n"].params.get(name).cloned().unwrap_or_default()
}

fn node<'a>(harness: &'a Inspector, name: &'a str) -> Node<'a> {
    harness.get_by_label(name)
}

fn type_into(harness: &mut Inspector, name: &str, text: &str) {
    node(harness, name).focus();
    harness.run();
    node(harness, name).type_text(text);
    harness.run();
    harness.key_press(Key::Enter);
    harness.run();
}

fn drag(harness: &mut Inspector, name: &str, by: egui::Vec2) {
    let from = node(harness, name).rect().center();
    drag_from(harness, from, by);
}

fn drag_from(harness: &mut Inspector, from: Pos2, by: egui::Vec2) {
    harness.hover_at(from);
    harness.step();
    harness.drag_at(from);
    harness.step();
    for n in 1..=5 {
        harness.hover_at(from + by * (n as f32 / 5.0));
        harness.step();
    }
    harness.drop_at(from + by);
    harness.run();
}

fn click(harness: &mut Inspector, name: &str) {
    node(harness, name).click();
    harness.run();
}

/// Whether this text stands somewhere.
fn says(harness: &Inspector, text: &str) -> bool {
    harness.query_all_by_label_contains(text).next().is_some()
}

#[test]
fn numbers_are_typed_as_arithmetic() {
    let mut harness = on(json!({ "type": "medium" }));
    assert_eq!(node(&harness, "n.g").value().as_deref(), Some("0"));
    type_into(&mut harness, "n.g", "sqrt(2)/2");
    assert_eq!(param(&harness, "g"), json!(2f64.sqrt() / 2.0));
    type_into(&mut harness, "n.max_cells", "2^20");
    assert_eq!(param(&harness, "max_cells"), json!(1 << 20));
    harness.state_mut().undo();
    harness.state_mut().undo();
    assert!(harness.state().project.document().nodes["n"].params.is_empty());
    assert!(harness.state_mut().project.undo().is_none());
}

#[test]
fn what_is_refused_stays_in_the_field() {
    let mut harness = on(json!({ "type": "medium", "g": 0.5 }));
    type_into(&mut harness, "n.g", "3");
    assert_eq!(param(&harness, "g"), json!(0.5));
    assert_eq!(node(&harness, "n.g").value().as_deref(), Some("3"));
    assert!(says(&harness, "g = 3 is outside -1 < value < 1; the default is 0"));
    assert!(harness.state_mut().project.undo().is_none());
    // Mended, the message goes.
    type_into(&mut harness, "n.g", "0.25");
    assert_eq!(param(&harness, "g"), json!(0.25));
    assert!(!says(&harness, "is outside"));
    type_into(&mut harness, "n.max_cells", "1.5");
    assert!(says(&harness, "max_cells is 1.5; write a whole number, value >= 1"));
    type_into(&mut harness, "n.g", "0.3 +");
    assert!(says(&harness, "'0.3 +' ends where a number should stand"));
}

#[test]
fn escape_takes_back_what_was_typed() {
    let mut harness = on(json!({ "type": "medium", "g": 0.5 }));
    node(&harness, "n.g").focus();
    harness.run();
    node(&harness, "n.g").type_text("0.7");
    harness.run();
    harness.key_press(Key::Escape);
    harness.run();
    assert_eq!(node(&harness, "n.g").value().as_deref(), Some("0.5"));
    assert_eq!(param(&harness, "g"), json!(0.5));
}

#[test]
fn a_drag_is_one_step() {
    let mut harness = on(json!({ "type": "medium" }));
    drag(&mut harness, "n.g drag", vec2(60.0, 0.0));
    // The soft range, -0.9 to 0.95, over 300 points, less the few that a drag takes to begin.
    let g = param(&harness, "g").as_f64().unwrap();
    assert!((0.3..=0.372).contains(&g), "{g}");
    harness.state_mut().undo();
    assert_eq!(param(&harness, "g"), Json::Null);
    assert!(harness.state_mut().project.undo().is_none());
    // Beyond the limit the document keeps the last valid value.
    drag(&mut harness, "n.g drag", vec2(290.0, 0.0));
    let g = param(&harness, "g").as_f64().unwrap();
    assert!(g > 0.5 && g < 1.0, "{g}");
}

#[test]
fn a_slider_spans_the_soft_range() {
    let mut harness = on(json!({ "type": "medium" }));
    let rect = node(&harness, "n.g slider").rect();
    drag_from(&mut harness, rect.center(), vec2(0.25 * rect.width(), 0.0));
    let g = param(&harness, "g").as_f64().unwrap();
    assert!((0.4..0.6).contains(&g), "{g}");
    harness.state_mut().undo();
    assert_eq!(param(&harness, "g"), Json::Null);
    assert!(harness.state_mut().project.undo().is_none());
}

#[test]
fn reset_is_the_default_again() {
    let mut harness = on(json!({ "type": "medium", "g": 0.5 }));
    assert!(harness.query_by_label("n.density_scale reset").is_none());
    click(&mut harness, "n.g reset");
    assert!(harness.state().project.document().nodes["n"].params.is_empty());
    assert!(harness.query_by_label("n.g reset").is_none());
    harness.state_mut().undo();
    assert_eq!(param(&harness, "g"), json!(0.5));
}

#[test]
fn vectors_have_a_field_a_number() {
    let mut harness = on(json!({ "type": "camera" }));
    type_into(&mut harness, "n.position.y", "1/4");
    assert_eq!(param(&harness, "position"), json!([0, 0.25, 5]));
    drag(&mut harness, "n.position.x drag", vec2(40.0, 0.0));
    assert!(param(&harness, "position")[0].as_f64().unwrap() > 0.2);
}

#[test]
fn colors_have_a_strength() {
    let mut harness = on(json!({ "type": "sun", "irradiance": [20, 10, 5] }));
    assert_eq!(node(&harness, "n.irradiance.strength").value().as_deref(), Some("20"));
    type_into(&mut harness, "n.irradiance.strength", "4");
    assert_eq!(param(&harness, "irradiance"), json!([4, 2, 1]));
    type_into(&mut harness, "n.irradiance.b", "7");
    assert_eq!(param(&harness, "irradiance"), json!([4, 2, 7]));
    click(&mut harness, "n.irradiance picker");
    assert!(harness.query_all_by_role(Role::ColorWell).count() > 0 || says(&harness, "n.irradiance picker"));
    let mut black = on(json!({ "type": "environment" }));
    type_into(&mut black, "n.radiance.strength", "0");
    assert_eq!(param(&black, "radiance"), json!([0, 0, 0]));
    type_into(&mut black, "n.radiance.strength", "3");
    assert_eq!(param(&black, "radiance"), json!([3, 3, 3]));
    // A share has none: the picker's range is its own.
    let harness = on(json!({ "type": "medium" }));
    assert!(harness.query_by_label("n.albedo.strength").is_none());
}

#[test]
fn a_color_is_picked_in_one_step() {
    let mut harness = on(json!({ "type": "medium" }));
    let rect = node(&harness, "n.albedo picker").rect();
    click(&mut harness, "n.albedo picker");
    // The field of saturation and value hangs somewhere below the swatch.
    for below in [60.0, 90.0, 120.0, 150.0, 180.0] {
        if param(&harness, "albedo").is_null() {
            drag_from(&mut harness, rect.left_bottom() + vec2(60.0, below), vec2(25.0, 25.0));
        }
    }
    let picked = param(&harness, "albedo");
    assert!(picked.is_array() && picked != json!([1, 1, 1]), "{picked}");
    harness.state_mut().undo();
    assert_eq!(param(&harness, "albedo"), Json::Null);
    assert!(harness.state_mut().project.undo().is_none());
}

#[test]
fn a_direction_is_turned() {
    let mut harness = on(json!({ "type": "sun", "direction": [0, 0, 2] }));
    drag(&mut harness, "n.direction ball", vec2(20.0, 0.0));
    let turned = param(&harness, "direction");
    let (x, z) = (turned[0].as_f64().unwrap(), turned[2].as_f64().unwrap());
    assert!(x > 0.5 && (x.hypot(z) - 2.0).abs() < 1e-3, "{turned}");
    harness.state_mut().undo();
    assert_eq!(param(&harness, "direction"), json!([0, 0, 2]));
    type_into(&mut harness, "n.direction.z", "0");
    // What is refused hides nothing else.
    assert!(harness.query_by_label("n.direction.x").is_some());
    assert!(says(&harness, "direction has no length; write 3 numbers in brackets, not all zero"));
}

#[test]
fn choices_switches_and_text() {
    let mut harness = on(json!({ "type": "load_vdb", "path": "../data/plume.vdb" }));
    click(&mut harness, "n.loop");
    assert_eq!(param(&harness, "loop"), json!(true));
    click(&mut harness, "n.frame set");
    assert_eq!(param(&harness, "frame"), json!(0));
    type_into(&mut harness, "n.frame", "7");
    assert_eq!(param(&harness, "frame"), json!(7));
    click(&mut harness, "n.frame set");
    assert_eq!(param(&harness, "frame"), Json::Null);
    type_into(&mut harness, "n.path", "../data/cumulus.vdb");
    assert_eq!(param(&harness, "path"), json!("../data/cumulus.vdb"));
    let mut harness = on(json!({ "type": "tone_map" }));
    click(&mut harness, "n.curve");
    click(&mut harness, "aces");
    assert_eq!(param(&harness, "curve"), json!("aces"));
}

#[test]
fn records_are_switched_on_and_off() {
    let mut harness = on(json!({ "type": "medium" }));
    assert!(harness.query_by_label("n.emission.flame").is_none());
    click(&mut harness, "n.emission set");
    assert_eq!(param(&harness, "emission"), json!({}));
    type_into(&mut harness, "n.emission.flame", "fuel");
    assert_eq!(param(&harness, "emission"), json!({ "flame": "fuel" }));
    click(&mut harness, "n.emission set");
    assert_eq!(param(&harness, "emission"), Json::Null);
    for _ in 0..3 {
        harness.state_mut().undo();
    }
    assert!(harness.state_mut().project.undo().is_none());
}

#[test]
fn keys_come_and_go_at_the_frame() {
    let mut harness = on(json!({ "type": "medium", "g": 0.5 }));
    click(&mut harness, "n.g key");
    assert_eq!(param(&harness, "g"), json!({ "keys": [[12, 0.5]] }));
    harness.state_mut().project.look_at(Some(20));
    harness.run();
    // A change is a key where there are keys.
    type_into(&mut harness, "n.g", "0.7");
    assert_eq!(param(&harness, "g"), json!({ "keys": [[12, 0.5], [20, 0.7]] }));
    harness.state_mut().project.look_at(Some(16));
    harness.run();
    assert_eq!(node(&harness, "n.g").value().as_deref(), Some("0.6"));
    type_into(&mut harness, "n.g", "1");
    assert!(says(&harness, "is outside"));
    harness.state_mut().project.look_at(Some(12));
    harness.run();
    click(&mut harness, "n.g key");
    assert_eq!(param(&harness, "g"), json!({ "keys": [[20, 0.7]] }));
    harness.state_mut().project.look_at(Some(20));
    harness.run();
    click(&mut harness, "n.g key");
    assert_eq!(param(&harness, "g"), json!(0.7));
}

#[test]
fn nodes_of_a_kind_are_edited_together() {
    let nodes = json!({
        "n": { "type": "medium", "g": 0.5 }, "m": { "type": "medium" }, "c": { "type": "camera" }
    });
    let mut harness = inspector(nodes, json!([]), &["m", "c", "n"]);
    assert!(says(&harness, "2 nodes are edited together"));
    type_into(&mut harness, "n.g", "0.25");
    let g = |harness: &Inspector, name: &str| {
        harness.state().project.document().nodes[name].params.get("g").cloned()
    };
    assert_eq!((g(&harness, "n"), g(&harness, "m")), (Some(json!(0.25)), Some(json!(0.25))));
    assert_eq!(g(&harness, "c"), None);
    harness.state_mut().undo();
    assert_eq!((g(&harness, "n"), g(&harness, "m")), (Some(json!(0.5)), None));
}

#[test]
fn grids_of_the_file_are_a_menu() {
    let nodes = json!({
        "cloud": { "type": "load_vdb", "path": "../data/plume.vdb" }, "n": { "type": "medium", "density": "x" }
    });
    let mut harness = inspector(nodes, json!(["cloud.volume -> n.volume"]), &["n"]);
    click(&mut harness, "n.density menu");
    let grid = harness.query_all_by_label_contains("density   float").next().expect("the grid of the file");
    grid.click();
    harness.run();
    assert_eq!(param(&harness, "density"), json!("density"));
    let mut harness = on(json!({ "type": "medium" }));
    click(&mut harness, "n.density menu");
    assert!(says(&harness, "wire a volume to n.volume to see its grids"));
}

#[test]
fn what_differs_says_so() {
    let nodes = json!({
        "n": { "type": "medium", "g": 0.5, "albedo": [1, 1, 1] }, "m": { "type": "medium", "g": 0.25 }
    });
    let mut harness = inspector(nodes, json!([]), &["m", "n"]);
    assert!(harness.query_by_label("n.g mixed").is_some());
    // A default that is written down is the default, and 1.0 is 1.
    assert!(harness.query_by_label("n.albedo mixed").is_none());
    assert!(harness.query_by_label("n.density_scale mixed").is_none());
    type_into(&mut harness, "n.g", "0.75");
    assert!(harness.query_by_label("n.g mixed").is_none());
}

#[test]
fn what_the_file_says_wrong_is_shown() {
    let harness = on(json!({ "type": "medium", "g": 4 }));
    assert!(says(&harness, "g = 4 is outside"));
    let harness = on(json!({ "type": "load_vdb" }));
    assert!(says(&harness, "path is missing; write a path as a string"));
}

#[test]
fn a_curve_is_drawn() {
    let points = json!([[0, 1, 0, 0, 0], [1, 0, 0, 1, 1]]);
    let mut harness = on(json!({ "type": "transfer_function", "points": points }));
    let whole = node(&harness, "n.points").rect();
    let double = |harness: &mut Inspector, at: Pos2| {
        harness.hover_at(at);
        harness.step();
        // Within one frame, because a frame of the harness is as long as a double click may take.
        let events = [true, false, true, false].map(|pressed| Event::PointerButton {
            pos: at,
            button: PointerButton::Primary,
            pressed,
            modifiers: Modifiers::NONE,
        });
        harness.input_mut().events.extend(events);
        harness.run();
    };
    double(&mut harness, whole.left_top() + vec2(0.5 * whole.width(), 30.0));
    let rows = param(&harness, "points");
    assert_eq!(rows.as_array().unwrap().len(), 3, "{rows}");
    // A color between its neighbors' in the middle.
    assert!(
        (rows[1][1].as_f64().unwrap() - 0.5).abs() < 0.02 && rows[1][4].as_f64().unwrap() > 0.6,
        "{rows}"
    );
    drag(&mut harness, "n.points point 1", vec2(-40.0, 30.0));
    let dragged = param(&harness, "points");
    assert!(dragged[1][0].as_f64() < rows[1][0].as_f64() && dragged[1][4].as_f64() < rows[1][4].as_f64());
    // Past a neighbor it waits.
    drag(&mut harness, "n.points point 1", vec2(-250.0, 0.0));
    assert!(param(&harness, "points")[1][0].as_f64().unwrap() > 0.0);
    type_into(&mut harness, "n.points.opacity", "2");
    assert!(says(&harness, "points[1].opacity = 2 is outside 0..=1"));
    node(&harness, "n.points point 1").click_secondary();
    harness.run();
    assert_eq!(param(&harness, "points"), points);
    click(&mut harness, "n.points map");
    click(&mut harness, "viridis");
    let rows = param(&harness, "points");
    assert_eq!(rows.as_array().unwrap().len(), 9);
    assert_eq!((&rows[8][0], &rows[8][4], &rows[4][4]), (&json!(1), &json!(1), &json!(0.5)));
    // A step each: double click, two drags, remove, map.
    for _ in 0..5 {
        harness.state_mut().undo();
    }
    assert_eq!(param(&harness, "points"), points);
    assert!(harness.state_mut().project.undo().is_none());
}

#[test]
fn what_a_node_said_of_its_run_is_shown() {
    let mut harness = on(json!({ "type": "medium" }));
    let thin = Decision::left_out("thin", "the residual", "the medium is thin", "tau 0.01");
    let report = Report { decisions: vec![thin], cells: Some([4, 5, 6]), ..Report::default() };
    let status = NodeStatus {
        state: NodeState::Failed("density_scale is too large".to_owned()),
        report: Arc::new(report),
        ..NodeStatus::default()
    };
    harness.state_mut().statuses.insert("n".to_owned(), status);
    harness.run();
    for text in
        ["density_scale is too large", "left out: the residual", "the medium is thin", "4 x 5 x 6 cells"]
    {
        assert!(says(&harness, text), "{text}");
    }
}

#[test]
fn a_graph_is_described_where_no_node_is_selected() {
    let mut harness = inspector(json!({ "sun": { "type": "sun" } }), json!([]), &[]);
    node(&harness, "about the graph").focus();
    harness.run_steps(2);
    for letters in ["low", " sun"] {
        harness.event(egui::Event::Text(letters.to_owned()));
        harness.run_steps(2);
    }
    assert_eq!(harness.state().project.document().about, "low sun");
    // All that was written is one step.
    harness.state_mut().undo();
    assert_eq!(harness.state().project.document().about, "");
}
