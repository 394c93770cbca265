//! `light_decomposition`: all light from afar as principal ordinates.

use super::{NodeKind, Run, no_files};
use crate::graph::{Category, NodeError, NodeSpec, ParamSpec, PortSpec, PortType, Value};
use crate::light::environment::Environment;
use crate::light::{Light, Ordinate, Ordinates};
use crate::wire::Importance;

mod median_cut;
mod region;
mod summed_area;
mod uniform;

pub(super) const KIND: NodeKind = NodeKind { spec: &SPEC, files: no_files, run };

static SPEC: NodeSpec = NodeSpec {
    id: "light_decomposition",
    version: 2,
    category: Category::Light,
    purpose: "Splits all light from afar into principal ordinates.",
    doc: "Suns pass through as they are. Of an environment, the constant part (its minimum over all directions, per channel) \
          becomes ambient light, which needs no beams; the rest is split into regions, each a beam with the region's irradiance \
          and its mean direction. How wide a region is counts where prefilter says so.",
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
        PortSpec::new(
            "importance",
            PortType::Importance,
            "where light matters to the picture: there median_cut makes smaller regions; without it all light counts alike",
        )
        .optional(),
    ],
    outputs: &[PortSpec::new("ordinates", PortType::Ordinates, "the beams, for principal_propagation")],
    params: &[
        ParamSpec::int("count", 32)
            .between(1.0, 1024.0)
            .soft(4.0, 128.0)
            .doc("How many ordinates an environment is split into."),
        ParamSpec::choice("method", &["median_cut", "uniform"]).doc(
            "median_cut: regions of even luminance times importance; uniform: regions of even solid angle.",
        ),
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
                region: None,
                window: None,
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
        let count = run.params.i64("count") as usize;
        let (ordinates, from_all_sides) = match run.params.text("method") {
            "uniform" => uniform::split(environment, count),
            _ => {
                let importance = run.inputs.maybe::<Importance>("importance");
                median_cut::split(environment, count, importance.map(|importance| &importance.light))
            }
        };
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
