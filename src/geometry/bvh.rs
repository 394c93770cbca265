//! A tree of boxes around triangles, laid out for a walk without a stack.
//!
//! Nodes stand in depth-first order. Who meets a node's box goes on with the next node, who misses it with
//! `skip`, so a ray's walk is one loop over one index, whatever the tree's depth; the price is that the
//! children are not visited in the ray's own order. Built from the top: of 16 bins along each axis the cut
//! with the least sum of area times number (the surface area heuristic; Wald 2007, "On fast construction
//! of SAH-based bounding volume hierarchies"). Boxes are a little larger than what they hold, so that the
//! rounding of a ray's distances loses no triangle. In: corners of triangles, in any space. Tested against
//! rays that try every triangle.

use glam::Vec3;

/// A box, and what stands in it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Node {
    /// Least corner.
    pub low: Vec3,
    /// Greatest corner.
    pub high: Vec3,
    /// Where to go on when the box is missed, or after its triangles.
    pub skip: u32,
    /// The first of its triangles, in [`Bvh::order`].
    pub first: u32,
    /// Triangles of a leaf; 0 for a node with children.
    pub n_triangles: u32,
}

/// The tree.
#[derive(Debug, Clone, Default)]
pub struct Bvh {
    /// In depth-first order; none where there are no triangles.
    pub nodes: Vec<Node>,
    /// Triangles in the order of the leaves.
    pub order: Vec<u32>,
}

/// Triangles of a leaf, at most.
const LEAF: usize = 4;
const BINS: usize = 16;
/// Trees of more triangles than this grow beside each other.
const ALONE: usize = 1 << 12;
/// By how much of its distance from the origin a box is larger than what it holds: 16 ulps.
const MARGIN: f32 = 16.0 * f32::EPSILON;

#[derive(Clone, Copy)]
struct Bounds {
    low: Vec3,
    high: Vec3,
}

impl Bounds {
    const EMPTY: Self = Self { low: Vec3::INFINITY, high: Vec3::NEG_INFINITY };

    fn with(self, other: Self) -> Self {
        Self { low: self.low.min(other.low), high: self.high.max(other.high) }
    }

    /// Half of its surface; 0 where it is empty.
    fn area(self) -> f32 {
        let d = (self.high - self.low).max(Vec3::ZERO);
        d.x * d.y + d.y * d.z + d.z * d.x
    }

    fn center(self) -> Vec3 {
        0.5 * self.low + 0.5 * self.high
    }
}

#[derive(Clone, Copy)]
struct Item {
    bounds: Bounds,
    triangle: u32,
}

impl Bvh {
    /// The tree around these triangles.
    pub fn new(triangles: &[[Vec3; 3]]) -> Self {
        let item = |(n, corners): (usize, &[Vec3; 3])| {
            let low = corners[0].min(corners[1]).min(corners[2]);
            let high = corners[0].max(corners[1]).max(corners[2]);
            Item { bounds: Bounds { low, high }, triangle: n as u32 }
        };
        let mut items: Vec<Item> = triangles.iter().enumerate().map(item).collect();
        Self::grown(&mut items)
    }

    fn grown(items: &mut [Item]) -> Self {
        let mut tree = Self::default();
        if !items.is_empty() {
            tree.add(items);
        }
        tree
    }

    /// Adds a tree after the nodes that are there.
    fn append(&mut self, other: &Self) {
        let (n_nodes, n_triangles) = (self.nodes.len() as u32, self.order.len() as u32);
        let moved =
            |node: &Node| Node { skip: node.skip + n_nodes, first: node.first + n_triangles, ..*node };
        self.nodes.extend(other.nodes.iter().map(moved));
        self.order.extend(&other.order);
    }

    fn add(&mut self, items: &mut [Item]) {
        let bounds = items.iter().fold(Bounds::EMPTY, |all, item| all.with(item.bounds));
        let margin = MARGIN * bounds.low.abs().max(bounds.high.abs());
        let idx = self.nodes.len();
        let is_leaf = items.len() <= LEAF;
        self.nodes.push(Node {
            low: bounds.low - margin,
            high: bounds.high + margin,
            skip: 0,
            first: self.order.len() as u32,
            n_triangles: if is_leaf { items.len() as u32 } else { 0 },
        });
        if is_leaf {
            self.order.extend(items.iter().map(|item| item.triangle));
        } else {
            let n_left = divide(items);
            let (left, right) = items.split_at_mut(n_left);
            if left.len().min(right.len()) > ALONE {
                let (left, right) = rayon::join(|| Self::grown(left), || Self::grown(right));
                self.append(&left);
                self.append(&right);
            } else {
                self.add(left);
                self.add(right);
            }
        }
        self.nodes[idx].skip = self.nodes.len() as u32;
    }
}

/// Brings the items into the order of the best cut; how many stand before it, neither none nor all.
fn divide(items: &mut [Item]) -> usize {
    let centers = items.iter().fold(Bounds::EMPTY, |all, item| {
        let center = item.bounds.center();
        all.with(Bounds { low: center, high: center })
    });
    let extent = centers.high - centers.low;
    let bin = |item: &Item, axis: usize| {
        let share = (item.bounds.center()[axis] - centers.low[axis]) / extent[axis];
        ((share * BINS as f32) as usize).min(BINS - 1)
    };
    let mut best: Option<(f32, usize, usize)> = None;
    for axis in (0..3).filter(|&axis| extent[axis] > 0.0) {
        let mut bins = [(Bounds::EMPTY, 0_usize); BINS];
        for item in &*items {
            let (bounds, n) = &mut bins[bin(item, axis)];
            *bounds = bounds.with(item.bounds);
            *n += 1;
        }
        let grow = |side: &mut (Bounds, usize), (bounds, n): (Bounds, usize)| {
            *side = (side.0.with(bounds), side.1 + n);
            Some(*side)
        };
        // What stands before each cut, and what from it on.
        let mut rights = [(Bounds::EMPTY, 0); BINS];
        let from_the_end = bins.iter().rev().copied().scan((Bounds::EMPTY, 0), grow);
        rights.iter_mut().rev().zip(from_the_end).for_each(|(right, side)| *right = side);
        let lefts = bins.iter().copied().scan((Bounds::EMPTY, 0), grow);
        for (before, ((left, n_left), (right, n_right))) in lefts.zip(rights.into_iter().skip(1)).enumerate()
        {
            let cost = left.area() * n_left as f32 + right.area() * n_right as f32;
            if n_left > 0 && n_right > 0 && best.is_none_or(|(least, ..)| cost < least) {
                best = Some((cost, axis, before + 1));
            }
        }
    }
    let Some((_, axis, cut)) = best else {
        // All centers in one point: any halves will do.
        return items.len() / 2;
    };
    items.sort_by_key(|item| bin(item, axis) >= cut);
    items.partition_point(|item| bin(item, axis) < cut)
}
