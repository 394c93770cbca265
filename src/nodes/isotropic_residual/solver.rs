//! The cascade: from the coarsest grid to the finest.

use std::sync::Arc;

use super::super::Run;
use super::level::{Level, Problem, REMEDY, SWEEPS_AT_ONCE, Scratch};
use super::sources::Sources;
use super::{Effort, Kind, thick};
use crate::gpu::{Bind, Format, Texture};
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
/// `reference` stops when phi changes by less than this from one round of sweeps to the next, or after so
/// many rounds.
const CONVERGED: f64 = 1e-5;
const MAX_ROUNDS: usize = 2000;

/// Solves for the residual; sweeps hold the radiances of at most `batch_bytes` of directions at once.
pub(super) fn solve(
    run: &Run,
    medium: &Medium,
    sources: &Sources,
    problem: &Problem,
    effort: Effort,
    channels: Channels,
    batch_bytes: u64,
) -> Result<Residual, NodeError> {
    let scratch = Scratch::new(run.gpu, problem, medium.lattice.dims, batch_bytes)?;
    let levels = levels(run, medium, sources, problem, &scratch)?;
    for idx in (0..levels.len()).rev() {
        if let Some(coarser) = levels.get(idx + 1) {
            prolong(run, coarser, &levels[idx])?;
        }
        match effort.kind {
            Kind::Thick => thick::solve_level(run, &levels[idx..], idx == 0)?,
            _ => sweep(run, &levels[idx], effort.sweeps_on(idx, levels.len()), true)?,
        }
    }
    if effort.kind == Kind::Reference {
        converge(run, &levels[0])?;
    }
    let finest = levels.into_iter().next().expect("there is at least the medium's own grid");
    let factors: Vec<f32> = run.gpu.read_buffer(&finest.balance)?;
    let balance = std::array::from_fn(|c| if c < problem.n_channels { f64::from(factors[c]) } else { 1.0 });
    Ok(Residual {
        moments: Arc::new(finest.moments),
        is_dark: false,
        lattice: medium.lattice.clone(),
        channels,
        balance,
        surface_light: None,
    })
}

/// Cells of all grids, finest first.
pub(super) fn grids(dims: [usize; 3]) -> Vec<[usize; 3]> {
    let is_halved = |dims: &[usize; 3]| dims.iter().any(|n| *n > COARSEST) && dims.iter().all(|n| n % 2 == 0);
    std::iter::successors(Some(dims), |dims| is_halved(dims).then(|| dims.map(|n| n / 2))).collect()
}

/// All grids, finest first.
fn levels(
    run: &Run,
    medium: &Medium,
    sources: &Sources,
    problem: &Problem,
    scratch: &Scratch,
) -> Result<Vec<Level>, NodeError> {
    let gpu = run.gpu;
    let mut cell_m = medium.lattice.cell_m;
    let fields = [&*medium.sigma_t, &sources.field];
    let mut levels = vec![Level::new(gpu, problem, scratch, 0, cell_m, fields, sources)?];
    let mut coarser: Option<[Texture; 2]> = None;
    for half in grids(medium.lattice.dims).into_iter().skip(1) {
        let [sigma_t, field] = match &coarser {
            Some([sigma_t, field]) => [sigma_t, field],
            None => fields,
        };
        let next = [
            restrict(run, sigma_t, half, Format::R32Float)?,
            restrict(run, field, problem.layers(half), Format::Rgba32Float)?,
        ];
        cell_m *= 2.0;
        levels.push(Level::new(gpu, problem, scratch, levels.len(), cell_m, [&next[0], &next[1]], sources)?);
        coarser = Some(next);
    }
    Ok(levels)
}

/// So many sweeps of a level.
pub(super) fn sweep(run: &Run, level: &Level, n: usize, balanced: bool) -> Result<(), NodeError> {
    for first in (0..n).step_by(SWEEPS_AT_ONCE) {
        level.sweep(run, SWEEPS_AT_ONCE.min(n - first), balanced)?;
    }
    Ok(())
}

/// Sweeps until nothing changes.
fn converge(run: &Run, level: &Level) -> Result<(), NodeError> {
    let read = || -> Result<Vec<[f32; 4]>, NodeError> { Ok(run.gpu.read_texture(&level.moments)?) };
    let mut before = read()?;
    for _ in 0..MAX_ROUNDS {
        sweep(run, level, SWEEPS_AT_ONCE, true)?;
        let after = read()?;
        let sum: f64 = after.iter().map(|m| f64::from(m[0])).sum();
        let changed: f64 = after.iter().zip(&before).map(|(a, b)| f64::from((a[0] - b[0]).abs())).sum();
        if changed <= CONVERGED * sum {
            return Ok(());
        }
        before = after;
    }
    Err(NodeError::new(format!(
        "quality reference did not settle in {} sweeps: this medium is too deep for it, choose quality thick",
        MAX_ROUNDS * SWEEPS_AT_ONCE
    )))
}

/// Box averages of a field.
pub(super) fn restrict(
    run: &Run,
    fine: &Texture,
    dims: [usize; 3],
    format: Format,
) -> Result<Texture, NodeError> {
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
    let inputs = [Bind::Texture(&coarser.moments), Bind::Sampler(&sampler)];
    let stage = gpu.stage("isotropic_residual/prolong", &[])?;
    let mut recorder = gpu.recorder("isotropic_residual");
    recorder
        .dispatch(&stage.bind(gpu, &level.params, &inputs, &[Bind::Texture(&level.moments)]), level.layers());
    run.finish(recorder)
}
