//! `point_light`: a point that shines evenly in all directions.

use glam::DVec3;

use super::{NodeKind, Rules, Run, no_files};
use crate::graph::{Category, NodeError, NodeSpec, ParamSpec, PortSpec, PortType, Value};
use crate::light::{BRIGHTEST, Light};

pub(super) const KIND: NodeKind = NodeKind { spec: &SPEC, files: no_files, run, rules: Rules::None };

static SPEC: NodeSpec = NodeSpec {
    id: "point_light",
    version: 1,
    category: Category::Light,
    purpose: "A point that shines evenly in all directions.",
    doc: "May stand outside or inside the medium. Wire it to spherical_propagation.lights.",
    inputs: &[],
    outputs: &[PortSpec::new("light", PortType::Light, "the light, for spherical_propagation.lights")],
    params: &[
        ParamSpec::vector("position", &[0.0, 2.0, 0.0]).unit("m").doc("Where it stands."),
        ParamSpec::rgb("intensity", [1.0; 3])
            .unit("W/sr")
            .between(0.0, BRIGHTEST)
            .soft(0.0, 100.0)
            .doc("Power per solid angle, linear Rec. 709."),
    ],
};

fn run(run: &Run) -> Result<Vec<Value>, NodeError> {
    let light = Light::Point {
        position: DVec3::from_array(run.params.vec("position")),
        intensity: run.params.rgb("intensity"),
    };
    Ok(vec![Value::new(PortType::Light, size_of::<Light>() as u64, vec![light])])
}
