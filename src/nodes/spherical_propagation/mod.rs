//! `spherical_propagation`: point lights through the medium (DESIGN 6.3, 6.7).

use super::{NodeKind, Run, no_files, shadow, walk};
use crate::graph::{Category, NodeError, NodeSpec, PortSpec, PortType, Value};
use crate::light::Light;
use crate::wire::{Beam, Beams, Medium, Place};

#[cfg(test)]
pub(super) mod oracle;

pub(super) const KIND: NodeKind = NodeKind { spec: &SPEC, files: no_files, run };

static SPEC: NodeSpec = NodeSpec {
    id: "spherical_propagation",
    version: 1,
    category: Category::Transport,
    purpose: "Carries point lights through the medium.",
    doc: "For every light the optical depth from it to the corners of the medium's cells, walked exactly. \
          What scatters out of the light's rays is the residual's. Behind surfaces there is no light.",
    inputs: &[
        PortSpec::new("medium", PortType::Medium, "what the light travels through"),
        PortSpec::new("lights", PortType::Light, "point lights").many(),
        shadow::SURFACES,
    ],
    outputs: &[PortSpec::new("beams", PortType::Beams, "the light in the medium")],
    params: &[],
};

fn run(run: &Run) -> Result<Vec<Value>, NodeError> {
    let medium: &Medium = run.inputs.one("medium");
    let index_from_world = medium.lattice.index_from_world();
    let beams = run
        .inputs
        .many::<Light>("lights")
        .into_iter()
        .map(|light| match light {
            Light::Point { position, intensity } => Ok(Beam {
                place: Place::Point(index_from_world.transform_point3(*position)),
                power: *intensity,
                a0: 1.0,
                window: None,
            }),
            Light::Sun { .. } => Err(NodeError::new(
                "lights takes point lights, found a sun: wire the sun to light_decomposition.lights",
            )),
        })
        .collect::<Result<Vec<Beam>, NodeError>>()?;
    let tau = walk::walk(run, medium, &beams)?;
    let has_shadows = shadow::cast(run, medium, &beams, &tau)?;
    let bytes = tau.texture.bytes();
    Ok(vec![Value::new(
        PortType::Beams,
        bytes,
        Beams {
            beams,
            tau,
            ambient: [0.0; 3],
            lattice: medium.lattice.clone(),
            has_shadows,
            peak: None,
            fields: Vec::new(),
        },
    )])
}
