use std::path::Path;

use super::*;
use crate::graph::document::Document;
use crate::graph::plan::Target;
use crate::graph::toy::{CATALOG, ToyHost};

const TEXT: &str = r#"{"tyndall": 1, "nodes": {
    "a": {"type": "number", "x": 2},
    "b": {"type": "number", "x": 3},
    "sum": {"type": "sum"},
    "pair": {"type": "pair"},
    "paint": {"type": "paint"},
    "save": {"type": "save"},
    "alone": {"type": "number"}},
  "wires": ["b.light -> sum.lights", "a.light -> sum.lights", "sum.light -> paint.light",
    "a.light -> pair.a", "paint.image -> save.image"]}"#;

struct Bench {
    document: Document,
    host: ToyHost,
    cache: Cache,
    events: Vec<Event>,
}

impl Bench {
    fn new() -> Self {
        Self {
            document: Document::parse(TEXT, Path::new("")).unwrap(),
            host: ToyHost::default(),
            cache: Cache::new(1_000),
            events: Vec::new(),
        }
    }

    fn set(&mut self, name: &str, text: &str) {
        self.document.set(CATALOG, name, text).unwrap();
    }

    fn run(&mut self, target: Target) -> Evaluation {
        self.run_with(target, &CancelToken::new())
    }

    fn run_with(&mut self, target: Target, cancel: &CancelToken) -> Evaluation {
        let plan = Plan::new(&self.document, CATALOG, target);
        self.events.clear();
        let events = &mut self.events;
        let on_event = &mut |event| events.push(event);
        evaluate(&plan, &self.host, &mut self.cache, cancel, on_event)
    }
}

fn number(evaluation: &Evaluation, node: &str, port: &str) -> f64 {
    *evaluation.value(node, port).unwrap().get()
}

#[test]
fn values_follow_the_wires() {
    let mut bench = Bench::new();
    let evaluation = bench.run(Target::Sinks);
    assert_eq!(bench.host.take(), ["a", "b", "sum", "pair", "paint", "save"]);
    // b is wired first, so it counts double: 3 + 3 + 2.
    assert_eq!(number(&evaluation, "sum", "light"), 8.0);
    assert_eq!(number(&evaluation, "paint", "image"), 8.0);
    assert_eq!(number(&evaluation, "pair", "difference"), -2.0);
    assert_eq!(number(&evaluation, "pair", "total"), 2.0);
    assert!(evaluation.value("pair", "c").is_none());
    assert!(evaluation.value("alone", "light").is_none());
    assert!(!evaluation.cancelled);
    assert_eq!(evaluation.failures().count(), 0);
}

#[test]
fn only_what_changed_runs_again() {
    let mut bench = Bench::new();
    bench.run(Target::Sinks);
    bench.host.take();
    bench.run(Target::Sinks);
    // A node without outputs always runs.
    assert_eq!(bench.host.take(), ["save"]);
    bench.set("b.x", "4");
    let evaluation = bench.run(Target::Sinks);
    assert_eq!(bench.host.take(), ["b", "sum", "paint", "save"]);
    assert_eq!(number(&evaluation, "paint", "image"), 10.0);
    bench.set("b.x", "3");
    bench.run(Target::Sinks);
    assert_eq!(bench.host.take(), ["save"]);
    // The key knows the order of the wires, but not the name of a node or its place.
    bench.document.wires.swap(0, 1);
    bench.run(Target::Sinks);
    assert_eq!(bench.host.take(), ["sum", "paint", "save"]);
    bench.document.layout.insert("a".to_owned(), [1.0, 2.0]);
    bench.run(Target::Nodes(&["alone"]));
    assert_eq!(bench.host.take(), ["alone"]);
    bench.set("alone.x", "2");
    bench.run(Target::Nodes(&["alone"]));
    assert!(bench.host.take().is_empty(), "found under the key of a");
}

#[test]
fn what_fades_runs_once_for_all_frames() {
    let mut bench = Bench::new();
    bench.set("b.x", r#"{"keys": [[0, 0], [4, 4], [8, 1]]}"#);
    let fade = r#"{"type": "fade"}"#;
    let node =
        Document::parse(&format!(r#"{{"tyndall": 1, "nodes": {{"fade": {fade}}}}}"#), Path::new("")).unwrap();
    bench.document.nodes.extend(node.nodes);
    bench.document.wires.push("b.light -> fade.light".parse().unwrap());
    let mut at = |frame| {
        bench.document.frame = Some(frame);
        let evaluation = bench.run(Target::Nodes(&["fade"]));
        (number(&evaluation, "fade", "light"), bench.host.take())
    };
    let ran = |names: &[&str]| names.iter().map(|name| (*name).to_owned()).collect::<Vec<_>>();
    assert_eq!(at(6), (2.5, ran(&["b@4", "b@8", "fade"])));
    assert_eq!(at(7), (1.75, ran(&["fade"])));
    // Of its own frame it is the same number that others fade from.
    assert_eq!(at(8), (1.0, ran(&["fade"])));
    assert_eq!(at(3), (3.0, ran(&["b@0", "fade"])));
    // From 1 to 1: what comes of it is found again.
    assert_eq!(at(10), (1.0, ran(&[])));
    assert_eq!(at(11), (1.0, ran(&[])));
}

#[test]
fn the_other_output_of_a_node_is_another_input() {
    let mut bench = Bench::new();
    bench.document.wires[2] = "pair.difference -> paint.light".parse().unwrap();
    assert_eq!(number(&bench.run(Target::Nodes(&["paint"])), "paint", "image"), -2.0);
    bench.document.wires[2] = "pair.total -> paint.light".parse().unwrap();
    assert_eq!(number(&bench.run(Target::Nodes(&["paint"])), "paint", "image"), 2.0);
}

#[test]
fn identity_of_the_host_is_in_the_key() {
    let mut bench = Bench::new();
    bench.run(Target::Nodes(&["paint"]));
    bench.host.take();
    *bench.host.identity.borrow_mut() = vec![1];
    bench.run(Target::Nodes(&["paint"]));
    assert_eq!(bench.host.take(), ["a", "b", "sum", "paint"]);
}

#[test]
fn events_tell_it_as_it_happens() {
    let mut bench = Bench::new();
    bench.run(Target::Nodes(&["a"]));
    let [Event::Started { name }, Event::Finished { cached, bytes, cpu_ms, report, .. }] = &bench.events[..]
    else {
        panic!("{:?}", bench.events);
    };
    assert_eq!((name.as_str(), *cached, *bytes), ("a", false, 8));
    assert!(*cpu_ms >= 0.0);
    assert_eq!(report.decisions[0].data, "x = 2");
    // A node that did not run again still tells it.
    let report = Arc::clone(report);
    bench.run(Target::Nodes(&["a"]));
    let cached = Event::Finished { name: "a".to_owned(), cached: true, cpu_ms: 0.0, bytes: 8, report };
    assert_eq!(bench.events, [cached]);
}

#[test]
fn an_error_stays_with_its_node() {
    let mut bench = Bench::new();
    bench.set("b.x", "7");
    let evaluation = bench.run(Target::Sinks);
    assert_eq!(bench.host.take(), ["a", "b", "pair"]);
    assert_eq!(evaluation.failures().collect::<Vec<_>>(), [("b", "7 is unlucky; write another number")]);
    let skipped = |name: &str| Event::Skipped { name: name.to_owned(), because: "b".to_owned() };
    assert!(bench.events.contains(&Event::Failed {
        name: "b".to_owned(),
        message: "7 is unlucky; write another number".to_owned()
    }));
    for name in ["sum", "paint", "save"] {
        assert!(bench.events.contains(&skipped(name)), "{name}");
    }
    assert_eq!(number(&evaluation, "pair", "total"), 2.0);
    assert!(evaluation.value("sum", "light").is_none());
    bench.run(Target::Sinks);
    assert_eq!(bench.host.take(), ["b"], "an error is not cached");
}

#[test]
fn a_problem_of_the_document_is_a_failure_of_its_node() {
    let mut bench = Bench::new();
    bench.document.nodes["a"].params.insert("x".to_owned(), 11.into());
    let evaluation = bench.run(Target::Sinks);
    assert_eq!(bench.host.take(), ["b"]);
    assert_eq!(
        evaluation.failures().collect::<Vec<_>>(),
        [("a", "x = 11 is outside 0..=10; the default is 1")]
    );
}

/// Its reader is skipped, not run with an empty input.
#[test]
fn an_unknown_kind_is_a_failure_of_its_node() {
    let mut bench = Bench::new();
    bench.document.nodes["b"].type_id = "numbr".to_owned();
    let evaluation = bench.run(Target::Nodes(&["paint"]));
    assert_eq!(bench.host.take(), ["a"]);
    assert_eq!(evaluation.failures().next().unwrap().0, "b");
    assert!(matches!(&evaluation.nodes["sum"], Outcome::Skipped(because) if because == "b"));
}

#[test]
fn an_identity_may_fail() {
    let mut bench = Bench::new();
    let file = r#"{"tyndall": 1, "nodes": {"file": {"type": "file", "path": "x"}}}"#;
    bench.document = Document::parse(file, Path::new("")).unwrap();
    let evaluation = bench.run(Target::Sinks);
    assert_eq!(evaluation.failures().collect::<Vec<_>>(), [("file", "no file here; write another path")]);
}

#[test]
fn cancelled_before_it_began() {
    let mut bench = Bench::new();
    let cancel = CancelToken::new();
    cancel.cancel();
    let evaluation = bench.run_with(Target::Sinks, &cancel);
    assert!(evaluation.cancelled && evaluation.nodes.is_empty());
    assert_eq!(bench.events, [Event::Cancelled]);
    assert!(bench.host.take().is_empty());
}

#[test]
fn cancelled_within_a_node() {
    let mut bench = Bench::new();
    bench.host.stop_in = "sum";
    let evaluation = bench.run(Target::Sinks);
    assert!(evaluation.cancelled);
    assert_eq!(bench.host.take(), ["a", "b", "sum"]);
    assert_eq!(bench.events.last(), Some(&Event::Cancelled));
    assert_eq!(number(&evaluation, "a", "light"), 2.0);
    assert!(evaluation.value("sum", "light").is_none());
    bench.host.stop_in = "";
    bench.run(Target::Sinks);
    assert_eq!(bench.host.take(), ["sum", "pair", "paint", "save"]);
}

#[test]
fn a_small_cache_only_costs_time() {
    let mut bench = Bench::new();
    bench.cache = Cache::new(16);
    let first = bench.run(Target::Nodes(&["paint"]));
    assert_eq!(number(&first, "paint", "image"), 8.0);
    assert!(bench.cache.used_bytes() <= 16);
    bench.host.take();
    let again = bench.run(Target::Nodes(&["paint"]));
    assert_eq!(number(&again, "paint", "image"), 8.0);
    assert_eq!(number(&first, "a", "light"), 2.0, "held by the evaluation");
}
