//! V-cycles for media that are both deep and white (DESIGN 6.4, quality `thick`).
//!
//! A sweep carries light a few mean free paths; in a deep medium the cascade is far from settled. The full
//! approximation scheme solves x = T(x), T one sweep, with help of the coarser level: sweep twice to y,
//! there solve z = T_H(z) + R y - T_H(R x) from z = R y, and correct y by P (z - R y). phi stays within a
//! factor 4 of what was swept, |F| within phi. Sweeps inside a cycle are not balanced, the one after it is.

use super::super::Run;
use super::level::{Level, REMEDY};
use super::solver::{restrict, sweep};
use crate::gpu::{Bind, Format, Texture};
use crate::graph::NodeError;

/// Sweeps that solve the coarsest level.
const COARSEST_SWEEPS: usize = 60;

/// How often each of so many levels is swept, finest first.
pub(super) fn sweeps(n_levels: usize) -> Vec<usize> {
    let mut counts = vec![0; n_levels];
    let last = n_levels - 1;
    for level in 0..n_levels {
        if level == last {
            counts[level] += COARSEST_SWEEPS;
            continue;
        }
        for _ in 0..cycles(level == 0) {
            for below in level..last {
                counts[below] += 2;
                counts[below + 1] += 1;
            }
            counts[last] += COARSEST_SWEEPS;
        }
        counts[level] += 1;
    }
    counts
}

/// V-cycles that solve a level.
fn cycles(finest: bool) -> usize {
    if finest { 2 } else { 1 }
}

/// Solves `levels[0]`, which has been started from `levels[1]`.
pub(super) fn solve_level(run: &Run, levels: &[Level], finest: bool) -> Result<(), NodeError> {
    if levels.len() == 1 {
        return sweep(run, &levels[0], COARSEST_SWEEPS, true);
    }
    for _ in 0..cycles(finest) {
        cycle(run, levels, None)?;
    }
    sweep(run, &levels[0], 1, true)
}

/// One cycle on the moments of `levels[0]`, whose equation is x = T(x) + defect.
fn cycle(run: &Run, levels: &[Level], defect: Option<&Texture>) -> Result<(), NodeError> {
    let level = &levels[0];
    let Some(coarser) = levels.get(1) else {
        for _ in 0..COARSEST_SWEEPS {
            shifted_sweep(run, level, defect)?;
        }
        return Ok(());
    };
    shifted_sweep(run, level, defect)?;
    let half = coarser.layers();
    let swept_once = restrict(run, &level.moments, half, Format::Rgba32Float)?;
    shifted_sweep(run, level, defect)?;
    let swept_twice = restrict(run, &level.moments, half, Format::Rgba32Float)?;
    let before = copy(run, &level.moments)?;

    store(run, &swept_once, &coarser.moments)?;
    sweep(run, coarser, 1, false)?;
    let coarse_defect = difference(run, coarser, &swept_twice, &coarser.moments)?;
    store(run, &swept_twice, &coarser.moments)?;
    cycle(run, &levels[1..], Some(&coarse_defect))?;

    let correction = difference(run, coarser, &coarser.moments, &swept_twice)?;
    let sampler = run.gpu.linear_sampler();
    let inputs = [Bind::Texture(&before), Bind::Texture(&correction), Bind::Sampler(&sampler)];
    dispatch(run, level, "correct", &inputs, &level.moments)
}

/// x becomes T(x) + defect.
fn shifted_sweep(run: &Run, level: &Level, defect: Option<&Texture>) -> Result<(), NodeError> {
    sweep(run, level, 1, false)?;
    let Some(defect) = defect else { return Ok(()) };
    let swept = copy(run, &level.moments)?;
    dispatch(run, level, "shift", &[Bind::Texture(&swept), Bind::Texture(defect)], &level.moments)
}

fn difference(run: &Run, level: &Level, from: &Texture, subtract: &Texture) -> Result<Texture, NodeError> {
    let result = run.gpu.texture3("a difference", level.layers(), Format::Rgba32Float, REMEDY)?;
    dispatch(run, level, "difference", &[Bind::Texture(from), Bind::Texture(subtract)], &result)?;
    Ok(result)
}

fn copy(run: &Run, field: &Texture) -> Result<Texture, NodeError> {
    let dims = field.dims().map(|n| n as usize);
    let copied = run.gpu.texture3("a copy", dims, field.format(), REMEDY)?;
    store(run, field, &copied)?;
    Ok(copied)
}

fn store(run: &Run, from: &Texture, to: &Texture) -> Result<(), NodeError> {
    let mut recorder = run.gpu.recorder("isotropic_residual");
    recorder.copy_box(from, [0; 3], to, [0; 3], from.dims().map(|n| n as usize));
    run.finish(recorder)
}

fn dispatch(
    run: &Run,
    level: &Level,
    stage: &str,
    inputs: &[Bind],
    output: &Texture,
) -> Result<(), NodeError> {
    let stage = run.gpu.stage(&format!("isotropic_residual/{stage}"), &[])?;
    let mut recorder = run.gpu.recorder("isotropic_residual");
    recorder.dispatch(&stage.bind(run.gpu, &level.params, inputs, &[Bind::Texture(output)]), level.layers());
    run.finish(recorder)
}
