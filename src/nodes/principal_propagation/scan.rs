//! The scan: tau from the light on, slab by slab, each from the plane of corners before it (DESIGN 6.3).
//!
//! A corner is walked from to a plane of corners a few cells nearer to the light, and takes what that plane has
//! where its way crosses it: between 4 x 4 corners by a cubic. So its cost is a few samples a corner and beam,
//! whatever the way through the medium; what is far away is taken from one plane to the next, and loses there
//! what is finer than a cell. Light that stands for a wide part of the sky has no shadow as sharp as that.
//!
//! In: sigma_t in 1/m. Out: tau at corners, kept in 32 bits until all four beams of a texel are known.
//! Tested against the walk: exact in what varies linearly across the beam, by a bound in what does not.

use super::super::Run;
use crate::gpu::{Bind, Buffer, Recorder};
use crate::graph::{NodeError, StageWork};
use crate::mirror;
use crate::wire::{AtlasLayout, Beam, Medium, Place, TauAtlas};

mirror! {
    /// `ScanParams` of `shaders/principal_propagation/scan.wgsl`.
    pub(super) struct ScanParams {
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

/// Planes of a slab. Half as many double what is interpolated and save a third of the time.
const SLAB: usize = 8;

/// Corners of a thread, along z, or y where the slabs stand across z; `COLUMN` of
/// `shaders/principal_propagation/scan.wgsl`.
const COLUMN: usize = 8;

/// Fills an atlas for these parallel beams: scans those of which `is_scanned` says so, the
/// others are walked, as one slab.
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
    for (pack, four) in beams.chunks(atlas.pack).enumerate() {
        // It begins as zeros, which are the depths of the plane that the light meets first: outside of all matter.
        let depths =
            gpu.buffer("depths of a pack", bytes(medium, atlas.pack), "lower medium.max_resolution")?;
        let mut recorder = gpu.recorder("scan");
        for (n, beam) in four.iter().enumerate() {
            let slab = if is_scanned[pack * atlas.pack + n] { SLAB } else { usize::MAX };
            record(&mut recorder, run, medium, (beam, n), slab, &depths)?;
        }
        let params = PackParams {
            corners: atlas.corners.map(|n| n as u32),
            n_beams: four.len() as u32,
            origin: atlas.origin(pack),
            pad: 0,
        };
        let bound = stage.bind(gpu, &params, &[Bind::Buffer(&depths)], &[Bind::Texture(&atlas.texture)]);
        recorder.dispatch(&bound, atlas.corners);
        run.finish(recorder)?;
    }
    Ok(atlas)
}

/// Whether the device holds the depths of a pack in one buffer.
pub(super) fn fits(run: &Run, medium: &Medium, layout: AtlasLayout) -> bool {
    bytes(medium, layout.pack) <= run.gpu.max_binding_bytes()
}

fn n_corners(medium: &Medium) -> usize {
    medium.lattice.dims.iter().map(|n| n + 1).product()
}

fn bytes(medium: &Medium, n_beams: usize) -> u64 {
    (n_beams * n_corners(medium) * size_of::<f32>()) as u64
}

/// The slabs of the `n`th beam of a pack, of so many planes each, in the order in which the light meets them.
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
    let along = (0..3).max_by(|a, b| steep[*a].total_cmp(&steep[*b])).unwrap_or(0);
    let column = if along == 2 { 1 } else { 2 };
    let corners = medium.lattice.dims.map(|n| n + 1);
    let last = corners[along] - 1;
    // Of the plane that the light meets as the so-many-eth one.
    let coordinate = |met: usize| if direction[along] > 0.0 { met } else { last - met };
    // The medium ends at the center of its first cell.
    let sense = direction[along].signum() as f32;
    let stage = run.gpu.stage("principal_propagation/scan", &[])?;
    let sampler = run.gpu.linear_sampler();
    let mut met = 1;
    while met <= last {
        let known = met - 1;
        let until = met.saturating_add(slab - 1).min(last);
        let (mut low, mut extent) = ([0; 3], corners);
        low[along] = coordinate(met).min(coordinate(until));
        extent[along] = until - met + 1;
        let params = ScanParams {
            low: low.map(|n| n as u32),
            first: (n * n_corners(medium)) as u32,
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

/// What it moves: of each corner and beam the samples of half a slab, the sixteen depths around its way, and its
/// own twice more.
pub(super) fn work(medium: &Medium, n_beams: usize) -> [StageWork; 2] {
    let moved = |bytes: usize| Some((n_corners(medium) * n_beams * bytes) as u64);
    [("principal_propagation/scan", 4 * (SLAB / 2 + 16 + 1)), ("principal_propagation/pack", 4 + 4)]
        .map(|(stage, bytes)| StageWork { stage, runs: n_beams, moved_bytes: moved(bytes) })
}

#[cfg(test)]
mod tests;
