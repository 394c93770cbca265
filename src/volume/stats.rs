//! Figures of a grid for `tyndall inspect`: active voxels, their least, greatest and mean value, their extent.
//!
//! Taken from the tree itself, never from what the file's metadata says. An active tile counts all the voxels that it
//! covers. Sums are made leaf by leaf in f64 and added in the order of the leaves, so the result is the same on any
//! number of threads. Values keep their grid's unit; bounding boxes are in index space and inclusive.
//! Limits: NaN is left out of `min` and `max` and makes `mean` NaN; a count beyond 2^64 − 1 stays there.
//! Tested here on counts by hand and in `vdb/tests.rs` against OpenVDB's own figures.

use super::grid::{Grid, Leaf, Tile};
use glam::IVec3;
use half::f16;
use rayon::prelude::*;
use serde::Serialize;

/// A value as numbers: a scalar, or a vector of three.
pub trait Components {
    /// Whether all three components count.
    const IS_VECTOR: bool;
    /// The components; a scalar stands in the first, the others are 0.
    fn components(self) -> [f64; 3];
}

macro_rules! scalar {
    ($($t:ty),*) => {$(
        impl Components for $t {
            const IS_VECTOR: bool = false;
            fn components(self) -> [f64; 3] {
                [f64::from(self), 0.0, 0.0]
            }
        }
        impl Components for [$t; 3] {
            const IS_VECTOR: bool = true;
            fn components(self) -> [f64; 3] {
                self.map(f64::from)
            }
        }
    )*};
}
scalar!(f32, f64, i32, f16);

impl Components for i64 {
    const IS_VECTOR: bool = false;
    fn components(self) -> [f64; 3] {
        [self as f64, 0.0, 0.0]
    }
}

impl Components for bool {
    const IS_VECTOR: bool = false;
    fn components(self) -> [f64; 3] {
        [f64::from(u8::from(self)), 0.0, 0.0]
    }
}

/// A number, or a list of three for vector grids.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
#[serde(untagged)]
pub enum Sample {
    /// Of float, integer, bool and mask grids; a bool is 0 or 1, and an integer beyond 2^53 is rounded.
    Scalar(f64),
    /// x, y and z of a vec3 grid.
    Vector([f64; 3]),
}

impl Sample {
    /// A grid's value as numbers.
    pub fn of<V: Components>(value: V) -> Self {
        Self::new::<V>(value.components())
    }

    fn new<V: Components>(components: [f64; 3]) -> Self {
        if V::IS_VECTOR { Self::Vector(components) } else { Self::Scalar(components[0]) }
    }
}

/// What there is to say about a grid's active voxels; nothing but the count if there are none.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Figures {
    /// A tile counts all the voxels that it covers; stays at 2^64 − 1 when there are more.
    pub active_voxels: u64,
    /// Least value, for vectors of each component by itself; +∞ where all are NaN.
    pub min: Option<Sample>,
    /// Greatest value, for vectors of each component by itself; −∞ where all are NaN.
    pub max: Option<Sample>,
    /// Sum over count, in f64; NaN as soon as one value is.
    pub mean: Option<Sample>,
    /// Lowest index coordinates of an active voxel, inclusive.
    pub bbox_min: Option<[i32; 3]>,
    /// Highest index coordinates of an active voxel, inclusive.
    pub bbox_max: Option<[i32; 3]>,
}

impl Figures {
    /// Figures of a scalar grid.
    pub fn of(grid: &Grid) -> Self {
        Self::of_tree(&grid.leaves, &grid.tiles)
    }

    /// Figures of the leaves and tiles of a tree of any value type.
    pub fn of_tree<V: Components + Copy + Send + Sync>(leaves: &[Leaf<V>], tiles: &[Tile<V>]) -> Self {
        let parts: Vec<Partial> = leaves.par_iter().map(Partial::of_leaf).collect();
        let mut all = Partial::default();
        for part in &parts {
            all.add(part);
        }
        for tile in tiles.iter().filter(|tile| tile.active) {
            all.add(&Partial::of_tile(tile));
        }
        let (bbox_min, bbox_max) =
            active_bbox(leaves, tiles).map(|(min, max)| (min.to_array(), max.to_array())).unzip();
        let sample = |components| (all.count > 0).then(|| Sample::new::<V>(components));
        Self {
            active_voxels: all.count,
            min: sample(all.min),
            max: sample(all.max),
            mean: sample(all.sum.map(|sum| sum / all.count as f64)),
            bbox_min,
            bbox_max,
        }
    }
}

/// Inclusive index bounds of the active voxels and tiles.
pub(super) fn active_bbox<V>(leaves: &[Leaf<V>], tiles: &[Tile<V>]) -> Option<(IVec3, IVec3)> {
    let boxes = leaves.iter().filter_map(Leaf::active_bbox);
    let boxes = boxes.chain(tiles.iter().filter(|tile| tile.active).map(|tile| (tile.origin, tile.last())));
    boxes.reduce(|a, b| (a.0.min(b.0), a.1.max(b.1)))
}

/// Voxels that are active, a tile with all that it covers.
pub(super) fn active_voxels<V>(leaves: &[Leaf<V>], tiles: &[Tile<V>]) -> u64 {
    let tiles = tiles.iter().filter(|tile| tile.active).map(Tile::n_voxels);
    leaves.iter().map(Leaf::active_voxels).chain(tiles).fold(0, u64::saturating_add)
}

struct Partial {
    count: u64,
    min: [f64; 3],
    max: [f64; 3],
    sum: [f64; 3],
}

impl Default for Partial {
    fn default() -> Self {
        Self { count: 0, min: [f64::INFINITY; 3], max: [f64::NEG_INFINITY; 3], sum: [0.0; 3] }
    }
}

impl Partial {
    fn of_leaf<V: Components + Copy>(leaf: &Leaf<V>) -> Self {
        let mut out = Self::default();
        for n in leaf.active_indices() {
            out.add_value(leaf.values[n].components(), 1);
        }
        out
    }

    fn of_tile<V: Components + Copy>(tile: &Tile<V>) -> Self {
        let mut out = Self::default();
        out.add_value(tile.value.components(), tile.n_voxels());
        out
    }

    fn add_value(&mut self, value: [f64; 3], count: u64) {
        self.add(&Self { count, min: value, max: value, sum: value.map(|v| v * count as f64) });
    }

    fn add(&mut self, other: &Self) {
        self.count = self.count.saturating_add(other.count);
        for i in 0..3 {
            self.min[i] = self.min[i].min(other.min[i]);
            self.max[i] = self.max[i].max(other.max[i]);
            self.sum[i] += other.sum[i];
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn tiles_count_what_they_cover() {
        let mut leaf = Leaf { origin: IVec3::ZERO, active: [0; 8], values: Box::new([[0.0_f32; 3]; 512]) };
        leaf.active[7] = 1 << 63;
        leaf.values[511] = [-512.0, 1.0, 2.0];
        let tile = |x, size, value, active| Tile {
            origin: IVec3::new(x, 0, 0),
            size,
            value: [value, 0.0, 0.0],
            active,
        };
        let tiles = [tile(8, 8, 3.0, true), tile(-4096, 4096, 9.0, false)];
        let figures = Figures::of_tree(&[leaf], &tiles);
        assert_eq!(figures.active_voxels, 513);
        assert_eq!(figures.min, Some(Sample::Vector([-512.0, 0.0, 0.0])));
        assert_eq!(figures.max, Some(Sample::Vector([3.0, 1.0, 2.0])));
        let mean = [-512.0 + 3.0 * 512.0, 1.0, 2.0].map(|sum| sum / 513.0);
        assert_eq!(figures.mean, Some(Sample::Vector(mean)));
        assert_eq!((figures.bbox_min, figures.bbox_max), (Some([7, 0, 0]), Some([15, 7, 7])));
    }

    #[test]
    fn counts_beyond_64_bits_saturate() {
        // 2^28 tiles of 2^36 voxels would be too many to hold, so the sum itself is tested.
        let mut all = Partial { count: u64::MAX - 1, ..Partial::default() };
        all.add_value([1.0; 3], 4096_u64.pow(3));
        assert_eq!(all.count, u64::MAX);
    }

    #[test]
    fn nothing_active_has_no_figures() {
        let tile = Tile { origin: IVec3::ZERO, size: 8, value: 1.0_f32, active: false };
        let figures = Figures::of_tree(&[], &[tile]);
        assert_eq!(
            (figures.active_voxels, figures.min, figures.mean, figures.bbox_min),
            (0, None, None, None)
        );
    }
}
