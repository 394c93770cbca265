use std::path::Path;

use super::*;
use crate::graph::cache::Cache;
use crate::graph::eval::{CancelToken, Outcome, evaluate};
use crate::graph::key::Key;
use crate::graph::plan::{Plan, Target};
use crate::graph::toy::{CATALOG, ToyHost};

const TEXT: &str = r#"{"tyndall": 1, "nodes": {"a": {"type": "number", "x": 3}, "b": {"type": "number", "x": 2},
      "s": {"type": "sum"}, "t": {"type": "sum"}, "pair": {"type": "pair"}, "paint": {"type": "paint"}},
    "wires": ["b.light -> s.lights", "a.light -> s.lights", "s.light -> t.lights", "a.light -> t.lights",
      "t.light -> pair.a", "s.light -> pair.b", "pair.total -> paint.light"],
    "layout": {"a": [0, 0], "s": [100, 0], "t": [200, 50], "paint": [400, 0]},
    "bends": {"a.light -> t.lights": [[50, 50]], "s.light -> t.lights": [[150, 50]]}}"#;

fn document() -> Document {
    Document::parse(TEXT, Path::new("")).unwrap()
}

fn strings(names: &[&str]) -> Vec<String> {
    names.iter().map(|name| (*name).to_owned()).collect()
}

/// The keys of all results, sorted: names do not count.
fn keys(document: &Document) -> Vec<String> {
    let plan = Plan::new(document, CATALOG, Target::Sinks);
    let host = ToyHost::default();
    let evaluation = evaluate(&plan, &host, &mut Cache::new(1 << 20), &CancelToken::new(), &mut |_| {});
    let key = |outcome: &Outcome| -> Key {
        match outcome {
            Outcome::Done { key, .. } => *key,
            other => panic!("{other:?}"),
        }
    };
    let mut keys: Vec<String> =
        evaluation.nodes.values().map(|outcome| format!("{:?}", key(outcome))).collect();
    keys.sort();
    keys
}

/// What is written must be read again.
fn assert_sound(document: &Document) {
    let again = Document::parse(&document.to_json(), Path::new("")).unwrap();
    assert_eq!(again.to_json(), document.to_json());
}

#[test]
fn keys_tell_two_graphs_apart() {
    let mut other = document();
    other.wires.swap(0, 1);
    assert_ne!(keys(&other), keys(&document()));
}

#[test]
fn any_selection_becomes_a_group_and_comes_back() {
    let names: Vec<String> = document().nodes.keys().cloned().collect();
    for mask in 1..1_usize << names.len() {
        let chosen: Vec<String> = names
            .iter()
            .enumerate()
            .filter(|(idx, _)| mask >> idx & 1 == 1)
            .map(|(_, name)| name.clone())
            .collect();
        let mut grouped = document();
        let group = grouped.make_group(&chosen, "look").unwrap();
        assert_sound(&grouped);
        assert_eq!(grouped.nodes.len(), names.len() - chosen.len() + 1);
        assert_eq!(keys(&grouped), keys(&document()), "{chosen:?}");
        let back = grouped.ungroup(&group).unwrap();
        assert_sound(&grouped);
        assert_eq!(back, chosen);
        assert_eq!(keys(&grouped), keys(&document()), "{chosen:?} back");
        assert_eq!(grouped.wires.len(), document().wires.len());
    }
}

#[test]
fn ports_places_and_bends_of_a_group() {
    let mut document = document();
    assert_eq!(document.make_group(&strings(&["s", "t"]), "a").unwrap(), "a_2");
    let inside = document.inside("a_2").unwrap();
    let wires = |document: &Document| document.wires.iter().map(Wire::to_string).collect::<Vec<_>>();
    assert_eq!(
        wires(&document),
        [
            "b.light -> a_2.lights",
            "a.light -> a_2.lights",
            // From inside to inside by the outside: the wire of `a` comes after it.
            "a_2.light -> a_2.t_lights",
            "a.light -> a_2.t_lights",
            "a_2.t_light -> pair.a",
            "a_2.light -> pair.b",
            "pair.total -> paint.light",
        ]
    );
    assert!(inside.wires.is_empty() && inside.bends.is_empty());
    assert_eq!(inside.layout["t"], [200.0, 50.0]);
    assert_eq!(document.layout["a_2"], [150.0, 25.0]);
    assert_eq!(document.bends.keys().map(Wire::to_string).collect::<Vec<_>>(), ["a.light -> a_2.t_lights"]);
    assert_eq!(document.nodes.keys().collect::<Vec<_>>(), ["a", "b", "a_2", "pair", "paint"]);
    document.layout.insert("a_2".to_owned(), [250.0, 25.0]);
    document.ungroup("a_2").unwrap();
    assert_eq!(document.nodes.keys().collect::<Vec<_>>(), ["a", "b", "s", "t", "pair", "paint"]);
    assert_eq!((document.layout["s"], document.layout["t"]), ([200.0, 0.0], [300.0, 50.0]));
    assert_eq!(document.bends.keys().map(Wire::to_string).collect::<Vec<_>>(), ["a.light -> t.lights"]);
}

#[test]
fn what_reads_the_same_is_one_port() {
    let text = r#"{"tyndall": 1, "nodes": {"a": {"type": "number", "x": 3}, "b": {"type": "number", "x": 2},
          "s": {"type": "sum"}, "t": {"type": "sum"}, "pair": {"type": "pair"}, "paint": {"type": "paint"}},
        "wires": ["b.light -> s.lights", "a.light -> s.lights", "a.light -> t.lights", "b.light -> t.lights",
          "a.light -> pair.a", "a.light -> pair.b", "pair.total -> paint.light"],
        "bends": {"a.light -> pair.b": [[50, 50]]}}"#;
    let before = Document::parse(text, Path::new("")).unwrap();
    let mut document = before.clone();
    document.make_group(&strings(&["s", "t", "pair"]), "g").unwrap();
    let inside = document.inside("g").unwrap();
    let ports: Vec<_> = inside.inputs.iter().map(|(name, ends)| (name.as_str(), ends.len())).collect();
    // The order of what a port reads counts.
    assert_eq!(ports, [("lights", 1), ("t_lights", 1), ("a", 2)]);
    assert_eq!(document.wires.iter().filter(|wire| wire.to.port == "a").count(), 1);
    assert!(document.bends.is_empty());
    assert_sound(&document);
    assert_eq!(keys(&document), keys(&before));
    // Of a group in a group the same inputs of the outer one are one, too.
    document.inside_mut("g").unwrap().make_group(&strings(&["pair"]), "inner").unwrap();
    let outer = document.inside("g").unwrap();
    assert_eq!(outer.inside("inner").unwrap().inputs["a"].len(), 2);
    assert_eq!(outer.inputs["a"], [End::new("inner", "a")]);
    assert_eq!(keys(&document), keys(&before));
    document.inside_mut("g").unwrap().ungroup("inner").unwrap();
    document.ungroup("g").unwrap();
    assert_eq!((keys(&document), document.wires.len()), (keys(&before), before.wires.len()));
}

#[test]
fn groups_of_groups() {
    let mut document = document();
    document.make_group(&strings(&["s", "t"]), "inner").unwrap();
    document.make_group(&strings(&["inner", "pair"]), "outer").unwrap();
    assert_eq!(
        document.paths(),
        ["a", "b", "outer", "outer/inner", "outer/inner/s", "outer/inner/t", "outer/pair", "paint"]
    );
    assert_eq!(keys(&document), keys(&self::document()));
    // Inside of a group the ports of the group follow.
    let outer = document.inside_mut("outer").unwrap();
    outer.make_group(&strings(&["pair"]), "p").unwrap();
    outer.rename("inner", "sums").unwrap();
    assert_sound(&document);
    assert_eq!(keys(&document), keys(&self::document()));
    document.inside_mut("outer").unwrap().ungroup("sums").unwrap();
    assert_eq!(keys(&document), keys(&self::document()));
}

#[test]
fn a_muted_group_comes_back_muted() {
    let mut document = document();
    document.make_group(&strings(&["s", "t"]), "g").unwrap();
    document.nodes["g"].bypass = true;
    let error = document.ungroup("g").unwrap_err();
    assert_eq!(error, "the group 'g' is bypassed; take that back first");
    document.nodes["g"].mute = true;
    document.ungroup("g").unwrap();
    assert!(document.nodes["s"].mute && document.nodes["t"].mute && !document.nodes["a"].mute);
}

#[test]
fn a_group_as_a_preset_and_a_preset_as_a_group() {
    let mut document = document();
    document.make_group(&strings(&["s", "t"]), "g").unwrap();
    let preset = document.preset_of("g").unwrap();
    let preset = Document::parse(&preset.to_json(), Path::new("")).unwrap();
    document.remove(&strings(&["g"]));
    let wires = Document { wires: document.wires, ..self::document() }.wires;
    assert_eq!(wires.len(), 1);
    let mut document = self::document();
    document.make_group(&strings(&["s", "t"]), "g").unwrap();
    let name = document.insert_preset(CATALOG, &preset, "g", [1.0, 2.0]);
    assert_eq!((name.as_str(), document.layout["g_2"]), ("g_2", [1.0, 2.0]));
    assert_eq!(document.nodes["g"].inside, document.nodes["g_2"].inside);
    assert_eq!(document.preset_of("a").unwrap_err(), "'a' is no group; group it first");
}

#[test]
fn what_cannot_be_grouped_changes_nothing() {
    let mut document = document();
    let mut refused = |names: &[&str], like: &str| document.make_group(&strings(names), like).unwrap_err();
    assert_eq!(refused(&[], "g"), "nothing is selected; select the nodes of the group");
    assert_eq!(refused(&["a"], "g h"), "'g h' is no name of a node; write letters, digits, '_' and '-'");
    assert_eq!(refused(&["x"], "g"), "'x': there is no such node; nodes are a, b, s, t, pair, paint");
    assert_eq!(document.ungroup("a").unwrap_err(), "'a' is no group; it is a number");
    assert_eq!(document, self::document());
}
