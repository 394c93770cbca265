//! Grids around point lights: optical depths by distance and direction (DESIGN 6.3, 6.7).
//!
//! A direction is a place of the octahedral square ([`octahedral`]). For a light among the matter that is all of
//! it, and nodes stand at 0 and from r_max/100 to r_max, ever further apart; for one outside it is the part that
//! the medium's box is seen in, and nodes stand evenly between the nearest and the farthest point of the box. The
//! square's middle is the direction to the box, so that no fold crosses what is seen. Memory depends on the
//! lights alone: 4 (n_angular + 2)² n_radial bytes each (157 KiB at 32² × 32), whatever the medium's cells.
//!
//! Limits: depths are linear between nodes; shadows of surfaces are as coarse as the directions. Tested by
//! closed forms, and against the walk, in `nodes/spherical_propagation`.

use std::sync::Arc;

use glam::DVec3;

use crate::gpu::{Buffer, Format, Gpu, GpuError, Texture};
use crate::mirror;
use crate::optics::octahedral;

mirror! {
    /// `RadialLight` of `shaders/lib/radial.wgsl`.
    pub struct RadialTexel {
        /// First row of the rotation to the light's frame, and the first node's distance.
        right: [f32; 4],
        /// Second row, and the last node's distance.
        up: [f32; 4],
        /// Third row, and 1 where nodes stand ever further apart.
        axis: [f32; 4],
        /// Part of the square: lowest corner, extent.
        crop: [f32; 4],
        /// First texel.
        origin: [u32; 3],
        /// Directions along an edge.
        n_angular: u32,
        /// Nodes of a direction.
        n_radial: u32,
        /// Unused.
        pad_0: u32,
        /// Unused.
        pad_1: u32,
        /// Unused.
        pad_2: u32,
    }
}

/// How fine a grid is.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Fineness {
    /// Directions along an edge of the square.
    pub n_angular: usize,
    /// Nodes of a direction.
    pub n_radial: usize,
}

impl Fineness {
    /// Texels, with a border of one direction.
    pub fn dims(self) -> [usize; 3] {
        [self.n_angular + 2, self.n_angular + 2, self.n_radial]
    }

    /// Of one grid.
    pub fn bytes(self) -> u64 {
        4 * self.dims().iter().product::<usize>() as u64
    }
}

/// Where the nodes and directions of a light stand, in index space.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Spacing {
    /// Axes of its frame.
    pub frame: [DVec3; 3],
    /// Distance of the first node.
    pub first: f64,
    /// Distance of the last.
    pub last: f64,
    /// Whether nodes stand ever further apart.
    pub is_log: bool,
    /// Lowest corner of the part of the square.
    pub low: [f64; 2],
    /// Extent of that part.
    pub extent: [f64; 2],
}

/// A light nearer to the box than this share of its farthest corner is treated as one inside.
const NEAR: f64 = 0.01;
/// What is kept around the medium, as a share of its extent, so that rounding loses nothing.
const MARGIN: f64 = 1e-3;

impl Spacing {
    /// For a light and the box of a medium, `last` its highest corner, 0 its lowest.
    pub fn new(position: DVec3, last: DVec3) -> Self {
        let corners = (0..8).map(|n| {
            let pick = |axis: usize| if n >> axis & 1 == 1 { last[axis] } else { 0.0 };
            DVec3::new(pick(0), pick(1), pick(2)) - position
        });
        let corners: Vec<DVec3> = corners.collect();
        // A box without an extent has one node, somewhere.
        let farthest = corners.iter().map(|line| line.length()).fold(1e-3, f64::max);
        let nearest = position.clamp(DVec3::ZERO, last) - position;
        if nearest.length() <= NEAR * farthest {
            let frame = [DVec3::X, DVec3::Y, DVec3::Z];
            return Self {
                frame,
                first: 0.0,
                last: farthest,
                is_log: true,
                low: [-1.0; 2],
                extent: [2.0; 2],
            };
        }
        // From outside of the ball around the box its middle is less than a right angle from all of it, else the
        // nearest point is: so that all is seen in the upper half of the octahedron.
        let middle = 0.5 * last - position;
        let axis = if middle.length() > 0.75 * last.length() { middle } else { nearest }.normalize();
        let (right, up) = axis.any_orthonormal_pair();
        let local = |line: &DVec3| DVec3::new(line.dot(right), line.dot(up), line.dot(axis));
        let seen: Vec<DVec3> = corners.iter().map(local).collect();
        let (mut low, mut high) = ([f64::INFINITY; 2], [f64::NEG_INFINITY; 2]);
        let mut include = |p: DVec3| {
            for (side, at) in octahedral::from_direction(p).into_iter().enumerate() {
                low[side] = low[side].min(at);
                high[side] = high[side].max(at);
            }
        };
        for (n, a) in seen.iter().enumerate() {
            include(*a);
            for b in (0..3).filter(|bit| n >> bit & 1 == 0).map(|bit| seen[n | 1 << bit]) {
                // Within a face of the octahedron an edge is straight: it turns where a coordinate changes sign.
                for side in 0..2 {
                    let t = a[side] / (a[side] - b[side]);
                    if t > 0.0 && t < 1.0 {
                        include(a.lerp(b, t));
                    }
                }
            }
        }
        // The axis itself is seen where it meets the box: faces have no other turns.
        include(DVec3::Z);
        let extent = [0, 1].map(|side| (high[side] - low[side]) * (1.0 + 2.0 * MARGIN));
        let low = [0, 1].map(|side| low[side] - MARGIN * (high[side] - low[side]));
        Self { frame: [right, up, axis], first: nearest.length(), last: farthest, is_log: false, low, extent }
    }

    /// For the shaders, at a place of the texture.
    fn texel(&self, fineness: Fineness, origin: [usize; 3]) -> RadialTexel {
        let row = |axis: DVec3, w: f64| axis.extend(w).as_vec4().to_array();
        let [right, up, axis] = self.frame;
        RadialTexel {
            right: row(right, self.first),
            up: row(up, self.last),
            axis: row(axis, f64::from(u8::from(self.is_log))),
            crop: [self.low[0], self.low[1], self.extent[0], self.extent[1]].map(|x| x as f32),
            origin: origin.map(|n| n as u32),
            n_angular: fineness.n_angular as u32,
            n_radial: fineness.n_radial as u32,
            pad_0: 0,
            pad_1: 0,
            pad_2: 0,
        }
    }

    /// The directions of a grid, row by row, with the solid angle of each in sr; of all directions 4 pi together.
    pub fn directions(&self, n_angular: usize) -> Vec<(DVec3, f64)> {
        let n = n_angular as f64;
        let area = self.extent[0] * self.extent[1] / (n * n);
        let [right, up, axis] = self.frame;
        let at = |i: usize, side: usize| self.low[side] + (i as f64 + 0.5) / n * self.extent[side];
        let mut list: Vec<(DVec3, f64)> = (0..n_angular * n_angular)
            .map(|idx| {
                let at = [at(idx % n_angular, 0), at(idx / n_angular, 1)];
                let local = octahedral::to_direction(at);
                (local.x * right + local.y * up + local.z * axis, area * octahedral::solid_angle(at))
            })
            .collect();
        if self.is_log {
            let all: f64 = list.iter().map(|(_, weight)| weight).sum();
            list.iter_mut().for_each(|(_, weight)| *weight *= 4.0 * std::f64::consts::PI / all);
        }
        list
    }
}

/// The grids of some lights, in the order of their beams.
#[derive(Clone)]
pub struct RadialGrids {
    /// Depths, one R32Float texel a node.
    pub texture: Arc<Texture>,
    /// Where each light's grid stands.
    pub texels: Vec<RadialTexel>,
    /// The same in f64.
    pub spacings: Vec<Spacing>,
    /// Depth of the whole way along each direction, as [`Spacing::directions`] orders them.
    pub exits: Vec<Arc<[f32]>>,
}

const REMEDY: &str = "lower spherical_propagation.angular or radial, or use fewer lights";

impl RadialGrids {
    /// Room for grids, all of them 0.
    ///
    /// # Errors
    /// [`GpuError`] where the device has no room.
    pub fn new(gpu: &Gpu, lights: &[(Spacing, Fineness)]) -> Result<Self, GpuError> {
        let slot: [usize; 3] = std::array::from_fn(|axis| {
            lights.iter().map(|(_, fineness)| fineness.dims()[axis]).max().unwrap_or(1)
        });
        let (dims, columns) = layout(gpu.max_texture_3d() as usize, slot, lights.len());
        let texture = gpu.texture3("grids of point lights", dims, Format::R32Float, REMEDY)?;
        let origin = |n: usize| {
            let [x, y, z] = [n % columns[0], n / columns[0] % columns[1], n / (columns[0] * columns[1])];
            [x * slot[0], y * slot[1], z * slot[2]]
        };
        let texels = lights.iter().enumerate();
        Ok(Self {
            texture: Arc::new(texture),
            texels: texels.map(|(n, (spacing, fineness))| spacing.texel(*fineness, origin(n))).collect(),
            spacings: lights.iter().map(|(spacing, _)| *spacing).collect(),
            exits: Vec::new(),
        })
    }

    /// One grid of nothing, for stages whose beams have none.
    ///
    /// # Errors
    /// [`GpuError`] where the device has no room.
    pub fn none(gpu: &Gpu) -> Result<Self, GpuError> {
        let spacing = Spacing::new(DVec3::ZERO, DVec3::ONE);
        Self::new(gpu, &[(spacing, Fineness { n_angular: 1, n_radial: 1 })])
    }

    /// How fine the grid of a light is.
    pub fn fineness(&self, n: usize) -> Fineness {
        let texel = self.texels[n];
        Fineness { n_angular: texel.n_angular as usize, n_radial: texel.n_radial as usize }
    }

    /// All of `parts`, one after the other; a single part is shared, not copied.
    ///
    /// # Errors
    /// [`GpuError`] where the device has no room.
    pub fn merge(gpu: &Gpu, parts: &[&Self]) -> Result<Self, GpuError> {
        if let [one] = parts {
            return Ok((*one).clone());
        }
        let lights = parts.iter().flat_map(|part| (0..part.texels.len()).map(move |n| (*part, n)));
        let list: Vec<_> = lights.clone().map(|(part, n)| (part.spacings[n], part.fineness(n))).collect();
        let mut merged = Self::new(gpu, &list)?;
        let mut recorder = gpu.recorder("merge beams");
        for ((part, n), to) in lights.clone().zip(&merged.texels) {
            let size = part.fineness(n).dims();
            recorder.copy_box(&part.texture, part.texels[n].origin, &merged.texture, to.origin, size);
        }
        recorder.finish()?;
        merged.exits = lights.map(|(part, n)| Arc::clone(&part.exits[n])).collect();
        Ok(merged)
    }

    /// For shaders: where the grids stand.
    ///
    /// # Errors
    /// [`GpuError`] where the device has no room.
    pub fn list(&self, gpu: &Gpu) -> Result<Buffer, GpuError> {
        gpu.buffer_from("lights with grids", &self.texels, REMEDY)
    }

    /// On the GPU and beside it.
    pub fn bytes(&self) -> u64 {
        self.texture.bytes() + self.exits.iter().map(|exits| 4 * exits.len() as u64).sum::<u64>()
    }
}

/// Texels for so many slots, and how many stand along x, y, z: near a cube's shape, within `most` texels.
fn layout(most: usize, slot: [usize; 3], n: usize) -> ([usize; 3], [usize; 3]) {
    let fits = slot.map(|texels| (most / texels).max(1));
    let along = |left: usize, axis: usize| fits[axis].min(left.max(1));
    let z = along(n, 2);
    let y = along(n.div_ceil(z), 1);
    let x = n.div_ceil(z * y).max(1);
    ([x * slot[0], y * slot[1], z * slot[2]], [x, y, z])
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn slots_fit_and_do_not_meet() {
        for n in [0, 1, 60, 61, 256, 5000] {
            let (dims, columns) = layout(2048, [34, 34, 32], n);
            assert!(dims.iter().all(|texels| *texels <= 2048), "{n}: {dims:?}");
            assert!(columns.iter().product::<usize>() >= n);
            assert_eq!(dims, std::array::from_fn(|axis| columns[axis] * [34, 34, 32][axis]));
        }
        // What does not fit is as long as it is, and refused by the device.
        assert!(layout(2048, [34, 34, 32], 1_000_000).0[0] > 2048);
    }

    /// Places inside of the box, beside it, at an edge, and far away.
    fn places() -> [DVec3; 7] {
        [
            DVec3::new(3.0, 4.0, 5.0),
            DVec3::ZERO,
            DVec3::new(12.0, 2.0, -2.0),
            DVec3::new(16.0, 15.0, 7.0),
            DVec3::new(1.0, 1.0, 13.2),
            DVec3::new(-400.0, 3000.0, 90.0),
            DVec3::new(30.0, 10.5, 5.2),
        ]
    }

    #[test]
    fn all_of_the_box_is_kept() {
        let last = DVec3::new(15.0, 21.0, 11.0);
        for position in places() {
            let spacing = Spacing::new(position, last);
            let [right, up, axis] = spacing.frame;
            for idx in 0..16 * 22 * 12 {
                let p = DVec3::new((idx % 16) as f64, (idx / 16 % 22) as f64, (idx / 352) as f64);
                let line = p - position;
                if line.length() < 1e-9 {
                    continue;
                }
                let at =
                    octahedral::from_direction(DVec3::new(line.dot(right), line.dot(up), line.dot(axis)));
                for (at, (low, extent)) in at.into_iter().zip(spacing.low.into_iter().zip(spacing.extent)) {
                    let part = (at - low) / extent;
                    assert!((0.0..=1.0).contains(&part), "{position}: {p} at {part}");
                }
                assert!((spacing.first..=spacing.last).contains(&line.length()), "{position}: {p}");
            }
        }
    }

    #[test]
    fn far_lights_see_a_narrow_cone() {
        let last = DVec3::splat(10.0);
        let near = Spacing::new(DVec3::new(25.0, 5.0, 5.0), last);
        let far = Spacing::new(DVec3::new(25_000.0, 5.0, 5.0), last);
        // 10 cells and their diagonal, over the distance of the near side.
        assert!(near.extent[0] < 1.0 && far.extent[0] < 7e-4, "{:?} {:?}", near.extent, far.extent);
        let seen: f64 = far.directions(8).iter().map(|(_, weight)| weight).sum();
        assert!(seen < 1e-6 && seen > 0.9 * 100.0 / 25_000f64.powi(2), "{seen}");
        let all: f64 = Spacing::new(last / 3.0, last).directions(8).iter().map(|(_, weight)| weight).sum();
        assert!((all - 4.0 * std::f64::consts::PI).abs() < 1e-12);
    }
}
