//! Light that is split by importance does not flicker where the camera moves.
//!
//! The camera that importance comes from goes around a cloud by 1.5 degrees a frame; the picture is another
//! camera's, which stands still, so that all that changes in it is the split. Flicker is what is not a steady
//! change, the mean over frames of Σ|X(t) − (X(t−1) + X(t+1))/2| / ΣX(t) over all pixels and channels; change is
//! that of Σ|X(t+1) − X(t)| / ΣX(t).

mod common;

use std::f64::consts::PI;
use std::path::Path;

use glam::DVec3;
use tyndall::graph::{CancelToken, Document, Target};
use tyndall::image::Image;
use tyndall::light::{Ordinate, Ordinates};
use tyndall::nodes;
use tyndall::optics::spectrum::luminance;
use tyndall::session::Session;

const GRAPH: &str = r#"{ "tyndall": 1, "nodes": {
    "shape": { "type": "shape", "kind": "cloud", "resolution": 24, "size": [2, 2, 2] },
    "medium": { "type": "medium", "density_scale": 6, "albedo": 0.99, "g": 0.9, "max_cells": 20000 },
    "sky": { "type": "environment", "path": "data/sky.exr" },
    "eye": { "type": "camera", "fov_y_deg": 38, "position": { "keys": [[0, [0, 0.8, 4]], [24, [2.35, 0.8, 3.24]]] } },
    "importance": { "type": "importance_propagation" },
    "split": { "type": "light_decomposition", "count": 16 },
    "prefilter": { "type": "prefilter" },
    "beams": { "type": "principal_propagation" },
    "residual": { "type": "isotropic_residual", "quality": "draft" },
    "view": { "type": "camera", "position": [1, 0.8, 4], "fov_y_deg": 38, "width": 24, "height": 24 },
    "march": { "type": "raymarch", "background": false } },
  "wires": [ "shape.volume -> medium.volume", "medium.medium -> importance.medium", "eye.camera -> importance.camera",
    "sky.environment -> split.environment", "importance.importance -> split.importance",
    "split.ordinates -> prefilter.ordinates", "sky.environment -> prefilter.environment",
    "medium.medium -> prefilter.medium", "prefilter.ordinates -> beams.ordinates", "medium.medium -> beams.medium",
    "medium.medium -> residual.medium", "beams.beams -> residual.beams", "medium.medium -> march.medium",
    "beams.beams -> march.beams", "residual.residual -> march.residual", "view.camera -> march.camera",
    "prefilter.environment -> march.environment" ] }"#;

fn document() -> Document {
    Document::parse(GRAPH, Path::new(env!("CARGO_MANIFEST_DIR"))).unwrap()
}

fn picture(session: &mut Session, document: &Document, frame: i64) -> Image {
    let document = Document { frame: Some(frame), ..document.clone() };
    let solved = session.solve(&document, Target::Nodes(&["march"]), &CancelToken::new(), &mut |_| ());
    let failures: Vec<_> = solved.evaluation.failures().collect();
    assert!(failures.is_empty(), "{failures:?}");
    solved.evaluation.value("march", "image").unwrap().get::<Image>().clone()
}

/// Σ|a − b| / Σa of two pictures, or of one and the mean of two.
fn apart(one: &Image, others: &[&Image]) -> f64 {
    let mean = |idx: usize| {
        others.iter().map(|image| f64::from(image.beauty()[idx])).sum::<f64>() / others.len() as f64
    };
    let (mut apart, mut sum) = (0.0, 0.0);
    for (idx, value) in one.beauty().iter().map(|value| f64::from(*value)).enumerate() {
        apart += (value - mean(idx)).abs();
        sum += value;
    }
    apart / sum
}

fn mean(values: impl ExactSizeIterator<Item = f64>) -> f64 {
    let count = values.len() as f64;
    values.sum::<f64>() / count
}

#[test]
fn a_fade_does_not_flicker() {
    let Some(mut session) = common::session() else { return };
    let mut document = document();
    let mut pictures = |recut_frames: &str| -> Vec<Image> {
        document.set(nodes::catalog(), "split.recut_frames", recut_frames).unwrap();
        (4..=12).map(|frame| picture(&mut session, &document, frame)).collect()
    };
    let (fresh, faded) = (pictures("1"), pictures("8"));
    let flicker = |pictures: &[Image]| mean(pictures.windows(3).map(|at| apart(&at[1], &[&at[0], &at[2]])));
    let change = |pictures: &[Image]| mean(pictures.windows(2).map(|at| apart(&at[0], &[&at[1]])));
    let found = [flicker(&fresh), flicker(&faded), change(&fresh), change(&faded)];
    eprintln!("flicker with a split for each frame, and with a fade; change of both: {found:.5?}");
    // Measured 1.4e-3, 2.0e-4; 2.3e-3, 1.4e-3: what a fresh split makes comes and goes, what a fade makes is steady.
    assert!(found[1] < 0.2 * found[0], "flicker {found:?}");
    assert!(found[3] < 0.75 * found[2], "change {found:?}");
    // Nothing is left over from frames before.
    session.forget();
    document.set(nodes::catalog(), "split.recut_frames", "8").unwrap();
    for frame in [11, 8, 5] {
        let again = picture(&mut session, &document, frame as i64);
        assert!(again.beauty() == faded[frame - 4].beauty(), "frame {frame} by itself is another picture");
    }
}

#[test]
fn a_fade_keeps_the_light() {
    let Some(mut session) = common::session() else { return };
    let mut split = |frame| {
        let document = Document { frame: Some(frame), ..document() };
        let solved = session.solve(&document, Target::Nodes(&["split"]), &CancelToken::new(), &mut |_| ());
        solved.evaluation.value("split", "ordinates").unwrap().get::<Ordinates>().clone()
    };
    let fluence = |light: &Ordinates, channel: usize| {
        let beams: f64 = light.ordinates.iter().map(|ordinate| ordinate.irradiance[channel]).sum();
        beams + 4.0 * PI * light.ambient[channel]
    };
    let vector = |light: &Ordinates| -> DVec3 {
        let of = |o: &Ordinate| luminance(o.irradiance) * o.region.unwrap() * o.direction;
        light.ordinates.iter().map(of).sum()
    };
    let (before, within, after) = (split(0), split(3), split(8));
    assert_eq!([&before, &within, &after].map(|light| light.ordinates.len()), [16, 32, 16]);
    for channel in 0..3 {
        let exact = fluence(&before, channel);
        // Sums of 1e5 texels in f64; 1e-4 is asked for.
        assert!((fluence(&within, channel) / exact - 1.0).abs() < 1e-11);
        assert!((fluence(&after, channel) / exact - 1.0).abs() < 1e-11);
    }
    assert!((vector(&within) - vector(&before)).length() < 1e-11 * vector(&before).length());
    // Five eighths are the split of frame 0, as it was there.
    let share = |o: &Ordinate, share: f64| o.irradiance.map(|e| share * e);
    for (ordinate, whole) in within.ordinates.iter().zip(before.ordinates.iter().chain(&after.ordinates)) {
        assert_eq!((ordinate.direction, ordinate.region), (whole.direction, whole.region));
    }
    assert_eq!(within.ordinates[7].irradiance, share(&before.ordinates[7], 0.625));
    assert_eq!(within.ordinates[20].irradiance, share(&after.ordinates[4], 0.375));
}
