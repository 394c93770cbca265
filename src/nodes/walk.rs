//! The walk to the light, shared by the propagations: tau from every corner of a cell to every light.
//!
//! Midpoint samples of the trilinear extinction, at most a cell apart, from the corner to the edge of
//! the medium or to the light (DESIGN 6.3); a homogeneous shape in closed form. Exact but for the
//! samples; its cost is corners × beams × the way through the medium.

use std::ops::Range;

use super::Run;
use super::bands::Bands;
use crate::gpu::{Bind, Recorder, Sampler};
use crate::graph::{NodeError, StageWork};
use crate::mirror;
use glam::DVec3;

use crate::wire::{Beam, BeamTexel, Medium, Place, ShapeTexel, TauAtlas};

mirror! {
    /// `WalkParams` of `shaders/walk.wgsl`.
    pub(super) struct WalkParams {
        shape: ShapeTexel,
        origin: [u32; 3],
        n_beams: u32,
        corners: [u32; 3],
        cell_m: f32,
        first: u32,
        pad_0: u32,
        pad_1: u32,
        pad_2: u32,
        beams: [BeamTexel; 4],
    }
}

/// Fills an atlas for these beams.
///
/// # Errors
/// What the device reports.
pub(super) fn walk(run: &Run, medium: &Medium, beams: &[Beam]) -> Result<TauAtlas, NodeError> {
    let atlas = TauAtlas::new(run.gpu, &medium.lattice, beams.len())?;
    let sampler = run.gpu.linear_sampler();
    // Layers of corners of all packs, one after the other: a GPU has many packs done in the time of a submission, a
    // processor takes a second for one.
    let n_layers = atlas.corners[2];
    let all = beams.len().div_ceil(atlas.pack) * n_layers;
    for band in Bands::new(all, all).beginning_with(n_layers.div_ceil(8)) {
        let mut recorder = run.gpu.recorder("walk to the light");
        for (pack, four) in beams.chunks(atlas.pack).enumerate() {
            let [start, end] =
                [band.start, band.end].map(|at| at.saturating_sub(pack * n_layers).min(n_layers));
            if start < end {
                record(&mut recorder, run, medium, &sampler, &atlas, (pack, four), start..end)?;
            }
        }
        run.finish(recorder)?;
    }
    Ok(atlas)
}

/// Samples that a walk takes from a corner to the light, the mean over the beams: half of the way through
/// the medium; of that of a point light half of the medium's mean extent.
pub(super) fn samples(medium: &Medium, beams: &[Beam]) -> f64 {
    let occupied = DVec3::from_array(medium.lattice.occupied.map(|n| n as f64));
    let ways = beams.iter().map(|beam| match beam.place {
        Place::Parallel(direction) => (occupied / direction.abs().max(DVec3::splat(1e-9))).min_element(),
        Place::Point(_) => occupied.element_sum() / 3.0,
    });
    0.5 * ways.sum::<f64>() / beams.len().max(1) as f64
}

/// A depth in closed form costs as much as so many samples (measured).
pub(super) const SAMPLES_OF_A_SHAPE: f64 = 16.0;

/// What it moves: the samples of each corner and beam, and a depth.
pub(super) fn work(medium: &Medium, beams: &[Beam]) -> StageWork {
    let samples = if medium.homogeneous.is_some() { SAMPLES_OF_A_SHAPE } else { samples(medium, beams) };
    let corners = medium.lattice.n_corners();
    let moved_bytes = Some(((corners * beams.len()) as f64 * 4.0 * (1.0 + samples)) as u64);
    StageWork { stage: "walk", runs: beams.len(), moved_bytes }
}

fn record(
    recorder: &mut Recorder,
    run: &Run,
    medium: &Medium,
    sampler: &Sampler,
    atlas: &TauAtlas,
    (pack, beams): (usize, &[Beam]),
    layers: Range<usize>,
) -> Result<(), NodeError> {
    let params = WalkParams {
        shape: medium.shape(),
        origin: atlas.origin(pack),
        n_beams: beams.len() as u32,
        corners: atlas.corners.map(|n| n as u32),
        cell_m: medium.lattice.cell_m as f32,
        first: layers.start as u32,
        pad_0: 0,
        pad_1: 0,
        pad_2: 0,
        beams: std::array::from_fn(|n| beams[n.min(beams.len() - 1)].texel([0.0; 3])),
    };
    let stage = run.gpu.stage("walk", &atlas.choices())?;
    let inputs = [Bind::Texture(&medium.sigma_t), Bind::Sampler(sampler)];
    let bound = stage.bind(run.gpu, &params, &inputs, &[Bind::Texture(&atlas.texture)]);
    recorder.dispatch(&bound, [atlas.corners[0], atlas.corners[1], layers.len()]);
    Ok(())
}

#[cfg(test)]
mod tests;
