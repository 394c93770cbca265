//! Random points on surfaces, each for a piece of their area.
//!
//! Surfaces are divided (`geometry/divide.rs`); a piece is hit as often as its area says, and less the further it
//! lies from the medium, d: by (1 + d²/R²)⁻¹, R half of the medium's diagonal, because its light matters less by d⁻² and
//! what stands far away is wide. A point stands for more area there: areas sum up to that of the surfaces on average,
//! exactly where all pieces are equally far. Along the list of pieces points stand evenly, one in each step.

use glam::{DVec3, Vec3};

use crate::geometry::divide::divide;
use crate::mirror;

mirror! {
    /// `SurfacePoint` of `shaders/bounce_lights.wgsl`.
    pub(super) struct SurfacePoint {
        p: [f32; 3],
        triangle: u32,
    }
}

/// A point of a surface, in index space.
#[derive(Debug, Clone, Copy)]
pub(super) struct Point {
    pub(super) position: Vec3,
    /// Unit normal on the front.
    pub(super) normal: DVec3,
    pub(super) triangle: u32,
    /// What it stands for [cells²].
    pub(super) area: f64,
}

impl Point {
    /// For the shader.
    pub(super) fn texel(&self) -> SurfacePoint {
        SurfacePoint { p: self.position.to_array(), triangle: self.triangle }
    }
}

/// Pieces have edges up to this share of the medium's diagonal, or of their distance from it.
const FINEST: f32 = 1.0 / 16.0;
/// Pieces that are added to triangles, at most.
const PIECES: usize = 1 << 16;

/// Numbers in 0..1 from a seed (splitmix64).
pub(super) struct Random(pub(super) u64);

impl Random {
    pub(super) fn unit(&mut self) -> f64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        ((z ^ (z >> 31)) >> 11) as f64 / (1u64 << 53) as f64
    }
}

/// `n` points on triangles, for a medium of so many cells.
pub(super) fn sample(triangles: &[[Vec3; 3]], dims: [usize; 3], n: usize, seed: u64) -> Vec<Point> {
    let last = Vec3::from_array(dims.map(|n| n.saturating_sub(1) as f32));
    let diagonal = last.length().max(1.0);
    let away = |p: Vec3| p.distance(p.clamp(Vec3::ZERO, last));
    let mut finest = FINEST;
    let pieces = loop {
        let longest = |p: Vec3| finest * diagonal.max(4.0 * away(p));
        match divide(triangles, longest, triangles.len() + PIECES) {
            Some(pieces) => break pieces,
            None => finest *= 2.0,
        }
    };
    let crossed = |[a, b, c]: [Vec3; 3]| {
        let [a, b, c] = [a, b, c].map(Vec3::as_dvec3);
        (b - a).cross(c - a)
    };
    // What is added up, so that a number below the whole is in a piece.
    let mut sum = 0.0;
    let ends: Vec<(f64, f64)> = pieces
        .iter()
        .map(|(corners, _)| {
            let area = 0.5 * crossed(*corners).length();
            let d = f64::from(away((corners[0] + corners[1] + corners[2]) / 3.0) / (0.5 * diagonal));
            let weight = area / (1.0 + d * d);
            sum += weight;
            (sum, area / weight.max(1e-300))
        })
        .collect();
    let mut random = Random(seed);
    (0..n)
        .map(|idx| {
            let at = (idx as f64 + random.unit()) / n as f64 * sum;
            let piece = ends.partition_point(|(end, _)| *end <= at).min(pieces.len() - 1);
            let (corners, triangle) = pieces[piece];
            // Evenly over a triangle.
            let (root, along) = (random.unit().sqrt() as f32, random.unit() as f32);
            let [a, b, c] = corners;
            let position = (1.0 - root) * a + root * ((1.0 - along) * b + along * c);
            let normal = crossed(triangles[triangle as usize]).normalize();
            Point { position, normal, triangle, area: ends[piece].1 * sum / n as f64 }
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn sheet(z: f32, size: f32) -> [[Vec3; 3]; 2] {
        let [a, b, c, d] =
            [(0.0, 0.0), (size, 0.0), (size, size), (0.0, size)].map(|(x, y)| Vec3::new(x, y, z));
        [[a, b, c], [a, c, d]]
    }

    #[test]
    fn points_stand_for_the_area() {
        // All pieces inside of the medium: equal areas, whose sum is exact.
        let points = sample(&sheet(3.0, 8.0), [16; 3], 1000, 5);
        assert!(points.iter().all(|point| (point.area - 0.064).abs() < 1e-7));
        // Shares of three corners, in f32.
        let in_plane = |point: &Point| (point.position.z - 3.0).abs() < 1e-6 && point.normal == DVec3::Z;
        assert!(points.iter().all(in_plane));
        let mean = points.iter().map(|point| point.position.x).sum::<f32>() / 1000.0;
        // Standard deviation 2.3 of one point, and steps make it less.
        assert!((mean - 4.0).abs() < 0.2, "{mean}");
        // Partly far away: on average. Weights differ by up to 450.
        let wide = sample(&sheet(-3.0, 200.0), [16; 3], 4000, 5);
        let area: f64 = wide.iter().map(|point| point.area).sum();
        assert!((area / 4e4 - 1.0).abs() < 0.1, "{area}");
        let near = wide.iter().filter(|point| point.position.max_element() < 30.0).count();
        assert!(near > 1000, "{near} of 4000 points in 2 % of the area");
    }

    #[test]
    fn the_seed_decides() {
        let places =
            |seed| sample(&sheet(3.0, 8.0), [16; 3], 50, seed).iter().map(|p| p.position).collect::<Vec<_>>();
        assert_eq!(places(1), places(1));
        assert_ne!(places(1), places(2));
    }
}
