//! The octahedral map of directions to a square.
//!
//! A direction d meets the octahedron |x| + |y| + |z| = 1 in q; its upper half is seen from above, and the lower
//! one is folded outwards over its edges (Cigolle et al. 2014, "Survey of Efficient Representations for
//! Independent Unit Vectors"). The square is −1..=1 along both axes; beyond it the map goes on with the
//! directions that lie beyond the fold, so that what is sampled a little outside is right. Its area element is
//! du dv = |q|³ dω. `shaders/lib/octahedral.wgsl` is its twin. Tested both ways, across the fold, and by 4π.

use glam::DVec3;

/// Where a direction of any length above 0 lies.
pub fn from_direction(d: DVec3) -> [f64; 2] {
    let q = d / (d.x.abs() + d.y.abs() + d.z.abs());
    if q.z >= 0.0 {
        return [q.x, q.y];
    }
    [(1.0 - q.y.abs()).copysign(q.x), (1.0 - q.x.abs()).copysign(q.y)]
}

/// The point of the octahedron at a place up to 1 beyond the square.
fn on_octahedron([u, v]: [f64; 2]) -> DVec3 {
    let (u, v) = if u.abs() > 1.0 { (2.0f64.copysign(u) - u, -v) } else { (u, v) };
    let (u, v) = if v.abs() > 1.0 { (-u, 2.0f64.copysign(v) - v) } else { (u, v) };
    let z = 1.0 - u.abs() - v.abs();
    if z >= 0.0 {
        return DVec3::new(u, v, z);
    }
    DVec3::new((1.0 - v.abs()).copysign(u), (1.0 - u.abs()).copysign(v), z)
}

/// The unit vector at a place up to 1 beyond the square.
pub fn to_direction(at: [f64; 2]) -> DVec3 {
    on_octahedron(at).normalize()
}

/// Solid angle per area of the square in sr.
pub fn solid_angle(at: [f64; 2]) -> f64 {
    on_octahedron(at).length().powi(-3)
}

#[cfg(test)]
mod tests {
    use std::f64::consts::PI;

    use super::*;

    fn grid(n: usize) -> impl Iterator<Item = [f64; 2]> {
        (0..n * n).map(move |idx| [idx % n, idx / n].map(|i| (2 * i + 1) as f64 / n as f64 - 1.0))
    }

    #[test]
    fn there_and_back() {
        for at in grid(31) {
            let [u, v] = from_direction(3.0 * to_direction(at));
            // Divisions and roots of numbers up to 1.
            assert!((u - at[0]).abs() < 1e-14 && (v - at[1]).abs() < 1e-14, "{at:?}: {u} {v}");
        }
    }

    #[test]
    fn the_map_goes_on_beyond_its_edges() {
        for v in [-0.9, -0.3, 0.2, 0.7] {
            for [inside, outside] in [[[0.99, v], [1.01, v]], [[v, -0.99], [v, -1.01]]] {
                let apart = to_direction(inside).angle_between(to_direction(outside));
                // A step of 0.02, on an octahedron of which no point is nearer than 0.57.
                assert!(apart < 0.02 * 2f64.sqrt() / 0.57, "{inside:?}: {apart}");
            }
        }
    }

    #[test]
    fn all_directions_are_four_pi() {
        let n = 200;
        let sum: f64 = grid(n).map(solid_angle).sum::<f64>() * (2.0 / n as f64).powi(2);
        // The midpoint rule: curvature of |q|^-3 is at most 30, over 24 · 100².
        assert!((sum / (4.0 * PI) - 1.0).abs() < 1e-4, "{sum}");
    }
}
