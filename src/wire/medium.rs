//! A participating medium on the solver's grid.

use std::sync::Arc;

use glam::DVec3;

use super::Emission;
use crate::gpu::{Bind, Format, Gpu, GpuError, Texture};
use crate::mirror;
use crate::volume::Lattice;

/// Extinction on a lattice, with the optical properties that all of it shares.
#[derive(Clone)]
pub struct Medium {
    /// The grid that all solvers of this medium use.
    pub lattice: Lattice,
    /// sigma_t [1/m] at the centers of cells; one R32Float texel a cell, void on the border.
    pub sigma_t: Arc<Texture>,
    /// Where there is something.
    pub blocks: Arc<Blocks>,
    /// The largest sigma_t [1/m].
    pub sigma_t_max: f64,
    /// No straight way has a larger optical depth.
    pub tau_max: f64,
    /// sigma_s / sigma_t.
    pub albedo: [f64; 3],
    /// Mean cosine of the phase function.
    pub g: f64,
    /// Set where it glows.
    pub emission: Option<Emission>,
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

mirror! {
    /// `OccupancyParams` of `shaders/occupancy.wgsl`.
    pub struct OccupancyParams {
        /// Blocks along x, y, z.
        n_blocks: [u32; 3],
        /// Unused.
        pad: u32,
    }
}

/// Kinds of a [`ShapeTexel`], as `shaders/lib/shape.wgsl` has them.
const VOXELS: u32 = 0;
const ELLIPSOID: u32 = 1;
const BOX: u32 = 2;

/// Edge of a block in cells.
const BLOCK: usize = 8;

/// The largest of sigma_t [1/m] and emission that a sample in each block of 8³ cells can meet.
pub struct Blocks {
    /// One R32Float texel a block.
    pub texture: Texture,
    /// The same numbers.
    pub largest: Vec<f32>,
}

impl Blocks {
    /// Blocks that are not empty.
    pub fn n_filled(&self) -> usize {
        self.largest.iter().filter(|largest| **largest > 0.0).count()
    }

    /// The number of the block that a position of index space lies in; outside, of the nearest one.
    pub fn at(&self, p: DVec3) -> f32 {
        let dims = self.texture.dims();
        let at =
            |axis: usize| (((p[axis] + 0.5) / BLOCK as f64).max(0.0) as usize).min(dims[axis] as usize - 1);
        self.largest[at(0) + dims[0] as usize * (at(1) + dims[1] as usize * at(2))]
    }
}

/// Which blocks of cells hold something, so that rays pass empty ones in one step.
///
/// # Errors
/// What the device reports.
pub fn occupancy(gpu: &Gpu, sigma_t: &Texture, emission: Option<&Emission>) -> Result<Blocks, GpuError> {
    let n_blocks = sigma_t.dims().map(|n| (n as usize).div_ceil(BLOCK));
    let blocks =
        gpu.texture3("blocks of cells", n_blocks, Format::R32Float, "lower medium.max_resolution")?;
    let params = OccupancyParams { n_blocks: n_blocks.map(|n| n as u32), pad: 0 };
    let stage = gpu.stage("occupancy", &[("emission", emission.is_some().to_string())])?;
    let glow = Emission::or_none(emission, gpu)?;
    let inputs = [Bind::Texture(sigma_t), Bind::Texture(&glow.cells)];
    let mut recorder = gpu.recorder("occupancy");
    recorder.dispatch(&stage.bind(gpu, &params, &inputs, &[Bind::Texture(&blocks)]), n_blocks);
    recorder.finish()?;
    let largest = gpu.read_texture(&blocks)?;
    Ok(Blocks { texture: blocks, largest })
}

impl Medium {
    /// Whether it is the same in all channels.
    pub fn is_grey(&self) -> bool {
        self.albedo.iter().all(|albedo| *albedo == self.albedo[0])
    }

    /// What bounds the medium, for the shaders.
    pub fn shape(&self) -> ShapeTexel {
        let single = |v: DVec3| v.as_vec3().to_array();
        match self.homogeneous {
            Some(shape) => ShapeTexel {
                center: single(shape.center),
                kind: if shape.ellipsoid { ELLIPSOID } else { BOX },
                half_extent: single(shape.half_extent),
                sigma_t: self.sigma_t_max as f32,
            },
            None => {
                // Between the centers of the outermost occupied cells; beyond there is void.
                let last = DVec3::from_array(self.lattice.occupied.map(|n| (n - 1) as f64));
                ShapeTexel {
                    center: single(0.5 * last),
                    kind: VOXELS,
                    half_extent: single(0.5 * last),
                    sigma_t: 0.0,
                }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::gpu::{Shader, wgsl_constant};

    #[test]
    fn blocks_are_as_large_in_the_shaders() {
        let shader = Shader::expand("occupancy.wgsl", &[("emission", "true".to_owned())]).unwrap();
        assert_eq!(wgsl_constant(&shader, "BLOCK").unwrap(), [BLOCK as f64]);
    }

    #[test]
    fn shapes_have_the_same_numbers_in_the_shaders() {
        let shader = Shader::expand("lib/shape.wgsl", &[]).unwrap();
        for (name, kind) in [("VOXELS", VOXELS), ("ELLIPSOID", ELLIPSOID), ("BOX", BOX)] {
            assert_eq!(wgsl_constant(&shader, name).unwrap(), [f64::from(kind)], "{name}");
        }
    }
}
