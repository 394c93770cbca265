//! `tyndall explain`: what a graph would do and why, before it does it.
//!
//! All of it comes from the session, which asks the nodes themselves; here it is only laid out.

use std::fmt::Write;
use std::path::PathBuf;
use std::process::ExitCode;
use std::str::FromStr;

use serde::Serialize;
use tyndall::gpu::AdapterChoice;
use tyndall::graph::{Decision, Target};
use tyndall::planner::cost;
use tyndall::session::{Explained, Explanation, Session};

use super::output::{Lines, NAME, TITLE, columns, print, print_json, size};
use super::render::parse_size;
use super::scene::{read, refuse_problems};

/// Show what a graph would do: what the scene requires, what is left out and why, sizes and times.
///
/// Volumes, media and lights are read, which decides the rest; propagations, residual and march only say what
/// they would do. Times of what was read are measured, others predicted, without the compiling of shaders; on a GPU
/// they are its own, without what the CPU does meanwhile.
#[derive(clap::Args)]
pub struct Args {
    /// The graph, a JSON file.
    graph: PathBuf,
    /// Set a parameter to a JSON value, such as medium.g=0.8; may be given several times.
    #[arg(long, value_name = "NODE.PARAM=VALUE")]
    set: Vec<String>,
    /// Size of every camera, in pixels.
    #[arg(long, value_name = "WxH", value_parser = parse_size)]
    size: Option<[u32; 2]>,
    /// What `render --full` would do.
    #[arg(long)]
    full: bool,
    /// Print JSON.
    #[arg(long)]
    json: bool,
    /// auto, cpu, or a part of an adapter's name (`tyndall doctor` lists them).
    #[arg(long, value_name = "ADAPTER", default_value = "auto", value_parser = AdapterChoice::from_str)]
    adapter: AdapterChoice,
}

/// Prints.
///
/// # Errors
/// All that is wrong in the graph; what is wrong on the command line; a node that fails.
pub fn run(args: &Args) -> anyhow::Result<ExitCode> {
    let document = read(&args.graph, &args.set, args.size)?;
    refuse_problems(&document, Target::Sinks, &args.graph)?;
    let mut session = Session::open(&args.adapter)?;
    session.set_pruning(!args.full);
    let explained = session.explain(&document, Target::Sinks)?;
    let file = args.graph.display().to_string();
    if !explained.failures.is_empty() {
        let lines = explained.failures.iter().map(|(name, why)| format!("{file}: node '{name}': {why}"));
        return Err(Lines(lines.collect()).into());
    }
    let report = session.gpu().report();
    let found = GraphJson::of(file, report.name.clone(), session.gpu().is_cpu(), &explained);
    if args.json {
        print_json(&found)?
    } else {
        print(&describe(&found))?
    }
    Ok(ExitCode::SUCCESS)
}

/// A graph for scripts; the field names are a contract.
#[derive(Serialize)]
struct GraphJson<'a> {
    graph: String,
    adapter: String,
    #[serde(skip)]
    is_cpu: bool,
    /// Read and written together.
    copy_gb_per_s: f64,
    /// Of all that was read and is foretold; nodes whose `ms` is null are not in it.
    ms: f64,
    nodes: Vec<NodeJson<'a>>,
    left_out: Vec<LeftOutJson<'a>>,
}

#[derive(Serialize)]
struct NodeJson<'a> {
    name: &'a str,
    #[serde(rename = "type")]
    kind: &'static str,
    /// Whether it was run to know this, and `ms` measured; else it is foretold.
    was_run: bool,
    cells: Option<[usize; 3]>,
    channels: Option<usize>,
    bytes: Option<u64>,
    ms: Option<f64>,
    stages: Vec<StageJson>,
    decisions: &'a [Decision],
    absent: Vec<AbsentJson>,
}

#[derive(Serialize)]
struct StageJson {
    stage: &'static str,
    runs: usize,
    moved_bytes: Option<u64>,
    /// Of a plain copy of what it moves.
    floor_ms: Option<f64>,
    ms: Option<f64>,
}

#[derive(Serialize)]
struct AbsentJson {
    input: &'static str,
    meaning: &'static str,
}

#[derive(Serialize)]
struct LeftOutJson<'a> {
    name: &'a str,
    reason: &'static str,
}

impl<'a> GraphJson<'a> {
    fn of(graph: String, adapter: String, is_cpu: bool, explained: &'a Explained) -> Self {
        let copy_gb_per_s = explained.copy_gb_per_s;
        let nodes = explained.nodes.iter().map(|node| NodeJson::of(node, copy_gb_per_s, is_cpu));
        let left_out = explained.left_out.iter();
        Self {
            graph,
            adapter,
            is_cpu,
            copy_gb_per_s,
            ms: explained.nodes.iter().filter_map(|node| node.ms).sum(),
            nodes: nodes.collect(),
            left_out: left_out.map(|name| LeftOutJson { name, reason: "no output needs it" }).collect(),
        }
    }
}

impl<'a> NodeJson<'a> {
    fn of(node: &'a Explanation, copy_gb_per_s: f64, is_cpu: bool) -> Self {
        let stages = node.report.stages.iter().map(|work| StageJson {
            stage: work.stage,
            runs: work.runs,
            moved_bytes: work.moved_bytes,
            floor_ms: cost::floor_ms(work, copy_gb_per_s),
            ms: cost::predicted_ms(work, copy_gb_per_s, is_cpu),
        });
        let absent = node.absent.iter().map(|&(input, meaning)| AbsentJson { input, meaning });
        Self {
            name: &node.name,
            kind: node.kind,
            was_run: node.was_run,
            cells: node.report.cells,
            channels: node.report.channels,
            bytes: node.bytes,
            ms: node.ms,
            stages: stages.collect(),
            decisions: &node.report.decisions,
            absent: absent.collect(),
        }
    }
}

fn describe(found: &GraphJson) -> String {
    let mut text = format!(
        "{TITLE}{}{TITLE:#} on {}, which copies {:.1} GB/s\n\n",
        found.graph, found.adapter, found.copy_gb_per_s
    );
    let heads = ["node", "type", "", "cells", "channels", "bytes", "time"].map(str::to_owned).to_vec();
    text += &columns(&[vec![heads], found.nodes.iter().map(row).collect()].concat());
    for node in found.nodes.iter().filter(|node| !node.decisions.is_empty() || !node.absent.is_empty()) {
        let _ = writeln!(text, "\n{NAME}{}{NAME:#}", node.name);
        let decisions = node.decisions.iter().map(|decision| {
            let verdict = if decision.kept { "kept" } else { "left out" };
            let data = if decision.data.is_empty() { String::new() } else { format!(" ({})", decision.data) };
            vec![verdict.to_owned(), decision.what.clone(), format!("{}{data}", decision.reason)]
        });
        let absent = node.absent.iter().map(|absent| {
            vec!["empty".to_owned(), format!("input {}", absent.input), absent.meaning.to_owned()]
        });
        text += &columns(&decisions.chain(absent).collect::<Vec<_>>());
    }
    for node in &found.left_out {
        let _ = writeln!(text, "\n{NAME}{}{NAME:#}\n  left out  the node  {}", node.name, node.reason);
    }
    let unknown: Vec<&str> =
        found.nodes.iter().filter(|node| node.ms.is_none()).map(|node| node.name).collect();
    let but = if unknown.is_empty() { String::new() } else { format!(", without {}", unknown.join(", ")) };
    let whose = if found.is_cpu { "" } else { ", of what would run the GPU's own time" };
    let _ = writeln!(text, "\nabout {}{but}{whose}", time(found.ms));
    text
}

fn row(node: &NodeJson) -> Vec<String> {
    let blank = || "-".to_owned();
    vec![
        node.name.to_owned(),
        node.kind.to_owned(),
        if node.was_run { "was run" } else { "would run" }.to_owned(),
        node.cells.map_or_else(blank, |[x, y, z]| format!("{x} x {y} x {z}")),
        node.channels.map_or_else(blank, |channels| channels.to_string()),
        node.bytes.map_or_else(blank, size),
        node.ms.map_or_else(blank, time),
    ]
}

/// As people read it: `0 ms`, `230 ms`, `2.5 s`.
fn time(ms: f64) -> String {
    // The sum of nothing is -0.
    if ms < 1000.0 { format!("{:.0} ms", ms.abs()) } else { format!("{:.1} s", ms / 1000.0) }
}
