//! The sources of point lights that have grids of their own, to the very power that leaves their rays (DESIGN 6.7).
//!
//! Cells are lit by samples of them, 2³ a cell, and 16³ within two cells of a light among the matter; lights
//! outside by the corners of cells, as parallel light is. What leaves the rays is known exactly:
//! sigma_s\*/sigma_t\* ∫ I (1 − e^{−k tau_exit}) dω, a telescoped sum. What all lights inside lack together goes to the
//! cells that they stand in, by their shares of the power; where samples give too much, or no light stands in
//! matter, all sources are multiplied by one number. So power is exact for lights inside and for those outside, per channel. Of several
//! lights the split between them is as good as the samples.
//!
//! Tested against the oracle of spherical propagation, and by power in thin, thick and mixed media.

use super::super::Run;
use super::level::{LevelParams, Problem, REMEDY};
use crate::gpu::{Bind, Format, Texture};
use crate::graph::NodeError;
use crate::mirror;
use crate::optics::delta::DeltaScaled;
use crate::wire::{Beam, Beams, Channels, Medium, Place, RadialGrids, ShapeTexel};

mirror! {
    /// `RadialSourceParams` of `radial_sources.wgsl`.
    pub(super) struct RadialSourceParams {
        level: LevelParams,
        shape: ShapeTexel,
        first: u32,
        n_lights: u32,
        inside: u32,
        pad: u32,
    }
}

mirror! {
    /// `SettleParams` of `radial_settle.wgsl`.
    pub(super) struct SettleParams {
        level: LevelParams,
        factor: [f32; 3],
        n_own: u32,
    }
}

mirror! {
    /// `OwnCell` of `radial_settle.wgsl`.
    pub(super) struct OwnCell {
        power: [f32; 3],
        cell: u32,
    }
}

/// `field` with the sources of all lights of grids.
pub(super) fn add(
    run: &Run,
    medium: &Medium,
    beams: &Beams,
    channels: &Channels,
    problem: &Problem,
    field: Texture,
) -> Result<Texture, NodeError> {
    let Some(grids) = &beams.radial else { return Ok(field) };
    [true, false].into_iter().try_fold(field, |field, inside| {
        match grids.spacings.iter().any(|spacing| spacing.is_log == inside) {
            true => add_those(run, medium, (beams, grids), channels, problem, field, inside),
            false => Ok(field),
        }
    })
}

/// The same of lights inside, or outside.
fn add_those(
    run: &Run,
    medium: &Medium,
    (beams, grids): (&Beams, &RadialGrids),
    channels: &Channels,
    problem: &Problem,
    before: Texture,
    inside: bool,
) -> Result<Texture, NodeError> {
    let gpu = run.gpu;
    let dims = medium.lattice.dims;
    let layers = problem.layers(dims);
    let level = problem.level(dims, medium.lattice.cell_m);
    let first = beams.n_at_corners();
    let sampler = gpu.linear_sampler();
    let (list, lights) = (beams.list(gpu, channels)?, grids.list(gpu)?);
    let params = RadialSourceParams {
        level,
        shape: medium.shape(),
        first: first as u32,
        n_lights: beams.n_radial as u32,
        inside: u32::from(inside),
        pad: 0,
    };
    let of_lights = gpu.texture3("sources of point lights", layers, Format::Rgba32Float, REMEDY)?;
    let inputs = [
        Bind::Texture(&medium.sigma_t),
        Bind::Sampler(&sampler),
        Bind::Texture(&grids.texture),
        Bind::Buffer(&lights),
        Bind::Buffer(&list),
    ];
    let choices = [("pack", beams.pack().to_string()), ("shadows", beams.has_shadows.to_string())];
    let stage = gpu.stage("isotropic_residual/radial_sources", &choices)?;
    let mut recorder = gpu.recorder("sources of point lights");
    recorder.dispatch(&stage.bind(gpu, &params, &inputs, &[Bind::Texture(&of_lights)]), dims);
    run.finish(recorder)?;

    let volume = medium.lattice.cell_m.powi(3);
    let given = sums(run, &of_lights, problem.n_channels)?.map(|sum| sum * volume);
    let powers: Vec<[f64; 3]> = grids
        .spacings
        .iter()
        .enumerate()
        .map(|(n, spacing)| match spacing.is_log == inside {
            true => power(medium, &beams.beams[first + n], grids, n, channels),
            false => [0.0; 3],
        })
        .collect();
    let cells = if inside { own_cells(run, medium, &beams.beams[first..])? } else { Vec::new() };
    let (factor, own) = settle(&powers, given, &cells, volume);
    let n_own = own.len() as u32;
    let own = if own.is_empty() { vec![bytemuck::Zeroable::zeroed()] } else { own };
    let own = gpu.buffer_from("cells of point lights", &own, "use fewer lights")?;
    let params = SettleParams { level, factor: factor.map(|x| x as f32), n_own };
    let sources = gpu.texture3("sources", layers, Format::Rgba32Float, REMEDY)?;
    let inputs = [Bind::Texture(&before), Bind::Texture(&of_lights), Bind::Buffer(&own)];
    let stage = gpu.stage("isotropic_residual/radial_settle", &[])?;
    let mut recorder = gpu.recorder("sources of point lights");
    recorder.dispatch(&stage.bind(gpu, &params, &inputs, &[Bind::Texture(&sources)]), layers);
    run.finish(recorder)?;
    Ok(sources)
}

/// The sum of each channel's first component [W/m³], in f64.
fn sums(run: &Run, field: &Texture, n_channels: usize) -> Result<[f64; 3], NodeError> {
    let texels: Vec<[f32; 4]> = run.gpu.read_texture(field)?;
    let mut sums = [0.0; 3];
    for (sum, layer) in sums.iter_mut().zip(texels.chunks_exact(texels.len() / n_channels)) {
        *sum = layer.iter().map(|texel| f64::from(texel[0])).sum();
    }
    Ok(sums)
}

/// The power [W] that a light's rays give to scattering, of channels that are solved: the telescoped sum.
pub(super) fn power(
    medium: &Medium,
    beam: &Beam,
    grids: &RadialGrids,
    n: usize,
    channels: &Channels,
) -> [f64; 3] {
    let directions = grids.spacings[n].directions(grids.fineness(n).n_angular);
    let intensity = channels.project(beam.power);
    std::array::from_fn(|c| {
        let scaled = DeltaScaled::new(medium.albedo[c], medium.g);
        let lost = directions.iter().zip(grids.exits[n].iter()).map(|((direction, weight), tau)| {
            let along = beam.facing.map_or(1.0, |normal| 4.0 * normal.dot(*direction).max(0.0));
            -weight * along * (-scaled.k * f64::from(*tau)).exp_m1()
        });
        intensity[c] * scaled.sigma_s_ratio / scaled.k.max(1e-300) * lost.sum::<f64>()
    })
}

/// For each light the number of its cell where there is matter in it.
fn own_cells(run: &Run, medium: &Medium, beams: &[Beam]) -> Result<Vec<Option<u32>>, NodeError> {
    let sigma_t: Vec<f32> = run.gpu.read_texture(&medium.sigma_t)?;
    let dims = medium.lattice.dims;
    let cell = |beam: &Beam| {
        let Place::Point(position) = beam.place else { return None };
        let at: [usize; 3] = std::array::from_fn(|axis| (position[axis] + 0.5).max(0.0) as usize);
        if (0..3).any(|axis| at[axis] >= dims[axis]) {
            return None;
        }
        let idx = at[0] + dims[0] * (at[1] + dims[1] * at[2]);
        (sigma_t[idx] > 0.0).then_some(idx as u32)
    };
    Ok(beams.iter().map(cell).collect())
}

/// What sources are multiplied by, and what own cells get, so that `given` [W] becomes the sum of `powers`.
fn settle(
    powers: &[[f64; 3]],
    given: [f64; 3],
    cells: &[Option<u32>],
    volume: f64,
) -> ([f64; 3], Vec<OwnCell>) {
    let mut factor = [1.0; 3];
    let mut per_power = [0.0; 3];
    for c in 0..3 {
        let wanted: f64 = powers.iter().map(|power| power[c]).sum();
        let in_own: f64 =
            powers.iter().zip(cells).filter(|(_, cell)| cell.is_some()).map(|(power, _)| power[c]).sum();
        if wanted >= given[c] && in_own > 0.0 {
            per_power[c] = (wanted - given[c]) / (in_own * volume);
        } else if given[c] > 0.0 {
            factor[c] = wanted / given[c];
        }
    }
    let own = powers.iter().zip(cells).filter_map(|(power, cell)| {
        Some(OwnCell { power: std::array::from_fn(|c| (per_power[c] * power[c]) as f32), cell: (*cell)? })
    });
    (factor, own.collect())
}

#[cfg(test)]
mod tests;
