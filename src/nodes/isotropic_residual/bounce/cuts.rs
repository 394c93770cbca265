//! Triangles cut into n² equal ones (`shaders/lib/cuts.wgsl`): the points of surfaces at which light is known.
//!
//! Patches, which send light back, are known at their middles. What a camera sees is known at the corners of the
//! cuts, a little towards the middle of their triangle: a corner often lies on another surface too, where
//! walls meet or a thing stands on the ground, and would be in its shadow or not by chance.

use glam::Vec3;

use super::super::super::Run;
use crate::gpu::Buffer;
use crate::graph::NodeError;
use crate::mirror;
use crate::wire::Surfaces;

mirror! {
    /// `SurfacePoint` of `surface_light.wgsl`.
    pub(in super::super) struct SurfacePoint {
        p: [f32; 3],
        triangle: u32,
    }
}

/// Patches of all surfaces together, about.
const PATCHES: f32 = 16384.0;
/// Least area of a patch [cells²].
const LEAST_AREA: f32 = 4.0;
/// How far corners move towards the middle of a triangle, in its cuts. In a corner between walls two cells
/// high that is 0.02 cells, 20 times what rays do not see at their start.
const INWARD: f32 = 1.0 / 32.0;
const REMEDY: &str = "use a mesh of fewer triangles";

/// Points on all triangles.
pub(super) struct Points {
    pub(super) list: Buffer,
    pub(super) n_points: usize,
    /// For each triangle its first point, and its cuts along an edge.
    pub(super) grids: Buffer,
}

impl Points {
    /// The middles of the cuts.
    pub(super) fn middles(run: &Run, surfaces: &Surfaces) -> Result<Self, NodeError> {
        Self::new(run, surfaces, |n| middles(n).collect())
    }

    /// The corners of the cuts.
    pub(super) fn corners(run: &Run, surfaces: &Surfaces) -> Result<Self, NodeError> {
        Self::new(run, surfaces, |n| corners(n).map(|at| inward(n, at)).collect())
    }

    fn new(run: &Run, surfaces: &Surfaces, of_cuts: fn(u32) -> Vec<[f32; 2]>) -> Result<Self, NodeError> {
        let area = |[a, b, c]: &[Vec3; 3]| 0.5 * (*b - *a).cross(*c - *a).length();
        let all: f32 = surfaces.corners.iter().map(area).sum();
        let wanted = (all / PATCHES).max(LEAST_AREA);
        let (mut list, mut grids) = (Vec::new(), Vec::new());
        for (triangle, corners) in surfaces.corners.iter().enumerate() {
            let n = (area(corners) / wanted).sqrt().ceil().clamp(1.0, PATCHES.sqrt()) as u32;
            grids.push([list.len() as u32, n]);
            list.extend(of_cuts(n).into_iter().map(|[u, v]| {
                let [a, b, c] = *corners;
                SurfacePoint { p: (a + u * (b - a) + v * (c - a)).to_array(), triangle: triangle as u32 }
            }));
        }
        Ok(Self {
            n_points: list.len(),
            list: run.gpu.buffer_from("points of surfaces", &list, REMEDY)?,
            grids: run.gpu.buffer_from("cuts of surfaces", &grids, REMEDY)?,
        })
    }

    /// An irradiance for each side of each point, none yet.
    pub(super) fn irradiances(&self, run: &Run) -> Result<Buffer, NodeError> {
        Ok(run.gpu.buffer("irradiances of surfaces", 32 * self.n_points as u64, REMEDY)?)
    }
}

/// The middles of a triangle's n² cuts, in the order of `patch_radiance` in `shaders/lib/patches.wgsl`.
fn middles(n: u32) -> impl Iterator<Item = [f32; 2]> {
    (0..n).flat_map(move |i| {
        (0..2 * (n - i) - 1).map(move |m| {
            let (j, is_upper) = (m / 2, m % 2);
            let third = (1 + is_upper) as f32 / 3.0;
            [(i as f32 + third) / n as f32, (j as f32 + third) / n as f32]
        })
    })
}

/// Their corners, in the order of `cut_corner` in `shaders/lib/surface_light.wgsl`.
fn corners(n: u32) -> impl Iterator<Item = [f32; 2]> {
    (0..=n).flat_map(move |i| (0..=n - i).map(move |j| [i as f32 / n as f32, j as f32 / n as f32]))
}

fn inward(n: u32, at: [f32; 2]) -> [f32; 2] {
    at.map(|x| x + INWARD / n as f32 * (1.0 / 3.0 - x))
}

#[cfg(test)]
pub(super) mod tests;
