//! What a march does and what it leaves out, by the rules of `planner`; and what it moves.

use glam::DVec3;

use super::super::{Run, walk};
use super::layers::Pixel;
use crate::camera::Camera;
use crate::graph::{NodeError, Report, StageWork};
use crate::light::Window;
use crate::light::environment::{Environment, STACK_TURNS, STACK_WAYS_AROUND};
use crate::optics::delta::DeltaScaled;
use crate::planner::{self, Colors, Gathering};
use crate::wire::{Beam, Beams, Channels, Medium, Place, Residual};

/// What is done.
pub(super) struct Plan {
    pub(super) channels: Channels,
    /// Whether light of beams is seen.
    pub(super) has_beams: bool,
    /// Whether it is gathered at corners first.
    pub(super) has_sums: bool,
    pub(super) has_peak: bool,
    pub(super) has_residual: bool,
    /// Whether lobes have a direction.
    pub(super) has_lobes: bool,
    /// Whether empty blocks are passed in one step.
    pub(super) skips: bool,
    pub(super) report: Report,
}

/// Decides from what the inputs say of themselves, without their fields.
///
/// # Errors
/// A camera that looks nowhere.
pub(super) fn plan(run: &Run) -> Result<Plan, NodeError> {
    let medium: &Medium = run.inputs.one("medium");
    let camera: &Camera = run.inputs.one("camera");
    let residual = run.inputs.maybe::<Residual>("residual");
    let parts = run.inputs.many::<Beams>("beams");
    let beams: Vec<Beam> = parts.iter().flat_map(|part| part.beams.iter().copied()).collect();
    let powers: Vec<[f64; 3]> = beams.iter().map(|beam| beam.power).collect();
    let fields = || parts.iter().flat_map(|part| &part.fields).map(|field| field.channels);
    let ambient = parts.iter().map(|part| part.ambient);

    let (has_beams, of_beams) = planner::beams(medium.albedo, &powers, run.prune);
    let (has_peak, of_peak) = planner::forward_peak(medium.g, run.prune);
    let (has_residual, of_residual) =
        planner::residual(residual.is_some(), residual.is_some_and(|residual| residual.is_dark));
    let (has_lobes, of_lobes) = planner::lobes(medium.g, run.prune);
    // What beams carry is seen in the medium, or on surfaces.
    let has_surfaces = !run.inputs.values("surfaces").is_empty();
    let seen = if has_beams || has_surfaces { &powers[..] } else { &[] };
    let colors = Colors {
        albedo: medium.albedo,
        glows: medium.emission.is_some(),
        lights: fields().map(|field| field.color).chain(seen.iter().copied()).chain(ambient).collect(),
        reflectances: Vec::new(),
        has_rgb_fields: fields().any(|field| field.count == 3),
    };
    let (channels, of_channels) = planner::channels(&colors, run.prune);
    let (channels, of_channels) = match residual.filter(|_| has_residual) {
        // One channel only where the residual has one of the same color.
        Some(residual) if residual.channels != channels => {
            (Channels::RGB, planner::three_channels("the residual has others", &colors))
        }
        _ => (channels, of_channels),
    };
    let blocks = &medium.blocks;
    let (skips, of_space) = planner::empty_space(blocks.n_filled(), blocks.largest.len(), run.prune);
    let mut decisions = vec![of_channels, of_beams];
    decisions.extend(has_beams.then_some(of_peak));
    decisions.push(of_residual);
    decisions.extend(has_residual.then_some(of_lobes));
    decisions.extend(medium.homogeneous.is_none().then_some(of_space));

    let mut plan = Plan {
        channels,
        has_beams,
        has_sums: false,
        has_peak: has_beams && has_peak,
        has_residual,
        has_lobes,
        skips,
        report: Report::default(),
    };
    let n_sub = (run.params.i64("samples") as f64).sqrt().ceil();
    let n_pixels = camera.width * camera.height;
    let pixels = (n_pixels * size_of::<Pixel>()) as f64;
    let n_rays = n_pixels as f64 * n_sub * n_sub;
    let of_ray = probe(medium, camera, run.params.f64("step"))?;
    let of_bending = if is_bent(run) { of_ray.hit * bytes_of_bending(medium, skips) } else { 0.0 };
    let moved = |of_lit: f64| {
        n_rays * (of_ray.lit * of_lit + of_ray.void * BYTES_OF_A_VOID_PAIR + of_bending) + pixels
    };
    let besides = bytes_besides_beams(&plan, medium, residual);
    let of_beams = bytes_of_beams(&plan, medium, &beams);
    let looked_up = moved(besides + of_beams);
    let gathering = bytes_of_gathering(&plan, medium, of_beams);
    let gathered = moved(besides + 16.0 * plan.channels.count as f64);
    let corners = medium.lattice.dims.map(|n| n + 1);
    let layers = corners[2] * plan.channels.count;
    let sums_bytes = (16 * corners[0] * corners[1] * layers) as u64;
    let mut stages = Vec::new();
    if has_beams {
        let facts = Gathering {
            n_beams: beams.len(),
            is_plain: parts.iter().all(|part| part.is_plain()),
            is_closed: medium.homogeneous.is_some(),
            g: beams.iter().map(|beam| medium.g.abs() * beam.a0).fold(0.0, f64::max),
            window: beams.iter().filter_map(|beam| beam.window).map(angle).fold(f64::INFINITY, f64::min),
            distance: distance(medium, camera),
            cell_tau: MEAN_OF_LARGEST * medium.sigma_t_max * medium.lattice.cell_m,
            fits: sums_bytes <= MOST_SUMS && layers <= run.gpu.max_texture_3d() as usize,
            looked_up_bytes: looked_up,
            gathered_bytes: gathering + gathered,
        };
        let (has_sums, of_sums) = planner::gathering(facts, run.prune);
        plan.has_sums = has_sums;
        decisions.push(of_sums);
        let gather = StageWork { stage: "raymarch/gather", runs: 1, moved_bytes: Some(gathering as u64) };
        stages.extend(has_sums.then_some(gather));
    }
    let moved_bytes = Some(if plan.has_sums { gathered } else { looked_up } as u64);
    stages.push(StageWork { stage: "raymarch", runs: 1, moved_bytes });
    plan.report = Report {
        decisions,
        cells: None,
        channels: Some(channels.count),
        bytes: Some((n_pixels * super::layers::BYTES_OF_A_PIXEL) as u64),
        stages,
    };
    Ok(plan)
}

/// Memory that sums of beams may take.
const MOST_SUMS: u64 = 1 << 29;

/// Between a window's angles in radians.
fn angle(window: Window) -> f64 {
    (window.outer_deg - window.inner_deg).to_radians()
}

/// From the eye to the nearest cell that may hold something [cells].
fn distance(medium: &Medium, camera: &Camera) -> f64 {
    let eye = medium.lattice.index_from_world().transform_point3(camera.position);
    let last = DVec3::from_array(medium.lattice.occupied.map(|n| (n - 1) as f64));
    eye.distance(eye.clamp(DVec3::ZERO, last))
}

/// Two samples of extinction.
const BYTES_OF_A_VOID_PAIR: f64 = 8.0;

/// Arithmetic counts as bytes, as measured: of a pair of steps, of a beam, of finding a depth or a point light, of
/// what glows in both steps.
const ARITHMETIC: f64 = 12.0;
const ARITHMETIC_OF_A_BEAM: f64 = 20.0;
const ARITHMETIC_OF_A_PLACE: f64 = 16.0;
const ARITHMETIC_OF_GLOW: f64 = 96.0;

/// What a pair of steps reads where there is matter, but for beams: two samples of extinction; the residual;
/// flame, temperature and black bodies of each step.
fn bytes_besides_beams(plan: &Plan, medium: &Medium, residual: Option<&Residual>) -> f64 {
    let mut bytes = ARITHMETIC + if medium.homogeneous.is_some() { 0.0 } else { BYTES_OF_A_VOID_PAIR };
    if let Some(residual) = residual.filter(|_| plan.has_residual) {
        bytes += 16.0 * residual.channels.count as f64;
    }
    if medium.emission.is_some() {
        bytes += ARITHMETIC_OF_GLOW + 2.0 * (4.0 + 4.0 + 16.0);
    }
    bytes
}

/// What is read of all beams for one place: a depth and, in each channel, the table of the peak.
fn bytes_of_beams(plan: &Plan, medium: &Medium, beams: &[Beam]) -> f64 {
    if !plan.has_beams {
        return 0.0;
    }
    let is_placed = |beam: &&Beam| medium.homogeneous.is_some() || matches!(beam.place, Place::Point(_));
    let n_peaks = if medium.is_grey() { 1 } else { plan.channels.count };
    let peak = if plan.has_peak { 4.0 * n_peaks as f64 } else { 0.0 };
    // Four of many share a texel of half floats.
    let depth = if beams.len() <= 2 { 4.0 } else { 2.0 };
    // The depth ahead and the phases of both streams.
    let returns = if medium.g < 0.0 { depth + 8.0 } else { 0.0 };
    beams.len() as f64 * (ARITHMETIC_OF_A_BEAM + depth + peak + returns)
        + beams.iter().filter(is_placed).count() as f64 * ARITHMETIC_OF_A_PLACE
}

/// Whether light of an environment's stack leaves the medium by bent ways.
fn is_bent(run: &Run) -> bool {
    let environment = run.inputs.maybe::<Environment>("environment");
    matches!(environment, Some(Environment::Map(map)) if map.stack.is_some())
}

/// A sample of a walk, with its arithmetic.
const BYTES_OF_A_SAMPLE: f64 = 10.0;

/// The same where it may pass empty blocks, as measured.
const BYTES_OF_A_SAMPLE_PAST: f64 = 16.0;

/// Cells from a place in the medium to where a walk leaves it.
fn way_out(medium: &Medium) -> f64 {
    0.5 * medium.lattice.occupied.into_iter().sum::<usize>() as f64 / 3.0
}

/// What a ray that meets matter reads for the ways by which light leaves (`shaders/raymarch/environment.wgsl`): walks to
/// their ends.
fn bytes_of_bending(medium: &Medium, skips: bool) -> f64 {
    let samples = if medium.homogeneous.is_some() { walk::SAMPLES_OF_A_SHAPE } else { way_out(medium) };
    let of_sample = if skips { BYTES_OF_A_SAMPLE_PAST } else { BYTES_OF_A_SAMPLE };
    (STACK_TURNS * STACK_WAYS_AROUND) as f64 * of_sample * samples
}

/// What a gathering moves: for each corner of filled blocks the beams, a walk to the eye through half of the
/// medium, and the sums.
fn bytes_of_gathering(plan: &Plan, medium: &Medium, of_beams: f64) -> f64 {
    let n_corners = (medium.blocks.n_filled() * CORNERS_OF_A_BLOCK) as f64;
    n_corners * (of_beams + BYTES_OF_A_SAMPLE * way_out(medium) + 16.0 * plan.channels.count as f64)
}

/// Of 8³ cells, with the faces that blocks share counted for each.
const CORNERS_OF_A_BLOCK: usize = 9 * 9 * 9;

/// Pairs of steps of a ray, the mean over the picture.
struct Steps {
    /// In blocks that hold something.
    lit: f64,
    /// In others.
    void: f64,
    /// Share of the rays that meet blocks that hold something.
    hit: f64,
}

/// Rays across the probe's picture, and down.
const N_RAYS: usize = 32;
/// Stride of a probing ray [cells]: half a block.
const STRIDE: f64 = 4.0;
/// Mean extinction of a filled block over its largest, about.
const MEAN_OF_LARGEST: f64 = 0.3;
/// Scaled optical depth at which `shaders/raymarch.wgsl` ends a ray: OPAQUE is 1e-5.
const OPAQUE_TAU: f64 = 11.5;

/// Looks through the blocks as the march will look through the cells.
fn probe(medium: &Medium, camera: &Camera, step: f64) -> Result<Steps, NodeError> {
    let lattice = &medium.lattice;
    let [forward, right, up] = camera.frame().map_err(NodeError::new)?.map(|v| lattice.turned(v));
    let eye = lattice.index_from_world().transform_point3(camera.position);
    let high = DVec3::from_array(lattice.occupied.map(|n| (n - 1) as f64));
    let k = medium.albedo.into_iter().map(|albedo| DeltaScaled::new(albedo, medium.g).k).fold(1.0, f64::min);
    let share = if medium.homogeneous.is_some() { 1.0 } else { MEAN_OF_LARGEST };
    let pairs_of_stride = STRIDE / (2.0 * step);
    let mut sum = Steps { lit: 0.0, void: 0.0, hit: 0.0 };
    for idx in 0..N_RAYS * N_RAYS {
        let at = |n: usize| 2.0 * (n as f64 + 0.5) / N_RAYS as f64 - 1.0;
        let direction = (forward + at(idx % N_RAYS) * right - at(idx / N_RAYS) * up).normalize();
        let (near, far) = (-eye / direction, (high - eye) / direction);
        let (mut t, end) = (near.min(far).max_element().max(0.0), near.max(far).min_element());
        let mut tau = 0.0;
        while t < end && tau < OPAQUE_TAU {
            let largest = medium.blocks.at(eye + (t + 0.5 * STRIDE) * direction);
            let pairs = pairs_of_stride * ((end - t) / STRIDE).min(1.0);
            if largest > 0.0 {
                sum.lit += pairs;
            } else {
                sum.void += pairs;
            }
            tau += k * share * f64::from(largest) * STRIDE * lattice.cell_m;
            t += STRIDE;
        }
        sum.hit += if tau > 0.0 { 1.0 } else { 0.0 };
    }
    let n = (N_RAYS * N_RAYS) as f64;
    Ok(Steps { lit: sum.lit / n, void: sum.void / n, hit: sum.hit / n })
}
