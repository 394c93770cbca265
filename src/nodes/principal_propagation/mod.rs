//! `principal_propagation`: parallel light through the medium (DESIGN 6.3).

use super::{NodeKind, Run, no_files, shadow, walk};
use crate::geometry::Mesh;
use crate::graph::{Category, NodeError, NodeSpec, ParamSpec, PortSpec, PortType, Value};
use crate::light::Ordinates;
use crate::wire::{Beam, Beams, Medium, Place, Surfaces};

mod aligned;
mod literal;
#[cfg(test)]
pub(super) mod oracle;
mod scan;
pub(super) mod widening;

pub(super) const KIND: NodeKind = NodeKind { spec: &SPEC, files: no_files, run };

static SPEC: NodeSpec = NodeSpec {
    id: "principal_propagation",
    version: 1,
    category: Category::Transport,
    purpose: "Carries suns and principal ordinates through the medium.",
    doc: "For every ordinate the optical depth that its light has come through, at the corners of the medium's cells. \
          What scatters out of a beam is the residual's. Behind surfaces there is no light.",
    inputs: &[
        PortSpec::new("medium", PortType::Medium, "what the light travels through"),
        PortSpec::new("ordinates", PortType::Ordinates, "the light"),
        shadow::SURFACES,
    ],
    outputs: &[PortSpec::new("beams", PortType::Beams, "the light in the medium")],
    params: &[
        ParamSpec::choice("scheme", &["auto", "scan", "walk", "literal"]).doc(
            "walk: from every corner to the light, exact but for its samples; scan: running sums along lines that follow the beam, \
             its cost independent of the way through the medium; auto: the cheaper one. A homogeneous shape needs neither: its depth is known. \
             literal: the seed paper's own scheme, for comparison: a lobe a cell hops from neighbor to neighbor on a grid for each \
             ordinate; the light of all ordinates reaches the camera through isotropic_residual. It does not converge, and knows no surfaces.",
        ),
        ParamSpec::int("iterations", 0).between(0.0, 100_000.0).soft(0.0, 1024.0).doc(
            "Hops of scheme literal; 0: as many as the grid of an ordinate has cells along its longest axis.",
        ),
        ParamSpec::choice("peak", &["straight", "widening"]).doc(
            "widening: light that is scattered forward by little spreads across its beam as it goes, at several times the cost: for \
             narrow beams, windows and the edges of shadows. Wide light hardly changes.",
        ),
    ],
};

/// A scan costs as much as a walk of so many samples a corner (measured on 112 x 96 x 128 cells, where a
/// walk of 77 takes 0.6 of the scan's time).
const SAMPLES_OF_A_SCAN: f64 = 125.0;

fn run(run: &Run) -> Result<Vec<Value>, NodeError> {
    let medium: &Medium = run.inputs.one("medium");
    let light: &Ordinates = run.inputs.one("ordinates");
    let widens = run.params.text("peak") == "widening";
    if run.params.text("scheme") == "literal" {
        if widens {
            return Err(NodeError::new(
                "peak widening is for beams, and scheme literal has none: choose auto, scan or walk, or peak straight",
            ));
        }
        return literal_scheme(run, medium, light);
    }
    let beams: Vec<Beam> = light
        .ordinates
        .iter()
        .map(|ordinate| Beam {
            place: Place::Parallel(medium.lattice.direction_in_index(ordinate.direction)),
            power: ordinate.irradiance,
            a0: ordinate.a0,
            window: ordinate.window,
        })
        .collect();
    let scans = match run.params.text("scheme") {
        "scan" => true,
        "walk" => false,
        // The scan's lines stand half a cell apart: the device must hold twice the cells along an axis.
        _ => {
            let lines = 2 * medium.lattice.dims.into_iter().max().unwrap_or(0) + 3;
            scan::samples_of_a_walk(medium, &beams) > SAMPLES_OF_A_SCAN
                && lines <= run.gpu.max_texture_3d() as usize
        }
    };
    // A shape in closed form needs no samples at all.
    let tau = if scans && medium.homogeneous.is_none() {
        scan::scan(run, medium, &beams)?
    } else {
        walk::walk(run, medium, &beams)?
    };
    let peak = if widens && medium.g > 0.0 {
        let surfaces = Surfaces::new(run.gpu, &medium.lattice, &run.inputs.many::<Mesh>("surfaces"))?;
        Some(widening::widen(run, medium, &beams, &tau, &surfaces)?)
    } else {
        None
    };
    let has_shadows = shadow::cast(run, medium, &beams, &tau)?;
    let bytes = tau.texture.bytes() + peak.as_ref().map_or(0, |peak| peak.texture.bytes());
    Ok(vec![Value::new(
        PortType::Beams,
        bytes,
        Beams {
            beams,
            tau,
            ambient: light.ambient,
            lattice: medium.lattice.clone(),
            has_shadows,
            peak,
            fields: Vec::new(),
        },
    )])
}

fn literal_scheme(run: &Run, medium: &Medium, light: &Ordinates) -> Result<Vec<Value>, NodeError> {
    if !run.inputs.many::<Mesh>("surfaces").is_empty() {
        return Err(NodeError::new(
            "scheme literal knows no surfaces: choose auto, scan or walk, or disconnect surfaces",
        ));
    }
    let field = literal::propagate(run, medium, light, run.params.i64("iterations") as usize)?;
    let bytes = field.moments.bytes();
    let none = Beams::none(run.gpu, &medium.lattice)?;
    let beams = Beams { fields: vec![field], ambient: light.ambient, ..none };
    Ok(vec![Value::new(PortType::Beams, bytes, beams)])
}
