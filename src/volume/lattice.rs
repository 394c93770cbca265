//! The solver's grid: cubic cells around what is active in a volume (DESIGN 6.3).
//!
//! Diagonal lines must pass through the centers of cells, so cells are cubes: along the volume's own
//! axes where its map is a rotation and one scale, along the world's where it is not. One cell of void
//! surrounds what is active, so that clamping a sample to the border equals a background of 0. Each axis
//! is padded with void to a multiple of 16 (32 from 200 cells on), so that the grid can be halved.
//! A cell's center sits at its integer index. Tested by what each choice promises.

use glam::{DMat3, DMat4, DVec3};

/// Cells of the solver.
#[derive(Debug, Clone, PartialEq)]
pub struct Lattice {
    /// Cells along x, y, z, padding included.
    pub dims: [usize; 3],
    /// Cells along x, y, z that can be anything but void, with their border of one cell.
    pub occupied: [usize; 3],
    /// Edge of a cell in meters.
    pub cell_m: f64,
    /// A rotation, one scale and a translation.
    pub world_from_index: DMat4,
}

/// How finely a volume is to be gridded.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Fineness {
    /// Cells along the longest axis; 0 for the volume's own.
    pub max_resolution: usize,
    /// No cell should be thicker than this in meters, if that fits in `max_cells`.
    pub wanted_cell_m: f64,
    /// Bound of the number of cells when cells are made smaller than voxels.
    pub max_cells: usize,
    /// The device's bound along an axis.
    pub max_axis: usize,
}

impl Lattice {
    /// Corners of its cells.
    pub fn n_corners(&self) -> usize {
        self.dims.iter().map(|n| n + 1).product()
    }

    /// A grid for the voxels from `min` to `max` (inclusive) of a volume with this map.
    pub fn fit(min: DVec3, max: DVec3, world_from_voxel: DMat4, fineness: Fineness) -> Self {
        let linear = DMat3::from_mat4(world_from_voxel);
        // The frame in which cells are laid out, its scale removed, and the occupied box in it [m].
        let (world_from_frame, low, high, voxel_m) = match uniform_scale(linear) {
            Some(scale) => (
                world_from_voxel * DMat4::from_scale(DVec3::splat(1.0 / scale)),
                min * scale,
                max * scale,
                scale,
            ),
            None => {
                let corners = (0..8).map(|n| {
                    let pick = |bit: usize, axis: usize| {
                        if n >> bit & 1 == 1 { max[axis] + 1.0 } else { min[axis] - 1.0 }
                    };
                    world_from_voxel.transform_point3(DVec3::new(pick(0, 0), pick(1, 1), pick(2, 2)))
                });
                let (low, high) = corners
                    .fold((DVec3::INFINITY, DVec3::NEG_INFINITY), |(low, high), p| (low.min(p), high.max(p)));
                let edge = [linear.x_axis, linear.y_axis, linear.z_axis]
                    .map(DVec3::length)
                    .into_iter()
                    .fold(f64::INFINITY, f64::min);
                (DMat4::IDENTITY, low, high, edge)
            }
        };
        let longest = ((high - low) / voxel_m).max_element() + 1.0;
        let coarser = match fineness.max_resolution {
            0 => 1.0,
            n => (longest / n as f64).max(1.0),
        };
        let mut split = 1;
        let wanted = (coarser * voxel_m / fineness.wanted_cell_m).ceil();
        let mut lattice = Self::around(low, high, voxel_m, coarser, world_from_frame);
        while (split as f64) < wanted {
            split += 1;
            let finer = Self::around(low, high, voxel_m, coarser / f64::from(split), world_from_frame);
            let n_cells: usize = finer.dims.iter().product();
            if n_cells > fineness.max_cells || finer.dims.iter().any(|&n| n > fineness.max_axis) {
                break;
            }
            lattice = finer;
        }
        lattice
    }

    /// Edge of a cell that is not split in meters: of the arguments of [`Self::fit`].
    pub fn whole_cell_m(min: DVec3, max: DVec3, world_from_voxel: DMat4, max_resolution: usize) -> f64 {
        let plain = Fineness { max_resolution, wanted_cell_m: f64::INFINITY, max_cells: 0, max_axis: 0 };
        Self::fit(min, max, world_from_voxel, plain).cell_m
    }

    /// Cells of `ratio` voxels around the box, whose first and last voxel centers are `low` and `high`.
    fn around(low: DVec3, high: DVec3, voxel_m: f64, ratio: f64, world_from_frame: DMat4) -> Self {
        let cell_m = voxel_m * ratio;
        // A trilinear voxel fades out one voxel beyond its center, and the border is one more cell.
        let reach = if ratio == 1.0 { 1.5 * voxel_m } else { voxel_m + cell_m };
        let first_face = low - reach;
        let extent = (high + reach - first_face) / cell_m;
        // Beyond a million no device follows, and their product must stay a number: the field is refused.
        let occupied = extent.to_array().map(|n| (n - 1e-6).ceil().min(1e6) as usize);
        let longest = occupied.into_iter().max().unwrap_or(1);
        let multiple = if longest < 200 { 16 } else { 32 };
        let center = first_face + 0.5 * cell_m;
        Self {
            dims: occupied.map(|n| n.next_multiple_of(multiple)),
            occupied,
            cell_m,
            world_from_index: world_from_frame
                * DMat4::from_translation(center)
                * DMat4::from_scale(DVec3::splat(cell_m)),
        }
    }

    /// A vector of the world turned into index space, its length kept: the map's scale is a cell's edge.
    pub fn turned(&self, v: DVec3) -> DVec3 {
        self.index_from_world().transform_vector3(v) * self.cell_m
    }

    /// From the world in meters to index coordinates.
    pub fn index_from_world(&self) -> DMat4 {
        self.world_from_index.inverse()
    }

    /// A direction of the world in index space, of unit length.
    pub fn direction_in_index(&self, direction: DVec3) -> DVec3 {
        self.index_from_world().transform_vector3(direction).normalize()
    }
}

/// The scale of a map that is a rotation (or reflection) and one scale; `None` for any other.
pub fn uniform_scale(linear: DMat3) -> Option<f64> {
    let columns = [linear.x_axis, linear.y_axis, linear.z_axis];
    let scale = columns[0].length();
    // Files carry maps in f32 at worst: 1e-5 is 100 of its ulps.
    let same = |a: f64, b: f64| (a - b).abs() <= 1e-5 * scale;
    let even = columns.iter().all(|column| same(column.length(), scale));
    let square = [(0, 1), (0, 2), (1, 2)].iter().all(|&(a, b)| same(columns[a].dot(columns[b]) / scale, 0.0));
    (scale > 0.0 && even && square).then_some(scale)
}

#[cfg(test)]
mod tests {
    use super::*;

    const PLAIN: Fineness =
        Fineness { max_resolution: 0, wanted_cell_m: f64::INFINITY, max_cells: 1 << 24, max_axis: 2048 };

    fn scaled(scale: f64) -> DMat4 {
        DMat4::from_scale(DVec3::splat(scale))
    }

    #[test]
    fn cells_are_the_voxels_and_a_border() {
        let lattice =
            Lattice::fit(DVec3::new(3.0, 0.0, 0.0), DVec3::new(12.0, 4.0, 20.0), scaled(0.5), PLAIN);
        assert_eq!(lattice.occupied, [12, 7, 23]);
        assert_eq!(lattice.dims, [16, 16, 32]);
        assert_eq!(lattice.cell_m, 0.5);
        // Cell 0 is the voxel before the first.
        assert_eq!(lattice.world_from_index.transform_point3(DVec3::ZERO), DVec3::new(1.0, -0.5, -0.5));
    }

    #[test]
    fn thick_cells_are_split_until_the_bound() {
        let fit = |max_cells| {
            let fineness = Fineness { wanted_cell_m: 0.3, max_cells, ..PLAIN };
            Lattice::fit(DVec3::ZERO, DVec3::splat(13.0), scaled(1.0), fineness)
        };
        assert_eq!(fit(1 << 24).cell_m, 0.25);
        assert_eq!(fit(50_000).cell_m, 0.5);
        assert_eq!(fit(1).cell_m, 1.0);
        // The outermost half voxel that fades is inside, with a cell of void around it.
        let fine = fit(1 << 24);
        let first = fine.world_from_index.transform_point3(DVec3::ZERO);
        assert!(first.x < -1.0 && first.x + 0.25 >= -1.0 - 1e-9, "{first}");
    }

    #[test]
    fn resolution_bounds_the_longest_axis() {
        let fineness = Fineness { max_resolution: 50, ..PLAIN };
        let lattice = Lattice::fit(DVec3::ZERO, DVec3::new(99.0, 49.0, 9.0), scaled(1.0), fineness);
        assert_eq!(lattice.cell_m, 2.0);
        assert!(lattice.occupied[0] <= 53, "{:?}", lattice.occupied);
    }

    #[test]
    fn uneven_maps_are_laid_along_the_world() {
        let map = DMat4::from_scale(DVec3::new(1.0, 2.0, 1.0));
        let lattice = Lattice::fit(DVec3::ZERO, DVec3::splat(9.0), map, PLAIN);
        assert_eq!(lattice.cell_m, 1.0);
        assert!(lattice.occupied[1] > 20);
        assert!(uniform_scale(DMat3::from_mat4(map)).is_none());
        let turned = DMat3::from_rotation_y(0.3) * DMat3::from_diagonal(DVec3::splat(0.1));
        assert!((uniform_scale(turned).unwrap() - 0.1).abs() < 1e-12);
    }
}
