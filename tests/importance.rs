//! What importance is for: fewer ordinates for a picture of the same error, where matter scatters forward.
//!
//! A cloud of 16 optical depths in front of real skies, against the picture of 256 ordinates; all with the
//! spread of regions, and all forward light theirs: with the window of `prefilter` as it is the stack brings it
//! (aristea_wreck 0.107 to 0.029 without importance) and importance only another quarter. The skies lie outside of the repository; where they are absent that is said.

mod common;

use tyndall::graph::{CancelToken, Document, Target};
use tyndall::image::{Image, metrics};
use tyndall::session::Session;

const GRAPH: &str = r#"{ "tyndall": 1, "nodes": {
    "shape": { "type": "shape", "kind": "cloud", "resolution": 40, "size": [2, 2, 2] },
    "medium": { "type": "medium", "density_scale": 8, "albedo": 0.99, "g": 0.9, "max_cells": 120000 },
    "sky": { "type": "environment", "path": "SKY" },
    "importance": { "type": "importance_propagation", "strength": STRENGTH },
    "split": { "type": "light_decomposition", "count": COUNT },
    "prefilter": { "type": "prefilter", "window_deg": [0.01, 0.02] },
    "beams": { "type": "principal_propagation" },
    "residual": { "type": "isotropic_residual" },
    "camera": { "type": "camera", "position": [2.5, 0.8, 4], "fov_y_deg": 38, "width": 48, "height": 48 },
    "march": { "type": "raymarch", "background": false } },
  "wires": [ "shape.volume -> medium.volume", "medium.medium -> importance.medium", "camera.camera -> importance.camera",
    "sky.environment -> split.environment", "importance.importance -> split.importance",
    "split.ordinates -> prefilter.ordinates", "sky.environment -> prefilter.environment",
    "medium.medium -> prefilter.medium", "prefilter.ordinates -> beams.ordinates", "medium.medium -> beams.medium",
    "medium.medium -> residual.medium", "beams.beams -> residual.beams", "medium.medium -> march.medium",
    "beams.beams -> march.beams", "residual.residual -> march.residual", "camera.camera -> march.camera" ] }"#;

fn picture(session: &mut Session, sky: &std::path::Path, count: usize, strength: f64) -> Image {
    let text = GRAPH
        .replace("SKY", sky.to_str().unwrap())
        .replace("COUNT", &count.to_string())
        .replace("STRENGTH", &strength.to_string());
    let document = Document::parse(&text, sky.parent().unwrap()).unwrap();
    let solved = session.solve(&document, Target::Nodes(&["march"]), &CancelToken::new(), &mut |_| ());
    let failures: Vec<_> = solved.evaluation.failures().collect();
    assert!(failures.is_empty(), "{failures:?}");
    solved.evaluation.value("march", "image").unwrap().get::<Image>().clone()
}

#[test]
fn importance_halves_the_error_of_16_ordinates() {
    let Some(mut session) = common::session() else { return };
    let Some(skies) = common::shared_dir().map(|shared| shared.join("env")) else {
        eprintln!("skipped: no shared files");
        return;
    };
    for name in ["aristea_wreck_puresky_1k", "studio_small_08_1k"] {
        let sky = skies.join(format!("{name}.hdr"));
        let reference = picture(&mut session, &sky, 256, 0.75);
        let mut error = |strength| {
            let picture = picture(&mut session, &sky, 16, strength);
            metrics::compare(&picture, &reference, None).unwrap().block_relative
        };
        let (by_luminance, by_importance) = (error(0.0), error(0.75));
        eprintln!("{name}: {by_luminance:.4} by luminance alone, {by_importance:.4} with importance");
        assert!(by_importance < 0.5 * by_luminance, "{name}: {by_importance} of {by_luminance}");
    }
}
