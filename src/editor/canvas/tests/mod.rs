//! Every gesture by AccessKit names, on a canvas alone in a window of 1000 × 700 points.

mod commands;
mod groups;
mod looks;
mod pointer;
mod ports;
mod undo;
mod wiring;

use std::collections::HashMap;
use std::path::Path;

use egui::{Event, Key, Modifiers, Pos2, Rect, Vec2};
use egui_kittest::Harness;
use egui_kittest::kittest::Queryable;

use super::{Canvas, Request};
use crate::editor::action::{self, Action};
use crate::editor::{Project, Selection, Statuses};
use crate::graph::{Document, Wire};

/// The canvas with what the editor would hold.
#[derive(Default)]
struct Bench {
    canvas: Canvas,
    project: Project,
    selection: Selection,
    statuses: Statuses,
    thumbnails: HashMap<String, egui::TextureHandle>,
    requests: Vec<Request>,
}

impl Bench {
    fn new(document: Document) -> Self {
        Self { project: Project::new(document), ..Self::default() }
    }

    fn show(&mut self, ui: &mut egui::Ui) {
        for action in action::pressed(ui.ctx(), self.canvas.has_keys()) {
            match action {
                Action::Canvas(command) => self.canvas.ask(command),
                Action::Undo => drop(self.project.undo()),
                Action::Redo => drop(self.project.redo()),
                _ => {}
            }
        }
        let Self { canvas, project, selection, statuses, thumbnails, requests } = self;
        requests.extend(canvas.show(ui, project, selection, statuses, thumbnails));
    }

    fn wires(&self) -> Vec<String> {
        self.project.document().wires.iter().map(Wire::to_string).collect()
    }

    fn names(&self) -> Vec<&str> {
        self.project.document().nodes.keys().map(String::as_str).collect()
    }

    fn selected(&self) -> Vec<&str> {
        self.selection.nodes.iter().map(String::as_str).collect()
    }
}

/// A window on a document, with the pointer over the empty.
fn window(text: &str) -> Harness<'static, Bench> {
    window_of(Document::parse(text, Path::new("")).unwrap())
}

fn window_of(document: Document) -> Harness<'static, Bench> {
    let builder = Harness::builder().with_size(Vec2::new(1000.0, 700.0)).with_step_dt(1.0 / 60.0);
    let mut harness = builder.build_ui_state(|ui, bench: &mut Bench| bench.show(ui), Bench::new(document));
    harness.step();
    harness.hover_at(EMPTY);
    harness.run_steps(2);
    harness
}

/// A point of the window where no test has a node.
const EMPTY: Pos2 = Pos2::new(500.0, 660.0);

/// Two suns, a split that takes one, a camera and a march.
const SCENE: &str = r#"{"tyndall": 1, "nodes": {
    "sun": {"type": "sun"}, "moon": {"type": "sun"}, "split": {"type": "light_decomposition"},
    "camera": {"type": "camera"}, "march": {"type": "raymarch"}},
    "wires": ["sun.light -> split.lights", "camera.camera -> march.camera"],
    "layout": {"sun": [0, 0], "moon": [0, 150], "split": [280, 0], "camera": [280, 250], "march": [560, 150]}}"#;

fn rect(harness: &Harness<Bench>, label: &str) -> Rect {
    harness.get_by_label(label).rect()
}

fn at(harness: &Harness<Bench>, label: &str) -> Pos2 {
    rect(harness, label).center()
}

/// From one point to another, with a stop on the way, and away after.
fn drag(harness: &mut Harness<Bench>, from: Pos2, to: Pos2) {
    drag_to(harness, from, to);
    harness.drop_at(to);
    harness.run_steps(3);
}

/// The same without letting go.
fn drag_to(harness: &mut Harness<Bench>, from: Pos2, to: Pos2) {
    harness.hover_at(from);
    harness.run_steps(2);
    harness.drag_at(from);
    harness.step();
    for part in [0.3, 0.7, 1.0] {
        harness.hover_at(from + (to - from) * part);
        harness.step();
    }
    harness.step();
}

fn drag_labels(harness: &mut Harness<Bench>, from: &str, to: &str) {
    let (from, to) = (at(harness, from), at(harness, to));
    drag(harness, from, to);
}

fn press(harness: &mut Harness<Bench>, modifiers: Modifiers, key: Key) {
    harness.key_press_modifiers(modifiers, key);
    harness.run_steps(3);
}

fn click(harness: &mut Harness<Bench>, label: &str) {
    harness.get_by_label(label).click();
    harness.run_steps(3);
}

fn click_with(harness: &mut Harness<Bench>, label: &str, modifiers: Modifiers) {
    harness.get_by_label(label).click_modifiers(modifiers);
    harness.run_steps(3);
}

fn undo(harness: &mut Harness<Bench>) {
    press(harness, Modifiers::COMMAND, Key::Z);
}

/// What the canvas put on the clipboard in the last frames.
fn copied(harness: &mut Harness<Bench>, event: Event) -> Option<String> {
    harness.event(event);
    let mut found = None;
    for _ in 0..3 {
        harness.step();
        for command in &harness.output().platform_output.commands {
            if let egui::OutputCommand::CopyText(text) = command {
                found = Some(text.clone());
            }
        }
    }
    found
}
