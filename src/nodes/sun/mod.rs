//! `sun`: parallel light from afar.

use glam::DVec3;

use super::{NodeKind, Rules, Run, no_files};
use crate::graph::{Category, NodeError, NodeSpec, ParamSpec, PortSpec, PortType, Value};
use crate::light::{BRIGHTEST, Light};

pub(super) const KIND: NodeKind = NodeKind { spec: &SPEC, files: no_files, run, rules: Rules::None };

static SPEC: NodeSpec = NodeSpec {
    id: "sun",
    version: 1,
    category: Category::Light,
    purpose: "Parallel light from afar, such as the sun.",
    doc: "Its irradiance is measured on a plane across it, before anything has been in its way.",
    inputs: &[],
    outputs: &[PortSpec::new("light", PortType::Light, "the sun, for light_decomposition.lights")],
    params: &[
        ParamSpec::direction("direction", [-0.5, -1.0, -0.5])
            .doc("The way the light travels; need not be of unit length."),
        ParamSpec::rgb("irradiance", [3.0; 3])
            .unit("W/m2")
            .between(0.0, BRIGHTEST)
            .soft(0.0, 20.0)
            .doc("On a plane across the light, linear Rec. 709."),
        ParamSpec::float("angular_diameter_deg", 0.0)
            .unit("deg")
            .between(0.0, 180.0)
            .soft(0.0, 10.0)
            .doc("Of its disk in the sky; the Sun's is 0.53."),
    ],
};

fn run(run: &Run) -> Result<Vec<Value>, NodeError> {
    let light = Light::Sun {
        direction: DVec3::from_array(run.params.unit("direction")),
        irradiance: run.params.rgb("irradiance"),
        angular_diameter_deg: run.params.f64("angular_diameter_deg"),
    };
    Ok(vec![Value::new(PortType::Light, size_of::<Light>() as u64, vec![light])])
}
