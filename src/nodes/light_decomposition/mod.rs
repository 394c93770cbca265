//! `light_decomposition`: all light from afar as principal ordinates.

use std::sync::Arc;

use super::{NodeKind, Rules, Run, no_files};
use crate::graph::{Category, NodeError, NodeSpec, ParamSpec, PortSpec, PortType, Report, Value};
use crate::light::environment::{Environment, Map};
use crate::light::{Light, Ordinate, Ordinates};
use crate::planner;
use crate::wire::Importance;

use region::Excess;

mod median_cut;
mod region;
mod summed_area;
mod uniform;

pub(super) const KIND: NodeKind = NodeKind { spec: &SPEC, files: no_files, run, rules: Rules::Cheap };

static SPEC: NodeSpec = NodeSpec {
    id: "light_decomposition",
    version: 2,
    category: Category::Light,
    purpose: "Splits all light from afar into principal ordinates.",
    doc: "Suns pass through as they are. Of an environment, the constant part (its minimum over all directions, per channel) \
          becomes ambient light, which needs no beams; the rest is split into regions, each a beam with the region's irradiance \
          and its mean direction. How wide a region is counts where prefilter says so.",
    inputs: &[
        PortSpec::new("environment", PortType::Environment, "light from all directions")
            .optional("there are only suns"),
        PortSpec::new("lights", PortType::Light, "suns").many().optional("there is only the environment"),
        PortSpec::new(
            "importance",
            PortType::Importance,
            "where light matters to the picture: there median_cut makes smaller regions",
        )
        .optional("all light counts alike"),
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
        let least = environment.minimum();
        let is_constant = matches!(environment, Environment::Constant(_));
        let (flows_in, decision) = planner::constant_light(least, is_constant, run.prune);
        run.tell(Report { decisions: vec![decision], ..Report::default() });
        let ambient = if flows_in { least } else { [0.0; 3] };
        let map = match environment {
            Environment::Map(map) => Some(map.clone()),
            Environment::Constant(_) if flows_in => None,
            Environment::Constant(radiance) => Some(even_map(*radiance)),
        };
        let (ordinates, from_all_sides) = map.map_or_else(Default::default, |map| split(run, &map, ambient));
        light.ordinates.extend(ordinates);
        light.ambient = std::array::from_fn(|c| ambient[c] + from_all_sides[c]);
    }
    let bytes = (light.ordinates.len() * size_of::<Ordinate>()) as u64;
    Ok(vec![Value::new(PortType::Ordinates, bytes, light)])
}

/// What a map has beyond `ambient` as ordinates, and the radiance of what has no direction.
fn split(run: &Run, map: &Map, ambient: [f64; 3]) -> (Vec<Ordinate>, [f64; 3]) {
    let excess = Excess::new(map, ambient);
    let count = run.params.i64("count") as usize;
    match run.params.text("method") {
        "uniform" => uniform::split(&excess, count),
        _ => {
            let importance = run.inputs.maybe::<Importance>("importance");
            median_cut::split(&excess, count, importance.map(|importance| &importance.light))
        }
    }
}

/// A map that is the same everywhere, for who wants ordinates of it.
fn even_map(radiance: [f64; 3]) -> Map {
    let (width, height) = (128, 64);
    let texels = Arc::new(vec![radiance.map(|l| l as f32); width * height]);
    Map { width, height, texels, scale: 1.0, rotate_y: 0.0, stack: None }
}

#[cfg(test)]
mod tests;
