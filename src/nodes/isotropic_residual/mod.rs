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

use std::sync::Arc;

use super::{NodeKind, Rules, Run, beams_through, check_media, no_files};
use crate::geometry::Mesh;
use crate::gpu::Format;
use crate::graph::{Category, NodeError, NodeSpec, ParamSpec, PortSpec, PortType, Value};
use crate::optics::directions::LineSet;
use crate::planner::Scattering;
use crate::wire::{Beams, Channels, Medium, Residual, Surfaces};
use plan::Plan;

mod bounce;
mod fields;
mod level;
#[cfg(test)]
pub(super) mod oracle;
mod plan;
mod radial;
mod solver;
mod sources;
mod thick;
mod walls;

pub(super) const KIND: NodeKind =
    NodeKind { spec: &SPEC, files: no_files, run, rules: Rules::Foretold(foretell) };

static SPEC: NodeSpec = NodeSpec {
    id: "isotropic_residual",
    version: 2,
    category: Category::Transport,
    purpose: "Multiple scattering: light that has lost its direction, as one lobe a cell.",
    doc: "Solves for all light that has been scattered out of the beams or is emitted, by sweeps along lines of the grid from coarse to fine. \
          One channel where the medium is grey and all light has one color, three otherwise. Surfaces are lit by beams, by the \
          medium and by each other, hide ambient light, stop scattered light, and send light back, twice.",
    inputs: &[
        PortSpec::new("medium", PortType::Medium, "where the light scatters"),
        PortSpec::new("beams", PortType::Beams, "the light that enters").many().optional("there is only what the medium emits"),
        PortSpec::new("surfaces", PortType::Surface, "what sends light back into the medium").many().optional("nothing sends light back"),
    ],
    outputs: &[PortSpec::new("residual", PortType::Residual, "the scattered light, for raymarch")],
    params: &[
        ParamSpec::choice("quality", &["default", "draft", "fast", "thick", "reference"]).doc(
            "Sweeps: draft 1 on the finest grid and 4 on coarser ones, along 8 directions; fast 1 and 8; default 4 and 16; thick: \
             V-cycles, for media that are both deep and white; reference: until the field changes by less than 1e-5.",
        ),
        ParamSpec::int_choice("directions", &DIRECTIONS).doc("Directions of the lines; 0 lets the quality and the scene choose."),
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
    /// The finest grid that is swept, 0 the medium's own; finer ones get what comes from there.
    first: usize,
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

impl Effort {
    /// Sweeps of a cascade's grid, of so many with the finest first.
    fn sweeps_on(&self, idx: usize, n_grids: usize) -> usize {
        if idx < self.first.min(n_grids - 1) {
            0
        } else if idx > 0 || n_grids == 1 {
            self.coarse_sweeps
        } else {
            self.sweeps
        }
    }

    /// Enough for what only lights surfaces: that need not be as good as what is seen, and of a cascade all
    /// grids but the two finest are solved, at a tenth of the cost.
    fn rough(self) -> Self {
        match self.kind {
            Kind::Cascade => Self { first: 2, coarse_sweeps: self.coarse_sweeps.min(8), ..self },
            _ => self,
        }
    }
}

fn run(run: &Run) -> Result<Vec<Value>, NodeError> {
    let medium: &Medium = run.inputs.one("medium");
    let beams = beams_through(run, medium)?;
    let Plan { effort, channels, scattering, has_lobes, report } = plan::plan(run)?;
    run.tell(report);
    let residual = match scattering {
        Scattering::Solved => solve(run, medium, &beams, effort, channels, has_lobes)?,
        Scattering::Even(phi) => even(run, medium, channels, phi)?,
        Scattering::None => Residual { is_dark: true, ..even(run, medium, channels, [0.0; 3])? },
    };
    let bytes = residual.moments.bytes() + residual.surface_light.as_ref().map_or(0, |light| light.bytes());
    Ok(vec![Value::new(PortType::Residual, bytes, residual)])
}

fn foretell(run: &Run) -> Result<Vec<Value>, NodeError> {
    let medium: &Medium = run.inputs.one("medium");
    check_media(run, medium)?;
    let Plan { channels, scattering, report, .. } = plan::plan(run)?;
    run.tell(report);
    let is_dark = scattering == Scattering::None;
    let residual = Residual { is_dark, ..even(run, medium, channels, [0.0; 3])? };
    Ok(vec![Value::new(PortType::Residual, 0, residual)])
}

/// The residual of the same fluence everywhere.
fn even(run: &Run, medium: &Medium, channels: Channels, phi: [f64; 3]) -> Result<Residual, NodeError> {
    let texels: Vec<[f32; 4]> =
        channels.project(phi)[..channels.count].iter().map(|phi| [*phi as f32, 0.0, 0.0, 0.0]).collect();
    let dims = [1, 1, channels.count];
    let moments = run.gpu.texture3_from("moments", dims, Format::Rgba32Float, &texels, "")?;
    Ok(Residual {
        moments: Arc::new(moments),
        is_dark: false,
        lattice: medium.lattice.clone(),
        channels,
        balance: [1.0; 3],
        surface_light: None,
    })
}

fn solve(
    run: &Run,
    medium: &Medium,
    beams: &Beams,
    effort: Effort,
    channels: Channels,
    has_lobes: bool,
) -> Result<Residual, NodeError> {
    let problem = level::Problem::new(medium, &channels, beams.ambient, effort.lines, has_lobes);
    let surfaces = Surfaces::new(run.gpu, &medium.lattice, &run.inputs.many::<Mesh>("surfaces"))?;
    let residual = if surfaces.is_empty() {
        let sources = sources::sources(run, medium, beams, &channels, &problem)?;
        solver::solve(run, medium, &sources, &problem, effort, channels, level::BATCH_BYTES)?
    } else {
        let problem = problem.behind(run.gpu, &surfaces, &solver::grids(medium.lattice.dims))?;
        bounce::solve(run, medium, beams, &surfaces, &problem, effort, channels)?
    };
    beams.fields.iter().try_fold(residual, |sum, field| fields::add(run, sum, field))
}

#[cfg(test)]
mod tests;
