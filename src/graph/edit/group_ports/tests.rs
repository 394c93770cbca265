use std::path::Path;

use super::*;
use crate::graph::Wire;
use crate::graph::toy::CATALOG;

/// A group of a sum that gives to a pair, between a number and a sum that saves.
const TEXT: &str = r#"{"tyndall": 1, "nodes": {"a": {"type": "number"}, "g": {"type": "group",
      "nodes": {"s": {"type": "sum"}, "pair": {"type": "pair"}, "file": {"type": "file", "path": "x"}},
      "wires": ["s.light -> pair.a"], "inputs": {"lights": "s.lights"}, "outputs": {"total": "pair.total"}},
      "t": {"type": "sum"}},
    "wires": ["a.light -> g.lights", "g.total -> t.lights"], "bends": {"g.total -> t.lights": [[1, 2]]}}"#;

fn document() -> Document {
    Document::parse(TEXT, Path::new("")).unwrap()
}

fn end(text: &str) -> End {
    text.parse().unwrap()
}

fn wires(document: &Document) -> Vec<String> {
    document.wires.iter().map(Wire::to_string).collect()
}

fn inputs(document: &Document) -> Vec<String> {
    let ends = |ends: &[End]| ends.iter().map(End::to_string).collect::<Vec<_>>().join(" ");
    document.inside("g").unwrap().inputs.iter().map(|(port, all)| format!("{port}: {}", ends(all))).collect()
}

/// What is written must be read again.
fn assert_sound(document: &Document) {
    let again = Document::parse(&document.to_json(), Path::new("")).unwrap();
    assert_eq!(again.to_json(), document.to_json());
}

#[test]
fn ports_are_made_led_and_taken_away() {
    let mut document = document();
    let mut inside = |change: &dyn Fn(&mut Document) -> Result<(), String>| {
        document.wire_inside("g", change).unwrap();
        assert_sound(&document);
        inputs(&document)
    };
    let expose =
        |text: &'static str| move |g: &mut Document| g.expose(CATALOG, Side::Input, &end(text)).map(drop);
    assert_eq!(inside(&expose("pair.b")), ["lights: s.lights", "b: pair.b"]);
    let lead = |port: &'static str, text: &'static str| {
        move |g: &mut Document| g.lead(CATALOG, Side::Input, port, &end(text))
    };
    // One that takes one wire loses what it had: a wire, or another port, which goes with its last end.
    assert_eq!(inside(&lead("lights", "pair.a")), ["lights: s.lights pair.a", "b: pair.b"]);
    assert_eq!(inside(&lead("lights", "pair.b")), ["lights: s.lights pair.a pair.b"]);
    assert_eq!(inside(&lead("lights", "pair.b")), ["lights: s.lights pair.a pair.b"]);
    assert!(document.inside("g").unwrap().wires.is_empty());
    let g = document.inside_mut("g").unwrap();
    assert!(
        g.unlead(Side::Input, "lights", &end("pair.a")) && !g.unlead(Side::Input, "lights", &end("pair.a"))
    );
    assert_eq!(g.expose(CATALOG, Side::Output, &end("s.light")).unwrap(), "light");
    assert_eq!(g.expose(CATALOG, Side::Output, &end("pair.difference")).unwrap(), "difference");
    g.lead(CATALOG, Side::Output, "light", &end("pair.difference")).unwrap();
    assert_eq!(g.outputs["light"], end("pair.difference"));
    // A name that is taken is told apart by the node's.
    assert_eq!(g.expose(CATALOG, Side::Output, &end("s.light")).unwrap(), "s_light");
}

#[test]
fn what_cannot_be_a_port_says_why() {
    let mut document = document();
    let g = document.inside_mut("g").unwrap();
    let before = g.clone();
    let mut refused = |side, text: &str| g.expose(CATALOG, side, &end(text)).unwrap_err();
    assert_eq!(refused(Side::Input, "s.lights"), "'s.lights' is the group's input 'lights' already");
    assert_eq!(
        refused(Side::Input, "pair.a"),
        "'pair.a' takes one wire and has 's.light -> pair.a'; unplug it first"
    );
    assert_eq!(
        refused(Side::Output, "pair.tot"),
        "'pair' (pair) has no output 'tot'; did you mean 'total'? allowed are difference, total"
    );
    assert_eq!(refused(Side::Input, "file.x"), "'file' (file) has no input 'x', and no other");
    assert_eq!(refused(Side::Input, "x.x"), "'x': there is no such node; nodes are s, pair, file");
    let mut refused = |side, port: &str, text: &str| g.lead(CATALOG, side, port, &end(text)).unwrap_err();
    assert_eq!(
        refused(Side::Output, "total", "file.volume"),
        "cannot lead 'total' to 'file.volume'; 'total' is light, 'file.volume' is volume"
    );
    assert_eq!(
        refused(Side::Input, "light", "pair.b"),
        "the group has no input 'light'; did you mean 'lights'? allowed are lights"
    );
    assert_eq!(*g, before);
    assert_eq!(document.wire_inside("a", |_| Ok(())).unwrap_err(), "'a' is no group; it is a number");
}

#[test]
fn what_was_wired_to_a_port_goes_with_it() {
    let mut document = document();
    document.edit_inside("g", |g| assert!(g.remove_port(Side::Output, "total"))).unwrap();
    assert_eq!(wires(&document), ["a.light -> g.lights"]);
    assert!(document.bends.is_empty());
    // Also where a node inside takes the port with it, and on all levels.
    let mut outer = Document::default();
    outer.nodes.insert("o".to_owned(), crate::graph::Node::group(self::document()));
    let o = outer.inside_mut("o").unwrap();
    o.outputs.insert("out".to_owned(), end("g.total"));
    o.inputs.insert("in".to_owned(), vec![end("g.lights"), end("t.lights")]);
    outer.nodes.insert("n".to_owned(), crate::graph::Node::new("sum"));
    outer.connect(CATALOG, "o.out -> n.lights".parse().unwrap()).unwrap();
    outer.edit_inside("o/g", |g| g.remove(&["pair".to_owned(), "s".to_owned()])).unwrap();
    let o = outer.inside("o").unwrap();
    assert!(o.outputs.is_empty() && o.wires.is_empty() && outer.wires.is_empty());
    assert_eq!(o.inputs["in"], [end("t.lights")]);
    assert!(outer.edit_inside("o/x", |_| ()).is_none());
}

#[test]
fn a_port_has_another_name_on_both_sides() {
    let mut outer = Document::default();
    outer.nodes.insert("o".to_owned(), crate::graph::Node::group(document()));
    outer.rename_port("o/g", Side::Output, "total", "sum").unwrap();
    outer.rename_port("o/g", Side::Input, "lights", "in").unwrap();
    let o = outer.inside("o").unwrap();
    assert_eq!(wires(o), ["a.light -> g.in", "g.sum -> t.lights"]);
    assert_eq!(o.bends.keys().map(Wire::to_string).collect::<Vec<_>>(), ["g.sum -> t.lights"]);
    assert_eq!(inputs(o), ["in: s.lights"]);
    let mut refused = |from: &str, to: &str| outer.rename_port("o/g", Side::Input, from, to).unwrap_err();
    assert_eq!(refused("in", "a b"), "'a b' is no name of a port; write letters, digits, '_' and '-'");
    assert_eq!(refused("lights", "x"), "the group has no input 'lights'; allowed are in");
    // An input and an output may have one name.
    outer.rename_port("o/g", Side::Input, "in", "sum").unwrap();
    let g = outer.inside_mut("o/g").unwrap();
    g.expose(CATALOG, Side::Input, &end("pair.b")).unwrap();
    let error = outer.rename_port("o/g", Side::Input, "b", "sum").unwrap_err();
    assert_eq!(error, "the group has an input 'sum' already; choose another name");
}

#[test]
fn ports_have_an_order() {
    let mut document = document();
    let g = document.inside_mut("g").unwrap();
    g.expose(CATALOG, Side::Input, &end("pair.b")).unwrap();
    g.shift_port(Side::Input, "b", -1).unwrap();
    assert_eq!(g.inputs.keys().collect::<Vec<_>>(), ["b", "lights"]);
    g.shift_port(Side::Input, "b", 7).unwrap();
    assert_eq!(g.inputs.keys().collect::<Vec<_>>(), ["lights", "b"]);
    assert!(g.shift_port(Side::Output, "b", 1).is_err());
    assert_sound(&document);
    // Maps are equal in any order, what is written is not.
    let before = document.clone();
    document.inside_mut("g").unwrap().shift_port(Side::Input, "b", -1).unwrap();
    assert!(document == before && !document.is_as(&before) && before.is_as(&before.clone()));
}

#[test]
fn a_cycle_through_the_outside_is_refused() {
    let mut document = document();
    document.edit_inside("g", |g| g.expose(CATALOG, Side::Input, &end("pair.b")).unwrap()).unwrap();
    document.connect(CATALOG, "t.light -> g.b".parse().unwrap()).unwrap_err();
    // Outside the sum reads the group; were it the group's new input, the pair would read itself.
    document.edit_inside("g", |g| g.remove_port(Side::Output, "total")).unwrap();
    document.edit_inside("g", |g| g.expose(CATALOG, Side::Output, &end("s.light")).unwrap()).unwrap();
    document.connect(CATALOG, "g.light -> t.lights".parse().unwrap()).unwrap();
    document.connect(CATALOG, "t.light -> g.b".parse().unwrap()).unwrap();
    let before = document.clone();
    let wire: Wire = "pair.total -> s.lights".parse().unwrap();
    let mut open = document.clone();
    open.inside_mut("g").unwrap().disconnect(&"s.light -> pair.a".parse().unwrap());
    let error = open.wire_inside("g", |g| g.connect(CATALOG, wire)).unwrap_err();
    assert_eq!(
        error,
        "that would close the cycle g/s -> t -> g/pair -> g/s; what is outside of the group counts too"
    );
    let lead = |g: &mut Document| g.lead(CATALOG, Side::Output, "light", &end("pair.total"));
    let error = document.wire_inside("g", lead).unwrap_err();
    assert!(error.starts_with("that would close the cycle t -> g/pair -> t;"), "{error}");
    assert_eq!(document, before);
}

#[test]
fn an_inner_wire_takes_the_place_of_a_port() {
    let mut document = document();
    let g = document.inside_mut("g").unwrap();
    g.expose(CATALOG, Side::Input, &end("pair.b")).unwrap();
    // What a port feeds is not empty.
    g.wires.clear();
    let wire: Wire = "s.light -> pair.b".parse().unwrap();
    document.edit_inside("g", |g| g.connect(CATALOG, wire).unwrap()).unwrap();
    assert_eq!(inputs(&document), ["lights: s.lights"]);
}
