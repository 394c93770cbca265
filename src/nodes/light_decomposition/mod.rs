//! `light_decomposition`: all light from afar as principal ordinates.

use super::{NodeKind, Run, no_files};
use crate::graph::{Category, NodeError, NodeSpec, ParamSpec, PortSpec, PortType, Value};
use crate::light::environment::Environment;
use crate::light::{Light, Ordinate, Ordinates};

mod uniform;

pub(super) const KIND: NodeKind = NodeKind { spec: &SPEC, files: no_files, run };

static SPEC: NodeSpec = NodeSpec {
    id: "light_decomposition",
    version: 1,
    category: Category::Light,
    purpose: "Splits all light from afar into principal ordinates.",
    doc: "Suns pass through as they are. Of an environment, the constant part (its minimum over all directions, per channel) \
          becomes ambient light, which needs no beams; the rest is split into regions of even solid angle, each a beam with the \
          region's irradiance, its mean direction and its spread.",
    inputs: &[
        PortSpec::new(
            "environment",
            PortType::Environment,
            "light from all directions; without it there are only suns",
        )
        .optional(),
        PortSpec::new("lights", PortType::Light, "suns; without them there is only the environment")
            .many()
            .optional(),
    ],
    outputs: &[PortSpec::new("ordinates", PortType::Ordinates, "the beams, for principal_propagation")],
    params: &[
        ParamSpec::int("count", 32)
            .between(1.0, 1024.0)
            .soft(4.0, 128.0)
            .doc("How many ordinates an environment is split into."),
        ParamSpec::choice("method", &["uniform"]).doc("uniform: regions of even solid angle."),
    ],
};

fn run(run: &Run) -> Result<Vec<Value>, NodeError> {
    let mut light = Ordinates::default();
    for source in run.inputs.many::<Light>("lights") {
        match source {
            Light::Sun { direction, irradiance, angular_diameter_deg } => light.ordinates.push(Ordinate {
                direction: *direction,
                irradiance: *irradiance,
                // Mean cosine over the disk's cap.
                a0: 0.5 * (1.0 + (0.5 * angular_diameter_deg.to_radians()).cos()),
            }),
            Light::Point { .. } => {
                return Err(NodeError::new(
                    "lights takes suns, found a point light: wire it to spherical_propagation.lights",
                ));
            }
        }
    }
    if let Some(environment) = run.inputs.maybe::<Environment>("environment") {
        light.ambient = environment.minimum();
        let (ordinates, from_all_sides) = uniform::split(environment, run.params.i64("count") as usize);
        light.ordinates.extend(ordinates);
        for (ambient, radiance) in light.ambient.iter_mut().zip(from_all_sides) {
            *ambient += radiance;
        }
    }
    let bytes = (light.ordinates.len() * size_of::<Ordinate>()) as u64;
    Ok(vec![Value::new(PortType::Ordinates, bytes, light)])
}

#[cfg(test)]
mod tests;
