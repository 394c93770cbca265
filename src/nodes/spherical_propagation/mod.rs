//! `spherical_propagation`: point lights through the medium (DESIGN 6.3, 6.7).
//!
//! Few lights are walked to from every corner of every cell, exactly; many have a grid of distance and direction
//! each (`wire/radial.rs`), all of them filled by one dispatch. Which, is `planner::spherical`'s to say.
//! Depths at corners take 2 bytes a corner and light (4 of one or two lights), grids 128 MiB at most where their
//! resolution is chosen: 256 lights among 64³ cells take 117 MiB, where corners would take 134, among 128³ cells
//! still 117, where corners would take 1,048.
//!
//! Inputs: a medium, lights, surfaces. Output: beams with depths of either kind. Limits: a grid blurs what is
//! finer than its directions, shadows too. Held against the f64 oracle beside it, closed forms, and the walk.

use std::sync::Arc;

use glam::DVec3;

use super::{NodeKind, Rules, Run, no_files, shadow, walk};
use crate::geometry::Mesh;
use crate::gpu::Bind;
use crate::graph::{Category, NodeError, NodeSpec, ParamSpec, PortSpec, PortType, Report, StageWork, Value};
use crate::light::Light;
use crate::mirror;
use crate::planner::{self, Points, Spherical};
use crate::wire::{
    AtlasLayout, Beam, Beams, Fineness, Medium, Place, RadialGrids, ShapeTexel, Spacing, Surfaces,
};

#[cfg(test)]
pub(super) mod oracle;

pub(super) const KIND: NodeKind =
    NodeKind { spec: &SPEC, files: no_files, run, rules: Rules::Foretold(foretell) };

static SPEC: NodeSpec = NodeSpec {
    id: "spherical_propagation",
    version: 2,
    category: Category::Transport,
    purpose: "Carries point lights through the medium.",
    doc: "For every light the optical depth from it to the medium: walked exactly to the corners of all cells where \
          lights are few, on a grid of distance and direction around each light where they are many. \
          What scatters out of the light's rays is the residual's. Behind surfaces there is no light.",
    inputs: &[
        PortSpec::new("medium", PortType::Medium, "what the light travels through"),
        PortSpec::new("lights", PortType::Light, "point lights, and those of bounce_lights").many(),
        shadow::SURFACES,
    ],
    outputs: &[PortSpec::new("beams", PortType::Beams, "the light in the medium")],
    params: &[
        ParamSpec::choice("scheme", &["auto", "walk", "radial"]).doc(
            "walk: from every corner of a cell to every light, exact but for its samples; radial: a grid around each light, \
             whose cost does not depend on the medium's cells; auto: walks while they cost little time and memory.",
        ),
        ParamSpec::int("radial", 0).between(0.0, 512.0).soft(0.0, 128.0).doc(
            "Distances of a light's grid, at least 3; 0: chosen. Among the matter they stand ever further apart, else evenly.",
        ),
        ParamSpec::int("angular", 0).between(0.0, 1024.0).soft(0.0, 128.0).doc(
            "Directions along an edge of a light's grid, which has this number squared: of a light outside of the medium \
             only those towards it; 0: chosen.",
        ),
    ],
};

mirror! {
    /// `RadialParams` of `shaders/spherical_propagation/radial.wgsl`.
    pub(super) struct RadialParams {
        shape: ShapeTexel,
        n_lights: u32,
        n_angular: u32,
        cell_m: f32,
        pad: u32,
    }
}

/// What is done with the lights.
struct Plan {
    beams: Vec<Beam>,
    /// Whether their depths are looked up at all.
    is_carried: bool,
    scheme: Spherical,
    report: Report,
}

fn plan(run: &Run) -> Result<Plan, NodeError> {
    let medium: &Medium = run.inputs.one("medium");
    let lights = run.inputs.many::<Vec<Light>>("lights");
    let beams = lights
        .into_iter()
        .flatten()
        .map(|light| beam(medium, light))
        .collect::<Result<Vec<Beam>, NodeError>>()?;
    let powers: Vec<[f64; 3]> = beams.iter().map(|beam| beam.power).collect();
    let (is_carried, decision) = planner::beams(medium.albedo, &powers, run.prune);
    let layout = AtlasLayout::new(run.gpu.max_texture_3d() as usize, &medium.lattice, beams.len());
    let (scheme, of_scheme) = planner::spherical(points(run, medium, &beams, layout.bytes())?, run.prune)
        .map_err(NodeError::new)?;
    let mut report = Report {
        decisions: vec![decision],
        cells: Some(medium.lattice.dims),
        bytes: Some(0),
        ..Report::default()
    };
    if is_carried {
        report.decisions.extend([planner::one_depth(beams.len()), of_scheme]);
        match scheme {
            Spherical::Walk => {
                report.stages.push(walk::work(medium, &beams));
                report.stages.extend(shadow::work(run, beams.len()));
                report.bytes = Some(layout.bytes());
            }
            Spherical::Radial(fineness) => {
                report.stages.push(work(run, medium, fineness, beams.len()));
                let exits = 4 * fineness.n_angular.pow(2) as u64;
                report.bytes = Some(beams.len() as u64 * (fineness.bytes() + exits));
            }
        }
    }
    Ok(Plan { beams, is_carried, scheme, report })
}

fn beam(medium: &Medium, light: &Light) -> Result<Beam, NodeError> {
    let place = |position: DVec3| Place::Point(medium.lattice.index_from_world().transform_point3(position));
    let beam = |place, power, facing| Beam { place, power, a0: 1.0, window: None, facing };
    match light {
        Light::Point { position, intensity } => Ok(beam(place(*position), *intensity, None)),
        Light::Surface { position, normal, power } => {
            let mean = power.map(|watts| watts / (4.0 * std::f64::consts::PI));
            Ok(beam(place(*position), mean, Some(medium.lattice.direction_in_index(*normal))))
        }
        Light::Sun { .. } => Err(NodeError::new(
            "lights takes point lights, found a sun: wire the sun to light_decomposition.lights",
        )),
    }
}

/// What the planner's rule is told.
fn points<'a>(
    run: &Run<'a>,
    medium: &Medium,
    beams: &[Beam],
    corner_bytes: u64,
) -> Result<Points<'a>, NodeError> {
    let asked = |name: &str| run.params.i64(name) as usize;
    if let n_radial @ 1..=2 = asked("radial") {
        return Err(NodeError::new(format!(
            "radial = {n_radial}: a grid has at least 3 distances, or 0 lets them be chosen"
        )));
    }
    let last = last_corner(medium);
    let distance = |beam: &Beam| match beam.place {
        Place::Point(position) => (position - position.clamp(DVec3::ZERO, last)).length(),
        Place::Parallel(_) => 0.0,
    };
    Ok(Points {
        scheme: run.params.text("scheme"),
        n_angular: asked("angular"),
        n_radial: asked("radial"),
        n_lights: beams.len(),
        n_corners: medium.lattice.n_corners(),
        samples: walk::samples(medium, beams),
        corner_bytes,
        longest: medium.lattice.occupied.into_iter().max().unwrap_or(0),
        farthest: beams.iter().map(distance).fold(0.0, f64::max),
        is_closed: medium.homogeneous.is_some(),
    })
}

/// Highest corner of the box between the centers of the outermost cells, beyond which there is void; its lowest
/// one is 0.
fn last_corner(medium: &Medium) -> DVec3 {
    DVec3::from_array(medium.lattice.occupied.map(|n| n.saturating_sub(1) as f64))
}

/// What filling the grids moves: a sample a cell and a node; rays that look for surfaces are not known before.
fn work(run: &Run, medium: &Medium, fineness: Fineness, n_lights: usize) -> StageWork {
    let n_rays = (n_lights * (fineness.n_angular + 2).pow(2)) as u64;
    let way = medium.lattice.occupied.into_iter().max().unwrap_or(0).max(fineness.n_radial);
    let moved = 4 * n_rays * (way + fineness.n_radial) as u64;
    let moved_bytes = (!shadow::is_cast(run)).then_some(moved);
    StageWork { stage: "spherical_propagation/radial", runs: 1, moved_bytes }
}

/// Grids of this fineness, filled.
fn grids(run: &Run, medium: &Medium, beams: &[Beam], fineness: Fineness) -> Result<RadialGrids, NodeError> {
    let gpu = run.gpu;
    let last = last_corner(medium);
    let positions: Vec<DVec3> = beams
        .iter()
        .map(|beam| match beam.place {
            Place::Point(position) => position,
            Place::Parallel(_) => unreachable!("point lights alone come here"),
        })
        .collect();
    let lights: Vec<(Spacing, Fineness)> =
        positions.iter().map(|position| (Spacing::new(*position, last), fineness)).collect();
    let mut grids = RadialGrids::new(gpu, &lights)?;
    let surfaces = Surfaces::new(gpu, &medium.lattice, &run.inputs.many::<Mesh>("surfaces"))?;
    let n = fineness.n_angular;
    let params = RadialParams {
        shape: medium.shape(),
        n_lights: beams.len() as u32,
        n_angular: n as u32,
        cell_m: medium.lattice.cell_m as f32,
        pad: 0,
    };
    let single: Vec<[f32; 4]> = positions.iter().map(|p| p.extend(0.0).as_vec4().to_array()).collect();
    let positions = gpu.buffer_from("places of lights", &single, "use fewer lights")?;
    let remedy = "lower spherical_propagation.angular, or use fewer lights";
    let exits = gpu.buffer("depths of whole ways", 4 * (beams.len() * n * n) as u64, remedy)?;
    let (sampler, list) = (gpu.linear_sampler(), grids.list(gpu)?);
    let [nodes, triangles] = surfaces.binds();
    let inputs = [
        Bind::Texture(&medium.sigma_t),
        Bind::Sampler(&sampler),
        Bind::Buffer(&list),
        Bind::Buffer(&positions),
        nodes,
        triangles,
    ];
    let outputs = [Bind::Texture(&grids.texture), Bind::Buffer(&exits)];
    let stage =
        gpu.stage("spherical_propagation/radial", &[("shadows", (!surfaces.is_empty()).to_string())])?;
    let mut recorder = gpu.recorder("grids of point lights");
    recorder.dispatch(&stage.bind(gpu, &params, &inputs, &outputs), [n + 2, n + 2, beams.len()]);
    run.finish(recorder)?;
    let exits: Vec<f32> = gpu.read_buffer(&exits)?;
    grids.exits = exits.chunks_exact(n * n).take(beams.len()).map(Arc::from).collect();
    Ok(grids)
}

fn run(run: &Run) -> Result<Vec<Value>, NodeError> {
    let medium: &Medium = run.inputs.one("medium");
    let Plan { beams, is_carried, scheme, report } = plan(run)?;
    run.tell(report);
    let mut carried = Beams::new(&medium.lattice, beams);
    let mut bytes = 0;
    match scheme {
        _ if !is_carried => {}
        Spherical::Walk => {
            let tau = walk::walk(run, medium, &carried.beams)?;
            carried.has_shadows = shadow::cast(run, medium, &carried.beams, &tau)?;
            bytes = tau.texture.bytes();
            carried.tau = Some(tau);
        }
        Spherical::Radial(fineness) => {
            let grids = grids(run, medium, &carried.beams, fineness)?;
            carried.has_shadows = shadow::is_cast(run);
            carried.n_radial = carried.beams.len();
            bytes = grids.bytes();
            carried.radial = Some(grids);
        }
    }
    Ok(vec![Value::new(PortType::Beams, bytes, carried)])
}

fn foretell(run: &Run) -> Result<Vec<Value>, NodeError> {
    let medium: &Medium = run.inputs.one("medium");
    let Plan { beams, is_carried, scheme, report } = plan(run)?;
    run.tell(report);
    let has_shadows = is_carried && shadow::is_cast(run);
    let is_radial = is_carried && matches!(scheme, Spherical::Radial(_));
    let n_radial = if is_radial { beams.len() } else { 0 };
    let beams = Beams { has_shadows, n_radial, ..Beams::new(&medium.lattice, beams) };
    Ok(vec![Value::new(PortType::Beams, 0, beams)])
}

#[cfg(test)]
mod tests;
