//! A box of voxels with a value in each.
//!
//! The value of voxel (i, j, k) sits at the index coordinate (i, j, k), not at its corner, so the box
//! reaches half a voxel beyond the outermost values.

use glam::{DMat4, DVec3};

/// Voxels in memory, x fastest.
#[derive(Clone, Debug)]
pub struct Dense {
    /// Voxels along x, y and z, each at least 1.
    pub dims: [usize; 3],
    /// Value of voxel (x, y, z) at `x + nx * (y + ny * z)`.
    pub values: Vec<f32>,
    /// From index coordinates to the world in meters.
    pub world_from_index: DMat4,
}

impl Dense {
    /// An empty (all 0) box of `dims` cubic voxels with its center at the world's origin.
    pub fn centered(dims: [usize; 3], voxel_size_m: f64) -> Self {
        let [nx, ny, nz] = dims;
        let last = DVec3::new(nx as f64, ny as f64, nz as f64) - 1.0;
        Self {
            dims,
            values: vec![0.0; nx * ny * nz],
            world_from_index: DMat4::from_translation(-0.5 * voxel_size_m * last)
                * DMat4::from_scale(DVec3::splat(voxel_size_m)),
        }
    }

    /// Edge of a voxel along its first axis in meters.
    pub fn voxel_m(&self) -> f64 {
        self.world_from_index.x_axis.truncate().length()
    }

    /// First and last voxel that is not 0; `None` where all are.
    pub fn occupied(&self) -> Option<([usize; 3], [usize; 3])> {
        let [nx, ny, _] = self.dims;
        let mut found: Option<([usize; 3], [usize; 3])> = None;
        for (row, values) in self.values.chunks_exact(nx).enumerate() {
            let Some(first) = values.iter().position(|&value| value != 0.0) else { continue };
            let last = values.iter().rposition(|&value| value != 0.0).unwrap_or(first);
            let (low, high) = ([first, row % ny, row / ny], [last, row % ny, row / ny]);
            found = Some(found.map_or((low, high), |(min, max)| {
                (
                    std::array::from_fn(|axis| min[axis].min(low[axis])),
                    std::array::from_fn(|axis| max[axis].max(high[axis])),
                )
            }));
        }
        found
    }
}
