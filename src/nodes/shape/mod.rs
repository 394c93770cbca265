//! `shape`: something to light without a file.

use glam::DVec3;

use super::{NodeKind, Rules, Run, no_files, transform};
use crate::graph::{Category, NodeError, NodeSpec, ParamSpec, PortSpec, PortType, Value};
use crate::volume::shapes::{self, Kind};
use crate::volume::{Evenly, Volume};

pub(super) const KIND: NodeKind = NodeKind { spec: &SPEC, files: no_files, run, rules: Rules::None };

static SPEC: NodeSpec = NodeSpec {
    id: "shape",
    version: 1,
    category: Category::Volume,
    purpose: "A made volume: sphere, box, cloud or checkerboard, as a grid `density`.",
    doc: "Centered on the origin. sphere (an ellipsoid of these extents) and box are filled with 1 to their exact boundary; \
          cloud is a cumulus with values up to 1; checker has four cells an axis of 0.05 and 1.",
    inputs: &[],
    outputs: &[PortSpec::new("volume", PortType::Volume, "one grid, `density`")],
    params: &[
        ParamSpec::choice("kind", &["sphere", "box", "cloud", "checker"]).doc("What it is."),
        ParamSpec::vector("size", &[2.0, 2.0, 2.0])
            .unit("m")
            .above(0.0)
            .soft(0.1, 1000.0)
            .doc("Full extents along x, y, z."),
        ParamSpec::int("resolution", 64)
            .between(1.0, 1024.0)
            .soft(16.0, 256.0)
            .doc("Voxels along the longest axis."),
        ParamSpec::int("seed", 1)
            .between(0.0, 4_294_967_295.0)
            .soft(0.0, 100.0)
            .doc("Another number, another cloud."),
        transform::PARAM,
    ],
};

fn run(run: &Run) -> Result<Vec<Value>, NodeError> {
    let size_m = run.params.vec("size");
    let (kind, evenly) = match run.params.text("kind") {
        "sphere" => (Kind::Sphere, Some(true)),
        "box" => (Kind::Box, Some(false)),
        "cloud" => (Kind::Cloud, None),
        _ => (Kind::Checker, None),
    };
    let dense =
        shapes::generate(kind, size_m, run.params.i64("resolution") as usize, run.params.i64("seed") as u32);
    let evenly = evenly.map(|ellipsoid| Evenly { ellipsoid, half_extent: 0.5 * DVec3::from_array(size_m) });
    let transform = transform::read(run.params)?;
    let volume = Volume::from_shape(dense, evenly, transform);
    Ok(vec![Value::measured(PortType::Volume, volume, Volume::bytes)])
}
