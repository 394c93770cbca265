//! Light that surfaces send back into the medium (DESIGN 6.7).
//!
//! Surfaces are cut into patches, each with one irradiance E a side, which send back L = reflectance E / pi. E
//! is what beams bring, past surfaces and through the medium, and a march of 64 directions through what the
//! medium scatters, other patches and ambient light. From every cell 32 rays look for patches: their (phi, F) is the
//! first-collision source Q0 += sigma_s* phi, Q1 += sigma_s* g* F of another solve, and is added to the
//! field that the camera reads. Twice: what comes back once more lights the patches again.
//! In the end E is computed once more, at the corners of the patches and without narrow beams: what a camera
//! finds on surfaces that it sees.
//!
//! Limits: surfaces do not block the lines of the solver; the light of patches is as coarse as they are (at
//! least two cells, 2^14 of them on all surfaces), and is gathered on at most 2^18 cells. Tested by the closed
//! forms of planes in a void and in a thin medium, and by what a closed ball must hold.

use std::sync::Arc;

use super::super::Run;
use super::level::{LevelParams, Problem, REMEDY};
use super::sources::{Sources, beam_list, with_sums};
use super::{Effort, Kind, level, solver};
use crate::gpu::{Bind, Buffer, Format, Texture};
use crate::graph::NodeError;
use crate::mirror;
use crate::wire::{Beams, Channels, Medium, Residual, ShapeTexel, SurfaceLight, Surfaces};

mod cuts;

use cuts::Points;

mirror! {
    /// `BounceParams` of `bounce.wgsl`.
    pub(super) struct BounceParams {
        level: LevelParams,
        shape: ShapeTexel,
        n_beams: u32,
        n_points: u32,
        coarser: u32,
        pad: u32,
    }
}

const BOUNCES: usize = 2;
/// Cells that look for patches, at most.
const LIT_CELLS: usize = 1 << 18;
/// Threads along x of one dispatch, 65,535 groups of 64; `surface_light.wgsl`.
const ROW: usize = 4_194_240;

/// Solves for the residual with what surfaces send back.
pub(super) fn solve(
    run: &Run,
    medium: &Medium,
    beams: &Beams,
    surfaces: &Surfaces,
    problem: &Problem,
    effort: Effort,
    channels: Channels,
) -> Result<Residual, NodeError> {
    let gpu = run.gpu;
    let dims = medium.lattice.dims;
    let patches = Points::middles(run, surfaces)?;
    let of_beams = super::sources::sources(run, medium, beams, &channels, problem)?;
    let settle = |sources: &Sources, effort: Effort| {
        solver::solve(run, medium, sources, problem, effort, channels, level::BATCH_BYTES)
    };
    // What only lights patches need not be as good as what is seen.
    let rough = match effort.kind {
        Kind::Cascade => Effort { sweeps: 1, coarse_sweeps: effort.coarse_sweeps.min(8), ..effort },
        _ => effort,
    };
    let mut residual = settle(&of_beams, rough)?;
    let coarser = coarser(dims);
    let params = BounceParams {
        level: problem.level(dims, medium.lattice.cell_m),
        shape: medium.shape(),
        n_beams: beams.beams.len() as u32,
        n_points: 0,
        coarser: coarser as u32,
        pad: 0,
    };
    let list = beam_list(gpu, beams, &channels)?;
    let lit = Lit { run, medium, beams, surfaces, list: &list, params: &params, patches: &patches };
    let sampler = gpu.linear_sampler();
    let [nodes, triangles] = surfaces.binds();
    let (clamp, sigma_t) = (Bind::Sampler(&sampler), Bind::Texture(&medium.sigma_t));
    let layers = problem.layers(dims);
    let lit_dims = dims.map(|n| n / coarser);
    let uncollided =
        gpu.texture3("light straight from surfaces", problem.layers(lit_dims), Format::Rgba32Float, REMEDY)?;
    let mut on_patches = patches.irradiances(run)?;
    let mut sources: Option<Sources> = None;
    for bounce in 0..BOUNCES {
        let field = &sources.as_ref().unwrap_or(&of_beams).field;
        on_patches = lit.irradiances(&patches, [field, &residual.moments], &on_patches, true)?;

        let inputs =
            [sigma_t, clamp, nodes, triangles, Bind::Buffer(&patches.grids), Bind::Buffer(&on_patches)];
        let stage = gpu.stage("isotropic_residual/uncollided", &[])?;
        let mut recorder = gpu.recorder("light straight from surfaces");
        recorder.dispatch(&stage.bind(gpu, &params, &inputs, &[Bind::Texture(&uncollided)]), lit_dims);
        run.finish(recorder)?;

        let field = gpu.texture3("sources", layers, Format::Rgba32Float, REMEDY)?;
        let inputs = [sigma_t, clamp, Bind::Texture(&uncollided), Bind::Texture(&of_beams.field)];
        let stage = gpu.stage("isotropic_residual/first_collision", &[])?;
        let mut recorder = gpu.recorder("light straight from surfaces");
        recorder.dispatch(&stage.bind(gpu, &params, &inputs, &[Bind::Texture(&field)]), layers);
        run.finish(recorder)?;
        let collided = with_sums(run, problem, &params.level, field)?;
        residual = settle(&collided, if bounce + 1 < BOUNCES { rough } else { effort })?;
        sources = Some(collided);
    }
    // What comes straight from surfaces is in the sources by its first collision, and seen itself by the rays
    // that meet patches: the moments here are still without it.
    let field = &sources.as_ref().unwrap_or(&of_beams).field;
    let corners = Points::corners(run, surfaces)?;
    let irradiances = lit.irradiances(&corners, [field, &residual.moments], &on_patches, false)?;
    let surface_light =
        SurfaceLight { irradiances, grids: corners.grids, triangles: surfaces.corners.clone() };

    let moments = gpu.texture3("moments", layers, Format::Rgba32Float, REMEDY)?;
    let inputs = [clamp, Bind::Texture(&uncollided), Bind::Texture(&residual.moments)];
    let stage = gpu.stage("isotropic_residual/add_uncollided", &[])?;
    let mut recorder = gpu.recorder("light straight from surfaces");
    recorder.dispatch(&stage.bind(gpu, &params, &inputs, &[Bind::Texture(&moments)]), layers);
    run.finish(recorder)?;
    Ok(Residual { moments: Arc::new(moments), surface_light: Some(Arc::new(surface_light)), ..residual })
}

/// What light on surfaces depends on, all bounces alike.
struct Lit<'a> {
    run: &'a Run<'a>,
    medium: &'a Medium,
    beams: &'a Beams,
    surfaces: &'a Surfaces,
    list: &'a Buffer,
    params: &'a BounceParams,
    patches: &'a Points,
}

impl Lit<'_> {
    /// E on both sides of points, by sources and moments of the medium and by what arrived on patches before.
    fn irradiances(
        &self,
        points: &Points,
        [sources, moments]: [&Texture; 2],
        on_patches: &Buffer,
        narrow: bool,
    ) -> Result<Buffer, NodeError> {
        let gpu = self.run.gpu;
        let found = points.irradiances(self.run)?;
        let sampler = gpu.linear_sampler();
        let [nodes, triangles] = self.surfaces.binds();
        let inputs = [
            Bind::Texture(&self.medium.sigma_t),
            Bind::Sampler(&sampler),
            Bind::Texture(sources),
            Bind::Texture(moments),
            nodes,
            triangles,
            Bind::Buffer(&points.list),
            Bind::Buffer(&self.patches.grids),
            Bind::Buffer(on_patches),
            Bind::Buffer(self.list),
        ];
        let [pack, _] = self.beams.tau.choices();
        let stage = gpu.stage("isotropic_residual/surface_light", &[pack, ("narrow", narrow.to_string())])?;
        let params = BounceParams { n_points: points.n_points as u32, ..*self.params };
        let bound = stage.bind(gpu, &params, &inputs, &[Bind::Buffer(&found)]);
        let n_sides = 2 * points.n_points;
        let mut recorder = gpu.recorder("light on surfaces");
        recorder.dispatch(&bound, [n_sides.min(ROW), n_sides.div_ceil(ROW), 1]);
        self.run.finish(recorder)?;
        Ok(found)
    }
}

/// How many of the lattice's cells one that looks for patches stands for, along an axis.
fn coarser(dims: [usize; 3]) -> usize {
    let mut coarser = 1;
    while dims.iter().all(|n| n % (2 * coarser) == 0)
        && dims.iter().map(|n| n / coarser).product::<usize>() > LIT_CELLS
    {
        coarser *= 2;
    }
    coarser
}

#[cfg(test)]
mod tests;
