//! A grid of a beam's own: cubic cells as large as the medium's, the third axis along the beam, around all
//! cells of the medium that can be anything but void.
//!
//! Along an axis of the medium its cells are the medium's own. Tested by that, and by what it covers.

use glam::{DMat3, DVec3};

use crate::mirror;
use crate::volume::Lattice;

mirror! {
    /// `Aligned` of `shaders/principal_propagation/aligned.wgsl`.
    pub(super) struct AlignedTexel {
        dims: [u32; 3],
        cell_m: f32,
        u: [f32; 3],
        pad_0: u32,
        v: [f32; 3],
        pad_1: u32,
        w: [f32; 3],
        pad_2: u32,
        origin: [f32; 3],
        pad_3: u32,
    }
}

/// The grid, in index space.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Aligned {
    /// Cells along its axes.
    pub(super) dims: [usize; 3],
    /// Edge of a cell [m].
    pub(super) cell_m: f64,
    /// Unit axes as columns, the third one the direction of travel.
    pub(super) index_from_aligned: DMat3,
    /// Center of the first cell.
    pub(super) origin: DVec3,
}

/// Of a cell, by which the grid may be narrower than the medium: rounding must not add a layer.
const SLACK: f64 = 1e-3;

impl Aligned {
    /// The grid for light along a unit vector of index space.
    pub(super) fn new(lattice: &Lattice, direction: DVec3) -> Self {
        let [x, y, z] = direction.abs().to_array();
        let side = match (x >= y && x >= z, y >= z) {
            (true, _) => DVec3::Y,
            (_, true) => DVec3::Z,
            _ => DVec3::X,
        };
        let u = (side - direction * direction.dot(side)).normalize();
        let axes = [u, direction.cross(u), direction];
        let extent = DVec3::from_array(lattice.occupied.map(|n| n as f64));
        let dims = axes.map(|axis| (axis.abs().dot(extent) - SLACK).ceil().max(1.0) as usize);
        let center = 0.5 * (extent - 1.0);
        let to_first: DVec3 = (0..3).map(|a| 0.5 * (dims[a] - 1) as f64 * axes[a]).sum();
        Self {
            dims,
            cell_m: lattice.cell_m,
            index_from_aligned: DMat3::from_cols(axes[0], axes[1], axes[2]),
            origin: center - to_first,
        }
    }

    pub(super) fn texel(&self) -> AlignedTexel {
        let single = |v: DVec3| v.as_vec3().to_array();
        AlignedTexel {
            dims: self.dims.map(|n| n as u32),
            cell_m: self.cell_m as f32,
            u: single(self.index_from_aligned.x_axis),
            pad_0: 0,
            v: single(self.index_from_aligned.y_axis),
            pad_1: 0,
            w: single(self.index_from_aligned.z_axis),
            pad_2: 0,
            origin: single(self.origin),
            pad_3: 0,
        }
    }
}

#[cfg(test)]
mod tests {
    use glam::DMat4;

    use super::*;
    use crate::nodes::testing::Random;

    fn lattice(occupied: [usize; 3]) -> Lattice {
        Lattice {
            dims: occupied.map(|n| n.next_multiple_of(16)),
            occupied,
            cell_m: 0.5,
            world_from_index: DMat4::from_scale(DVec3::splat(0.5)),
        }
    }

    #[test]
    fn along_an_axis_its_cells_are_the_mediums() {
        let lattice = lattice([5, 7, 12]);
        for (direction, dims, first) in [
            (DVec3::Z, [5, 7, 12], [0.0, 0.0, 0.0]),
            (DVec3::NEG_Z, [5, 7, 12], [0.0, 6.0, 11.0]),
            (DVec3::X, [7, 12, 5], [0.0, 0.0, 0.0]),
            (DVec3::NEG_Y, [12, 5, 7], [4.0, 6.0, 0.0]),
        ] {
            let grid = Aligned::new(&lattice, direction);
            assert_eq!((grid.dims, grid.origin), (dims, DVec3::from_array(first)), "{direction}");
        }
    }

    #[test]
    fn it_holds_the_medium_and_no_layer_more() {
        let lattice = lattice([5, 7, 12]);
        let mut random = Random(3);
        for _ in 0..50 {
            let grid = Aligned::new(&lattice, random.direction());
            let back = grid.index_from_aligned.transpose();
            // A rotation: nine roundings.
            assert!((back * grid.index_from_aligned).abs_diff_eq(DMat3::IDENTITY, 1e-14));
            assert!((grid.index_from_aligned.determinant() - 1.0).abs() < 1e-14);
            let corners = (0..8).map(|n| {
                let corner = [n & 1, n >> 1 & 1, n >> 2];
                let p: [f64; 3] = std::array::from_fn(|a| (corner[a] * lattice.occupied[a]) as f64 - 0.5);
                back * (DVec3::from_array(p) - grid.origin)
            });
            let (low, high) = corners
                .fold((DVec3::INFINITY, DVec3::NEG_INFINITY), |(low, high), p| (low.min(p), high.max(p)));
            for axis in 0..3 {
                let last = grid.dims[axis] as f64 - 0.5;
                assert!((-0.5 - SLACK..0.5).contains(&low[axis]), "{low}");
                assert!((last - 1.0..last + SLACK).contains(&high[axis]), "{high} of {:?}", grid.dims);
            }
        }
    }
}
