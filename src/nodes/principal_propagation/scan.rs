//! The scan: tau from the light on, slab by slab, each from the plane of corners before it (DESIGN 6.3).
//!
//! A corner is walked from to a plane of corners a few cells nearer to the light, and takes what that plane has
//! where its way crosses it: between 4 x 4 corners by a cubic. So its cost is a few samples a corner and beam,
//! whatever the way through the medium; what is far away is taken from one plane to the next, and loses there
//! what is finer than a cell. Light that stands for a wide part of the sky has no shadow as sharp as that.
//!
//! In: sigma_t in 1/m. Out: tau at corners, kept in 32 bits until all four beams of a texel are known.
//! Tested against the f64 oracle, which takes the same samples, and against the walk by what may be lost.

use super::super::{Run, walk};
use crate::gpu::{Bind, Buffer, Recorder};
use crate::graph::{NodeError, StageWork};
use crate::mirror;
use crate::wire::{AtlasLayout, Beam, Medium, Place, ShapeTexel, TauAtlas};

mirror! {
    /// `ScanParams` of `shaders/principal_propagation/scan.wgsl`.
    pub(super) struct ScanParams {
        shape: ShapeTexel,
        low: [u32; 3],
        first: u32,
        extent: [u32; 3],
        along: u32,
        corners: [u32; 3],
        known: u32,
        to_light: [f32; 3],
        cell_m: f32,
        until: f32,
        pad_0: u32,
        pad_1: u32,
        pad_2: u32,
    }
}

mirror! {
    /// `PackParams` of `shaders/principal_propagation/pack.wgsl`.
    pub(super) struct PackParams {
        corners: [u32; 3],
        n_beams: u32,
        origin: [u32; 3],
        pad: u32,
    }
}

/// Planes of a slab. Twice as many change the picture of a cloud half as much (0.014 and 0.028 %), and take twice the
/// samples.
const SLAB: usize = 8;

/// Corners of a thread, along z, or y where the slabs stand across z; `COLUMN` of
/// `shaders/principal_propagation/scan.wgsl`.
const COLUMN: usize = 8;

/// Fills an atlas for these parallel beams: scans those of which `is_scanned` says so, and walks the others.
///
/// # Errors
/// What the device reports.
pub(super) fn scan(
    run: &Run,
    medium: &Medium,
    beams: &[Beam],
    is_scanned: &[bool],
) -> Result<TauAtlas, NodeError> {
    let gpu = run.gpu;
    let atlas = TauAtlas::new(gpu, &medium.lattice, beams.len())?;
    let stage = gpu.stage("principal_propagation/pack", &atlas.choices())?;
    let remedy = "choose scheme auto or walk, or lower medium.max_resolution";
    for (pack, four) in beams.chunks(atlas.pack).enumerate() {
        // It begins as zeros, which are the depths of the plane that the light meets first: outside of all matter.
        let depths = gpu.buffer("depths of a pack", bytes(medium, atlas.pack), remedy)?;
        for (n, beam) in four.iter().enumerate() {
            let slab = if is_scanned[pack * atlas.pack + n] { SLAB } else { usize::MAX };
            // A submission each, so that a cancel is heard between beams.
            let mut recorder = gpu.recorder("scan");
            record(&mut recorder, run, medium, (beam, n), slab, &depths)?;
            run.finish(recorder)?;
        }
        let params = PackParams {
            corners: atlas.corners.map(|n| n as u32),
            n_beams: four.len() as u32,
            origin: atlas.origin(pack),
            pad: 0,
        };
        let bound = stage.bind(gpu, &params, &[Bind::Buffer(&depths)], &[Bind::Texture(&atlas.texture)]);
        let mut recorder = gpu.recorder("scan");
        recorder.dispatch(&bound, atlas.corners);
        run.finish(recorder)?;
    }
    Ok(atlas)
}

/// Whether the device holds the depths of a pack in one buffer.
pub(super) fn fits(run: &Run, medium: &Medium, layout: AtlasLayout) -> bool {
    bytes(medium, layout.pack) <= run.gpu.max_binding_bytes()
}

fn bytes(medium: &Medium, n_beams: usize) -> u64 {
    (n_beams * medium.lattice.n_corners() * size_of::<f32>()) as u64
}

/// The slabs of the `n`th beam of a pack, of so many planes each, in the order in which the light meets them; one
/// that holds all planes is walked.
fn record(
    recorder: &mut Recorder,
    run: &Run,
    medium: &Medium,
    (beam, n): (&Beam, usize),
    slab: usize,
    depths: &Buffer,
) -> Result<(), NodeError> {
    let Place::Parallel(direction) = beam.place else {
        panic!("a point light has no planes: its node walks");
    };
    let steep = direction.abs();
    // Of equals the first.
    let along = (0..3).rev().max_by(|a, b| steep[*a].total_cmp(&steep[*b])).unwrap_or(0);
    let column = if along == 2 { 1 } else { 2 };
    let corners = medium.lattice.dims.map(|n| n + 1);
    let last = corners[along] - 1;
    // Of the plane that the light meets as the so-many-eth one.
    let coordinate = |met: usize| if direction[along] > 0.0 { met } else { last - met };
    // The medium ends at the center of its first cell.
    let sense = direction[along].signum() as f32;
    let is_whole = slab >= last;
    let stage = run.gpu.stage("principal_propagation/scan", &[("whole", is_whole.to_string())])?;
    let sampler = run.gpu.linear_sampler();
    let mut met = 1;
    while met <= last {
        let known = met - 1;
        let until = met.saturating_add(slab - 1).min(last);
        let (mut low, mut extent) = ([0; 3], corners);
        low[along] = coordinate(met).min(coordinate(until));
        extent[along] = until - met + 1;
        let params = ScanParams {
            shape: medium.shape(),
            low: low.map(|n| n as u32),
            first: (n * medium.lattice.n_corners()) as u32,
            extent: extent.map(|n| n as u32),
            along: along as u32,
            corners: corners.map(|n| n as u32),
            known: coordinate(known) as u32,
            to_light: (-direction).as_vec3().to_array(),
            cell_m: medium.lattice.cell_m as f32,
            until: coordinate(known) as f32 + if known == 0 { 0.5 * sense } else { 0.0 },
            pad_0: 0,
            pad_1: 0,
            pad_2: 0,
        };
        let inputs = [Bind::Texture(&medium.sigma_t), Bind::Sampler(&sampler)];
        let mut threads = extent;
        threads[column] = threads[column].div_ceil(COLUMN);
        recorder.dispatch(&stage.bind(run.gpu, &params, &inputs, &[Bind::Buffer(depths)]), threads);
        met = until + 1;
    }
    Ok(())
}

/// What it moves: of each corner the samples of half a slab, or of a walk; of the plane behind the slab four depths, and
/// the rows above and below that a column shares; and its own, twice more.
pub(super) fn work(medium: &Medium, beams: &[Beam], is_scanned: &[bool], per_pack: usize) -> [StageWork; 2] {
    let in_slab = 0.5 * SLAB as f64 + 4.0 * (COLUMN + 3) as f64 / COLUMN as f64;
    let read = |(beam, is_scanned): (&Beam, &bool)| {
        if *is_scanned { in_slab } else { walk::samples(medium, std::slice::from_ref(beam)) }
    };
    let read: f64 = beams.iter().zip(is_scanned).map(read).sum();
    let depths = (medium.lattice.n_corners() * beams.len()) as f64;
    let moved = |values: f64| Some((4.0 * values) as u64);
    [
        StageWork {
            stage: "principal_propagation/scan",
            runs: beams.len(),
            moved_bytes: moved(medium.lattice.n_corners() as f64 * read + depths),
        },
        StageWork {
            stage: "principal_propagation/pack",
            runs: beams.len().div_ceil(per_pack),
            moved_bytes: moved(2.0 * depths),
        },
    ]
}

#[cfg(test)]
mod tests;
