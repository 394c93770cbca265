use std::path::Path;

use super::*;
use crate::graph::check::check;
use crate::graph::plan::{Plan, Target};
use crate::graph::toy::CATALOG;

fn document(nodes: &str, wires: &str) -> Document {
    let text = format!(r#"{{"tyndall": 1, "nodes": {{{nodes}}}, "wires": [{wires}]}}"#);
    Document::parse(&text, Path::new("")).unwrap()
}

fn lines(document: &Document) -> Vec<String> {
    check(document, CATALOG, Target::Sinks).iter().map(Problem::to_string).collect()
}

fn names(plan: &Plan) -> Vec<&str> {
    plan.jobs.iter().map(|job| job.name.as_str()).collect()
}

fn wires(document: &Document) -> Vec<String> {
    document.wires.iter().map(Wire::to_string).collect()
}

const NODES: &str = r#""a": {"type": "number"}, "b": {"type": "number", "x": 2}, "sum": {"type": "sum"},
    "pair": {"type": "pair"}, "paint": {"type": "paint"}"#;
const WIRES: &str = r#""b.light -> sum.lights", "a.light -> sum.lights", "sum.light -> pair.a", "a.light -> pair.b",
    "pair.total -> paint.light""#;

/// The graph above, flat, with some fields of nodes set.
fn flat_with(settings: &[(&str, &str)]) -> Document {
    let mut document = document(NODES, WIRES);
    for (name, value) in settings {
        document.set(CATALOG, name, value).unwrap();
    }
    flatten(&document, CATALOG).into_owned()
}

#[test]
fn a_plain_graph_is_its_own() {
    let document = document(NODES, WIRES);
    assert!(matches!(flatten(&document, CATALOG), Cow::Borrowed(_)));
    // What is flat stays as it is.
    let flat = flat_with(&[("sum.bypass", "true")]);
    assert!(matches!(flatten(&flat, CATALOG), Cow::Borrowed(_)));
}

#[test]
fn a_muted_node_is_as_if_it_were_not_there() {
    let flat = flat_with(&[("b.mute", "true"), ("b.bypass", "true")]);
    assert_eq!(flat.nodes.keys().collect::<Vec<_>>(), ["a", "sum", "pair", "paint"]);
    let without_b =
        ["a.light -> sum.lights", "sum.light -> pair.a", "a.light -> pair.b", "pair.total -> paint.light"];
    assert_eq!(wires(&flat), without_b);
    // What is wrong with it does not matter.
    let wrong = document(r#""a": {"type": "nothing", "mute": true}, "b": {"type": "number"}"#, "");
    assert!(lines(&wrong).is_empty());
    assert_eq!(names(&Plan::new(&wrong, CATALOG, Target::Sinks)), ["b"]);
}

#[test]
fn a_bypassed_node_lets_its_first_wired_input_through() {
    // An input that takes many lets its first wire through, and two outputs the same.
    let flat = flat_with(&[("sum.bypass", "true"), ("pair.bypass", "true")]);
    assert_eq!(wires(&flat), ["b.light -> paint.light"]);
    // The first that has something to give.
    let flat = flat_with(&[("sum.mute", "true"), ("pair.bypass", "true")]);
    assert_eq!(wires(&flat), ["a.light -> paint.light"]);
    // What is wired twice in this way is one wire.
    let flat = flat_with(&[("b.mute", "true"), ("sum.bypass", "true")]);
    assert_eq!(wires(&flat), ["a.light -> pair.a", "a.light -> pair.b", "pair.total -> paint.light"]);
    let twice = document(
        r#""a": {"type": "number"}, "s": {"type": "sum", "bypass": true}, "t": {"type": "sum"}"#,
        r#""a.light -> s.lights", "s.light -> t.lights", "a.light -> t.lights""#,
    );
    assert_eq!(wires(&flatten(&twice, CATALOG)), ["a.light -> t.lights"]);
    // A cycle of bypassed nodes gives nothing, and ends.
    let cycle = document(
        r#""s": {"type": "sum", "bypass": true}, "t": {"type": "sum", "bypass": true}, "p": {"type": "paint"}"#,
        r#""s.light -> t.lights", "t.light -> s.lights", "t.light -> p.light""#,
    );
    assert!(flatten(&cycle, CATALOG).wires.is_empty());
}

#[test]
fn an_empty_input_names_the_silent_node() {
    let mut document = document(
        r#""one": {"type": "number", "mute": true}, "paint": {"type": "paint"}, "save": {"type": "save"}"#,
        r#""one.light -> paint.light", "paint.image -> save.image""#,
    );
    let givers =
        "wire light into it, which number.light, sum.light, pair.difference, pair.total or fade.light give";
    assert_eq!(
        lines(&document),
        [format!("node 'paint': input 'light' is empty, because 'one' is muted; unmute it or {givers}")]
    );
    document.set(CATALOG, "one.mute", "false").unwrap();
    assert!(lines(&document).is_empty());
    document.set(CATALOG, "one.bypass", "true").unwrap();
    assert_eq!(
        lines(&document),
        [format!(
            "node 'paint': input 'light' is empty, because 'one' is bypassed and has no light to pass on; {givers}"
        )]
    );
    let found = check(&document, CATALOG, Target::Nodes(&["one"]));
    assert_eq!(found[0].to_string(), "node 'one': 'one' is bypassed; take that back");
    document.set(CATALOG, "one.mute", "true").unwrap();
    let found = check(&document, CATALOG, Target::Nodes(&["one"]));
    assert_eq!(found[0].to_string(), "node 'one': 'one' is muted; unmute it");
}

/// `look` paints what comes in, added to a number of its own, through a group of its own.
const GROUPS: &str = r#""a": {"type": "number", "x": 3}, "b": {"type": "number"}, "look": {"type": "group",
    "nodes": {"own": {"type": "number", "x": 2}, "inner": {"type": "group",
        "nodes": {"sum": {"type": "sum"}, "paint": {"type": "paint"}},
        "wires": ["sum.light -> paint.light"],
        "inputs": {"lights": "sum.lights"}, "outputs": {"image": "paint.image", "light": "sum.light"}}},
    "wires": ["own.light -> inner.lights"],
    "inputs": {"lights": "inner.lights"}, "outputs": {"image": "inner.image", "light": "inner.light"}},
    "save": {"type": "save"}"#;
const GROUP_WIRES: &str = r#""a.light -> look.lights", "b.light -> look.lights", "look.image -> save.image""#;

#[test]
fn groups_are_replaced_by_what_they_hold() {
    let flat = document(GROUPS, GROUP_WIRES);
    assert!(lines(&flat).is_empty());
    let flat = flatten(&flat, CATALOG);
    let paths = ["a", "b", "look/own", "look/inner/sum", "look/inner/paint", "save"];
    assert_eq!(flat.nodes.keys().collect::<Vec<_>>(), paths);
    assert_eq!(
        wires(&flat),
        [
            "a.light -> look/inner/sum.lights",
            "b.light -> look/inner/sum.lights",
            "look/inner/paint.image -> save.image",
            "look/own.light -> look/inner/sum.lights",
            "look/inner/sum.light -> look/inner/paint.light",
        ]
    );
    let plan = Plan::new(&document(GROUPS, GROUP_WIRES), CATALOG, Target::Nodes(&["look"]));
    assert_eq!(names(&plan), ["a", "b", "look/own", "look/inner/sum", "look/inner/paint"]);
    let plan = Plan::new(&document(GROUPS, GROUP_WIRES), CATALOG, Target::Nodes(&["look/own"]));
    assert_eq!(names(&plan), ["look/own"]);
}

#[test]
fn groups_are_muted_and_bypassed_as_nodes_are() {
    let with = |setting: &str| {
        let mut document = document(GROUPS, GROUP_WIRES);
        document.set(CATALOG, setting, "true").unwrap();
        document
    };
    let image = "wire image into it, which paint.image gives";
    assert_eq!(
        lines(&with("look.mute")),
        [format!("node 'save': input 'image' is empty, because 'look' is muted; unmute it or {image}")]
    );
    assert_eq!(
        lines(&with("look/inner.bypass")),
        [format!(
            "node 'save': input 'image' is empty, because 'look/inner' is bypassed and has no image to pass on; {image}"
        )]
    );
    let muted = with("look.mute");
    let found = check(&muted, CATALOG, Target::Nodes(&["look/inner/sum"]));
    assert_eq!(found[0].to_string(), "node 'look/inner/sum': 'look' is muted; unmute it");
    // Light goes through by the types of the ports: of the group, of one inside of it, of a node inside.
    let source = |setting: &str| {
        let light = End { node: "look".to_owned(), port: "light".to_owned() };
        with(setting).source_of(CATALOG, &light).map(|end| end.to_string())
    };
    assert_eq!(source("b.mute").unwrap(), "look/inner/sum.light");
    for setting in ["look.bypass", "look/inner.bypass", "look/inner/sum.bypass"] {
        assert_eq!(source(setting).unwrap(), "a.light", "{setting}");
    }
    assert_eq!(source("look.mute"), None);
}

#[test]
fn wires_to_ports_that_a_group_does_not_have() {
    assert_eq!(
        lines(&document(GROUPS, r#""a.light -> look.light", "look.imag -> save.image""#)),
        [
            "node 'look': 'look' (group) takes no input 'light'; did you mean 'lights'? allowed are lights",
            "node 'save': 'look' (group) gives no output 'imag'; did you mean 'image'? allowed are image, light",
        ]
    );
    assert_eq!(
        lines(&document(GROUPS, r#""a.light -> look.lights", "look.light -> save.image""#))[0],
        "node 'save': cannot wire light into image; 'save.image' takes image, which paint.image gives"
    );
}

#[test]
fn parameters_in_groups() {
    let mut document = document(GROUPS, GROUP_WIRES);
    document.set(CATALOG, "look/own.x", "5").unwrap();
    assert_eq!(document.node("look/own").unwrap().params["x"], 5);
    let mut error = |name: &str| document.set(CATALOG, name, "1").unwrap_err().to_string();
    assert_eq!(
        error("look/onw.x"),
        "cannot set 'look/onw.x': there is no such node; did you mean 'look/own'? nodes are a, b, look, look/own, \
         look/inner, look/inner/sum, look/inner/paint, save"
    );
    assert_eq!(
        error("look.x"),
        "cannot set 'look.x': a group has no parameters; write look/node.parameter=value"
    );
    assert_eq!(error("look.mute"), "cannot set 'look.mute': mute is 1; write true or false");
}

/// Longer than any stack of calls would bear.
#[test]
fn a_long_chain_of_bypassed_nodes_is_no_recursion() {
    let mut document = document(r#""n0": {"type": "number"}"#, "");
    for idx in 1..5_000 {
        document.nodes.insert(format!("n{idx}"), Node { bypass: true, ..Node::new("sum") });
        document.wires.push(format!("n{}.light -> n{idx}.lights", idx - 1).parse().unwrap());
    }
    let last = End { node: "n4999".to_owned(), port: "light".to_owned() };
    assert_eq!(document.source_of(CATALOG, &last).unwrap().to_string(), "n0.light");
}
