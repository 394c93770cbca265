//! Light that surfaces send back into the medium (DESIGN 6.7).
//!
//! At points of surfaces (`points.rs`) the irradiance E is known on both sides, between them it is linear, and
//! surfaces send back L = reflectance E / pi. E is what beams bring, past surfaces and through the medium, and
//! a march of 16 directions through what the medium scatters, to other surfaces and ambient light. From cells
//! near matter 32 rays look for surfaces: their (phi, F) is the first-collision source Q0 += sigma_s* phi,
//! Q1 += sigma_s* g* F of another solve, and is added to the field that the camera reads. Twice: what comes back
//! once more lights surfaces again.
//! Ambient light enters the solver past surfaces: what they hide of it is taken off the same rays, so that
//! (phi, F) straight from surfaces may be negative. With the ambient light that is in the solver's it is not.
//! In the end E is computed once more, from 64 directions and without narrow beams: what a camera finds on
//! surfaces that it sees.
//!
//! What the medium has scattered ends at surfaces inside of it (`walls.rs`). All solves but the last are rough: of
//! a cascade the two finest grids get what comes from the third.
//!
//! Limits: light on surfaces is as coarse as their points (two cells apart or more, 2^14 on all surfaces), and is
//! gathered on at most 2^16 cells. Tested by the closed forms of planes in a void and in a thin medium, and by what
//! a closed ball must hold.

use std::sync::Arc;

use super::super::Run;
use super::level::{LevelParams, Problem, REMEDY};
use super::sources::{Sources, with_sums};
use super::{Effort, level, solver};
use crate::gpu::{Bind, Buffer, Format, Texture};
use crate::graph::NodeError;
use crate::mirror;
use crate::wire::{Beam, Beams, Channels, Medium, Residual, ShapeTexel, SurfaceLight, Surfaces};

mod few;
mod flame;
mod points;

use points::Points;

mirror! {
    /// `BounceParams` of `bounce.wgsl`.
    pub(super) struct BounceParams {
        level: LevelParams,
        shape: ShapeTexel,
        n_beams: u32,
        n_points: u32,
        coarser: u32,
        pad: u32,
        flame: [f32; 4],
    }
}

/// Cells that look for surfaces, at most: in the last bounce, which is seen, and in the one before.
const LIT_CELLS: [usize; 2] = [1 << 16, 1 << 13];
/// Threads along x of one dispatch, 65,535 groups of 64, as `surface_light.wgsl` has it.
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
    let points = Points::new(run.gpu, medium.lattice.occupied, surfaces)?;
    let params = BounceParams {
        level: problem.level(medium.lattice.dims, medium.lattice.cell_m),
        shape: medium.shape(),
        n_beams: 0,
        n_points: 0,
        coarser: 1,
        pad: 0,
        flame: flame::ball(run, medium)?.to_array(),
    };
    let of_beams = super::sources::sources(run, medium, beams, &channels, problem)?;
    let mut scene = Scene { run, medium, beams, problem, channels, params, points, of_beams };
    let rough = effort.rough();
    let unseen = scene.scattered(&scene.of_beams, &scene.settle(&scene.of_beams, rough)?)?;
    let unlit = scene.points.irradiances(run.gpu)?;
    let from_beams = scene.light_of_beams(&few::few(&beams.beams), false)?;
    let glance = scene.irradiances(&unseen, &unlit, &from_beams, Use::Glance)?;
    scene.points = scene.points.settled(run.gpu, &glance)?;
    let from_beams = scene.light_of_beams(&beams.beams, true)?;
    let [most, most_before] = LIT_CELLS;
    let before = scene.bounce(&unseen, &unlit, &from_beams, most_before, rough)?;
    let last = scene.bounce(&before.scattered, &before.on_surfaces, &from_beams, most, effort)?;
    let irradiances = scene.irradiances(&last.scattered, &last.on_surfaces, &from_beams, Use::Camera)?;
    let moments = Arc::new(scene.with_uncollided(&last)?);
    let surface_light = SurfaceLight {
        irradiances,
        corners: scene.points.corners,
        surfaces: scene.points.surfaces,
        whole: surfaces.corners.clone(),
    };
    Ok(Residual { moments, surface_light: Some(Arc::new(surface_light)), ..last.residual })
}

/// What light on points of surfaces is for.
#[derive(Clone, Copy, PartialEq)]
enum Use {
    /// To see which points are in the dark.
    Glance,
    /// To be sent back.
    Bounce,
    /// To be seen by a camera, which adds narrow beams by itself.
    Camera,
}

impl Use {
    /// From how many directions light is gathered. What surfaces send back is spread over the medium before it
    /// is seen.
    fn n_directions(self) -> usize {
        match self {
            Self::Glance => 4,
            Self::Bounce => 16,
            Self::Camera => 64,
        }
    }
}

/// What all bounces share.
struct Scene<'a> {
    run: &'a Run<'a>,
    medium: &'a Medium,
    beams: &'a Beams,
    problem: &'a Problem,
    channels: Channels,
    params: BounceParams,
    points: Points,
    of_beams: Sources,
}

/// Light after a bounce.
struct Bounced {
    /// E on surfaces, of which this is the light.
    on_surfaces: Buffer,
    /// phi and F straight from surfaces, in cells `coarser` times as large as the medium's.
    uncollided: Texture,
    coarser: u32,
    /// What all cells scatter, after their first collision too.
    scattered: Texture,
    /// Without what comes straight from surfaces.
    residual: Residual,
}

impl Scene<'_> {
    fn settle(&self, sources: &Sources, effort: Effort) -> Result<Residual, NodeError> {
        solver::solve(self.run, self.medium, sources, self.problem, effort, self.channels, level::BATCH_BYTES)
    }

    /// Lights the surfaces, and the medium by them.
    fn bounce(
        &self,
        scattered: &Texture,
        on_surfaces: &Buffer,
        from_beams: &Buffer,
        most_lit: usize,
        effort: Effort,
    ) -> Result<Bounced, NodeError> {
        let gpu = self.run.gpu;
        let on_surfaces = self.irradiances(scattered, on_surfaces, from_beams, Use::Bounce)?;
        let dims = self.medium.lattice.dims;
        let coarser = coarser(dims, most_lit);
        let params = BounceParams { coarser: coarser as u32, ..self.params };
        let lit_dims = dims.map(|n| n / coarser);
        let sampler = gpu.linear_sampler();
        let (clamp, sigma_t) = (Bind::Sampler(&sampler), Bind::Texture(&self.medium.sigma_t));
        let [nodes, triangles] = self.points.surfaces.binds();
        let inputs = [
            sigma_t,
            clamp,
            Bind::Texture(&self.medium.blocks.texture),
            nodes,
            triangles,
            Bind::Buffer(&self.points.corners),
            Bind::Buffer(&on_surfaces),
        ];
        let uncollided = self.field("light straight from surfaces", lit_dims)?;
        self.dispatch("uncollided", &params, &inputs, &uncollided, lit_dims)?;

        let inputs = [sigma_t, clamp, Bind::Texture(&uncollided), Bind::Texture(&self.of_beams.field)];
        let field = self.field("sources", dims)?;
        self.dispatch("first_collision", &params, &inputs, &field, self.problem.layers(dims))?;
        let sources = with_sums(self.run, self.problem, &self.params.level, field)?;
        let residual = self.settle(&sources, effort)?;
        let scattered = self.scattered(&sources, &residual)?;
        Ok(Bounced { on_surfaces, uncollided, coarser: params.coarser, scattered, residual })
    }

    /// What beams bring to all points, past surfaces and, if `has_depths`, dimmed by the medium: of narrow ones on
    /// both sides, and then of the others.
    fn light_of_beams(&self, beams: &[Beam], has_depths: bool) -> Result<Buffer, NodeError> {
        let gpu = self.run.gpu;
        let n_points = self.points.n_points;
        let found = gpu.buffer("light of beams on surfaces", 64 * n_points as u64, REMEDY)?;
        let list = Beams::list_of(gpu, beams, &self.channels)?;
        let sampler = gpu.linear_sampler();
        let [nodes, triangles] = self.points.surfaces.binds();
        let inputs = [
            Bind::Texture(&self.medium.sigma_t),
            Bind::Sampler(&sampler),
            Bind::Texture(&self.medium.blocks.texture),
            nodes,
            triangles,
            Bind::Buffer(&self.points.list),
            Bind::Buffer(&list),
        ];
        let choices = [("pack", self.beams.pack().to_string()), ("depths", has_depths.to_string())];
        let stage = gpu.stage("isotropic_residual/surface_beams", &choices)?;
        let params = BounceParams { n_beams: beams.len() as u32, n_points: n_points as u32, ..self.params };
        let mut recorder = gpu.recorder("light on surfaces");
        let bound = stage.bind(gpu, &params, &inputs, &[Bind::Buffer(&found)]);
        recorder.dispatch(&bound, [n_points.min(ROW), n_points.div_ceil(ROW), 1]);
        self.run.finish(recorder)?;
        Ok(found)
    }

    /// E on both sides of all points, by what the medium scatters and by what arrived on surfaces before.
    fn irradiances(
        &self,
        scattered: &Texture,
        on_surfaces: &Buffer,
        from_beams: &Buffer,
        what_for: Use,
    ) -> Result<Buffer, NodeError> {
        let gpu = self.run.gpu;
        let points = &self.points;
        let found = points.irradiances(gpu)?;
        let sampler = gpu.linear_sampler();
        let [nodes, triangles] = self.points.surfaces.binds();
        let inputs = [
            Bind::Texture(&self.medium.sigma_t),
            Bind::Sampler(&sampler),
            Bind::Texture(&self.medium.blocks.texture),
            Bind::Texture(scattered),
            nodes,
            triangles,
            Bind::Buffer(&points.list),
            Bind::Buffer(&self.points.corners),
            Bind::Buffer(on_surfaces),
            Bind::Buffer(from_beams),
        ];
        let choices = [
            ("narrow", (what_for != Use::Camera).to_string()),
            ("glows", self.medium.emission.is_some().to_string()),
            ("skips_dark", (what_for == Use::Camera).to_string()),
            ("directions", what_for.n_directions().to_string()),
            ("channels", self.channels.count.to_string()),
        ];
        let stage = gpu.stage("isotropic_residual/surface_light", &choices)?;
        let params = BounceParams { n_points: points.n_points as u32, ..self.params };
        let bound = stage.bind(gpu, &params, &inputs, &[Bind::Buffer(&found)]);
        let n_sides = 2 * points.n_points;
        let mut recorder = gpu.recorder("light on surfaces");
        recorder.dispatch(&bound, [n_sides.min(ROW), n_sides.div_ceil(ROW), 1]);
        self.run.finish(recorder)?;
        Ok(found)
    }

    fn scattered(&self, sources: &Sources, residual: &Residual) -> Result<Texture, NodeError> {
        let dims = self.medium.lattice.dims;
        let [sigma_t, moments] = [&self.medium.sigma_t, &residual.moments].map(|field| Bind::Texture(field));
        let inputs = [sigma_t, Bind::Texture(&sources.field), moments];
        let field = self.field("what cells scatter", dims)?;
        self.dispatch("scattered", &self.params, &inputs, &field, self.problem.layers(dims))?;
        Ok(field)
    }

    /// The moments that a camera sees.
    fn with_uncollided(&self, last: &Bounced) -> Result<Texture, NodeError> {
        let dims = self.medium.lattice.dims;
        let params = BounceParams { coarser: last.coarser, ..self.params };
        let sampler = self.run.gpu.linear_sampler();
        let inputs =
            [Bind::Sampler(&sampler), Bind::Texture(&last.uncollided), Bind::Texture(&last.residual.moments)];
        let moments = self.field("moments", dims)?;
        self.dispatch("add_uncollided", &params, &inputs, &moments, self.problem.layers(dims))?;
        Ok(moments)
    }

    fn field(&self, what: &str, dims: [usize; 3]) -> Result<Texture, NodeError> {
        Ok(self.run.gpu.texture3(what, self.problem.layers(dims), Format::Rgba32Float, REMEDY)?)
    }

    fn dispatch(
        &self,
        stage: &str,
        params: &BounceParams,
        inputs: &[Bind],
        output: &Texture,
        threads: [usize; 3],
    ) -> Result<(), NodeError> {
        let gpu = self.run.gpu;
        let stage = gpu.stage(&format!("isotropic_residual/{stage}"), &[])?;
        let mut recorder = gpu.recorder("light straight from surfaces");
        recorder.dispatch(&stage.bind(gpu, params, inputs, &[Bind::Texture(output)]), threads);
        self.run.finish(recorder)
    }
}

/// How many of the lattice's cells one that looks for surfaces stands for, along an axis.
fn coarser(dims: [usize; 3], most: usize) -> usize {
    let mut coarser = 1;
    while dims.iter().all(|n| n % (2 * coarser) == 0)
        && dims.iter().map(|n| n / coarser).product::<usize>() > most
    {
        coarser *= 2;
    }
    coarser
}

#[cfg(test)]
mod tests;
