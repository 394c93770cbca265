use std::path::Path;

use super::*;
use crate::graph::toy::CATALOG;

fn document(nodes: &str, wires: &str) -> Document {
    let text = format!(r#"{{"tyndall": 1, "nodes": {{{nodes}}}, "wires": [{wires}]}}"#);
    Document::parse(&text, Path::new("")).unwrap()
}

fn lines(nodes: &str, wires: &str) -> Vec<String> {
    let problems = check(&document(nodes, wires), CATALOG, Target::Sinks);
    problems.iter().map(Problem::to_string).collect()
}

const SOUND: &str = r#""shape": {"type": "shape"}, "medium": {"type": "medium"}, "one": {"type": "number"},
    "paint": {"type": "paint"}, "save": {"type": "save"}"#;
const SOUND_WIRES: &str =
    r#""shape.volume -> medium.volume", "one.light -> paint.light", "paint.image -> save.image""#;

/// The only problem of the sound graph with one wire more.
fn with_wire(wire: &str) -> String {
    let found = lines(SOUND, &format!(r#"{SOUND_WIRES}, "{wire}""#));
    assert_eq!(found.len(), 1, "{found:?}");
    found[0].clone()
}

#[test]
fn a_sound_graph_has_no_problem() {
    assert!(lines(SOUND, SOUND_WIRES).is_empty());
    assert!(lines("", "").is_empty());
}

#[test]
fn types_and_parameters_of_all_nodes() {
    let found = lines(
        r#""a": {"type": "shap"}, "medium": {"type": "medium", "albedo": [1, 1.2, 1], "g": 1},
           "file": {"type": "file"}, "shape": {"type": "shape"}"#,
        r#""shape.volume -> medium.volume""#,
    );
    assert_eq!(
        found,
        [
            "node 'a': unknown type 'shap'; did you mean 'shape'? allowed are number, sum, pair, \
             paint, save, file, shape, medium, fade",
            "node 'medium': albedo[1] = 1.2 is outside 0..=1; the default is [1,1,1]",
            "node 'medium': g = 1 is outside -1 < value < 1; the default is 0",
            "node 'file': path is missing; write a path as a string",
        ]
    );
}

#[test]
fn problems_name_their_field() {
    let document = document(r#""m": {"type": "medium", "emission": {"flame": 1}}"#, "");
    let problems = check(&document, CATALOG, Target::Sinks);
    let fields: Vec<&str> = problems.iter().map(|problem| problem.field.as_str()).collect();
    assert_eq!(fields, ["emission.flame", "volume"]);
}

#[test]
fn wires_that_fit_nowhere() {
    assert_eq!(
        lines(SOUND, r#""shap.volume -> medium.volume""#)[0],
        "node 'medium': the wire 'shap.volume -> medium.volume' starts at no node; did you mean \
         'shape'? nodes are shape, medium, one, paint, save"
    );
    assert_eq!(
        with_wire("shape.volume -> x.volume"),
        "node 'x': the wire 'shape.volume -> x.volume' ends at no node; nodes are shape, medium, \
         one, paint, save"
    );
    assert_eq!(
        with_wire("shape.volume -> medium.volum"),
        "node 'medium': medium takes no input 'volum'; did you mean 'volume'? allowed are volume"
    );
    assert_eq!(
        with_wire("one.light -> shape.light"),
        "node 'shape': shape takes no input 'light'; it has none, remove the wire"
    );
    assert_eq!(
        lines(SOUND, r#""shape.grid -> medium.volume""#)[0],
        "node 'medium': 'shape' (shape) gives no output 'grid'; allowed are volume"
    );
    assert_eq!(
        lines(SOUND, r#""save.x -> medium.volume""#)[0],
        "node 'medium': 'save' (save) gives no output 'x'; it has none, remove the wire"
    );
}

#[test]
fn kinds_that_do_not_fit() {
    assert_eq!(
        lines(SOUND, r#""one.light -> paint.light", "paint.image -> medium.volume""#),
        ["node 'medium': cannot wire image into volume; 'medium.volume' takes volume, which \
          file.volume or shape.volume give"]
    );
    assert_eq!(
        lines(SOUND, r#""one.light -> save.image""#),
        ["node 'save': cannot wire light into image; 'save.image' takes image, which paint.image \
          gives"]
    );
}

#[test]
fn counts_of_wires() {
    assert_eq!(
        with_wire("shape.volume -> medium.volume"),
        "node 'medium': the wire 'shape.volume -> medium.volume' stands twice; keep one"
    );
    assert_eq!(
        lines(
            r#""s": {"type": "shape"}, "t": {"type": "shape"}, "m": {"type": "medium"}"#,
            r#""s.volume -> m.volume", "t.volume -> m.volume""#
        ),
        ["node 'm': input 'volume' takes one wire and has 2, from s.volume, t.volume; keep one"]
    );
    let many = r#""a": {"type": "number"}, "b": {"type": "number"}, "s": {"type": "sum"}"#;
    assert!(lines(many, r#""a.light -> s.lights", "b.light -> s.lights""#).is_empty());
}

#[test]
fn an_input_is_missed_only_where_it_is_needed() {
    let nodes = r#""s": {"type": "sum"}, "pair": {"type": "pair"}, "one": {"type": "number"},
        "p": {"type": "paint"}"#;
    let wires = r#""s.light -> p.light""#;
    assert_eq!(
        lines(nodes, wires),
        ["node 's': input 'lights' is empty; wire light into it, which number.light, sum.light, \
          pair.difference, pair.total or fade.light give"]
    );
    let document = document(nodes, wires);
    let found = check(&document, CATALOG, Target::Nodes(&["pair", "one"]));
    assert_eq!(found.len(), 1);
    assert_eq!((found[0].node.as_str(), found[0].field.as_str()), ("pair", "a"));
    let found = check(&document, CATALOG, Target::Nodes(&["on"]));
    assert_eq!(
        found[0].to_string(),
        "node 'on': there is no such node; did you mean 'one'? nodes are s, pair, one, p"
    );
}

#[test]
fn cycles_are_named_from_their_first_node_on() {
    let nodes = r#""d": {"type": "paint"}, "a": {"type": "sum"}, "b": {"type": "sum"}, "c": {"type": "sum"},
        "me": {"type": "sum"}"#;
    let wires = r#""c.light -> a.lights", "a.light -> b.lights", "b.light -> c.lights", "c.light -> d.light",
        "me.light -> me.lights""#;
    assert_eq!(
        lines(nodes, wires),
        [
            "node 'a': is in the cycle a -> b -> c -> a; remove a wire of it",
            "node 'me': is in the cycle me -> me; remove a wire of it",
        ]
    );
}
