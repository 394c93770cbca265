use std::path::Path;

use super::*;
use crate::graph::toy::CATALOG;

const TEXT: &str = r#"{"tyndall": 1, "nodes": {"a": {"type": "number"}, "b": {"type": "number"}, "s": {"type": "sum"},
      "t": {"type": "sum"}, "pair": {"type": "pair"}, "paint": {"type": "paint"}, "odd": {"type": "what"}},
    "wires": ["a.light -> s.lights", "s.light -> t.lights", "t.light -> paint.light"],
    "bends": {"t.light -> paint.light": [[1, 2]]}}"#;

fn document() -> Document {
    Document::parse(TEXT, Path::new("")).unwrap()
}

fn wire(text: &str) -> Wire {
    text.parse().unwrap()
}

fn wires(document: &Document) -> Vec<String> {
    document.wires.iter().map(Wire::to_string).collect()
}

#[test]
fn an_input_that_takes_one_loses_the_one_that_it_had() {
    let mut document = document();
    let mut without = document.clone();
    without.disconnect(&wire("t.light -> paint.light"));
    assert!(without.bends.is_empty());
    document.connect(CATALOG, wire("b.light -> paint.light")).unwrap();
    assert_eq!(wires(&document), ["a.light -> s.lights", "s.light -> t.lights", "b.light -> paint.light"]);
    assert!(document.bends.is_empty());
    document.connect(CATALOG, wire("b.light -> s.lights")).unwrap();
    document.connect(CATALOG, wire("b.light -> s.lights")).unwrap();
    assert_eq!(wires(&document)[3..], ["b.light -> s.lights"]);
    assert!(document.disconnect(&wire("s.light -> t.lights")));
    assert!(!document.disconnect(&wire("s.light -> t.lights")));
    assert_eq!(document.wires.len(), 3);
    // Of a kind that is not known nothing is forbidden.
    document.connect(CATALOG, wire("odd.x -> paint.light")).unwrap();
}

#[test]
fn what_does_not_fit_says_why() {
    let mut document = document();
    let mut refused = |text: &str| {
        let error = document.connect(CATALOG, wire(text)).unwrap_err();
        assert_eq!(document, self::document());
        error
    };
    assert_eq!(
        refused("paint.image -> s.lights"),
        "cannot wire image into light; 's.lights' takes light, which number.light, sum.light, pair.difference, \
         pair.total or fade.light give"
    );
    assert_eq!(
        refused("a.light -> s.light"),
        "sum takes no input 'light'; did you mean 'lights'? allowed are lights"
    );
    assert_eq!(
        refused("c.light -> s.lights"),
        "'c': there is no such node; nodes are a, b, s, t, pair, paint, odd"
    );
    assert_eq!(
        refused("t.light -> s.lights"),
        "'t.light -> s.lights' would close the cycle s -> t -> s; wire it from a node that does not read 's'"
    );
    assert_eq!(
        refused("s.light -> s.lights"),
        "'s.light -> s.lights' would close the cycle s -> s; wire it from a node that does not read 's'"
    );
}

#[test]
fn cycles_go_through_groups() {
    let mut document = document();
    document.make_group(&["s".to_owned(), "pair".to_owned()], "g").unwrap();
    let inside = document.inside_mut("g").unwrap();
    inside.inputs.insert("a".to_owned(), vec!["pair.a".parse().unwrap()]);
    inside.outputs.insert("total".to_owned(), "pair.total".parse().unwrap());
    // The pair in the group does not read the sum in it.
    document.connect(CATALOG, wire("g.light -> g.a")).unwrap();
    document.connect(CATALOG, wire("g.total -> t.lights")).unwrap();
    let error = document.connect(CATALOG, wire("t.light -> g.lights")).unwrap_err();
    let cycle = "would close the cycle g/s -> g/pair -> t -> g/s";
    let direct = "would close the cycle g/s -> t -> g/s";
    assert!(error.contains(cycle) || error.contains(direct), "{error}");
}

#[test]
fn a_node_takes_the_place_of_a_wire() {
    let mut document = document();
    document.connect(CATALOG, wire("b.light -> t.lights")).unwrap();
    document.insert_on(CATALOG, &wire("s.light -> t.lights"), "pair").unwrap();
    assert_eq!(
        wires(&document),
        [
            "a.light -> s.lights",
            "s.light -> pair.a",
            "pair.difference -> t.lights",
            "t.light -> paint.light",
            "b.light -> t.lights",
        ]
    );
    let before = document.clone();
    let mut refused = |on: &str, name: &str| document.insert_on(CATALOG, &wire(on), name).unwrap_err();
    assert_eq!(
        refused("t.light -> paint.light", "a"),
        "'a' does not fit on 't.light -> paint.light'; it takes a node with an empty input and an output for light"
    );
    assert_eq!(refused("a.light -> b.light", "s"), "there is no wire 'a.light -> b.light'");
    let error = refused("t.light -> paint.light", "s");
    assert!(error.starts_with("'t.light -> s.lights' would close the cycle s -> pair -> t -> s;"), "{error}");
    assert_eq!(document, before);
}

#[test]
fn who_reads_whom() {
    let document = document();
    let sorted = |names: HashSet<String>| {
        let mut names: Vec<String> = names.into_iter().collect();
        names.sort();
        names.join(" ")
    };
    assert_eq!(sorted(document.downstream("s")), "paint s t");
    assert_eq!(sorted(document.upstream("t")), "a s t");
}
