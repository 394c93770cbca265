//! What arrives on surfaces, for a camera that sees them (`shaders/lib/surface_light.wgsl`).

use glam::Vec3;

use super::Surfaces;
use crate::gpu::{Bind, Buffer};

/// Irradiance [W/m²] at points of surfaces, on both of their sides; across a triangle it is linear between the
/// points of its corners. In it is all light but that of narrow beams (`is_narrow` of
/// `shaders/lib/beam.wgsl`), whose shadows are sharper than triangles: who looks it up adds those.
pub struct SurfaceLight {
    /// Two for each point, the side of the normal and the other; the residual's channels in red, green and
    /// blue, one channel in red.
    pub(crate) irradiances: Buffer,
    /// For each triangle the points that its corners are lit as.
    pub(crate) corners: Buffer,
    /// The triangles, small enough for what arrives.
    pub(crate) surfaces: Surfaces,
    /// What they are pieces of, in the order in which those are numbered.
    pub(crate) whole: Vec<[Vec3; 3]>,
}

impl SurfaceLight {
    /// Whether it lies on these surfaces.
    pub fn is_of(&self, surfaces: &Surfaces) -> bool {
        self.whole == surfaces.corners
    }

    /// The triangles by whose numbers it is looked up.
    pub fn surfaces(&self) -> &Surfaces {
        &self.surfaces
    }

    /// For a stage: `surface_light`, then `surface_corners`.
    pub fn binds(&self) -> [Bind<'_>; 2] {
        [Bind::Buffer(&self.irradiances), Bind::Buffer(&self.corners)]
    }

    /// On the GPU.
    pub fn bytes(&self) -> u64 {
        self.irradiances.bytes() + self.corners.bytes() + self.surfaces.bytes()
    }
}
