//! A participating medium on the solver's grid.

use std::sync::Arc;

use glam::DVec3;

use crate::gpu::Texture;
use crate::mirror;
use crate::volume::Lattice;

/// Extinction on a lattice, with the optical properties that all of it shares.
#[derive(Clone)]
pub struct Medium {
    /// The grid that all solvers of this medium use.
    pub lattice: Lattice,
    /// sigma_t [1/m] at the centers of cells; one R32Float texel a cell, void on the border.
    pub sigma_t: Arc<Texture>,
    /// The largest sigma_t that a sample in a block of 8³ cells can meet [1/m]; one R32Float texel a block.
    pub blocks: Arc<Texture>,
    /// The largest sigma_t [1/m].
    pub sigma_t_max: f64,
    /// sigma_s / sigma_t.
    pub albedo: [f64; 3],
    /// Mean cosine of the phase function.
    pub g: f64,
    /// Set where the medium is one shape of one density, whose boundary is then exact.
    pub homogeneous: Option<Homogeneous>,
}

/// A shape filled evenly, in index space.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Homogeneous {
    /// An ellipsoid; else a box.
    pub ellipsoid: bool,
    /// Center.
    pub center: DVec3,
    /// Half of its extents, along the axes of index space.
    pub half_extent: DVec3,
}

mirror! {
    /// `Shape` of `shaders/lib/shape.wgsl`.
    pub struct ShapeTexel {
        /// Center in index space.
        center: [f32; 3],
        /// 0 voxels, 1 ellipsoid, 2 box.
        kind: u32,
        /// Half extents in index space.
        half_extent: [f32; 3],
        /// Extinction inside a closed form [1/m].
        sigma_t: f32,
    }
}

impl Medium {
    /// What bounds the medium, for the shaders.
    pub fn shape(&self) -> ShapeTexel {
        let single = |v: DVec3| v.as_vec3().to_array();
        match self.homogeneous {
            Some(shape) => ShapeTexel {
                center: single(shape.center),
                kind: if shape.ellipsoid { 1 } else { 2 },
                half_extent: single(shape.half_extent),
                sigma_t: self.sigma_t_max as f32,
            },
            None => {
                // Between the centers of the outermost occupied cells; beyond there is void.
                let last = DVec3::from_array(self.lattice.occupied.map(|n| (n - 1) as f64));
                ShapeTexel {
                    center: single(0.5 * last),
                    kind: 0,
                    half_extent: single(0.5 * last),
                    sigma_t: 0.0,
                }
            }
        }
    }

    /// Whether all channels scatter alike.
    pub fn is_grey(&self) -> bool {
        self.albedo.iter().all(|&albedo| albedo == self.albedo[0])
    }
}
