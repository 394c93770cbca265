//! Light through whole graphs, where a closed form or a refusal says what must come out.

mod common;

use std::f64::consts::PI;
use std::path::Path;

use tyndall::graph::{CancelToken, Document, Target};
use tyndall::image::Image;
use tyndall::nodes;
use tyndall::session::{Session, Solved};

/// A box of 2 m, 12 optical depths thick, between the camera and a sun that shines straight at it.
const BACKLIT: &str = r#"{ "tyndall": 1, "nodes": {
    "box": { "type": "shape", "kind": "box", "resolution": 32 },
    "medium": { "type": "medium", "density_scale": 6, "albedo": 0.5 },
    "sun": { "type": "sun", "direction": [0, 0, 1], "irradiance": 3 },
    "split": { "type": "light_decomposition" },
    "beams": { "type": "principal_propagation" },
    "camera": { "type": "camera", "position": [0, 0, 100], "fov_y_deg": 0.1, "width": 8, "height": 8 },
    "march": { "type": "raymarch" } },
  "wires": [ "box.volume -> medium.volume", "sun.light -> split.lights", "split.ordinates -> beams.ordinates",
    "medium.medium -> beams.medium", "beams.beams -> march.beams", "medium.medium -> march.medium",
    "camera.camera -> march.camera" ] }"#;

fn document(text: &str) -> Document {
    Document::parse(text, Path::new(env!("CARGO_MANIFEST_DIR"))).unwrap()
}

fn solve(session: &mut Session, document: &Document) -> Solved {
    session.solve(document, Target::Nodes(&["march"]), &CancelToken::new(), &mut |_| ())
}

#[test]
fn the_dark_side_of_a_thick_box_is_its_closed_form() {
    let Some(mut session) = common::session() else { return };
    let solved = solve(&mut session, &document(BACKLIT));
    let image = solved.evaluation.value("march", "image").expect("a picture").get::<Image>();
    let single = f64::from(image.layers["single"].data[3 * (8 * 4 + 4)]);
    // Every depth gives the same: albedo T exp(-T) E / 4 pi.
    let exact = 0.5 * 12.0 * (-12.0_f64).exp() * 3.0 / (4.0 * PI);
    // A ray ends where 1e-5 of it is left, at 11.5 of 12: 4.1 % are cut.
    assert!((single / exact - 1.0).abs() < 0.05, "{single:e} against {exact:e}");
}

#[test]
fn beams_of_another_medium_are_refused() {
    let Some(mut session) = common::session() else { return };
    let text = BACKLIT
        .replace(
            r#""medium.medium -> march.medium""#,
            r#""ball.volume -> other.volume", "other.medium -> march.medium""#,
        )
        .replace(r#""sun": {"#, r#""ball": { "type": "shape" }, "other": { "type": "medium" }, "sun": {"#);
    let solved = solve(&mut session, &document(&text));
    let failures: Vec<_> = solved.evaluation.failures().collect();
    assert_eq!(failures.len(), 1);
    assert!(failures[0].0 == "march" && failures[0].1.contains("another medium"), "{failures:?}");
}

#[test]
fn too_bright_a_light_is_refused_and_the_brightest_is_a_picture() {
    let Some(mut session) = common::session() else { return };
    let mut document = document(BACKLIT);
    let refused = document.set(nodes::catalog(), "sun.irradiance", "3e38").unwrap_err();
    assert!(refused.to_string().contains("outside 0..=1e28"), "{refused}");
    document.set(nodes::catalog(), "sun.irradiance", "1e28").unwrap();
    document.set(nodes::catalog(), "sun.direction", "[0, 0, -1]").unwrap();
    document.set(nodes::catalog(), "medium.density_scale", "100").unwrap();
    document.set(nodes::catalog(), "medium.g", "-0.99").unwrap();
    let solved = solve(&mut session, &document);
    let failures: Vec<_> = solved.evaluation.failures().collect();
    assert!(failures.is_empty(), "{failures:?}");
}

#[test]
fn a_flattened_volume_is_refused_by_its_size() {
    let Some(mut session) = common::session() else { return };
    let mut document = document(BACKLIT);
    let flat = "[1,0,0,0, 0,1,0,0, 0,0,1e-30,0, 0,0,0,1]";
    document.set(nodes::catalog(), "box.transform", flat).unwrap();
    let solved = solve(&mut session, &document);
    let failures: Vec<_> = solved.evaluation.failures().collect();
    assert!(failures.len() == 1 && failures[0].1.contains("max_resolution"), "{failures:?}");
}
