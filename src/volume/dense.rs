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

    /// For each axis the sum, over the slices across it, of the largest value in each.
    pub fn slice_maxima(&self) -> [f64; 3] {
        let [nx, ny, nz] = self.dims;
        let mut largest = [vec![0.0_f32; nx], vec![0.0; ny], vec![0.0; nz]];
        for (row, values) in self.values.chunks_exact(nx).enumerate() {
            let mut of_row = 0.0_f32;
            for (of_slice, &value) in largest[0].iter_mut().zip(values) {
                *of_slice = of_slice.max(value);
                of_row = of_row.max(value);
            }
            for (axis, n) in [(1, row % ny), (2, row / ny)] {
                largest[axis][n] = largest[axis][n].max(of_row);
            }
        }
        largest.map(|slices| slices.into_iter().map(f64::from).sum())
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn slices_have_their_largest() {
        let mut dense = Dense::centered([3, 2, 4], 1.0);
        for (x, y, z, value) in [(0, 0, 0, 1.0), (0, 1, 3, 4.0), (2, 1, 3, 3.0), (1, 0, 2, 0.5)] {
            dense.values[x + 3 * (y + 2 * z)] = value;
        }
        assert_eq!(dense.slice_maxima(), [4.0 + 0.5 + 3.0, 1.0 + 4.0, 1.0 + 0.5 + 4.0]);
    }
}
