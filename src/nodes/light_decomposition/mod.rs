//! `light_decomposition`: all light from afar as principal ordinates.
//!
//! Where the camera moves, a cut by its importance is another in every frame, and what is lit flickers. So
//! over frames the cut is made only every `recut_frames`, and between two of them the ordinates of both are
//! there, the light going over from one to the other (DESIGN 6.6): irradiance and fluence stay those of the
//! map, at up to twice `count` ordinates. A cloud of g 0.9 with 16 ordinates, the camera moving by 1.5 degrees a
//! frame, flickers by 2.0e-4 instead of 1.4e-3 under the sky of `data` (`tests/flicker.rs`, which says how that is
//! measured). Of the light of its ordinates alone, what is scattered by less than 30 degrees left out, it was 1.1e-4
//! instead of 3.1e-3, and 1.5e-4, 1.8e-4 and 4.7e-4 instead of 2.8e-3, 1.0e-2 and 9.5e-3 under three skies more.

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
    version: 4,
    category: Category::Light,
    purpose: "Splits all light from afar into principal ordinates.",
    doc: "Suns pass through as they are, and so do those in a map: small, over 100 times as bright as its mean, and over \
          1/32 of its light. Of an environment, the constant part (its minimum over all directions, per channel) becomes \
          ambient light, which needs no beams; the rest is split into regions, each a beam with the region's irradiance \
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
        .optional("all light counts alike")
        .faded_by("recut_frames"),
    ],
    outputs: &[PortSpec::new("ordinates", PortType::Ordinates, "the beams, for principal_propagation")],
    params: &[
        ParamSpec::int("count", 32)
            .between(1.0, 1024.0)
            .soft(4.0, 128.0)
            .doc("How many ordinates an environment is split into, its suns among them; one at least beside them."),
        ParamSpec::choice("method", &["median_cut", "uniform"]).doc(
            "median_cut: regions of even luminance times importance; uniform: regions of even solid angle.",
        ),
        ParamSpec::int("recut_frames", 8).between(0.0, 10_000.0).soft(0.0, 48.0).doc(
            "Over frames, importance is looked at only every so many, and one split fades into the next, so that a \
             camera that moves makes no flicker; takes up to twice `count` ordinates. 0 or 1: a split of its own for each frame.",
        ),
    ],
};

fn run(run: &Run) -> Result<Vec<Value>, NodeError> {
    let mut light = Ordinates::default();
    for source in run.inputs.many::<Vec<Light>>("lights").into_iter().flatten() {
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
            Light::Surface { .. } => {
                return Err(NodeError::new(
                    "lights takes suns, found light of surfaces: wire bounce_lights to spherical_propagation.lights",
                ));
            }
        }
    }
    if let Some(environment) = run.inputs.maybe::<Environment>("environment") {
        let least = environment.minimum();
        let is_constant = matches!(environment, Environment::Constant(_));
        let (flows_in, decision) = planner::constant_light(least, is_constant, run.prune);
        run.tell(Report { decisions: vec![decision], ..Report::default() });
        light.ambient = if flows_in { least } else { [0.0; 3] };
        let map = match environment {
            Environment::Map(map) => Some(map.clone()),
            Environment::Constant(_) if flows_in => None,
            Environment::Constant(radiance) => Some(even_map(*radiance)),
        };
        let splits = map.map_or_else(Vec::new, |map| {
            let mut excess = Excess::new(&map, light.ambient);
            let suns = excess.take_suns();
            light.n_regions = (run.params.i64("count") as usize).saturating_sub(suns.len()).max(1);
            let splits = split(run, &excess, light.n_regions);
            light.ordinates.extend(suns);
            splits
        });
        for ((ordinates, from_all_sides), share) in splits {
            light.ordinates.extend(
                ordinates.into_iter().map(|ordinate| Ordinate {
                    irradiance: ordinate.irradiance.map(|e| share * e),
                    ..ordinate
                }),
            );
            for (ambient, radiance) in light.ambient.iter_mut().zip(from_all_sides) {
                *ambient += share * radiance;
            }
        }
    }
    let bytes = (light.ordinates.len() * size_of::<Ordinate>()) as u64;
    Ok(vec![Value::new(PortType::Ordinates, bytes, light)])
}

/// The ordinates of a map, and the radiance of what has no direction.
type Cut = (Vec<Ordinate>, [f64; 3]);

/// A map without its suns as ordinates: each cut that fades, with its share.
fn split(run: &Run, excess: &Excess, count: usize) -> Vec<(Cut, f64)> {
    let by_importance = || run.inputs.faded::<Importance>("importance").into_iter();
    match run.params.text("method") {
        "uniform" => vec![(uniform::split(excess, count), 1.0)],
        _ if by_importance().next().is_none() => vec![(median_cut::split(excess, count, None), 1.0)],
        _ => by_importance()
            .map(|(by, share)| (median_cut::split(excess, count, Some(&by.light)), share))
            .collect(),
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
