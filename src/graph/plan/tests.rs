use std::path::Path;

use super::*;
use crate::graph::toy::CATALOG;

fn document(nodes: &[(&str, &str)], wires: &[&str]) -> Document {
    let nodes = nodes.iter().map(|(name, kind)| format!(r#""{name}": {{"type": "{kind}"}}"#));
    let wires = wires.iter().map(|wire| format!("\"{wire}\""));
    let text = format!(
        r#"{{"tyndall": 1, "nodes": {{{}}}, "wires": [{}]}}"#,
        nodes.collect::<Vec<_>>().join(", "),
        wires.collect::<Vec<_>>().join(", ")
    );
    Document::parse(&text, Path::new("")).unwrap()
}

fn names(plan: &Plan) -> Vec<&str> {
    plan.jobs.iter().map(|job| job.name.as_str()).collect()
}

fn chain() -> Document {
    document(
        &[
            ("save", "save"),
            ("paint", "paint"),
            ("sum", "sum"),
            ("z", "number"),
            ("a", "number"),
            ("alone", "number"),
            ("other", "paint"),
        ],
        &[
            "a.light -> sum.lights",
            "z.light -> sum.lights",
            "sum.light -> paint.light",
            "paint.image -> save.image",
            "z.light -> other.light",
        ],
    )
}

#[test]
fn order_of_the_document_breaks_ties() {
    let plan = Plan::new(&chain(), CATALOG, Target::Sinks);
    assert_eq!(names(&plan), ["z", "a", "sum", "paint", "save", "other"]);
    assert_eq!(plan.left_out, ["alone"]);
}

#[test]
fn a_named_node_needs_only_what_it_reads() {
    let plan = Plan::new(&chain(), CATALOG, Target::Nodes(&["other"]));
    assert_eq!(names(&plan), ["z", "other"]);
    assert_eq!(plan.left_out, ["save", "paint", "sum", "a", "alone"]);
    let plan = Plan::new(&chain(), CATALOG, Target::Nodes(&["alone", "a"]));
    assert_eq!(names(&plan), ["a", "alone"]);
}

#[test]
fn sources_keep_the_order_of_the_wires() {
    let plan = Plan::new(&chain(), CATALOG, Target::Sinks);
    let work = plan.job("sum").unwrap().work.as_ref().unwrap();
    let source = |job_idx| Source { job_idx, output_idx: 0 };
    assert_eq!(work.sources, [[source(1), source(0)]]);
}

#[test]
fn without_wires_all_nodes_run() {
    let plan = Plan::new(&document(&[("b", "number"), ("a", "number")], &[]), CATALOG, Target::Sinks);
    assert_eq!(names(&plan), ["b", "a"]);
}

#[test]
fn a_problem_stays_with_its_node() {
    let plan = Plan::new(
        &document(&[("a", "numbr"), ("s", "sum")], &["a.light -> s.lights"]),
        CATALOG,
        Target::Nodes(&["s", "nobody"]),
    );
    assert_eq!(names(&plan), ["a", "s", "nobody"]);
    let failure = |name: &str| plan.job(name).unwrap().work.as_ref().err().cloned();
    assert!(failure("a").unwrap().starts_with("unknown type 'numbr'"));
    assert_eq!(failure("s"), None);
    assert_eq!(failure("nobody").unwrap(), "there is no such node; nodes are a, s");
}

#[test]
fn what_stands_after_a_cycle_is_ordered_after_it() {
    let plan = Plan::new(
        &document(
            &[("paint", "paint"), ("b", "sum"), ("a", "sum"), ("first", "number")],
            &[
                "first.light -> a.lights",
                "a.light -> b.lights",
                "b.light -> a.lights",
                "b.light -> paint.light",
            ],
        ),
        CATALOG,
        Target::Sinks,
    );
    assert_eq!(names(&plan), ["first", "b", "a", "paint"]);
    let failed = |name: &str| plan.job(name).unwrap().work.as_ref().err().cloned();
    assert_eq!(failed("b").unwrap(), "is in the cycle b -> a -> b; remove a wire of it");
    assert_eq!(failed("a").unwrap(), "is in a cycle; remove a wire of it");
    assert!(failed("paint").is_none());
}

/// A chain longer than any stack of calls would bear.
#[test]
fn a_long_chain_is_no_recursion() {
    let n_nodes = 2_000;
    let names: Vec<String> = (0..n_nodes).map(|idx| format!("n{idx}")).collect();
    let nodes: Vec<(&str, &str)> = names.iter().map(|name| (name.as_str(), "sum")).collect();
    let wires: Vec<String> =
        (1..n_nodes).map(|idx| format!("n{}.light -> n{}.lights", idx, idx - 1)).collect();
    let wires: Vec<&str> = wires.iter().map(String::as_str).collect();
    let order = order(&document(&nodes, &wires));
    assert!(order.nodes.iter().rev().copied().eq(0..n_nodes));
    assert!(order.cycles.is_empty());
}
