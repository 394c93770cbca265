//! Procedural volumes: something to light without a file, and boxes whose truth is known.
//!
//! All are boxes of cubic voxels centered at the origin, `resolution` along the longest edge.
//! - [`Kind::Sphere`]: each voxel holds the part of it inside an ellipsoid that touches all faces
//!   of the box. Along x that part is exact, across it is the mean of 8 x 8 chords; so the sum
//!   over all voxels is the ellipsoid's volume by the midpoint rule with steps of 1/8 voxel.
//! - [`Kind::Box`]: ones, out to the faces of the outermost voxels.
//! - [`Kind::Checker`]: four cells an axis, 0.05 in the corner with the lowest coordinates, then 1,
//!   in turn.
//! - [`Kind::Cloud`]: module `cloud`.
//!
//! Size: extents in meters; values 0..1 without unit, a medium gives them one.
//!
//! Limits: where a shorter edge is no whole number of voxels, box and checker take the nearest
//! number (at least 1), so that they stay sharp; sphere and cloud take the next larger one and
//! keep their extents. A checker of an edge that 4 does not divide has cells of unequal width.
//!
//! Tested: shape of the box in voxels, volumes and means in closed form, the cloud in its module.

mod cloud;
pub mod noise;
mod puffs;

use crate::volume::dense::Dense;
use glam::DVec3;
use rayon::prelude::*;

/// What fills the box.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kind {
    /// An ellipsoid that touches all faces, of value 1.
    Sphere,
    /// The whole box, of value 1.
    Box,
    /// A cumulus, of values up to 1.
    Cloud,
    /// Four cells an axis of 0.05 and 1 in turn.
    Checker,
}

/// Chords of the sphere an axis of a voxel.
const CHORDS: usize = 8;

/// Cells of the checker an axis.
const CHECKER_CELLS: usize = 4;

/// Values of the checker's cells, the one at the lowest corner first.
const CHECKER_VALUES: [f32; 2] = [0.05, 1.0];

/// Fills a box of `size_m` (full extents in meters) with `resolution` voxels along its longest edge;
/// `seed` matters for the cloud alone.
///
/// # Panics
/// If an extent is not finite and above 0, or `resolution` is 0.
pub fn generate(kind: Kind, size_m: [f64; 3], resolution: usize, seed: u32) -> Dense {
    assert!(size_m.iter().all(|s| s.is_finite() && *s > 0.0), "extents of a shape: {size_m:?}");
    assert!(resolution > 0, "a shape without voxels");
    let voxel_size_m = DVec3::from(size_m).max_element() / resolution as f64;
    let dims = size_m.map(|edge_m| {
        let n = edge_m / voxel_size_m;
        // What rounding adds to a whole number must not become a voxel.
        let n = match kind {
            Kind::Box | Kind::Checker => n.round(),
            Kind::Sphere | Kind::Cloud => (n - 1e-6).ceil(),
        };
        (n as usize).max(1)
    });
    let mut dense = Dense::centered(dims, voxel_size_m);
    match kind {
        Kind::Sphere => fill_sphere(&mut dense, 0.5 * DVec3::from(size_m)),
        Kind::Box => dense.values.fill(1.0),
        Kind::Cloud => cloud::fill(&mut dense, size_m, seed),
        Kind::Checker => fill_checker(&mut dense),
    }
    dense
}

fn fill_sphere(dense: &mut Dense, radii_m: DVec3) {
    let [nx, ny, nz] = dense.dims;
    let h = dense.voxel_m();
    // Where chord s of voxel i of n lies, from the box's center.
    let chord_m =
        |i: usize, s: usize, n: usize| h * (i as f64 - 0.5 * n as f64 + (s as f64 + 0.5) / CHORDS as f64);
    dense.values.par_chunks_mut(nx).enumerate().for_each(|(row, values)| {
        let (j, k) = (row % ny, row / ny);
        let mut half_chords_m = [0.0f64; CHORDS * CHORDS];
        for (s, half_m) in half_chords_m.iter_mut().enumerate() {
            let y = chord_m(j, s % CHORDS, ny) / radii_m.y;
            let z = chord_m(k, s / CHORDS, nz) / radii_m.z;
            *half_m = radii_m.x * (1.0 - y * y - z * z).max(0.0).sqrt();
        }
        let shortest_m = half_chords_m.iter().copied().fold(f64::INFINITY, f64::min);
        let longest_m = half_chords_m.iter().copied().fold(0.0, f64::max);
        for (i, value) in values.iter_mut().enumerate() {
            let low_m = h * (i as f64 - 0.5 * nx as f64);
            let high_m = low_m + h;
            let farthest_m = high_m.max(-low_m);
            if farthest_m <= shortest_m {
                *value = 1.0;
            } else if farthest_m - h < longest_m {
                let inside_m = |half_m: &f64| (high_m.min(*half_m) - low_m.max(-half_m)).max(0.0);
                let sum_m: f64 = half_chords_m.iter().map(inside_m).sum();
                *value = ((sum_m / (h * half_chords_m.len() as f64)) as f32).min(1.0);
            }
        }
    });
}

fn fill_checker(dense: &mut Dense) {
    let [nx, ny, nz] = dense.dims;
    let cell = |i: usize, n: usize| i * CHECKER_CELLS / n;
    for (at, value) in dense.values.iter_mut().enumerate() {
        let cells = cell(at % nx, nx) + cell(at / nx % ny, ny) + cell(at / (nx * ny), nz);
        *value = CHECKER_VALUES[cells % 2];
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::PI;

    const KINDS: [Kind; 4] = [Kind::Sphere, Kind::Box, Kind::Cloud, Kind::Checker];

    fn volume_m3(dense: &Dense) -> f64 {
        let sum: f64 = dense.values.iter().map(|&v| f64::from(v)).sum();
        sum * dense.voxel_m().powi(3)
    }

    #[test]
    fn dims_follow_the_size() {
        let dims = |kind, size, resolution| generate(kind, size, resolution, 0).dims;
        for kind in KINDS {
            assert_eq!(dims(kind, [2.0, 2.0, 2.0], 9), [9, 9, 9]);
            assert_eq!(dims(kind, [400.0, 200.0, 300.0], 32), [32, 16, 24]);
            assert_eq!(dims(kind, [0.3, 0.1, 1e-9], 27), [27, 9, 1]);
            assert_eq!(dims(kind, [2.0, 2.0, 2.0], 1), [1, 1, 1]);
            assert_eq!(dims(kind, [1.0, 2.0, 1.0], 2), [1, 2, 1]);
        }
        assert_eq!(dims(Kind::Box, [1.0, 0.52, 0.58], 10), [10, 5, 6]);
        assert_eq!(dims(Kind::Sphere, [1.0, 0.52, 0.58], 10), [10, 6, 6]);
    }

    #[test]
    fn centered_on_the_origin() {
        for kind in KINDS {
            let dense = generate(kind, [3.0, 2.0, 1.0], 9, 0);
            let [nx, ny, nz] = dense.dims.map(|n| n as f64);
            assert_eq!(dense.values.len(), 9 * 6 * 3);
            let low = dense.world_from_index.transform_point3(DVec3::ZERO);
            let last = DVec3::new(nx, ny, nz) - 1.0;
            let high = dense.world_from_index.transform_point3(last);
            // Two roundings of numbers below 2.
            assert!((low + high).abs().max_element() < 4.0 * f64::EPSILON, "{low} {high}");
            // The outermost faces are half a voxel beyond: the box's own.
            assert!((high.x + 0.5 * dense.voxel_m() - 1.5).abs() < 4.0 * f64::EPSILON);
        }
    }

    #[test]
    fn finite_and_bounded_at_extremes() {
        for kind in KINDS {
            for size in [[2.0, 2.0, 2.0], [1e6, 1e3, 1.0], [1e-6, 2e-6, 1e-6], [1.0, 900.0, 3.0]] {
                for resolution in [1, 2, 3, 17] {
                    let dense = generate(kind, size, resolution, 3);
                    assert!(
                        dense.values.iter().all(|v| (0.0..=1.0).contains(v)),
                        "{kind:?} {size:?} {resolution}"
                    );
                }
            }
        }
    }

    #[test]
    fn sphere_has_its_volume() {
        for (size, resolution) in
            [([2.0, 2.0, 2.0], 64), ([400.0, 250.0, 333.0], 65), ([1.0, 1.0, 1.0], 2), ([5.0, 5.0, 5.0], 1)]
        {
            let dense = generate(Kind::Sphere, size, resolution, 0);
            let truth = PI / 6.0 * size[0] * size[1] * size[2];
            // Midpoint rule with steps H = 1/8 voxel, H in radii: the cells within 2 H of the rim
            // have chords up to 4 sqrt(H) on an area of 4 pi H, the others err by
            // H²/24 times the integral of the chord's Laplacian, 2 pi / sqrt(H), all over the
            // volume 4 pi / 3.
            let shortest = size[1].min(size[2]);
            let step = dense.voxel_m() / CHORDS as f64 / (0.5 * shortest);
            let tolerance = (16.0 * PI + 2.0 * PI / 24.0) * step.powf(1.5) / (4.0 * PI / 3.0);
            let error = volume_m3(&dense) / truth - 1.0;
            eprintln!("sphere {size:?} {resolution}: volume {error:+.2e}, allowed {tolerance:.2e}");
            assert!(error.abs() < tolerance);
        }
    }

    #[test]
    fn sphere_is_one_inside_and_symmetric() {
        let dense = generate(Kind::Sphere, [2.0, 2.0, 2.0], 15, 0);
        assert_eq!(dense.values[7 + 15 * (7 + 15 * 7)], 1.0);
        assert_eq!(dense.values[0], 0.0);
        let reversed: Vec<f32> = dense.values.iter().rev().copied().collect();
        for (a, b) in dense.values.iter().zip(&reversed) {
            // 64 chords summed in the other order.
            assert!((a - b).abs() < 64.0 * f32::EPSILON);
        }
    }

    #[test]
    fn box_is_all_ones() {
        let dense = generate(Kind::Box, [3.0, 1.0, 2.0], 33, 0);
        assert!(dense.values.iter().all(|&v| v == 1.0));
        // 3993 exact ones times a voxel of 1/11.
        assert!((volume_m3(&dense) - 6.0).abs() < 6.0 * 8.0 * f64::EPSILON);
    }

    #[test]
    fn checker_alternates() {
        let dense = generate(Kind::Checker, [2.0, 2.0, 1.0], 16, 0);
        assert_eq!(dense.dims, [16, 16, 8]);
        let at = |i: usize, j: usize, k: usize| dense.values[i + 16 * (j + 16 * k)];
        assert_eq!([at(0, 0, 0), at(3, 3, 1), at(4, 0, 0), at(4, 4, 0)], [0.05, 0.05, 1.0, 0.05]);
        assert_eq!([at(0, 0, 2), at(15, 0, 0)], [1.0, 1.0]);
        let mean = volume_m3(&dense) / 4.0;
        // 0.05 is rounded to f32 once.
        assert!((mean - 0.525).abs() < f64::from(f32::EPSILON) * 0.05);
    }
}
