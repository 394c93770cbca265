//! The sources of the residual: what beams lose to scattering in each cell, and emission (DESIGN 6.3).
//!
//! Limits: what cells of parallel light get is not exactly what its rays lose, since rays see the trilinear
//! extinction and cells are even: 0.3 % is missing at most in the scenes of the truth set, 6 % in a homogeneous
//! block of 0.7 optical depths a cell at g 0, half in one of 5 (`tests/power.rs`).

use super::super::Run;
use super::super::bands::Bands;
use super::level::{LevelParams, Problem, REMEDY};
use crate::gpu::{Bind, Buffer, Format, Texture};
use crate::graph::NodeError;
use crate::mirror;
use crate::wire::{Beams, Channels, Emission, Medium};

mirror! {
    /// `SourceParams` of `sources.wgsl`.
    pub(super) struct SourceParams {
        level: LevelParams,
        n_beams: u32,
        packs_per_column: u32,
        first: u32,
        pad: u32,
    }
}

/// Columns of cells that a workgroup adds up, along an axis: `EDGE` of `source_sum.wgsl`.
pub(super) const COLUMNS_OF_A_SUM: usize = 8;

/// Q0 and Q1 [W/m³] on the finest grid.
pub(super) struct Sources {
    pub(super) field: Texture,
    /// Powers of parts of the grid, so many of each channel; their sum is the power of all its sources.
    pub(super) sums: Buffer,
    pub(super) n_sums: usize,
}

pub(super) fn sources(
    run: &Run,
    medium: &Medium,
    beams: &Beams,
    channels: &Channels,
    problem: &Problem,
) -> Result<Sources, NodeError> {
    let gpu = run.gpu;
    let dims = medium.lattice.dims;
    let level = problem.level(dims, medium.lattice.cell_m);
    let layers = problem.layers(dims);
    let field = gpu.texture3("sources", layers, Format::Rgba32Float, REMEDY)?;
    let list = beams.list(gpu, channels)?;
    let depths = beams.depths(gpu)?;
    let params = SourceParams {
        level,
        n_beams: if beams.tau.is_some() { beams.n_at_corners() as u32 } else { 0 },
        packs_per_column: depths.tau.packs_per_column as u32,
        first: 0,
        pad: 0,
    };
    let glow = Emission::or_none(medium.emission.as_ref(), gpu)?;
    let inputs = [
        Bind::Texture(&medium.sigma_t),
        Bind::Texture(&depths.star.texture),
        Bind::Buffer(&list),
        Bind::Texture(&glow.cells),
        Bind::Texture(&depths.ahead.texture),
    ];
    let [pack, format] = depths.tau.choices();
    let emission = medium.emission.is_some().to_string();
    let returns = beams.ahead.is_some().to_string();
    let choices =
        [pack, format, ("emission", emission), ("grey", medium.is_grey().to_string()), ("returns", returns)];
    let stage = gpu.stage("isotropic_residual/sources", &choices)?;
    for layers in Bands::new(dims[2], dims[2]) {
        let params = SourceParams { first: layers.start as u32, ..params };
        let bound = stage.bind(gpu, &params, &inputs, &[Bind::Texture(&field)]);
        let mut recorder = gpu.recorder("sources");
        recorder.dispatch(&bound, [dims[0], dims[1], layers.len()]);
        run.finish(recorder)?;
    }
    let field = super::radial::add(run, medium, beams, channels, problem, field)?;
    with_sums(run, problem, &level, field)
}

/// A field of sources with its powers.
pub(super) fn with_sums(
    run: &Run,
    problem: &Problem,
    level: &LevelParams,
    field: Texture,
) -> Result<Sources, NodeError> {
    let gpu = run.gpu;
    let columns = [level.dims[0] as usize, level.dims[1] as usize, problem.n_channels];
    let n_sums = columns[..2].iter().map(|n| n.div_ceil(COLUMNS_OF_A_SUM)).product();
    let sums = gpu.buffer("powers of sources", 4 * (n_sums * problem.n_channels) as u64, REMEDY)?;
    let stage = gpu.stage("isotropic_residual/source_sum", &[])?;
    let mut recorder = gpu.recorder("sources");
    recorder.dispatch(&stage.bind(gpu, level, &[Bind::Texture(&field)], &[Bind::Buffer(&sums)]), columns);
    run.finish(recorder)?;
    Ok(Sources { field, sums, n_sums })
}
