//! `isotropic_residual`: light that has lost its direction, as one lobe a cell (DESIGN 6.4).
//!
//! What beams lose to scattering, less the forward peak that delta scaling leaves in them, is the source
//! of a transport problem on the medium's grid. It is solved by line-exact sweeps: in a cubic grid the
//! line through a cell's center along an integer vector meets other centers, so each line is one thread,
//! positive and conservative. A cascade of grids, from 8 cells up, carries the coarse solution to the
//! fine one; after each sweep one factor a channel restores the balance of power.
//!
//! Emission is a source like what beams lose, of all directions alike.
//!
//! Inputs: a medium and its beams. Output: phi and F [W/m²] a cell and channel. Held against the f64
//! oracle beside it, the slabs of adding–doubling, and the invariants of DESIGN 8.

use super::{NodeKind, Run, beams_through, no_files};
use crate::geometry::Mesh;
use crate::graph::{Category, NodeError, NodeSpec, ParamSpec, PortSpec, PortType, Value};
use crate::optics::directions::LineSet;
use crate::wire::{Channels, Medium, Surfaces};

mod bounce;
mod fields;
mod level;
#[cfg(test)]
pub(super) mod oracle;
mod solver;
mod sources;
mod thick;

pub(super) const KIND: NodeKind = NodeKind { spec: &SPEC, files: no_files, run };

static SPEC: NodeSpec = NodeSpec {
    id: "isotropic_residual",
    version: 1,
    category: Category::Transport,
    purpose: "Multiple scattering: light that has lost its direction, as one lobe a cell.",
    doc: "Solves for all light that has been scattered out of the beams or is emitted, by sweeps along lines of the grid from coarse to fine. \
          One channel where the medium is grey and all light has one color, three otherwise. Surfaces are lit by beams, by the \
          medium and by each other, hide ambient light, and send light back, twice; scattered light passes through those inside.",
    inputs: &[
        PortSpec::new("medium", PortType::Medium, "where the light scatters"),
        PortSpec::new("beams", PortType::Beams, "the light that enters; without it, only what the medium emits").many().optional(),
        PortSpec::new("surfaces", PortType::Surface, "what sends light back into the medium").many().optional(),
    ],
    outputs: &[PortSpec::new("residual", PortType::Residual, "the scattered light, for raymarch")],
    params: &[
        ParamSpec::choice("quality", &["default", "draft", "fast", "thick", "reference"]).doc(
            "Sweeps: draft 1 on the finest grid and 4 on coarser ones, along 8 directions; fast 1 and 8; default 4 and 16; thick: \
             V-cycles, for media that are both deep and white; reference: until the field changes by less than 1e-5.",
        ),
        ParamSpec::int_choice("directions", &DIRECTIONS).doc("Directions of the lines; 0 lets the quality choose."),
        ParamSpec::int("sweeps", 0).between(0.0, 10000.0).soft(0.0, 64.0).doc("Sweeps on the finest grid; 0 lets the quality choose. Not for thick."),
        ParamSpec::int("coarse_sweeps", 0).between(0.0, 10000.0).soft(0.0, 64.0).doc("Sweeps on each coarser grid; 0 lets the quality choose. Not for thick."),
    ],
};

/// 0, and the sets of lines that there are.
const DIRECTIONS: [i64; 1 + LineSet::ALL.len()] = {
    let mut counts = [0; 1 + LineSet::ALL.len()];
    let mut idx = 0;
    while idx < LineSet::ALL.len() {
        counts[idx + 1] = LineSet::ALL[idx].count() as i64;
        idx += 1;
    }
    counts
};

/// How much work the cascade does.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Effort {
    lines: LineSet,
    sweeps: usize,
    coarse_sweeps: usize,
    kind: Kind,
}

#[derive(Debug, Clone, Copy, PartialEq)]
enum Kind {
    /// A fixed number of sweeps on each level.
    Cascade,
    /// V-cycles on each level.
    Thick,
    /// The cascade, and then sweeps until nothing changes.
    Reference,
}

fn effort(run: &Run) -> Result<Effort, NodeError> {
    let (sweeps, coarse_sweeps, directions, kind) = match run.params.text("quality") {
        "draft" => (1, 4, 8, Kind::Cascade),
        "fast" => (1, 8, 14, Kind::Cascade),
        "thick" => (4, 16, 14, Kind::Thick),
        "reference" => (4, 16, 14, Kind::Reference),
        _ => (4, 16, 14, Kind::Cascade),
    };
    let or = |name: &str, chosen: usize| match run.params.i64(name) {
        0 => chosen,
        asked => asked as usize,
    };
    let given = ["sweeps", "coarse_sweeps"].into_iter().find(|name| run.params.i64(name) > 0);
    if let (Kind::Thick, Some(name)) = (kind, given) {
        return Err(NodeError::new(format!(
            "{name} = {}: quality thick has V-cycles of its own, leave it at 0 or choose another quality",
            run.params.i64(name)
        )));
    }
    let lines = LineSet::from_count(or("directions", directions)).expect("a choice of the parameter");
    Ok(Effort {
        lines,
        sweeps: or("sweeps", sweeps),
        coarse_sweeps: or("coarse_sweeps", coarse_sweeps),
        kind,
    })
}

fn run(run: &Run) -> Result<Vec<Value>, NodeError> {
    let medium: &Medium = run.inputs.one("medium");
    let effort = effort(run)?;
    let beams = beams_through(run, medium)?;
    let meshes = run.inputs.many::<Mesh>("surfaces");
    let is_grey = |mesh: &&Mesh| mesh.reflectance.iter().all(|share| *share == mesh.reflectance[0]);
    let channels = match Channels::of(medium, &beams) {
        channels if meshes.iter().all(is_grey) => channels,
        _ => Channels::RGB,
    };
    let problem = level::Problem::new(medium, &channels, beams.ambient, effort.lines);
    let surfaces = Surfaces::new(run.gpu, &medium.lattice, &meshes)?;
    if !surfaces.is_empty() && !beams.fields.is_empty() {
        return Err(NodeError::new(
            "surfaces are lit by beams, and principal_propagation's scheme literal has none: choose another scheme, \
             or disconnect surfaces",
        ));
    }
    let residual = if surfaces.is_empty() {
        let sources = sources::sources(run, medium, &beams, &channels, &problem)?;
        solver::solve(run, medium, &sources, &problem, effort, channels, level::BATCH_BYTES)?
    } else {
        bounce::solve(run, medium, &beams, &surfaces, &problem, effort, channels)?
    };
    let residual = beams.fields.iter().try_fold(residual, |sum, field| fields::add(run, sum, field))?;
    let bytes = residual.moments.bytes() + residual.surface_light.as_ref().map_or(0, |light| light.bytes());
    Ok(vec![Value::new(PortType::Residual, bytes, residual)])
}

#[cfg(test)]
mod tests;
