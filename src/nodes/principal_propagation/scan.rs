//! The scan: tau as running sums along lines that follow the beam (DESIGN 6.3, the aligned grid).
//!
//! Lines stand half a cell apart across the beam, twice the scene's resolution, and run exactly along it, so
//! nothing is blurred on the way; a corner then takes tau between the four lines around it. Its cost is four
//! samples a cell and beam, whatever the way through the medium.

use super::super::Run;
use crate::gpu::{Bind, Format, Sampler, Texture};
use crate::graph::{NodeError, StageWork};
use crate::mirror;
use crate::wire::{Beam, Medium, Place, TauAtlas};

mirror! {
    /// `Shear` of `shaders/principal_propagation/shear.wgsl`.
    pub(super) struct Shear {
        corners: [u32; 3],
        along: u32,
        slope: [f32; 2],
        sense: f32,
        cell_m: f32,
        direction: [f32; 3],
        first_u: i32,
        first_v: i32,
        pad_0: u32,
        pad_1: u32,
        pad_2: u32,
    }
}

mirror! {
    /// `GatherParams` of `shaders/principal_propagation/gather.wgsl`.
    pub(super) struct GatherParams {
        shears: [Shear; 4],
        origin: [u32; 3],
        pad: u32,
        corners: [u32; 3],
        n_beams: u32,
    }
}

/// Fills an atlas for these parallel beams.
///
/// # Errors
/// What the device reports.
pub(super) fn scan(run: &Run, medium: &Medium, beams: &[Beam]) -> Result<TauAtlas, NodeError> {
    let gpu = run.gpu;
    let atlas = TauAtlas::new(gpu, &medium.lattice, beams.len())?;
    let sampler = gpu.linear_sampler();
    let unused = gpu.texture3("no lines", [1; 3], Format::R32Float, "")?;
    for (pack, four) in beams.chunks(atlas.pack).enumerate() {
        let shears: Vec<Shear> = four.iter().map(|beam| shear(medium, beam)).collect();
        let lines = shears
            .iter()
            .map(|shear| lines(run, medium, &sampler, shear))
            .collect::<Result<Vec<Texture>, NodeError>>()?;
        let params = GatherParams {
            shears: std::array::from_fn(|n| shears[n.min(shears.len() - 1)]),
            origin: atlas.origin(pack),
            pad: 0,
            corners: atlas.corners.map(|n| n as u32),
            n_beams: four.len() as u32,
        };
        let line = |n: usize| Bind::Texture(lines.get(n).unwrap_or(&unused));
        let inputs = [line(0), line(1), line(2), line(3), Bind::Sampler(&sampler)];
        let stage = gpu.stage("principal_propagation/gather", &atlas.choices())?;
        let mut recorder = gpu.recorder("scan");
        recorder
            .dispatch(&stage.bind(gpu, &params, &inputs, &[Bind::Texture(&atlas.texture)]), atlas.corners);
        run.finish(recorder)?;
    }
    Ok(atlas)
}

fn lines(run: &Run, medium: &Medium, sampler: &Sampler, shear: &Shear) -> Result<Texture, NodeError> {
    let gpu = run.gpu;
    let [n_u, n_v, n_planes] = shear.corners.map(|n| n as usize);
    let kept = [2 * n_u + 1, 2 * n_v + 1, n_planes];
    let lines = gpu.texture3("lines along a beam", kept, Format::R32Float, "lower medium.max_resolution")?;
    // Every line that is kept of some plane.
    let span = |slope: f32| (2.0 * slope.abs() * (n_planes - 1) as f32).ceil() as usize + 1;
    let threads = [kept[0] + span(shear.slope[0]), kept[1] + span(shear.slope[1]), 1];
    let stage = gpu.stage("principal_propagation/scan", &[])?;
    let inputs = [Bind::Texture(&medium.sigma_t), Bind::Sampler(sampler)];
    let mut recorder = gpu.recorder("scan");
    recorder.dispatch(&stage.bind(gpu, shear, &inputs, &[Bind::Texture(&lines)]), threads);
    run.finish(recorder)?;
    Ok(lines)
}

fn shear(medium: &Medium, beam: &Beam) -> Shear {
    let Place::Parallel(direction) = beam.place else {
        panic!("a point light has no parallel lines: its node walks");
    };
    let longest = direction.abs().max_element();
    let (along, u, v) = if direction.z.abs() == longest {
        (2, 0, 1)
    } else if direction.y.abs() == longest {
        (1, 0, 2)
    } else {
        (0, 1, 2)
    };
    let corners = medium.lattice.dims.map(|n| (n + 1) as u32);
    let slope = |axis: usize| (direction[axis] / longest) as f32;
    let last = (corners[along] - 1) as f32;
    let first = |slope: f32| (-2.0 * slope.max(0.0) * last).floor() as i32;
    Shear {
        corners: [corners[u], corners[v], corners[along]],
        along: along as u32,
        slope: [slope(u), slope(v)],
        sense: direction[along].signum() as f32,
        cell_m: medium.lattice.cell_m as f32,
        direction: direction.as_vec3().to_array(),
        first_u: first(slope(u)),
        first_v: first(slope(v)),
        pad_0: 0,
        pad_1: 0,
        pad_2: 0,
    }
}

/// What it moves: of each corner and beam four lines, of which each takes a sample and writes a sum; and the
/// sums around the corner.
pub(super) fn work(medium: &Medium, n_beams: usize) -> [StageWork; 2] {
    let corners: usize = medium.lattice.dims.iter().map(|n| n + 1).product();
    [("principal_propagation/scan", 4 * 8), ("principal_propagation/gather", 4 * 4 + 4)].map(
        |(stage, bytes)| StageWork {
            stage,
            runs: n_beams,
            moved_bytes: Some((corners * n_beams * bytes) as u64),
        },
    )
}
