//! A cumulus: what one sees first, so it has to look like one.
//!
//! A skeleton of puffs (module `puffs`) gives the towers; the depth under their smooth union, in
//! a field warped by gradient noise, is pushed in and out by `bumps` of falling size, which
//! leaves round humps with creases between, the cauliflower of a growing cloud. The density rises
//! over `EDGE` or about a voxel, whichever is wider, and inside it grows with the height over
//! the base as the liquid water of a rising parcel does. A plane, made ragged by noise, cuts the
//! base, with thin shreds below. Layering noise over simple solids follows Ebert et al.,
//! "Texturing & Modeling" (2003), ch. 9, and Schneider and Vos, "The real-time volumetric
//! cloudscapes of Horizon: Zero Dawn" (2015); nothing here simulates a cloud.
//!
//! Units: the skeleton's length is half the geometric mean of the box's longest and shortest
//! edge, so that detail keeps its proportions in boxes that are no cubes. Densities are 0..1.
//!
//! Resolution: bumps below about two voxels are left out, and nothing else depends on it, so the
//! same seed gives the same cloud. Two voxels stay empty on each face; where
//! they are more than `MARGIN` (below 50 to 64 voxels) the cloud shrinks to keep it, where it
//! would be a quarter of the box (below about 12 voxels) the border gives way.
//!
//! Tested: bits by a hash, range, border, seeds and sizes, agreement of two resolutions.

use super::noise::{BUMP_RANGE, bumps, fbm, perlin, smoothstep, stream};
use super::puffs::{Cell, Nearby, Puff, grow};
use crate::volume::dense::Dense;
use glam::{DVec3, Vec3};
use rayon::prelude::*;

/// Height of the base in the skeleton, as a part of the half extent.
const BASE: f32 = -0.68;

/// How far the shreds below the base reach.
const SHREDS: f32 = 0.05;

/// Depths are told apart this far from the union's surface; all noise stays within.
const BAND: f32 = 0.08;

/// Room around the puffs for what noise adds to them.
const PAD: f32 = 0.05;

/// Width of the rise from 0 to the inner density, at least.
const EDGE: f32 = 0.016;

/// Empty room between the padded skeleton and the box, at least.
const MARGIN: f32 = 0.086;

/// Empty room between the padded skeleton and the box in voxels, at least: the values of
/// two empty voxels reach 1.5 from the face, half the edge is 0.6.
const BORDER_VOXELS: f64 = 2.1;

/// Width of the largest bumps, each octave half of the one before.
const BUMP: f32 = 0.1;

/// Octaves of bumps: the last is resolved by boxes of about 500 voxels.
const BUMP_OCTAVES: u32 = 4;

/// Height of a bump over its width.
const BUMP_STRENGTH: f32 = 0.75;

/// Fills `dense`, centered at the origin, with the cloud `seed` in a box of `size_m` (extents in meters).
pub fn fill(dense: &mut Dense, size_m: [f64; 3], seed: u32) {
    let cloud = Cloud::new(size_m, dense.voxel_m(), seed);
    let [nx, ny, _] = dense.dims;
    let world_from_index = dense.world_from_index;
    dense.values.par_chunks_mut(nx).enumerate().for_each(|(row, values)| {
        let (j, k) = (row % ny, row / ny);
        for (i, value) in values.iter_mut().enumerate() {
            let index = DVec3::new(i as f64, j as f64, k as f64);
            let world_m = world_from_index.transform_point3(index);
            *value = cloud.density((world_m / cloud.unit_m).as_vec3());
        }
    });
}

struct Cloud {
    nearby: Nearby,
    /// A length of 1 in the skeleton, before it is fitted to the box (m).
    unit_m: f64,
    /// The skeleton's position of `p` is `p * scale + offset`.
    scale: Vec3,
    offset: Vec3,
    base: f32,
    top: f32,
    /// Longest edge of a voxel in the skeleton.
    voxel: f32,
    /// Width of the rise from 0 to the inner density.
    edge: f32,
    seed: u32,
}

impl Cloud {
    fn new(size_m: [f64; 3], voxel_size_m: f64, seed: u32) -> Self {
        let half_m = 0.5 * DVec3::from(size_m);
        let unit_m = (half_m.max_element() * half_m.min_element()).sqrt();
        let half = (half_m / unit_m).as_vec3();
        let base = BASE * half.y;
        let puffs = grow(half, base, seed);
        let mut low = Vec3::INFINITY;
        let mut high = Vec3::NEG_INFINITY;
        for Puff { center, radii } in &puffs {
            low = low.min(center - radii);
            high = high.max(center + radii);
        }
        low.y = base - SHREDS;
        low -= PAD;
        high += PAD;
        let border = (BORDER_VOXELS * voxel_size_m / unit_m) as f32;
        let margin = Vec3::splat(border.max(MARGIN)).min(0.5 * half);
        let scale = (high - low) / (2.0 * (half - margin));
        let voxel = (voxel_size_m / unit_m) as f32 * scale.max_element();
        Self {
            nearby: Nearby::new(&puffs, low, high, BAND),
            unit_m,
            scale,
            offset: 0.5 * (low + high),
            base,
            top: high.y,
            voxel,
            edge: EDGE.max(1.2 * voxel).min(2.0 * BAND),
            seed,
        }
    }

    fn density(&self, p: Vec3) -> f32 {
        let p = p * self.scale + self.offset;
        let above_base = p.y - self.base;
        if above_base <= -SHREDS - PAD {
            return 0.0;
        }
        let depth = match self.nearby.at(p) {
            Cell::Inside => BAND,
            Cell::Near(puffs) if puffs.is_empty() => return 0.0,
            Cell::Near(puffs) => self.depth(p, puffs),
        };
        let rim = smoothstep(-0.5 * self.edge, 0.5 * self.edge, depth);
        if rim == 0.0 {
            return 0.0;
        }
        let height = above_base / (self.top - self.base);
        let uneven = 0.9 + 0.1 * fbm(p * 3.0, 2, stream(self.seed, 1)).clamp(-1.0, 1.0);
        let water = (0.6 + 0.4 * smoothstep(0.0, 0.6, height)) * uneven;
        rim * self.base_share(p, above_base) * water
    }

    /// What the base leaves of the density, 0 below, 1 well above.
    fn base_share(&self, p: Vec3, above_base: f32) -> f32 {
        if above_base > 0.4 {
            return 1.0;
        }
        let q = Vec3::new(5.0 * p.x, 2.5 * p.y, 5.0 * p.z);
        let ragged = fbm(q, 4, stream(self.seed, 2));
        let solid = smoothstep(0.01, 0.08, above_base + 0.035 * ragged);
        let shreds = 0.3 * smoothstep(0.0, 0.1, above_base + 0.14 * ragged);
        solid.max(shreds) * smoothstep(-SHREDS - 0.03, -0.02, above_base)
    }

    /// Depth of `p` under the cloud's surface, cut to -`BAND` outside.
    fn depth(&self, p: Vec3, puffs: &[Puff]) -> f32 {
        let warp = Vec3::from_array([3, 4, 5].map(|field| perlin(6.0 * p, stream(self.seed, field))));
        let q = p + 0.02 * warp;
        let mut depth = -BAND;
        for puff in puffs {
            depth = smooth_max(depth, puff.depth(q), 0.12 * puff.radii.x);
        }
        if depth <= -BAND || depth >= BAND {
            return depth;
        }
        let mut width = BUMP;
        for octave in 0..BUMP_OCTAVES {
            let resolved = smoothstep(1.5, 3.0, width / self.voxel);
            // All that this and the finer octaves, each half of it, can still add.
            let reach = 2.0 * BUMP_STRENGTH * width;
            let outside = depth + reach * BUMP_RANGE[1] < -0.5 * self.edge;
            let inside = depth + reach * BUMP_RANGE[0] > 0.5 * self.edge;
            if resolved == 0.0 || outside || inside {
                break;
            }
            depth += resolved * BUMP_STRENGTH * width * bumps(q / width, stream(self.seed, 6 + octave));
            width *= 0.5;
        }
        depth
    }
}

/// The larger of `a` and `b`, rounded off where they differ by less than `k` (Quilez, "Smooth
/// minimum", 2013).
fn smooth_max(a: f32, b: f32, k: f32) -> f32 {
    let h = (k - (a - b).abs()).max(0.0) / k;
    a.max(b) + 0.25 * h * h * k
}

#[cfg(test)]
mod tests {
    use crate::volume::dense::Dense;
    use crate::volume::shapes::{Kind, generate};

    const CUBE_M: [f64; 3] = [2.0, 2.0, 2.0];

    fn mean(dense: &Dense) -> f64 {
        dense.values.iter().map(|&v| f64::from(v)).sum::<f64>() / dense.values.len() as f64
    }

    /// FNV-1a of the bits.
    fn hash(dense: &Dense) -> u64 {
        dense
            .values
            .iter()
            .flat_map(|v| v.to_bits().to_le_bytes())
            .fold(0xcbf2_9ce4_8422_2325, |h, byte| (h ^ u64::from(byte)).wrapping_mul(0x100_0000_01b3))
    }

    #[test]
    fn same_bits_everywhere() {
        assert_eq!(hash(&generate(Kind::Cloud, CUBE_M, 32, 1)), 0xb4a4_449d_1b2c_aeb5);
    }

    #[test]
    fn seeds_differ() {
        let [a, b] = [1, 2].map(|seed| generate(Kind::Cloud, CUBE_M, 24, seed));
        assert_ne!(hash(&a), hash(&b));
    }

    #[test]
    fn bounded_with_an_empty_border() {
        for (size_m, resolution, seed) in [
            (CUBE_M, 64, 1),
            (CUBE_M, 33, 2),
            (CUBE_M, 16, 3),
            ([400.0, 240.0, 360.0], 80, 4),
            ([1.0, 3.0, 1.5], 60, 5),
            ([10.0, 2.5, 5.0], 64, 6),
        ] {
            let dense = generate(Kind::Cloud, size_m, resolution, seed);
            let [nx, ny, nz] = dense.dims;
            let mut least_gap = [usize::MAX; 6];
            for (at, &v) in dense.values.iter().enumerate() {
                assert!((0.0..=1.0).contains(&v), "{size_m:?} {resolution}: {v}");
                if v > 0.0 {
                    let [i, j, k] = [at % nx, at / nx % ny, at / (nx * ny)];
                    let gaps = [i, j, k, nx - 1 - i, ny - 1 - j, nz - 1 - k];
                    least_gap = std::array::from_fn(|f| least_gap[f].min(gaps[f]));
                }
            }
            eprintln!("{size_m:?} {resolution}: gaps {least_gap:?}, mean {:.4}", mean(&dense));
            assert!(least_gap.iter().all(|&gap| gap >= 2), "{size_m:?} {resolution} {least_gap:?}");
            // It fills its box: of a side, no more is free than the margin, the room for noise
            // that is not there, and the border in voxels.
            for (gap, n) in least_gap.iter().zip(dense.dims.iter().cycle()) {
                assert!(*gap >= 2, "{size_m:?} {resolution}: {least_gap:?}");
                assert!(*gap as f64 <= 3.0 + 0.1 * *n as f64, "{size_m:?} {resolution}: {least_gap:?}");
            }
        }
    }

    #[test]
    fn resolutions_agree() {
        let [coarse, fine] = [64, 96].map(|n| generate(Kind::Cloud, CUBE_M, n, 1));
        let (a, b) = (mean(&coarse), mean(&fine));
        eprintln!("mean at 64 {a:.5}, at 96 {b:.5}");
        // Rims are symmetrical about the surface and bumps have mean 0, so only their curvature
        // and the base are left: measured below 0.3 % for eight seeds
        // in a cube and in a box of 400 x 240 x 360 m.
        assert!((a / b - 1.0).abs() < 0.01, "{a} {b}");
    }
}
