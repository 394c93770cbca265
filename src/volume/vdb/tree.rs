//! Trees of 5-4-3 nodes: a root map of nodes of 4096³ voxels, their children of 128³, and leaves of 8³.
//!
//! In the file all nodes come first, depth first, with the leaves' active masks (the topology), then the values of all
//! leaves in the same order (the buffers). [`Plan::parse`] walks both and only notes where values lie;
//! [`Plan::decode`] decodes the leaves in parallel. The walk is linear in the bytes, and what it allocates is at most
//! a tile (24 bytes for a scalar) for two bits of a mask, or a leaf's 512 values for the 64 bytes of its mask.
//! Source: `openvdb/tree/{Tree,RootNode,InternalNode,LeafNode,LeafNodeBool,LeafNodeMask}.h`, `readTopology` and
//! `readBuffers`. Limits: other trees than 5-4-3 do not come here.
//! Tested in `tests.rs` against OpenVDB's own reading of the same files.

use super::codec::{Format, Mask, Packed, VERSION_NODE_MASK, skip_buffer};
use super::cursor::{Cursor, Fault};
use super::value::{LeafLayout, Value};
use crate::volume::grid::{Leaf, Tile};
use glam::IVec3;
use rayon::prelude::*;
use std::collections::BTreeSet;
use std::ops::Range;

/// Log2 of the slots along an edge of the two kinds of inner nodes, and of the edge of a slot in voxels.
const UPPER: Level = Level { slots_log2: 5, slot_size_log2: 7 };
const LOWER: Level = Level { slots_log2: 4, slot_size_log2: 3 };
const ROOT_SLOT_SIZE: i32 = 4096;
const N_LEAF: usize = 512;

struct Level {
    slots_log2: u32,
    slot_size_log2: u32,
}

impl Level {
    const fn n_slots(&self) -> usize {
        1 << (3 * self.slots_log2)
    }

    fn slot_origin(&self, node: IVec3, slot: usize) -> IVec3 {
        let mask = (1 << self.slots_log2) - 1;
        let slot = slot as i32;
        let [x, y, z] = [slot >> (2 * self.slots_log2), slot >> self.slots_log2 & mask, slot & mask];
        node + (IVec3::new(x, y, z) << self.slot_size_log2 as i32)
    }
}

/// The leaves and tiles of a tree.
pub(super) struct Tree<V, T> {
    pub background: V,
    pub leaves: Vec<Leaf<T>>,
    pub tiles: Vec<Tile<T>>,
}

/// A tree that is found but not decoded.
pub(super) struct Plan<'a, V> {
    background: V,
    tiles: Vec<Tile<V>>,
    leaves: Vec<Found<'a, V>>,
}

struct Site<'a> {
    origin: IVec3,
    active: Mask<'a>,
}

struct Found<'a, V> {
    site: Site<'a>,
    values: Values<'a, V>,
}

enum Values<'a, V> {
    Packed(Packed<'a, V>),
    Bits(Mask<'a>),
}

impl<'a, V: Value> Plan<'a, V> {
    /// Walks a tree from its buffer count on to the end of its last leaf.
    pub fn parse(cursor: &mut Cursor<'a>, format: Format) -> Result<Self, Fault> {
        let offset = cursor.offset();
        let n_buffers = cursor.i32()?;
        if n_buffers != 1 {
            return Err(Fault::unsupported(offset, format!("tree of {n_buffers} buffers, only 1 is known")));
        }
        let background = V::parse(cursor.take(V::N_BYTES)?);
        let n_tiles = cursor.u32()?;
        let n_children = cursor.u32()?;
        let mut walk = Walk { format, background, tiles: Vec::new(), sites: Vec::new() };
        let mut seen = BTreeSet::new();
        cursor.check(u64::from(n_tiles) * (13 + V::N_BYTES as u64))?;
        for _ in 0..n_tiles {
            let origin = root_origin(cursor, &mut seen)?;
            let value = V::parse(cursor.take(V::N_BYTES)?);
            walk.add_tile(origin, ROOT_SLOT_SIZE, value, cursor.u8()? != 0);
        }
        let mut children: Vec<([i32; 3], Range<usize>)> = Vec::new();
        for _ in 0..n_children {
            let origin = root_origin(cursor, &mut seen)?;
            let first = walk.sites.len();
            walk.upper(cursor, origin)?;
            children.push((origin.to_array(), first..walk.sites.len()));
        }
        // The buffers follow in the order of the root's map, not in that of the topology.
        children.sort_by_key(|&(origin, _)| origin);
        let mut sites: Vec<Option<Site>> = walk.sites.into_iter().map(Some).collect();
        let mut leaves = Vec::with_capacity(sites.len());
        for site in children.into_iter().flat_map(|(_, range)| range) {
            let site = sites[site].take().expect("the root's children have leaves of their own");
            leaves.push(Found::parse(cursor, format, background, site)?);
        }
        Ok(Self { background, tiles: walk.tiles, leaves })
    }

    /// Decodes all leaves, in parallel, and converts each value.
    pub fn decode<T: Copy + Send + Sync>(self, convert: impl Fn(V) -> T + Sync) -> Result<Tree<V, T>, Fault> {
        // All leaves first and then the first error, so that the same damage always gets the same message.
        let leaves: Vec<Result<Leaf<T>, Fault>> =
            self.leaves.par_iter().map(|leaf| leaf.decode(self.background, &convert)).collect();
        let tile = |tile: Tile<V>| Tile {
            origin: tile.origin,
            size: tile.size,
            value: convert(tile.value),
            active: tile.active,
        };
        Ok(Tree {
            background: self.background,
            leaves: leaves.into_iter().collect::<Result<_, _>>()?,
            tiles: self.tiles.into_iter().map(tile).collect(),
        })
    }
}

fn root_origin(cursor: &mut Cursor, seen: &mut BTreeSet<[i32; 3]>) -> Result<IVec3, Fault> {
    let offset = cursor.offset();
    let origin = cursor.coord()?;
    if origin.iter().any(|at| at % ROOT_SLOT_SIZE != 0) {
        return Err(Fault::invalid(
            offset,
            format!("root node at {origin:?}, which are no multiples of 4096"),
        ));
    }
    if !seen.insert(origin) {
        return Err(Fault::invalid(offset, format!("a second root node at {origin:?}")));
    }
    Ok(IVec3::from_array(origin))
}

/// The topology, as far as it is walked.
struct Walk<'a, V> {
    format: Format,
    background: V,
    tiles: Vec<Tile<V>>,
    sites: Vec<Site<'a>>,
}

impl<'a, V: Value> Walk<'a, V> {
    fn upper(&mut self, cursor: &mut Cursor<'a>, origin: IVec3) -> Result<(), Fault> {
        let children = self.table(cursor, &UPPER, origin)?;
        for slot in (0..UPPER.n_slots()).filter(|&slot| children.get(slot)) {
            self.lower(cursor, UPPER.slot_origin(origin, slot))?;
        }
        Ok(())
    }

    fn lower(&mut self, cursor: &mut Cursor<'a>, origin: IVec3) -> Result<(), Fault> {
        let children = self.table(cursor, &LOWER, origin)?;
        for slot in (0..LOWER.n_slots()).filter(|&slot| children.get(slot)) {
            let active = Mask::parse(cursor, N_LEAF)?;
            self.sites.push(Site { origin: LOWER.slot_origin(origin, slot), active });
        }
        Ok(())
    }

    /// Reads an inner node's masks and tiles and returns which slots are children.
    fn table(&mut self, cursor: &mut Cursor<'a>, level: &Level, origin: IVec3) -> Result<Mask<'a>, Fault> {
        let n_slots = level.n_slots();
        let children = Mask::parse(cursor, n_slots)?;
        let active = Mask::parse(cursor, n_slots)?;
        let size = 1 << level.slot_size_log2;
        let format = self.format;
        if format.version < VERSION_NODE_MASK {
            let slots: Vec<usize> = (0..n_slots).filter(|&slot| !children.get(slot)).collect();
            let packed = Packed::<V>::parse(cursor, format, self.background, slots.len(), active)?;
            return packed
                .unpack(slots.len(), active, |i, value| {
                    self.add_tile(level.slot_origin(origin, slots[i]), size, value, active.get(slots[i]));
                })
                .map(|()| children);
        }
        let packed = Packed::parse(cursor, format, self.background, n_slots, active)?;
        if packed.uniform().is_none_or(|value| value != self.background) {
            packed.unpack(n_slots, active, |slot, value| {
                if !children.get(slot) {
                    self.add_tile(level.slot_origin(origin, slot), size, value, active.get(slot));
                }
            })?;
        }
        Ok(children)
    }

    fn add_tile(&mut self, origin: IVec3, size: i32, value: V, active: bool) {
        if active || value != self.background {
            self.tiles.push(Tile { origin, size, value, active });
        }
    }
}

impl<'a, V: Value> Found<'a, V> {
    fn parse(cursor: &mut Cursor<'a>, format: Format, background: V, site: Site<'a>) -> Result<Self, Fault> {
        let offset = cursor.offset();
        if Mask::parse(cursor, N_LEAF)? != site.active {
            return Err(Fault::invalid(
                offset,
                format!("leaf at {} has two different active masks", site.origin),
            ));
        }
        let is_old = format.version < VERSION_NODE_MASK;
        if is_old || V::LAYOUT != LeafLayout::Values {
            let offset = cursor.offset();
            let origin = IVec3::from_array(cursor.coord()?);
            if origin != site.origin {
                return Err(Fault::invalid(
                    offset,
                    format!("leaf at {} says it is at {origin}", site.origin),
                ));
            }
        }
        let values = match V::LAYOUT {
            LeafLayout::Values => {
                let n_buffers = if is_old { cursor.u8()? as i8 } else { 1 };
                let packed = Packed::parse(cursor, format, background, N_LEAF, site.active)?;
                for _ in 1..n_buffers {
                    skip_buffer::<V>(cursor, format)?;
                }
                Values::Packed(packed)
            }
            LeafLayout::Bits => Values::Bits(Mask::parse(cursor, N_LEAF)?),
            LeafLayout::Mask => Values::Bits(site.active),
        };
        Ok(Self { site, values })
    }

    fn decode<T: Copy>(&self, background: V, convert: impl Fn(V) -> T) -> Result<Leaf<T>, Fault> {
        let mut values = Box::new([convert(background); N_LEAF]);
        match &self.values {
            Values::Packed(packed) => {
                packed.unpack(N_LEAF, self.site.active, |i, value| values[i] = convert(value))?;
            }
            Values::Bits(bits) => {
                for (i, value) in values.iter_mut().enumerate() {
                    *value = convert(V::parse(&[u8::from(bits.get(i))]));
                }
            }
        }
        Ok(Leaf { origin: self.site.origin, active: self.site.active.leaf_words(), values })
    }
}
