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

    /// The same with a border of one voxel of what stands outside, and each value as `value` makes it.
    pub fn padded(&self, outside: f32, value: impl Fn(f32) -> f32) -> Self {
        let [nx, ny, nz] = self.dims;
        let dims = self.dims.map(|n| n + 2);
        let mut values = vec![value(outside); dims.iter().product()];
        for z in 0..nz {
            for y in 0..ny {
                let from = nx * (y + ny * z);
                let to = 1 + dims[0] * (y + 1 + dims[1] * (z + 1));
                for x in 0..nx {
                    values[to + x] = value(self.values[from + x]);
                }
            }
        }
        let world_from_index = self.world_from_index * DMat4::from_translation(DVec3::NEG_ONE);
        Self { dims, values, world_from_index }
    }

    /// The trilinear value at index coordinates; what stands outside takes part.
    pub fn trilinear(&self, p: DVec3, outside: f64) -> f64 {
        let low = p.floor();
        let t = p - low;
        let value = |corner: [f64; 3]| {
            let at: [f64; 3] = std::array::from_fn(|axis| low[axis] + corner[axis]);
            let is_inside = (0..3).all(|axis| at[axis] >= 0.0 && at[axis] < self.dims[axis] as f64);
            let [x, y, z] = at.map(|n| n as usize);
            if is_inside {
                f64::from(self.values[x + self.dims[0] * (y + self.dims[1] * z)])
            } else {
                outside
            }
        };
        let along_x = |y, z| value([0.0, y, z]) * (1.0 - t.x) + value([1.0, y, z]) * t.x;
        let along_y = |z| along_x(0.0, z) * (1.0 - t.y) + along_x(1.0, z) * t.y;
        along_y(0.0) * (1.0 - t.z) + along_y(1.0) * t.z
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
    fn trilinear_reproduces_products_of_lines() {
        let mut dense = Dense::centered([3, 4, 5], 1.0);
        let function = |p: DVec3| (1.0 + p.x) * (2.0 - 0.5 * p.y) * (3.0 + 0.25 * p.z);
        for (idx, value) in dense.values.iter_mut().enumerate() {
            // Halves and quarters: exact in f32.
            *value = function(DVec3::new((idx % 3) as f64, (idx / 3 % 4) as f64, (idx / 12) as f64)) as f32;
        }
        for p in [DVec3::new(0.3, 2.7, 1.9), DVec3::new(2.0, 3.0, 4.0), DVec3::new(0.0, 0.5, 0.0)] {
            // Seven mixes of values up to 24.
            assert!((dense.trilinear(p, 9.0) - function(p)).abs() < 14.0 * 24.0 * f64::EPSILON, "{p}");
        }
        let first = f64::from(dense.values[0]);
        assert_eq!(dense.trilinear(DVec3::new(-0.25, 0.0, 0.0), 2.0), 0.75 * first + 0.25 * 2.0);
        assert_eq!(dense.trilinear(DVec3::splat(1e12), 7.0), 7.0);
        let padded = dense.padded(7.0, |value| 2.0 * value);
        assert_eq!((padded.dims, padded.values[0]), ([5, 6, 7], 14.0));
        assert_eq!(padded.trilinear(DVec3::ONE, 0.0), 2.0 * first);
        let corner = padded.world_from_index.transform_point3(DVec3::ONE);
        assert!((corner - dense.world_from_index.transform_point3(DVec3::ZERO)).length() < 1e-12);
    }

    #[test]
    fn slices_have_their_largest() {
        let mut dense = Dense::centered([3, 2, 4], 1.0);
        for (x, y, z, value) in [(0, 0, 0, 1.0), (0, 1, 3, 4.0), (2, 1, 3, 3.0), (1, 0, 2, 0.5)] {
            dense.values[x + 3 * (y + 2 * z)] = value;
        }
        assert_eq!(dense.slice_maxima(), [4.0 + 0.5 + 3.0, 1.0 + 4.0, 1.0 + 0.5 + 4.0]);
    }
}
