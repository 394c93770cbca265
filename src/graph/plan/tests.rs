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
    let source = |job_idx| Source { job_idx, output_idx: 0, share: 1.0 };
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

/// `fade` reads `a` through `sum`, which also reads `still`; `paint` reads both.
fn fading() -> Document {
    let text = r#"{"tyndall": 1, "nodes": {
        "a": {"type": "number", "x": {"keys": [[0, 0], [8, 8]]}}, "still": {"type": "number"},
        "sum": {"type": "sum"}, "fade": {"type": "fade"}, "pair": {"type": "pair"}},
      "wires": ["a.light -> sum.lights", "still.light -> sum.lights", "sum.light -> fade.light",
        "fade.light -> pair.a", "a.light -> pair.b"]}"#;
    Document::parse(text, Path::new("")).unwrap()
}

#[test]
fn what_fades_is_read_around_the_frame() {
    let at = |frame| Plan::new(&Document { frame, ..fading() }, CATALOG, Target::Sinks);
    let plan = at(Some(5));
    // The sum is not needed at frame 5; what no frame changes is needed once.
    assert_eq!(names(&plan), ["a", "a@4", "a@8", "still", "sum@4", "sum@8", "fade", "pair"]);
    let sources = |name: &str| plan.job(name).unwrap().work.as_ref().unwrap().sources.clone();
    let source = |job_idx, share| Source { job_idx, output_idx: 0, share };
    assert_eq!(sources("fade"), [[source(4, 0.75), source(5, 0.25)]]);
    assert_eq!(sources("sum@8"), [[source(2, 1.0), source(3, 1.0)]]);
    assert_eq!(sources("pair"), [[source(6, 1.0)], [source(0, 1.0)]]);
    let x = |name: &str| plan.job(name).unwrap().work.as_ref().unwrap().params.f64("x");
    assert_eq!([x("a"), x("a@4"), x("a@8")], [5.0, 4.0, 8.0]);
    // At a frame of the fade itself, without a frame, and where each has its own.
    let plain = ["a", "still", "sum", "fade", "pair"];
    assert_eq!(names(&at(Some(8))), plain);
    assert_eq!(names(&at(None)), plain);
    assert_eq!(names(&at(Some(-3)))[1..3], ["a@-4", "a@0"]);
    for apart in ["0", "1"] {
        let mut each = Document { frame: Some(5), ..fading() };
        each.set(CATALOG, "fade.apart", apart).unwrap();
        assert_eq!(names(&Plan::new(&each, CATALOG, Target::Sinks)), plain);
    }
    let mut still = Document { frame: Some(5), ..fading() };
    still.set(CATALOG, "a.x", "2").unwrap();
    assert_eq!(names(&Plan::new(&still, CATALOG, Target::Sinks)), plain);
}

#[test]
fn a_problem_of_another_frame_is_named_by_it() {
    let mut document = Document { frame: Some(5), ..fading() };
    document.set(CATALOG, "fade.apart", "300").unwrap_err();
    let up = r#"{"type": "shape", "up": {"keys": [[0, [1, 0, 0]], [8, [-1, 0, 0]]]}}"#;
    let text = format!(r#"{{"tyndall": 1, "nodes": {{"shape": {up}}}}}"#);
    document = Document { frame: Some(4), ..Document::parse(&text, Path::new("")).unwrap() };
    let plan = Plan::new(&document, CATALOG, Target::Sinks);
    let why = "up has no length at frame 4; add a key, so that it turns around";
    assert_eq!(plan.job("shape").unwrap().work.as_ref().unwrap_err(), why);
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
