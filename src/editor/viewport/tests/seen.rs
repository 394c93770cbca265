//! What is told of the picture: tone, layers, values, histogram, scale; and what it all looks like.

use egui::Theme;
use egui_kittest::{SnapshotOptions, wgpu as drawing};
use serde_json::json;

use super::*;
use crate::gpu::testing::{gpu, window_backends};

#[test]
fn exposure_and_curve_need_no_new_picture() {
    let mut harness = window();
    let first = |harness: &Harness<Bench>| harness.state().viewport.shown[0].as_ref().unwrap().tone;
    assert_eq!(first(&harness), Tone::default());
    let from = at(&harness, "Exposure");
    plain_drag(&mut harness, from, vec2(50.0, 0.0));
    let ev = harness.state().param("tone", "exposure_ev").unwrap().as_f64().unwrap();
    assert!(ev > 0.2, "{ev}");
    assert_eq!(f64::from(first(&harness).exposure_ev), f64::from(ev as f32));
    click(&mut harness, "Tone curve");
    click(&mut harness, "aces");
    assert_eq!(harness.state().param("tone", "curve"), Some(&json!("aces")));
    assert_eq!(first(&harness).curve, tonemap_curve("aces"));
    // The pictures are those that were there.
    let shown = &harness.state().viewport.shown[0].as_ref().unwrap().value;
    assert!(shown.shares_data_with(&harness.state().pictures["march"].value));
    assert_eq!(harness.state_mut().project.undo().as_deref(), Some("change the exposure"));
    assert_eq!(harness.state().param("tone", "curve"), Some(&json!("none")));
    harness.state_mut().project.undo();
    assert_eq!(harness.state().param("tone", "exposure_ev"), None);
}

fn tonemap_curve(name: &str) -> crate::image::tonemap::Curve {
    serde_json::from_value(name.into()).unwrap()
}

#[test]
fn layers_are_chosen_from_a_menu() {
    let mut harness = window();
    click(&mut harness, "Layer");
    click(&mut harness, DEPTH);
    assert_eq!(harness.state().viewport.layer, DEPTH);
    assert_eq!(harness.state().viewport.shown[0].as_ref().unwrap().layer, DEPTH);
    harness.hover_at(at(&harness, "Picture"));
    harness.run_steps(2);
    assert!(has(&harness, "depth 6.000"));
}

#[test]
fn value_and_place_are_told_under_the_cursor() {
    let mut harness = window();
    harness.hover_at(at(&harness, "Picture"));
    harness.run_steps(2);
    // 0.25 + 0.5 · 48/96 in the middle, and 6 m ahead of (0, 1, 6) on the way to the origin.
    assert!(has(&harness, "beauty 0.5000"));
    let at_6_m = harness.query_all_by_label_contains("depth 6.000 m   at").next().is_some();
    assert!(at_6_m);
    harness.remove_cursor();
    harness.run_steps(2);
    assert!(!has(&harness, "beauty 0.5000"));
}

#[test]
fn histogram_and_scale_are_told() {
    let mut harness = window();
    assert!(has(&harness, "Scale bar: 50 cm"));
    assert!(!has(&harness, "Histogram of beauty"));
    click(&mut harness, "Histogram");
    assert!(has(&harness, "Histogram of beauty"));
    click(&mut harness, "Histogram");
    assert!(!has(&harness, "Histogram of beauty"));
}

/// What the viewport looks like, with all that can be drawn over a picture, in both themes.
///
/// Drivers differ in the last bit of a blend and in which pixels an edge covers: egui feathers edges over a pixel, so
/// that such a pixel differs by a part of its contrast. The threshold of 0.6 (YIQ distance, egui_kittest's own for a
/// single driver) with 300 of 288 000 pixels beyond it allows for a pixel along each of the lines and letters that
/// are drawn. A legend that is missing changes 20 838, a picture that is moved by a pixel 8829.
#[test]
fn it_looks_as_it_did() {
    if gpu().is_none() {
        return;
    }
    let mut results = egui_kittest::SnapshotResults::new();
    for (theme, name) in [(Theme::Dark, "viewport_dark"), (Theme::Light, "viewport_light")] {
        let mut setup = drawing::default_wgpu_setup();
        if let eframe::egui_wgpu::WgpuSetup::CreateNew(new) = &mut setup {
            new.instance_descriptor.backends = window_backends();
        }
        let renderer = drawing::WgpuTestRenderer::from_setup(setup);
        let builder = Harness::builder().with_size(vec2(720.0, 400.0)).renderer(renderer).with_theme(theme);
        let mut bench = Bench::new();
        bench.viewport.toggle_histogram();
        bench.viewport.slice = slice::with_cut();
        let mut harness = builder.build_ui_state(|ui, bench: &mut Bench| bench.show(ui), bench);
        crate::editor::theme::apply(&harness.ctx, theme.into());
        harness.run_steps(4);
        let options =
            SnapshotOptions::new().threshold(0.6).max_failed_pixels(300_usize).output_path("tests/snapshots");
        harness.snapshot_options(name, &options);
        results.extend_harness(&mut harness);
    }
}
