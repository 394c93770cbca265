//! What nodes tell, and pictures of the canvas to look at.

use std::sync::Arc;

use super::*;
use crate::editor::snapshot::assert_looks;
use crate::editor::{NodeState, NodeStatus};
use crate::graph::{Decision, Report};

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
fn snapshot_of_the_canvas() {
    for (theme, name) in [(egui::Theme::Dark, "canvas_dark"), (egui::Theme::Light, "canvas_light")] {
        let mut bench = Bench::new(Document::parse(SCENE, Path::new("")).unwrap());
        bench.statuses = statuses();
        bench.selection.only("split");
        let builder = Harness::builder().with_size(Vec2::new(480.0, 300.0)).with_theme(theme);
        let mut harness = builder.build_ui_state(|ui, bench: &mut Bench| bench.show(ui), bench);
        harness.run_steps(3);
        assert_looks(&mut harness, name);
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
