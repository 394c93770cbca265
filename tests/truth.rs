//! Pictures against the truth: an independent unbiased path tracer.
//!
//! Errors are `block_relative` over the blocks that meet the medium (DESIGN 11), at default quality. The
//! limits are the prototype's figures (DESIGN 6.8) plus one percentage point. The scenes live outside of
//! the repository; where they are absent that is said, and only our own small scene is rendered.

mod common;

use std::path::Path;

use tyndall::graph::{CancelToken, Document, Target, check};
use tyndall::image::{self, Image, metrics};
use tyndall::nodes;

/// Scene and the prototype's error; without one, 4 % and the noise of the truth, less a point.
const SCENES: &[(&str, f64)] = &[
    ("s01_sphere_iso_dir", 0.005),
    ("s05_checker_dir", 0.021),
    ("s06_checker_fwd_sky", 0.048),
    ("s07_cloud128_thin_mixed", 0.0025),
    ("s08_cloud128_rgb_const", 0.008),
    ("s12_plume_dir", 0.022),
    ("s13_plume_point", 0.030),
    ("s15_fire_mixed", 0.027),
    ("s16_cloud128_mesh_sky", 0.0355),
];

fn render(graph: &Path) -> Option<Image> {
    let mut session = common::session()?;
    let document = Document::load(graph).unwrap();
    let target = Target::Nodes(&["march"]);
    let problems = check(&document, nodes::catalog(), target);
    assert!(problems.is_empty(), "{graph:?}: {problems:?}");
    let solved = session.solve(&document, target, &CancelToken::new(), &mut |_| ());
    let failures: Vec<_> = solved.evaluation.failures().collect();
    assert!(failures.is_empty(), "{failures:?}");
    Some(solved.evaluation.value("march", "image").unwrap().get::<Image>().clone())
}

/// Renders `NAME.graph.json` of a folder and compares it with `NAME.exr` where `NAME_tau.exr` has medium;
/// says what was found, and whether all channels together and each apart are within the limit.
fn is_within(folder: &Path, scene: &str, limit: f64) -> bool {
    let file = |ending: &str| folder.join(format!("{scene}{ending}"));
    let Some(picture) = render(&file(".graph.json")) else { return true };
    let reference = image::read(&file(".exr")).unwrap();
    let mask = image::read(&file("_tau.exr")).unwrap();
    // Where there are surfaces all of the picture counts.
    let has_surfaces = std::fs::read_to_string(file(".graph.json")).unwrap().contains("\"mesh\"");
    let found = metrics::compare(&picture, &reference, (!has_surfaces).then_some(&mask)).unwrap();
    let channels: Vec<String> =
        found.per_channel.iter().map(|c| format!("{:.4} ({:+.4})", c.block_relative, c.bias)).collect();
    eprintln!(
        "{scene}: block_relative {:.4}, bias {:+.4}, limit {limit:.4}; channels {}",
        found.block_relative,
        found.bias,
        channels.join(", ")
    );
    let worst = found.per_channel.iter().map(|c| c.block_relative).fold(found.block_relative, f64::max);
    worst <= limit && found.non_finite == 0
}

#[test]
fn our_own_scene_is_within_a_point_of_the_prototype() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("data/truth");
    assert!(is_within(&folder, "checker_sun", 0.031));
    // The comparison sees an error: nothing is within 0.1 %.
    assert!(common::session().is_none() || !is_within(&folder, "checker_sun", 0.001));
}

#[test]
fn scenes_are_within_a_point_of_the_prototype() {
    let Some(truth) = common::shared_dir().map(|shared| shared.join("truth")) else {
        eprintln!("skipped: no shared files");
        return;
    };
    let only = std::env::var("TYNDALL_SCENE").unwrap_or_default();
    let failed: Vec<&str> = SCENES
        .iter()
        .filter(|(scene, _)| scene.starts_with(&only))
        .filter(|(scene, prototype)| !is_within(&truth, scene, prototype + 0.01))
        .map(|(scene, _)| *scene)
        .collect();
    assert!(failed.is_empty(), "over their limits: {failed:?}");
}
