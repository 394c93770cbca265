//! A sparse scalar grid in memory: leaves of 8³ voxels, tiles of one value, a background for the rest.
//!
//! This is OpenVDB's tree (Museth, *VDB: High-Resolution Sparse Volumes with Dynamic Topology*, 2013) without its inner
//! nodes: a list of leaves and a list of tiles are all that the medium builder reads, once, in order. Coordinates are
//! integers in index space; `world_from_index` takes voxel centers to meters. Values have the unit that the file gives
//! them.
//! Limits: origins are multiples of the node's size, so that no coordinate overflows an `i32`.
//! Tested here bit by bit, and in `vdb/tests.rs` against OpenVDB and a search through all nodes.

use super::stats;
use glam::{DMat4, IVec3};
use rayon::prelude::*;
use std::ops::Range;

/// Edge of a leaf in voxels.
pub const LEAF_SIZE: i32 = 8;

/// A scalar volume.
#[derive(Debug, Clone, PartialEq)]
pub struct Grid {
    /// As a graph asks for it; need not be unique, as the writer numbers grids of one name.
    pub name: String,
    /// Value where there is neither leaf nor tile.
    pub background: f32,
    /// Takes voxel centers, at integer coordinates, to meters; affine.
    pub world_from_index: DMat4,
    /// In any order; none overlaps another or a tile.
    pub leaves: Vec<Leaf>,
    /// Only tiles that are active or differ from the background.
    pub tiles: Vec<Tile>,
}

/// 8³ voxels; the value of voxel (x, y, z) stands at x·64 + y·8 + z.
#[derive(Debug, Clone, PartialEq)]
pub struct Leaf<V = f32> {
    /// Index coordinates of the first voxel, multiples of 8.
    pub origin: IVec3,
    /// One bit a voxel in the order of the values, the lowest bit first.
    pub active: [u64; 8],
    /// In the grid's unit, those of inactive voxels too.
    pub values: Box<[V; 512]>,
}

/// A cube of one value.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Tile<V = f32> {
    /// Index coordinates of the first voxel, multiples of `size`.
    pub origin: IVec3,
    /// Edge in voxels: 8, 128 or 4096.
    pub size: i32,
    /// Of each voxel covered, in the grid's unit.
    pub value: V,
    /// Whether all the voxels covered count as active, or none.
    pub active: bool,
}

impl<V> Leaf<V> {
    /// Number of active voxels, 0 to 512.
    pub fn active_voxels(&self) -> u64 {
        self.active.iter().map(|word| u64::from(word.count_ones())).sum()
    }

    /// Indices into `values` of the active voxels, ascending.
    pub fn active_indices(&self) -> impl Iterator<Item = usize> + '_ {
        self.active.iter().enumerate().flat_map(|(x, &word)| {
            std::iter::successors(Some(word), |rest| Some(rest & rest.wrapping_sub(1)))
                .take_while(|&rest| rest != 0)
                .map(move |rest| x * 64 + rest.trailing_zeros() as usize)
        })
    }

    /// Inclusive index bounds of the active voxels.
    pub fn active_bbox(&self) -> Option<(IVec3, IVec3)> {
        // A word is a slab of constant x; its bytes are rows of constant y.
        let slabs = self.active.iter().fold(0, |all, word| all | word);
        if slabs == 0 {
            return None;
        }
        let x = (0..8).filter(|&x| self.active[x as usize] != 0);
        let rows = slabs.to_le_bytes();
        let y = (0..8).filter(|&y| rows[y as usize] != 0);
        let columns = rows.iter().fold(0, |all, row| all | row);
        let min = IVec3::new(x.clone().min()?, y.clone().min()?, columns.trailing_zeros() as i32);
        let max = IVec3::new(x.max()?, y.max()?, 7 - columns.leading_zeros() as i32);
        Some((self.origin + min, self.origin + max))
    }
}

impl<V> Tile<V> {
    /// Index coordinates of the last voxel.
    pub fn last(&self) -> IVec3 {
        self.origin + IVec3::splat(self.size - 1)
    }

    /// Number of voxels covered.
    pub fn n_voxels(&self) -> u64 {
        (self.size as u64).pow(3)
    }
}

impl Grid {
    /// Inclusive index bounds of what is active, from voxels and tiles; `None` if nothing is.
    pub fn active_bbox(&self) -> Option<(IVec3, IVec3)> {
        stats::active_bbox(&self.leaves, &self.tiles)
    }

    /// Number of active voxels; a tile counts all that it covers.
    pub fn active_voxels(&self) -> u64 {
        stats::active_voxels(&self.leaves, &self.tiles)
    }

    /// Memory taken by leaves and tiles.
    pub fn bytes(&self) -> u64 {
        let leaves = self.leaves.len() * (size_of::<Leaf>() + size_of::<[f32; 512]>());
        (leaves + self.tiles.len() * size_of::<Tile>()) as u64
    }

    /// A grid of the values in a box, x fastest as [`Grid::dense`] gives them; active is what differs from the
    /// background.
    ///
    /// # Panics
    /// If `values` is not as long as `size` says or the box leaves the range of `i32`.
    pub fn from_dense(
        name: impl Into<String>,
        background: f32,
        world_from_index: DMat4,
        min: IVec3,
        size: [usize; 3],
        values: &[f32],
    ) -> Self {
        assert_eq!(values.len(), size.iter().product::<usize>(), "values and size of a dense box");
        let ends: [i32; 3] = std::array::from_fn(|i| {
            i32::try_from(i64::from(min[i]) + size[i] as i64 - 1)
                .expect("a dense box within the range of i32")
        });
        let blocks = |i: usize| min[i].div_euclid(LEAF_SIZE)..=ends[i].div_euclid(LEAF_SIZE);
        let mut leaves = Vec::new();
        if values.is_empty() {
            return Self { name: name.into(), background, world_from_index, leaves, tiles: Vec::new() };
        }
        for (bx, by, bz) in
            blocks(0).flat_map(|x| blocks(1).flat_map(move |y| blocks(2).map(move |z| (x, y, z))))
        {
            let origin = IVec3::new(bx, by, bz) * LEAF_SIZE;
            let mut leaf = Leaf { origin, active: [0; 8], values: Box::new([background; 512]) };
            for n in 0..512 {
                let at = origin + IVec3::new(n as i32 / 64, n as i32 / 8 % 8, n as i32 % 8);
                if (0..3).any(|i| at[i] < min[i] || at[i] > ends[i]) {
                    continue;
                }
                let [x, y, z] = (at - min).to_array().map(|v| v as usize);
                let value = values[x + size[0] * (y + size[1] * z)];
                leaf.values[n] = value;
                leaf.active[n / 64] |= u64::from(value != background) << (n % 64);
            }
            if leaf.active != [0; 8] {
                leaves.push(leaf);
            }
        }
        Self { name: name.into(), background, world_from_index, leaves, tiles: Vec::new() }
    }

    /// The tree's values in the box of `size` voxels from `min` on, active or not, as OpenVDB's `getValue` gives them:
    /// the value at index coordinates `min` + (x, y, z) stands at x + nx·(y + ny·z).
    ///
    /// Takes 4 bytes a voxel: a caller that takes the box from [`Grid::active_bbox`] limits it first.
    pub fn dense(&self, min: IVec3, size: [usize; 3]) -> Vec<f32> {
        let [nx, ny, nz] = size;
        let mut out = vec![self.background; nx * ny * nz];
        if out.is_empty() {
            return out;
        }
        // A slab is the z range of one layer of leaves, so that no two tasks write the same voxels or read one leaf.
        let first_layer = min.z.div_euclid(LEAF_SIZE);
        let z_end = i64::from(min.z) + nz as i64;
        let mut slabs = Vec::new();
        let mut rest = out.as_mut_slice();
        let mut z = i64::from(min.z);
        while z < z_end {
            let next = ((z.div_euclid(8) + 1) * 8).min(z_end);
            let (slab, after) = rest.split_at_mut(nx * ny * (next - z) as usize);
            slabs.push(Slab {
                min: [i64::from(min.x), i64::from(min.y), z],
                size: [nx, ny, (next - z) as usize],
                out: slab,
            });
            rest = after;
            z = next;
        }
        let layers_of = |origin: IVec3, n_layers: i32| {
            let first = i64::from(origin.z.div_euclid(LEAF_SIZE)) - i64::from(first_layer);
            let clip = |layer: i64| layer.clamp(0, slabs.len() as i64) as usize;
            clip(first)..clip(first + i64::from(n_layers))
        };
        let mut leaves_of = vec![Vec::new(); slabs.len()];
        for leaf in &self.leaves {
            for layer in layers_of(leaf.origin, 1) {
                leaves_of[layer].push(leaf);
            }
        }
        let mut tiles_of = vec![Vec::new(); slabs.len()];
        for tile in &self.tiles {
            for layer in layers_of(tile.origin, tile.size / LEAF_SIZE) {
                tiles_of[layer].push(tile);
            }
        }
        slabs.par_iter_mut().zip(leaves_of).zip(tiles_of).for_each(|((slab, leaves), tiles)| {
            for tile in tiles {
                slab.put(tile.origin, tile.size, |_, _, _| tile.value);
            }
            for leaf in leaves {
                slab.put(leaf.origin, LEAF_SIZE, |x, y, z| leaf.values[x * 64 + y * 8 + z]);
            }
        });
        out
    }
}

/// A part of a dense box, all x and y of some z.
struct Slab<'a> {
    min: [i64; 3],
    size: [usize; 3],
    out: &'a mut [f32],
}

impl Slab<'_> {
    /// Writes what a node of edge `size` at `origin` shares with the slab; `value` takes coordinates in the node.
    fn put(&mut self, origin: IVec3, size: i32, value: impl Fn(usize, usize, usize) -> f32) {
        let overlap = |i: usize| -> Range<i64> {
            let start = i64::from(origin[i]).max(self.min[i]);
            start..(i64::from(origin[i]) + i64::from(size)).min(self.min[i] + self.size[i] as i64).max(start)
        };
        let (xs, ys, zs) = (overlap(0), overlap(1), overlap(2));
        let local = |i: usize, at: i64| (at - i64::from(origin[i])) as usize;
        for z in zs {
            for y in ys.clone() {
                let row =
                    self.size[0] * ((y - self.min[1]) as usize + self.size[1] * (z - self.min[2]) as usize);
                for x in xs.clone() {
                    self.out[row + (x - self.min[0]) as usize] = value(local(0, x), local(1, y), local(2, z));
                }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_bit_of_a_leaf_is_its_voxel() {
        let origin = IVec3::new(-8, 16, 0);
        for n in 0..512 {
            let mut leaf = Leaf { origin, active: [0; 8], values: Box::new([0.0; 512]) };
            assert_eq!(leaf.active_bbox(), None);
            leaf.active[n / 64] = 1 << (n % 64);
            let at = origin + IVec3::new(n as i32 / 64, n as i32 / 8 % 8, n as i32 % 8);
            assert_eq!(leaf.active_bbox(), Some((at, at)));
            assert_eq!(leaf.active_indices().collect::<Vec<_>>(), [n]);
            leaf.active[0] |= 1;
            assert_eq!(leaf.active_bbox(), Some((origin, at)));
            assert_eq!(leaf.active_voxels(), if n == 0 { 1 } else { 2 });
        }
    }

    #[test]
    fn a_dense_box_comes_back() {
        let (min, size) = (IVec3::new(-3, 5, -17), [11, 4, 19]);
        let values: Vec<f32> = (0..11 * 4 * 19).map(|i| (i % 10) as f32).collect();
        let grid = Grid::from_dense("box", 0.0, DMat4::IDENTITY, min, size, &values);
        assert_eq!(grid.dense(min, size), values);
        assert_eq!(grid.active_voxels(), values.iter().filter(|&&value| value != 0.0).count() as u64);
        assert_eq!(grid.active_bbox(), Some((min, min + IVec3::new(10, 3, 18))));
        assert_eq!(grid.bytes(), grid.leaves.len() as u64 * (2048 + size_of::<Leaf>() as u64));
    }
}
