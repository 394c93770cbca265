//! Light that surfaces send back into the medium (DESIGN 6.7).
//!
//! Surfaces are cut into patches, each with one radiance a side, L = reflectance E / pi. E is what beams
//! bring, past surfaces and through the medium, and a march of 64 directions through what the medium
//! scatters, other patches and ambient light. From every cell 32 rays look for patches: their (phi, F) is the
//! first-collision source Q0 += sigma_s* phi, Q1 += sigma_s* g* F of another solve, and is added to the
//! field that the camera reads. Twice: what comes back once more lights the patches again.
//!
//! Limits: surfaces do not block the lines of the solver; the light of patches is as coarse as they are (at
//! least two cells, 2^14 of them on all surfaces), and is gathered on at most 2^18 cells. Tested by the closed
//! form of a plane in a void and in a thin medium, and by what a closed white box must hold.

use std::sync::Arc;

use glam::Vec3;

use super::super::Run;
use super::level::{LevelParams, Problem, REMEDY};
use super::sources::{Sources, beam_list, with_sums};
use super::{Effort, Kind, level, solver};
use crate::gpu::{Bind, Buffer, Format};
use crate::graph::NodeError;
use crate::mirror;
use crate::wire::{Beams, Channels, Medium, Residual, ShapeTexel, Surfaces};

mirror! {
    /// `BounceParams` of `bounce.wgsl`.
    pub(super) struct BounceParams {
        level: LevelParams,
        shape: ShapeTexel,
        n_beams: u32,
        n_patches: u32,
        coarser: u32,
        pad: u32,
    }
}

mirror! {
    /// `Patch` of `patch_light.wgsl`.
    pub(super) struct Patch {
        point: [f32; 3],
        triangle: u32,
    }
}

const BOUNCES: usize = 2;
/// Patches of all surfaces together, about.
const PATCHES: f32 = 16384.0;
/// Least area of a patch [cells²].
const LEAST_AREA: f32 = 4.0;
/// Cells that look for patches, at most.
const LIT_CELLS: usize = 1 << 18;
/// Threads along x of one dispatch, 65,535 groups of 64; `patch_light.wgsl`.
const ROW: usize = 4_194_240;

/// The patches of surfaces.
struct Patches {
    list: Buffer,
    n_patches: usize,
    /// For each triangle its first patch, and its cuts along an edge.
    grids: Buffer,
}

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
    let patches = patches(run, surfaces)?;
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
        n_patches: patches.n_patches as u32,
        coarser: coarser as u32,
        pad: 0,
    };
    let list = beam_list(gpu, beams, &channels)?;
    let sampler = gpu.linear_sampler();
    let [nodes, triangles] = surfaces.binds();
    let (clamp, sigma_t) = (Bind::Sampler(&sampler), Bind::Texture(&medium.sigma_t));
    let (grids, layers) = (Bind::Buffer(&patches.grids), problem.layers(dims));
    let lit_dims = dims.map(|n| n / coarser);
    let uncollided =
        gpu.texture3("light straight from surfaces", problem.layers(lit_dims), Format::Rgba32Float, REMEDY)?;
    let mut radiances = side_radiances(run, &patches)?;
    let mut sources: Option<Sources> = None;
    for bounce in 0..BOUNCES {
        let reflected = side_radiances(run, &patches)?;
        let inputs = [
            sigma_t,
            clamp,
            Bind::Texture(&sources.as_ref().unwrap_or(&of_beams).field),
            Bind::Texture(&residual.moments),
            nodes,
            triangles,
            Bind::Buffer(&patches.list),
            grids,
            Bind::Buffer(&radiances),
            Bind::Buffer(&list),
        ];
        let n_sides = 2 * patches.n_patches;
        let stage = gpu.stage("isotropic_residual/patch_light", &beams.tau.choices())?;
        let mut recorder = gpu.recorder("light on surfaces");
        let bound = stage.bind(gpu, &params, &inputs, &[Bind::Buffer(&reflected)]);
        recorder.dispatch(&bound, [n_sides.min(ROW), n_sides.div_ceil(ROW), 1]);
        run.finish(recorder)?;
        radiances = reflected;

        let inputs = [sigma_t, clamp, nodes, triangles, grids, Bind::Buffer(&radiances)];
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
        let lit = with_sums(run, problem, &params.level, field)?;
        residual = settle(&lit, if bounce + 1 < BOUNCES { rough } else { effort })?;
        sources = Some(lit);
    }
    let moments = gpu.texture3("moments", layers, Format::Rgba32Float, REMEDY)?;
    let inputs = [clamp, Bind::Texture(&uncollided), Bind::Texture(&residual.moments)];
    let stage = gpu.stage("isotropic_residual/add_uncollided", &[])?;
    let mut recorder = gpu.recorder("light straight from surfaces");
    recorder.dispatch(&stage.bind(gpu, &params, &inputs, &[Bind::Texture(&moments)]), layers);
    run.finish(recorder)?;
    Ok(Residual { moments: Arc::new(moments), ..residual })
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

/// A radiance for each side of each patch, black.
fn side_radiances(run: &Run, patches: &Patches) -> Result<Buffer, NodeError> {
    Ok(run.gpu.buffer("radiances of patches", 32 * patches.n_patches as u64, MESH_REMEDY)?)
}

const MESH_REMEDY: &str = "use a mesh of fewer triangles";

fn patches(run: &Run, surfaces: &Surfaces) -> Result<Patches, NodeError> {
    let area = |[a, b, c]: &[Vec3; 3]| 0.5 * (*b - *a).cross(*c - *a).length();
    let all: f32 = surfaces.corners.iter().map(area).sum();
    let wanted = (all / PATCHES).max(LEAST_AREA);
    let (mut list, mut grids) = (Vec::new(), Vec::new());
    for (triangle, corners) in surfaces.corners.iter().enumerate() {
        let n = (area(corners) / wanted).sqrt().ceil().clamp(1.0, PATCHES.sqrt()) as u32;
        grids.push([list.len() as u32, n]);
        list.extend(middles(n).map(|[u, v]| {
            let [a, b, c] = *corners;
            Patch { point: (a + u * (b - a) + v * (c - a)).to_array(), triangle: triangle as u32 }
        }));
    }
    Ok(Patches {
        n_patches: list.len(),
        list: run.gpu.buffer_from("patches of surfaces", &list, MESH_REMEDY)?,
        grids: run.gpu.buffer_from("grids of patches", &grids, MESH_REMEDY)?,
    })
}

/// The middles of a triangle's n² patches, in the order of `patch_at` in `shaders/lib/patches.wgsl`.
fn middles(n: u32) -> impl Iterator<Item = [f32; 2]> {
    (0..n).flat_map(move |i| {
        (0..2 * (n - i) - 1).map(move |m| {
            let (j, is_upper) = (m / 2, m % 2);
            let third = (1 + is_upper) as f32 / 3.0;
            [(i as f32 + third) / n as f32, (j as f32 + third) / n as f32]
        })
    })
}

#[cfg(test)]
mod tests;
