//! What nodes tell, and pictures of the canvas to look at.

use std::sync::Arc;

use super::super::paint::Brush;
use super::super::scene::{self, PortShape, Scene};
use super::super::theme::Theme;
use super::super::view::View;
use super::*;
use crate::editor::snapshot::assert_looks;
use crate::editor::{NodeState, NodeStatus};
use crate::graph::{Decision, Report, Side};
use crate::nodes::catalog;

fn statuses() -> Statuses {
    let report = Report {
        decisions: vec![Decision::left_out("suns", "a prefilter", "the light is a sun", "1 sun")],
        ..Report::default()
    };
    let states = [
        ("sun", NodeState::Done, true),
        ("moon", NodeState::Stale, false),
        ("split", NodeState::Done, false),
        ("camera", NodeState::Failed("fov_y_deg is 0; write more".to_owned()), false),
        ("march", NodeState::Skipped("camera".to_owned()), false),
    ];
    let status = |(name, state, cached): (&str, NodeState, bool)| {
        let report = Arc::new(if name == "split" { report.clone() } else { Report::default() });
        let status =
            NodeStatus { state, cached, cpu_ms: 12.0, bytes: 3_565_158, report, ..NodeStatus::default() };
        (name.to_owned(), status)
    };
    states.map(status).into_iter().collect()
}

#[test]
fn every_node_tells_its_state() {
    let mut harness = window(SCENE);
    harness.state_mut().statuses = statuses();
    harness.run_steps(2);
    for label in [
        "state of sun: done, from the cache; cpu 12 ms, 3.4 MiB",
        "state of moon: stale: something that it depends on changed; cpu 12 ms, 3.4 MiB",
        "state of camera: failed: fov_y_deg is 0; write more; cpu 12 ms, 3.4 MiB",
        "state of march: skipped, because camera failed; cpu 12 ms, 3.4 MiB",
        "left out of split: a prefilter: the light is a sun",
    ] {
        assert!(harness.query_by_label(label).is_some(), "{label}");
    }
}

#[test]
fn what_is_off_the_screen_is_no_widget() {
    let mut harness = window(SCENE);
    assert!(harness.query_by_label("node sun").is_some());
    harness.state_mut().canvas.view.pan.x -= 3000.0;
    harness.run_steps(2);
    assert!(
        harness.query_by_label("node sun").is_none()
            && harness.query_by_label("input march.camera").is_none()
    );
}

#[test]
fn names_of_ports_in_a_row_do_not_touch() {
    let text = r#"{"tyndall": 1, "nodes": {"blur": {"type": "prefilter"}, "split": {"type": "light_decomposition"}}}"#;
    let scene = Scene::new(&Document::parse(text, Path::new("")).unwrap(), catalog());
    let mut harness = Harness::new_ui(move |ui| {
        let painter = ui.painter().clone();
        for zoom in [0.42, 0.49, 0.6, 0.8, 1.0, 2.0] {
            let view = View { zoom, ..View::default() };
            let brush = Brush { painter: &painter, view, theme: Theme::of(ui) };
            let mut n_rows = 0;
            for node in &scene.nodes {
                let [inputs, outputs] = [Side::Input, Side::Output].map(|side| node.side(side));
                for pair in inputs.zip(outputs) {
                    let drawn = |port: &PortShape| {
                        let (size, width) = brush.label_room(port);
                        assert!(size >= 6.5, "{size}");
                        // What has no room in its width is cut to it.
                        brush.width(&port.port.end.port, size).min(width)
                    };
                    let free = (scene::WIDTH - 22.0) * zoom - drawn(pair.0) - drawn(pair.1);
                    assert!(free >= 5.0, "{free} between the names of {} at {zoom}", node.name);
                    n_rows += 1;
                }
            }
            assert_eq!(n_rows, 3);
        }
    });
    harness.run_steps(2);
}

#[test]
fn the_canvas_looks_as_it_did() {
    for (theme, name) in [(egui::Theme::Dark, "canvas_dark"), (egui::Theme::Light, "canvas_light")] {
        let mut bench = Bench::new(Document::parse(SCENE, Path::new("")).unwrap());
        bench.statuses = statuses();
        bench.selection.only("split");
        assert_looks(name, Vec2::new(480.0, 300.0), theme, bench, |ui, bench| bench.show(ui));
    }
}

/// Writes pictures to look at; `cargo test canvas::tests::looks -- --ignored`.
#[test]
#[ignore = "writes pictures for people"]
fn pictures() {
    let folder =
        std::path::PathBuf::from(std::env::var("TYNDALL_PICTURES").unwrap_or("target/pictures".into()));
    std::fs::create_dir_all(&folder).unwrap();
    for theme in [egui::Theme::Dark, egui::Theme::Light] {
        for graph in ["small", "beams", "groups"] {
            let document = match graph {
                "small" => Document::parse(SCENE, Path::new("")).unwrap(),
                "groups" => Document::parse(super::groups::GROUPS, Path::new("")).unwrap(),
                graph => Document::load(&Path::new("graphs").join(format!("{graph}.json"))).unwrap(),
            };
            let builder = Harness::builder().with_size(Vec2::new(1280.0, 700.0)).with_theme(theme).wgpu();
            let mut bench = Bench::new(document);
            bench.statuses = statuses();
            bench.selection.only("split");
            let mut harness = builder.build_ui_state(|ui, bench: &mut Bench| bench.show(ui), bench);
            harness.run_steps(3);
            let shown = |harness: &mut Harness<Bench>, what: &str| {
                let picture = harness.render().unwrap();
                let name = format!("{graph}_{what}_{theme:?}.png").to_lowercase();
                picture.save(folder.join(name)).unwrap();
            };
            shown(&mut harness, "all");
            if graph == "beams" {
                let factor = 0.5 / harness.state().canvas.view.zoom;
                harness.state_mut().canvas.view.zoom_at(Pos2::new(640.0, 350.0), factor);
                harness.run_steps(2);
                shown(&mut harness, "half");
            }
            if graph == "small" {
                let from = at(&harness, "output moon.light");
                let to = at(&harness, "input march.medium");
                drag_to(&mut harness, from, to);
                shown(&mut harness, "drag");
                harness.drop_at(EMPTY);
                harness.run_steps(3);
                harness.hover_at(EMPTY);
                shown(&mut harness, "search");
            }
        }
    }
}
