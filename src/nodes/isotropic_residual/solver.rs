//! The cascade: from the coarsest grid to the finest.

use std::sync::Arc;

use super::super::Run;
use super::level::{Level, Problem, REMEDY, Scratch};
use super::sources::Sources;
use super::{Effort, Kind};
use crate::gpu::{Bind, Format, Gpu, Texture};
use crate::graph::NodeError;
use crate::mirror;
use crate::wire::{Channels, Medium, Residual};

mirror! {
    /// `RestrictParams` of `restrict.wgsl`.
    pub(super) struct RestrictParams {
        dims: [u32; 3],
        pad: u32,
    }
}

/// Grids are halved while an axis is longer than this.
const COARSEST: usize = 8;

/// Solves for the residual; sweeps hold the radiances of at most `batch_bytes` of directions at once.
pub(super) fn solve(
    run: &Run,
    medium: &Medium,
    sources: Sources,
    problem: &Problem,
    effort: Effort,
    channels: Channels,
    batch_bytes: u64,
) -> Result<Residual, NodeError> {
    let gpu = run.gpu;
    let scratch = Scratch::new(gpu, problem, medium.lattice.dims, batch_bytes)?;
    let levels = levels(run, medium, sources, problem, &scratch)?;
    for idx in (0..levels.len()).rev() {
        let level = &levels[idx];
        if let Some(coarser) = levels.get(idx + 1) {
            prolong(run, coarser, level)?;
        }
        let sweeps = if idx > 0 || levels.len() == 1 { effort.coarse_sweeps } else { effort.sweeps };
        for _ in 0..sweeps {
            // A submission each: a cancel is heard after every sweep.
            let mut recorder = gpu.recorder("isotropic_residual");
            level.sweep(&mut recorder, true);
            run.finish(recorder)?;
        }
    }
    finish(run, &levels[0], problem, channels)
}

/// All grids, finest first.
fn levels(
    run: &Run,
    medium: &Medium,
    sources: Sources,
    problem: &Problem,
    scratch: &Scratch,
) -> Result<Vec<Level>, NodeError> {
    let gpu = run.gpu;
    let mut cell_m = medium.lattice.cell_m;
    let mut fields = [Arc::clone(&medium.sigma_t), Arc::new(sources.field)];
    let mut levels = Vec::new();
    loop {
        let level = Level::new(gpu, problem, scratch, cell_m, fields.clone(), &sources.sums)?;
        let dims = level.dims;
        levels.push(level);
        let longest = dims.into_iter().max().unwrap_or(0);
        if longest <= COARSEST || dims.iter().any(|n| n % 2 == 1) {
            return Ok(levels);
        }
        let half = dims.map(|n| n / 2);
        fields = [
            Arc::new(restrict(run, &fields[0], half, Format::R32Float)?),
            Arc::new(restrict(run, &fields[1], problem.layers(half), Format::Rgba32Float)?),
        ];
        cell_m *= 2.0;
    }
}

/// Box averages of a field.
fn restrict(run: &Run, fine: &Texture, dims: [usize; 3], format: Format) -> Result<Texture, NodeError> {
    let gpu = run.gpu;
    let coarse = gpu.texture3("a coarser grid", dims, format, REMEDY)?;
    let params = RestrictParams { dims: dims.map(|n| n as u32), pad: 0 };
    let mut recorder = gpu.recorder("isotropic_residual");
    let stage = gpu.stage("isotropic_residual/restrict", &[("format", format.wgsl().to_owned())])?;
    recorder.dispatch(&stage.bind(gpu, &params, &[Bind::Texture(fine)], &[Bind::Texture(&coarse)]), dims);
    run.finish(recorder)?;
    Ok(coarse)
}

/// Starts a level from the next coarser one.
fn prolong(run: &Run, coarser: &Level, level: &Level) -> Result<(), NodeError> {
    let gpu = run.gpu;
    let sampler = gpu.linear_sampler();
    let inputs = [Bind::Texture(&coarser.moments), Bind::Sampler(&sampler), Bind::Buffer(&coarser.balance)];
    let stage = gpu.stage("isotropic_residual/prolong", &[])?;
    let mut recorder = gpu.recorder("isotropic_residual");
    recorder
        .dispatch(&stage.bind(gpu, &level.params, &inputs, &[Bind::Texture(&level.moments)]), level.layers());
    run.finish(recorder)
}

/// The finest level's field, rebalanced.
fn finish(run: &Run, level: &Level, problem: &Problem, channels: Channels) -> Result<Residual, NodeError> {
    let gpu: &Gpu = run.gpu;
    let result = gpu.texture3("residual", level.layers(), Format::Rgba32Float, REMEDY)?;
    let stage = gpu.stage("isotropic_residual/finish", &[])?;
    let inputs = [Bind::Texture(&level.moments), Bind::Buffer(&level.balance)];
    let mut recorder = gpu.recorder("isotropic_residual");
    recorder.dispatch(&stage.bind(gpu, &level.params, &inputs, &[Bind::Texture(&result)]), level.layers());
    run.finish(recorder)?;
    let factors: Vec<f32> = gpu.read_buffer(&level.balance)?;
    let balance = std::array::from_fn(|c| if c < problem.n_channels { f64::from(factors[c]) } else { 1.0 });
    Ok(Residual { moments: Arc::new(result), channels, balance })
}
