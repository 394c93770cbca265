//! `scheme: literal`: the seed paper's own scheme, for comparison (DESIGN 6.1).
//!
//! Elek, Ritschel, Dachsbacher, Seidel, *Principal-Ordinates Propagation for Real-Time Rendering of
//! Participating Media* (2014), as far as it can be reconstructed: a grid for each ordinate, aligned with it;
//! a cell holds a radiance and one anisotropy a. In each iteration all of it hops to the six neighbors, by
//! the share of Henyey and Greenstein's lobe in the caps mu > 2/3 and mu < −2/3 and a quarter of the band
//! between. Of what arrives in a cell of optical depth tau the part T + albedo (1 − T), T = e^{−tau}, goes on,
//! its anisotropies mixed by flux: a where not scattered, g a where scattered. A lobe of |a| under
//! [`LEAST_ANISOTROPY`] is split into one of that anisotropy and an isotropic rest, which keeps power and
//! flux; the rest is the scheme's own residual and hops to all neighbors alike. phi and F are sums over all
//! that has arrived, times the mean of e^{−t} over the cell.
//!
//! In: extinction [1/m] and ordinates. Out: a [`LightField`], which `isotropic_residual` hands on to the
//! camera; there are no beams. After as many iterations as the grid is long, by default, the light is mostly
//! still on its way: that is the scheme, and so is its failure: power is conserved and never negative, but
//! the hop forgets its direction in each cell, the free path becomes a cell, and nothing converges as cells
//! get smaller (slab of tau 10, g 0.9: R = 0.017, 0.033, 0.048 at 8, 16, 32 cells when settled; truth 0.307).
//!
//! Limits: no surfaces; all of an ordinate's light enters, windows of `prefilter` are not heeded. Held
//! against the f64 oracle beside it.

use std::sync::Arc;

use super::super::Run;
use super::aligned::{Aligned, AlignedTexel};
use crate::gpu::{Bind, Format, Texture};
use crate::graph::{NodeError, Report, StageWork};
use crate::light::Ordinates;
use crate::mirror;
use crate::planner::{self, Colors};
use crate::wire::{Channels, LightField, Medium};

#[cfg(test)]
mod oracle;

mirror! {
    /// `HopParams` of `shaders/principal_propagation/literal_hop.wgsl`.
    struct HopParams {
        grid: AlignedTexel,
        albedo: f32,
        g: f32,
        entering: f32,
        a0: f32,
    }
}

mirror! {
    /// `AddParams` of `shaders/principal_propagation/literal_add.wgsl`.
    struct AddParams {
        grid: AlignedTexel,
        power: [f32; 4],
        dims: [u32; 3],
        n_channels: u32,
    }
}

/// What has less is handed to the residual.
const LEAST_ANISOTROPY: f64 = 0.1;
/// Hops of one submission, between which a cancel is heard.
const HOPS_AT_ONCE: usize = 16;
const REMEDY: &str = "lower medium.max_resolution";

/// What an ordinate's grid holds.
struct Cells {
    /// Power, power times anisotropy, power without direction, and the sum phi.
    state: Texture,
    /// The sum F along the beam.
    flux: Texture,
}

/// The channels that it solves, and what there is to say.
pub(super) fn plan(run: &Run, medium: &Medium, light: &Ordinates) -> (Channels, Report) {
    let lights = light.ordinates.iter().map(|ordinate| ordinate.irradiance).collect();
    let colors = Colors { albedo: medium.albedo, lights, ..Colors::default() };
    let (channels, decision) = planner::channels(&colors, run.prune);
    let report = Report {
        decisions: vec![decision],
        cells: Some(medium.lattice.dims),
        channels: Some(channels.count),
        stages: vec![StageWork { stage: "literal", runs: light.ordinates.len(), moved_bytes: None }],
        ..Report::default()
    };
    (channels, report)
}

/// The light of all ordinates after so many iterations; 0: as many as the grid of each is long.
///
/// # Errors
/// What the device reports.
pub(super) fn propagate(
    run: &Run,
    medium: &Medium,
    light: &Ordinates,
    channels: Channels,
    iterations: usize,
) -> Result<LightField, NodeError> {
    let gpu = run.gpu;
    // Channels that scatter alike share a solution.
    let is_grey = medium.albedo.iter().all(|albedo| *albedo == medium.albedo[0]);
    let n_albedos = if is_grey { 1 } else { 3 };
    let dims = medium.lattice.dims;
    let layers = [dims[0], dims[1], dims[2] * channels.count];
    let field = || gpu.texture3("light of the literal scheme", layers, Format::Rgba32Float, REMEDY);
    let (mut moments, mut next) = (field()?, field()?);
    let sampler = gpu.linear_sampler();
    for ordinate in &light.ordinates {
        let grid = Aligned::new(&medium.lattice, medium.lattice.direction_in_index(ordinate.direction));
        let power = channels.project(ordinate.irradiance).map(|power| power as f32);
        let n_hops = if iterations == 0 { grid.dims.into_iter().max().unwrap_or(1) } else { iterations };
        for (albedo_idx, &albedo) in medium.albedo.iter().take(n_albedos).enumerate() {
            let cells = hop(run, medium, &grid, albedo, ordinate.a0, n_hops)?;
            let lit = |c: usize| if n_albedos == 1 || c == albedo_idx { power[c] } else { 0.0 };
            let params = AddParams {
                grid: grid.texel(),
                power: [lit(0), lit(1), lit(2), 0.0],
                dims: dims.map(|n| n as u32),
                n_channels: channels.count as u32,
            };
            let inputs = [
                Bind::Sampler(&sampler),
                Bind::Texture(&cells.state),
                Bind::Texture(&cells.flux),
                Bind::Texture(&moments),
            ];
            let stage = gpu.stage("principal_propagation/literal_add", &[])?;
            let mut recorder = gpu.recorder("literal");
            recorder.dispatch(&stage.bind(gpu, &params, &inputs, &[Bind::Texture(&next)]), layers);
            run.finish(recorder)?;
            std::mem::swap(&mut moments, &mut next);
        }
    }
    Ok(LightField { moments: Arc::new(moments), channels })
}

/// Light of 1 W/m² enters, and hops.
fn hop(
    run: &Run,
    medium: &Medium,
    grid: &Aligned,
    albedo: f64,
    a0: f64,
    n_hops: usize,
) -> Result<Cells, NodeError> {
    let gpu = run.gpu;
    let new = || -> Result<Cells, NodeError> {
        Ok(Cells {
            state: gpu.texture3("light of an ordinate", grid.dims, Format::Rgba32Float, REMEDY)?,
            flux: gpu.texture3("flux of an ordinate", grid.dims, Format::R32Float, REMEDY)?,
        })
    };
    let (mut before, mut after) = (new()?, new()?);
    let sampler = gpu.linear_sampler();
    let choices = [("least_anisotropy", format!("{LEAST_ANISOTROPY:?}"))];
    let stage = gpu.stage("principal_propagation/literal_hop", &choices)?;
    for first in (0..=n_hops).step_by(HOPS_AT_ONCE) {
        let mut recorder = gpu.recorder("literal");
        for n in first..(first + HOPS_AT_ONCE).min(n_hops + 1) {
            let params = HopParams {
                grid: grid.texel(),
                albedo: albedo as f32,
                g: medium.g as f32,
                entering: if n == 0 { 1.0 } else { 0.0 },
                a0: a0 as f32,
            };
            let inputs = [
                Bind::Texture(&medium.sigma_t),
                Bind::Sampler(&sampler),
                Bind::Texture(&before.state),
                Bind::Texture(&before.flux),
            ];
            let outputs = [Bind::Texture(&after.state), Bind::Texture(&after.flux)];
            recorder.dispatch(&stage.bind(gpu, &params, &inputs, &outputs), grid.dims);
            std::mem::swap(&mut before, &mut after);
        }
        run.finish(recorder)?;
    }
    Ok(before)
}

#[cfg(test)]
mod tests;
