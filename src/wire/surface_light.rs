//! What arrives on surfaces, for a camera that sees them (`shaders/lib/surface_light.wgsl`).

use glam::Vec3;

use super::Surfaces;
use crate::gpu::{Bind, Buffer};

/// Irradiance [W/m²] at the corners of the cuts of each triangle, on both of its sides, between which it is
/// linear. In it is all light but that of narrow beams (`is_narrow` of `shaders/lib/beam.wgsl`), whose
/// shadows are sharper than cuts: who looks it up adds those.
pub struct SurfaceLight {
    /// Two for each corner, the side of the normal and the other; the residual's channels in red, green and
    /// blue, one channel in red.
    pub(crate) irradiances: Buffer,
    /// For each triangle its first corner, and its cuts along an edge.
    pub(crate) grids: Buffer,
    /// The triangles, in the order in which they are numbered.
    pub(crate) triangles: Vec<[Vec3; 3]>,
}

impl SurfaceLight {
    /// Whether these are the surfaces that it lies on, numbered alike.
    pub fn is_of(&self, surfaces: &Surfaces) -> bool {
        self.triangles == surfaces.corners
    }

    /// For a stage: `surface_light`, then `surface_grids`.
    pub fn binds(&self) -> [Bind<'_>; 2] {
        [Bind::Buffer(&self.irradiances), Bind::Buffer(&self.grids)]
    }

    /// On the GPU.
    pub fn bytes(&self) -> u64 {
        self.irradiances.bytes() + self.grids.bytes()
    }
}
