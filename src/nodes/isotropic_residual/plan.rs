//! What a residual does and what it leaves out, by the rules of `planner`; and what its stages move.

use glam::DVec3;

use super::super::Run;
use super::{Effort, Kind, solver, thick};
use crate::geometry::Mesh;
use crate::graph::{NodeError, Report, StageWork};
use crate::light::chromaticity;
use crate::optics::directions::LineSet;
use crate::planner::{self, Colors, Lit, Scattering};
use crate::wire::{Beam, Beams, Channels, Medium, Place};

/// What is done.
pub(super) struct Plan {
    pub(super) effort: Effort,
    pub(super) channels: Channels,
    pub(super) scattering: Scattering,
    /// Whether lobes have a direction.
    pub(super) has_lobes: bool,
    pub(super) report: Report,
}

/// Decides from what the inputs say of themselves, without their fields.
///
/// # Errors
/// Parameters and inputs that do not go together.
pub(super) fn plan(run: &Run) -> Result<Plan, NodeError> {
    let medium: &Medium = run.inputs.one("medium");
    let parts = run.inputs.many::<Beams>("beams");
    let meshes = run.inputs.many::<Mesh>("surfaces");
    let has_surfaces = meshes.iter().any(|mesh| !mesh.triangles.is_empty());
    let beams: Vec<Beam> = parts.iter().flat_map(|part| part.beams.iter().copied()).collect();
    let fields: Vec<Channels> =
        parts.iter().flat_map(|part| part.fields.iter().map(|field| field.channels)).collect();
    if has_surfaces && !fields.is_empty() {
        return Err(NodeError::new(
            "surfaces are lit by beams, and principal_propagation's scheme literal has none: choose another scheme, \
             or disconnect surfaces",
        ));
    }
    if has_surfaces && beams.iter().any(|beam| beam.facing.is_some()) {
        return Err(NodeError::new(
            "beams hold light of bounce_lights, which surfaces wired here would send back a second time: disconnect \
             surfaces here, or leave bounce_lights out",
        ));
    }
    let powers: Vec<[f64; 3]> = beams.iter().map(|beam| beam.power).collect();
    let ambient = std::array::from_fn(|c| parts.iter().map(|part| part.ambient[c]).sum());
    let glows = medium.emission.is_some();
    let lit = || beams.iter().filter(|beam| chromaticity(beam.power).is_some());
    let (scattering, decision) = planner::scattering(
        &Lit {
            albedo: medium.albedo,
            g: medium.g,
            tau_max: medium.tau_max,
            n_beams: lit().count(),
            is_parallel: lit().all(Beam::is_parallel) && !parts.iter().any(|part| part.has_shadows),
            ambient,
            glows,
            has_surfaces,
            has_fields: !fields.is_empty(),
        },
        run.prune,
    );
    let mut decisions = vec![decision];
    let colors = Colors {
        albedo: medium.albedo,
        glows,
        lights: fields
            .iter()
            .map(|field| field.color)
            .chain(powers.iter().copied())
            .chain([ambient])
            .collect(),
        reflectances: meshes.iter().map(|mesh| mesh.reflectance).collect(),
        has_rgb_fields: fields.iter().any(|field| field.count == 3),
    };
    // Darkness has no color.
    let (channels, decision) = match scattering {
        Scattering::None => (Channels { count: 1, color: [1.0; 3] }, None),
        _ => {
            let (channels, decision) = planner::channels(&colors, run.prune);
            (channels, Some(decision))
        }
    };
    let told_channels = decision.is_some().then_some(channels.count);
    decisions.extend(decision);
    let (mut effort, asks_for_lines) = effort(run)?;
    let (has_lobes, lobes) = planner::lobes(medium.g, run.prune);
    let mut stages = Vec::new();
    let dims = medium.lattice.dims;
    let mut n_cells = 1;
    if scattering == Scattering::Solved {
        if !asks_for_lines {
            let n_inside = lit().filter(|beam| is_inside(beam, medium)).count();
            let (lines, decision) = planner::directions(effort.lines, n_inside, glows, run.prune);
            effort.lines = lines;
            decisions.push(decision);
        }
        let (is_carried, decision) = planner::beams(medium.albedo, &powers, run.prune);
        decisions.extend([lobes, decision]);
        let n_radial: usize = parts.iter().map(|part| part.n_radial).sum();
        let n_at_corners = if is_carried { beams.len() - n_radial } else { 0 };
        stages = work(dims, channels.count, n_at_corners, effort, has_surfaces);
        if is_carried && n_radial > 0 {
            // What a light's cells near it cost is not known by bytes.
            let stage = "isotropic_residual/radial_sources";
            stages.push(StageWork { stage, runs: 1, moved_bytes: None });
        }
        n_cells = dims.iter().product();
    }
    // How many patches surfaces are cut into, only the run shows.
    let bytes = (!has_surfaces || n_cells == 0).then_some(16 * (n_cells * channels.count) as u64);
    let report = Report { decisions, cells: Some(dims), channels: told_channels, bytes, stages };
    Ok(Plan { effort, channels, scattering, has_lobes, report })
}

/// Whether a light stands among the matter: in the box of a shape, or in that of cells without their border.
fn is_inside(beam: &Beam, medium: &Medium) -> bool {
    let Place::Point(position) = beam.place else { return false };
    let (low, high) = match medium.homogeneous {
        Some(shape) => (shape.center - shape.half_extent, shape.center + shape.half_extent),
        None => (DVec3::ONE, DVec3::from_array(medium.lattice.occupied.map(|n| n as f64 - 2.0))),
    };
    position.cmpge(low).all() && position.cmple(high).all()
}

/// What the parameters ask for, and whether they name the lines.
fn effort(run: &Run) -> Result<(Effort, bool), NodeError> {
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
    let effort = Effort {
        lines,
        first: 0,
        sweeps: or("sweeps", sweeps),
        coarse_sweeps: or("coarse_sweeps", coarse_sweeps),
        kind,
    };
    Ok((effort, run.params.i64("directions") > 0))
}

/// What the stages move. With surfaces the medium is solved three times, twice roughly; what rays between
/// them cost only the run shows.
fn work(
    dims: [usize; 3],
    n_channels: usize,
    n_beams: usize,
    effort: Effort,
    has_surfaces: bool,
) -> Vec<StageWork> {
    let cells = (dims.iter().product::<usize>() * n_channels) as u64;
    // Extinction and source, the depths at the corners of each beam, and as much as that of arithmetic and of
    // first writing to the field, as measured.
    let of_sources = StageWork {
        stage: "isotropic_residual/sources",
        runs: 1,
        moved_bytes: Some(cells * (20 + 100 + 20 * n_beams as u64)),
    };
    let solves: &[Effort] = if has_surfaces { &[effort, effort.rough(), effort.rough()] } else { &[effort] };
    let mut stages = vec![of_sources];
    if has_surfaces {
        stages.push(StageWork { stage: "light on surfaces", runs: 3, moved_bytes: None });
    }
    let grids = solver::grids(dims);
    let n_directions = effort.lines.count() as u64;
    // Each with what it moves of a cell: a sweep reads 16 bytes of lobe and writes 4 a direction, what follows
    // gathers these into the next lobe or, after the last sweep, into moments, from which the next call starts.
    let each_sweep = [
        ("isotropic_residual/sweep", 20 * n_directions),
        ("isotropic_residual/gather_lobes", 4 * n_directions + 36),
    ];
    let each_grid = [
        ("isotropic_residual/gather_moments", 4 * n_directions + 16),
        ("isotropic_residual/lobe", 52),
        ("isotropic_residual/prolong", 32),
    ];
    let mut n_sweeps = vec![0; grids.len()];
    let mut n_ends = vec![0; grids.len()];
    for solve in solves {
        let sweeps: Vec<usize> = match solve.kind {
            Kind::Thick => thick::sweeps(grids.len()),
            _ => (0..grids.len()).map(|idx| solve.sweeps_on(idx, grids.len())).collect(),
        };
        for (idx, sweeps) in sweeps.into_iter().enumerate() {
            n_sweeps[idx] += sweeps;
            // A V-cycle stops after each sweep.
            n_ends[idx] += if solve.kind == Kind::Thick { sweeps } else { sweeps.min(1) };
        }
    }
    let mut add = |stage, bytes: u64, runs: &[usize]| {
        let moved = grids
            .iter()
            .zip(runs)
            .map(|(dims, runs)| (dims.iter().product::<usize>() * n_channels * runs) as u64 * bytes);
        let settles = effort.kind != Kind::Reference;
        let moved_bytes = settles.then_some(moved.sum());
        stages.push(StageWork { stage, runs: runs.iter().sum(), moved_bytes });
    };
    for (stage, bytes) in each_sweep {
        add(stage, bytes, &n_sweeps);
    }
    for (stage, bytes) in each_grid {
        add(stage, bytes, &n_ends);
    }
    stages
}
