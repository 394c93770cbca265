use std::path::Path;

use super::*;
use crate::graph::toy::CATALOG;

/// a, b -> sum -> pair.a -> paint -> save, and a shape.
fn document() -> Document {
    let text = r#"{"tyndall": 1, "nodes": {"a": {"type": "number", "x": 2}, "b": {"type": "number"},
        "sum": {"type": "sum"}, "pair": {"type": "pair"}, "paint": {"type": "paint"}, "save": {"type": "save"},
        "shape": {"type": "shape"}},
        "wires": ["a.light -> sum.lights", "b.light -> sum.lights", "sum.light -> pair.a",
        "pair.total -> paint.light", "paint.image -> save.image"],
        "layout": {"a": [0, 10], "sum": [100, 0]}}"#;
    Document::parse(text, Path::new("")).unwrap()
}

fn wire(text: &str) -> Wire {
    text.parse().unwrap()
}

fn wires(document: &Document) -> Vec<String> {
    document.wires.iter().map(Wire::to_string).collect()
}

#[test]
fn one_wire_is_replaced_and_many_are_appended() {
    let mut document = document();
    document.connect(CATALOG, wire("a.light -> pair.a")).unwrap();
    assert!(!wires(&document).contains(&"sum.light -> pair.a".to_owned()));
    assert_eq!(wires(&document).last().unwrap(), "a.light -> pair.a");
    document.wires.retain(|other| other.from.node != "a");
    document.connect(CATALOG, wire("a.light -> sum.lights")).unwrap();
    let into: Vec<String> =
        wires(&document).into_iter().filter(|wire| wire.ends_with("sum.lights")).collect();
    assert_eq!(into, ["b.light -> sum.lights", "a.light -> sum.lights"]);
    let before = document.clone();
    document.connect(CATALOG, wire("a.light -> sum.lights")).unwrap();
    assert_eq!(document, before);
}

#[test]
fn what_does_not_fit_says_why() {
    let before = document();
    let refused = |text: &str| {
        let mut document = before.clone();
        let message = document.connect(CATALOG, wire(text)).unwrap_err();
        assert_eq!(document, before);
        message
    };
    assert_eq!(refused("shape.volume -> pair.a"), "pair.a takes light, not volume");
    assert_eq!(refused("a.heat -> pair.a"), "a gives no output 'heat'");
    assert_eq!(refused("a.light -> pair.c"), "pair takes no input 'c'");
    assert_eq!(refused("x.light -> pair.a"), "there is no node x");
    assert_eq!(
        refused("pair.total -> sum.lights"),
        "sum.lights cannot read pair.total: the wire would close the cycle sum -> pair -> sum"
    );
    assert_eq!(
        refused("sum.light -> sum.lights"),
        "sum.lights cannot read sum.light: the wire would close the cycle sum -> sum"
    );
}

#[test]
fn a_node_is_inserted_in_its_wire() {
    let mut document = document();
    let sum = document.nodes["sum"].clone();
    document.nodes.insert("more".into(), sum);
    document.insert_on(CATALOG, &wire("a.light -> sum.lights"), "more").unwrap();
    assert_eq!(
        wires(&document)[..3],
        ["a.light -> more.lights", "more.light -> sum.lights", "b.light -> sum.lights"]
    );
    let before = document.clone();
    let refused = |document: &mut Document, name| {
        document.insert_on(CATALOG, &wire("b.light -> sum.lights"), name).unwrap_err()
    };
    assert_eq!(refused(&mut document, "shape"), "shape has no empty input for light");
    let message = "sum.lights cannot read pair.difference: the wire would close the cycle sum -> pair -> sum";
    assert_eq!(refused(&mut document, "pair"), message);
    assert_eq!(document, before);
}

#[test]
fn a_part_is_pasted_with_its_wires_under_free_names() {
    let mut document = document();
    let part = document.part(&["a".into(), "sum".into()]);
    assert_eq!(wires(&part), ["a.light -> sum.lights"]);
    assert_eq!(part.layout.len(), 2);
    assert_eq!(document.paste(&part, [5.0, 7.0]), ["a_2", "sum_2"]);
    assert_eq!(wires(&document).last().unwrap(), "a_2.light -> sum_2.lights");
    assert_eq!((document.layout["a_2"], document.layout["sum_2"]), ([5.0, 17.0], [105.0, 7.0]));
    assert_eq!(document.nodes["a_2"], document.nodes["a"]);
    document.remove(&["a_2".into(), "sum_2".into()]);
    assert_eq!(document, super::tests::document());
}

#[test]
fn the_two_directions_of_wires() {
    let document = document();
    let sorted = |set: HashSet<String>| {
        let mut names: Vec<String> = set.into_iter().collect();
        names.sort();
        names
    };
    assert_eq!(sorted(document.downstream("pair")), ["paint", "pair", "save"]);
    assert_eq!(sorted(document.upstream("pair")), ["a", "b", "pair", "sum"]);
}
