//! `spherical_propagation`: point lights through the medium (DESIGN 6.3, 6.7).

use super::{NodeKind, Rules, Run, no_files, shadow, walk};
use crate::graph::{Category, NodeError, NodeSpec, PortSpec, PortType, Report, Value};
use crate::light::Light;
use crate::planner;
use crate::wire::{AtlasLayout, Beam, Beams, Medium, Place};

#[cfg(test)]
pub(super) mod oracle;

pub(super) const KIND: NodeKind =
    NodeKind { spec: &SPEC, files: no_files, run, rules: Rules::Foretold(foretell) };

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

/// The beams, whether their depths are looked up at all, and what there is to say.
fn plan(run: &Run) -> Result<(Vec<Beam>, bool, Report), NodeError> {
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
    let powers: Vec<[f64; 3]> = beams.iter().map(|beam| beam.power).collect();
    let (is_carried, decision) = planner::beams(medium.albedo, &powers, run.prune);
    let mut report = Report {
        decisions: vec![decision],
        cells: Some(medium.lattice.dims),
        bytes: Some(0),
        ..Report::default()
    };
    if is_carried {
        report.decisions.push(planner::one_depth(beams.len()));
        report.stages.push(walk::work(medium, &beams));
        report.stages.extend(shadow::work(run, beams.len()));
        let layout = AtlasLayout::new(run.gpu.max_texture_3d() as usize, &medium.lattice, beams.len());
        report.bytes = Some(layout.bytes());
    }
    Ok((beams, is_carried, report))
}

fn run(run: &Run) -> Result<Vec<Value>, NodeError> {
    let medium: &Medium = run.inputs.one("medium");
    let (beams, is_carried, report) = plan(run)?;
    run.tell(report);
    let mut carried = Beams::new(&medium.lattice, beams);
    if is_carried {
        let tau = walk::walk(run, medium, &carried.beams)?;
        carried.has_shadows = shadow::cast(run, medium, &carried.beams, &tau)?;
        carried.tau = Some(tau);
    }
    let bytes = carried.tau.as_ref().map_or(0, |tau| tau.texture.bytes());
    Ok(vec![Value::new(PortType::Beams, bytes, carried)])
}

fn foretell(run: &Run) -> Result<Vec<Value>, NodeError> {
    let medium: &Medium = run.inputs.one("medium");
    let (beams, is_carried, report) = plan(run)?;
    run.tell(report);
    let has_shadows = is_carried && shadow::is_cast(run);
    let beams = Beams { has_shadows, ..Beams::new(&medium.lattice, beams) };
    Ok(vec![Value::new(PortType::Beams, 0, beams)])
}
