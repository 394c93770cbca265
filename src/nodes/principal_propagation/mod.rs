//! `principal_propagation`: parallel light through the medium (DESIGN 6.3).

use super::{NodeKind, Rules, Run, no_files, shadow, walk};
use std::sync::Arc;

use crate::geometry::Mesh;
use crate::gpu::Format;
use crate::graph::{Category, NodeError, NodeSpec, ParamSpec, PortSpec, PortType, Report, StageWork, Value};
use crate::light::{Ordinate, Ordinates};
use crate::planner::{self, DepthFacts, Depths};
use crate::wire::{AtlasLayout, Beam, Beams, LightField, Medium, Place, Surfaces};

mod aligned;
mod literal;
#[cfg(test)]
pub(super) mod oracle;
mod scan;
pub(super) mod widening;

pub(super) const KIND: NodeKind =
    NodeKind { spec: &SPEC, files: no_files, run, rules: Rules::Foretold(foretell) };

static SPEC: NodeSpec = NodeSpec {
    id: "principal_propagation",
    version: 2,
    category: Category::Transport,
    purpose: "Carries suns and principal ordinates through the medium.",
    doc: "For every ordinate the optical depth that its light has come through, at the corners of the medium's cells. \
          What scatters out of a beam is the residual's. Where g < 0 also the depth that is still before the light, for what \
          turns straight back and goes to and fro; not with surfaces. Behind surfaces there is no light.",
    inputs: &[
        PortSpec::new("medium", PortType::Medium, "what the light travels through"),
        PortSpec::new("ordinates", PortType::Ordinates, "the light"),
        shadow::SURFACES,
    ],
    outputs: &[PortSpec::new("beams", PortType::Beams, "the light in the medium")],
    params: &[
        ParamSpec::choice("scheme", &["auto", "scan", "walk", "literal"]).doc(
            "walk: from every corner to the light, exact but for its samples; scan: from slab to slab of the medium, each from the one \
             before, its cost independent of the way through the medium, shadows far behind what casts them soft by a cell; auto: scans \
             for light that stands for a wide region and has no sharp shadows, where they are cheaper, and walks for the rest. A \
             homogeneous shape needs neither: its depth is known. \
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

/// What is done with the light.
struct Plan {
    beams: Vec<Beam>,
    /// Whether their depths are looked up at all.
    is_carried: bool,
    depths: Depths,
    widens: bool,
    returns: bool,
    report: Report,
}

fn plan(run: &Run) -> Result<Plan, NodeError> {
    let medium: &Medium = run.inputs.one("medium");
    let light: &Ordinates = run.inputs.one("ordinates");
    let beams: Vec<Beam> = light
        .ordinates
        .iter()
        .map(|ordinate| Beam {
            place: Place::Parallel(medium.lattice.direction_in_index(ordinate.direction)),
            power: ordinate.irradiance,
            a0: ordinate.a0,
            window: ordinate.window,
            facing: None,
        })
        .collect();
    let powers: Vec<[f64; 3]> = beams.iter().map(|beam| beam.power).collect();
    let (is_carried, decision) = planner::beams(medium.albedo, &powers, run.prune);
    let mut decisions = vec![decision];
    let layout = AtlasLayout::new(run.gpu.max_texture_3d() as usize, &medium.lattice, beams.len());
    let of_beam = |(beam, ordinate): (&Beam, &Ordinate)| {
        (walk::samples(medium, std::slice::from_ref(beam)), ordinate.region.unwrap_or(ordinate.a0))
    };
    let of_beams: Vec<(f64, f64)> = beams.iter().zip(&light.ordinates).map(of_beam).collect();
    let facts = DepthFacts {
        asked: run.params.text("scheme"),
        is_closed: medium.homogeneous.is_some(),
        beams: &of_beams,
        fits: scan::fits(run, medium, layout),
        is_cpu: run.gpu.is_cpu(),
    };
    let (depths, decision) = planner::depths(facts, run.prune);
    let asks_for_widening = run.params.text("peak") == "widening";
    let (mut widens, mut returns) = (false, false);
    let mut stages: Vec<StageWork> = Vec::new();
    if is_carried {
        decisions.extend([planner::one_depth(beams.len()), decision]);
        if asks_for_widening {
            let (has_peak, decision) = planner::forward_peak(medium.g, true);
            widens = has_peak;
            decisions.push(decision);
        }
        if medium.g < 0.0 {
            let (comes_back, decision) =
                planner::backward_peak(medium.g, run.inputs.many::<Mesh>("surfaces").len());
            returns = comes_back;
            decisions.push(decision);
        }
        match &depths {
            Depths::Walk => stages.push(walk::work(medium, &beams)),
            Depths::Scan(which) => stages.extend(scan::work(medium, &beams, which, layout.pack)),
        }
        if returns {
            // The depths ahead as well.
            for stage in &mut stages {
                stage.runs *= 2;
                stage.moved_bytes = stage.moved_bytes.map(|bytes| 2 * bytes);
            }
        }
        stages.extend(widens.then_some(StageWork {
            stage: "widening",
            runs: beams.len(),
            moved_bytes: None,
        }));
        stages.extend(shadow::work(run, beams.len()));
    }
    let n_atlases = u64::from(is_carried) * (1 + u64::from(widens) + u64::from(returns));
    let report = Report {
        decisions,
        cells: Some(medium.lattice.dims),
        bytes: Some(n_atlases * layout.bytes()),
        stages,
        ..Report::default()
    };
    Ok(Plan { beams, is_carried, depths, widens, returns, report })
}

fn run(run: &Run) -> Result<Vec<Value>, NodeError> {
    let medium: &Medium = run.inputs.one("medium");
    let light: &Ordinates = run.inputs.one("ordinates");
    if is_literal(run)? {
        return literal_scheme(run, medium, light);
    }
    let Plan { beams, is_carried, depths, widens, returns, report } = plan(run)?;
    run.tell(report);
    let mut carried = Beams { ambient: light.ambient, ..Beams::new(&medium.lattice, beams) };
    if is_carried {
        let depths_of = |beams: &[Beam]| match &depths {
            Depths::Scan(which) => scan::scan(run, medium, beams, which),
            Depths::Walk => walk::walk(run, medium, beams),
        };
        let tau = depths_of(&carried.beams)?;
        if returns {
            let reversed: Vec<Beam> = carried.beams.iter().map(Beam::reversed).collect();
            carried.returns = true;
            carried.ahead = Some(depths_of(&reversed)?);
        }
        if widens {
            let surfaces = Surfaces::new(run.gpu, &medium.lattice, &run.inputs.many::<Mesh>("surfaces"))?;
            carried.widens = true;
            carried.peak = Some(widening::widen(run, medium, &carried.beams, &tau, &surfaces)?);
        }
        carried.has_shadows = shadow::cast(run, medium, &carried.beams, &tau)?;
        carried.tau = Some(tau);
    }
    let atlases = [&carried.tau, &carried.peak, &carried.ahead].into_iter().flatten();
    let bytes = atlases.map(|atlas| atlas.texture.bytes()).sum();
    Ok(vec![Value::new(PortType::Beams, bytes, carried)])
}

fn foretell(run: &Run) -> Result<Vec<Value>, NodeError> {
    let medium: &Medium = run.inputs.one("medium");
    let light: &Ordinates = run.inputs.one("ordinates");
    let mut beams = Beams { ambient: light.ambient, ..Beams::new(&medium.lattice, Vec::new()) };
    if is_literal(run)? {
        let (channels, report) = literal::plan(run, medium, light);
        run.tell(report);
        let nothing = run.gpu.texture3("light foretold", [1; 3], Format::Rgba32Float, "")?;
        beams.fields.push(LightField { moments: Arc::new(nothing), channels });
    } else {
        let plan = plan(run)?;
        run.tell(plan.report);
        beams.beams = plan.beams;
        beams.widens = plan.is_carried && plan.widens;
        beams.returns = plan.is_carried && plan.returns;
        beams.has_shadows = plan.is_carried && shadow::is_cast(run);
    }
    Ok(vec![Value::new(PortType::Beams, 0, beams)])
}

/// Whether the scheme without beams is asked for.
fn is_literal(run: &Run) -> Result<bool, NodeError> {
    if run.params.text("scheme") != "literal" {
        return Ok(false);
    }
    if run.params.text("peak") == "widening" {
        return Err(NodeError::new(
            "peak widening is for beams, and scheme literal has none: choose auto, scan or walk, or peak straight",
        ));
    }
    if !run.inputs.many::<Mesh>("surfaces").is_empty() {
        return Err(NodeError::new(
            "scheme literal knows no surfaces: choose auto, scan or walk, or disconnect surfaces",
        ));
    }
    Ok(true)
}

fn literal_scheme(run: &Run, medium: &Medium, light: &Ordinates) -> Result<Vec<Value>, NodeError> {
    let (channels, report) = literal::plan(run, medium, light);
    run.tell(report);
    let field = literal::propagate(run, medium, light, channels, run.params.i64("iterations") as usize)?;
    let bytes = field.moments.bytes();
    let beams =
        Beams { fields: vec![field], ambient: light.ambient, ..Beams::new(&medium.lattice, Vec::new()) };
    Ok(vec![Value::new(PortType::Beams, bytes, beams)])
}

#[cfg(test)]
mod tests;
