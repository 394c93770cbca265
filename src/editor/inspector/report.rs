//! What a node is wired to, and what it said of its run.

use egui::{RichText, Ui};

use crate::editor::{NodeState, NodeStatus};
use crate::graph::{Decision, Document, NodeSpec, PortSpec};

/// Inputs and outputs, and what they are wired to.
pub fn ports(ui: &mut Ui, document: &Document, name: &str, spec: &NodeSpec) {
    for port in spec.inputs {
        let wires = document.wires.iter().filter(|wire| wire.to.node == name && wire.to.port == port.name);
        let ends: Vec<String> = wires.map(|wire| wire.from.to_string()).collect();
        line(ui, port, "<-", &ends, || match port.absent {
            Some(meaning) => (format!("empty: {meaning}"), false),
            None => (format!("empty: wire a {} to it", port.kind), true),
        });
    }
    for port in spec.outputs {
        let wires =
            document.wires.iter().filter(|wire| wire.from.node == name && wire.from.port == port.name);
        let ends: Vec<String> = wires.map(|wire| wire.to.to_string()).collect();
        line(ui, port, "->", &ends, || ("read by nothing".to_owned(), false));
    }
}

fn line(ui: &mut Ui, port: &PortSpec, arrow: &str, ends: &[String], empty: impl Fn() -> (String, bool)) {
    ui.horizontal_wrapped(|ui| {
        let about = format!("{}: {}", port.kind, port.doc);
        ui.label(RichText::new(port.name).strong()).on_hover_text(about);
        if !ends.is_empty() {
            ui.label(format!("{arrow} {}", ends.join(", ")));
            return;
        }
        match empty() {
            (text, true) => ui.colored_label(ui.visuals().error_fg_color, text),
            (text, false) => ui.weak(text),
        };
    });
}

/// State, cost and decisions of the last run.
pub fn run(ui: &mut Ui, status: &NodeStatus) {
    let error = ui.visuals().error_fg_color;
    match &status.state {
        NodeState::Idle => ui.weak("It has not run: no picture that is shown needs it."),
        NodeState::Stale => ui.weak("Something that it depends on changed since it ran."),
        NodeState::Running => ui.label("It runs."),
        NodeState::Done => ui.label(cost(status)),
        NodeState::Failed(message) => ui.colored_label(error, message),
        NodeState::Skipped(because) => {
            ui.colored_label(error, format!("It waits for '{because}', which failed."))
        }
    };
    if let Some([x, y, z]) = status.report.cells {
        ui.weak(format!("{x} x {y} x {z} cells"));
    }
    for decision in &status.report.decisions {
        told(ui, decision);
    }
}

fn cost(status: &NodeStatus) -> String {
    let cached = if status.cached { ", from the cache" } else { "" };
    let mib = status.bytes as f64 / f64::from(1 << 20);
    format!("{:.1} ms, of these {:.1} ms on the GPU; {mib:.1} MiB{cached}", status.cpu_ms, status.gpu_ms)
}

fn told(ui: &mut Ui, decision: &Decision) {
    let Decision { kept, what, reason, data, .. } = decision;
    let what = if *kept { RichText::new(what) } else { RichText::new(format!("left out: {what}")).strong() };
    ui.horizontal_wrapped(|ui| {
        ui.label(what).on_hover_text(data);
        ui.weak(reason);
    });
}
