//! What is told of the picture: tone, layers, values, histogram, scale; and what it all looks like.

use egui::Theme;
use serde_json::json;

use super::*;
use crate::editor::snapshot::assert_looks;

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

#[test]
fn where_there_is_no_room_things_go_in_an_order() {
    let mut harness = window();
    harness.state_mut().viewport.toggle_histogram();
    harness.state_mut().viewport.slice = slice::with_cut();
    // From what can be done without first to what stays longest.
    let names = ["Legend", "Axes", "Histogram of", "Scale bar", "beauty 0."];
    let mut lowest = names.map(|_| f32::INFINITY);
    for height in (96..=560).rev().step_by(4) {
        harness.set_size(vec2(SIZE.x, height as f32));
        harness.remove_cursor();
        for is_pointed in [false, true] {
            harness.run_steps(2);
            let picture = harness.get_by_label("Picture").rect();
            if is_pointed {
                // Not on the handle of the slice.
                harness.hover_at(picture.center() + vec2(0.0, 0.4 * picture.height()));
                harness.run_steps(2);
            }
            let rects = names.map(|name| harness.query_by_label_contains(name).map(|node| node.rect()));
            for (idx, rect) in rects.iter().enumerate().filter_map(|(idx, rect)| Some((idx, (*rect)?))) {
                assert!(picture.contains_rect(rect), "{} at {height}: {rect:?} in {picture:?}", names[idx]);
                lowest[idx] = picture.height();
                for (other, name) in rects.iter().zip(names).skip(idx + 1) {
                    let covers = other.is_some_and(|other| other.shrink(0.5).intersects(rect));
                    assert!(!covers, "{} and {name} at {height}", names[idx]);
                }
            }
        }
    }
    assert!(lowest.is_sorted_by(|a, b| a > b) && lowest[0] < 250.0 && lowest[3] < 45.0, "{lowest:?}");
}

#[test]
fn a_moved_picture_has_no_guides_under_the_histogram() {
    let mut harness = window();
    harness.state_mut().viewport.toggle_histogram();
    harness.run_steps(2);
    let names = ["Axes", "Histogram of", "Scale bar"];
    let mut is_seen = names.map(|_| false);
    // As high as the viewport: from wholly seen to out at the top.
    let area = harness.get_by_label("Picture").rect();
    let zoom = area.height() / 64.0;
    for up in (0..=area.height() as usize).step_by(4) {
        harness.state_mut().viewport.place = Place::Free { zoom, offset: vec2(0.0, -(up as f32)) };
        harness.run_steps(2);
        let rects = names.map(|name| harness.query_by_label_contains(name).map(|node| node.rect()));
        let [axes, histogram, scale] = rects;
        for (name, rect) in [("axes", axes), ("scale bar", scale)] {
            let covers = histogram.zip(rect).is_some_and(|(a, b)| a.shrink(0.5).intersects(b));
            assert!(!covers, "{name} at {up}: {histogram:?}, {rect:?}");
        }
        for (is_seen, rect) in is_seen.iter_mut().zip(rects) {
            *is_seen |= rect.is_some();
        }
    }
    assert_eq!(is_seen, [true; 3]);
}

/// What the viewport looks like, with all that can be drawn over a picture, in both themes.
#[test]
fn it_looks_as_it_did() {
    for (theme, name) in [(Theme::Dark, "viewport_dark"), (Theme::Light, "viewport_light")] {
        let mut bench = Bench::new();
        bench.viewport.toggle_histogram();
        bench.viewport.slice = slice::with_cut();
        assert_looks(name, vec2(720.0, 400.0), theme, bench, |ui, bench| bench.show(ui));
    }
}
