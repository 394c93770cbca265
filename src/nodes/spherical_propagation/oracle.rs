//! f64 oracle of spherical propagation: the optical depth and irradiance of a point light.
//!
//! As for a parallel beam (`oracle_scene/corners.rs`), with walks that end at the light.
//! The irradiance of 1 W/sr is r⁻² e^{−k tau}. Where a cell's center is nearer to the light than a
//! cell edge, r⁻² is the mean over the cell, exact. The edges of the mean of e^{−k tau} run along
//! the axis nearest to the line from the light to the grid's center.
//!
//! In: sigma_t [1/m], `h` (m), position in index coordinates. Out: tau at corners; mean irradiance
//! [1/m²] at cells. [`RadialOracle`] is the grid of a light, with walks from node to node. Limits: r⁻² and e^{−k tau} are averaged apart. Tested in vacuum, by the closed
//! form of a homogeneous medium, and by the integral of r⁻² over a cube.

use glam::DVec3;

use crate::nodes::oracle_scene::corners::{corner_field, mean_over_cells, tau_along};
use crate::optics::octahedral;
use crate::volume::field::Field;
use crate::wire::{Fineness, Spacing};

/// The grid of distance and direction around a light (`wire/radial.rs`).
pub struct RadialOracle {
    spacing: Spacing,
    fineness: Fineness,
    /// Depths by direction, row by row, then by node.
    pub tau: Vec<f64>,
}

impl RadialOracle {
    /// Walks along each direction from node to node, with samples at most a cell apart.
    pub fn new(sigma_t: &Field<f64>, h: f64, position: DVec3, fineness: Fineness) -> Self {
        let last = DVec3::from_array(sigma_t.dims.map(|n| (n - 1) as f64));
        let spacing = Spacing::new(position, last);
        let directions = spacing.directions(fineness.n_angular);
        let mut tau = vec![0.0; directions.len()];
        for node in 1..fineness.n_radial {
            let [from, to] = [node - 1, node].map(|node| Self::distance(&spacing, fineness, node));
            let before = tau.len() - directions.len();
            for (idx, (direction, _)) in directions.iter().enumerate() {
                let step = tau_inside(sigma_t, h, position + from * *direction, *direction, to - from);
                tau.push(tau[before + idx] + step);
            }
        }
        Self { spacing, fineness, tau }
    }

    /// Distance of a node [cells].
    pub fn distance(spacing: &Spacing, fineness: Fineness, node: usize) -> f64 {
        let n = (fineness.n_radial - 1) as f64;
        match (spacing.is_log, node) {
            (false, _) => spacing.first + (spacing.last - spacing.first) * node as f64 / n,
            (true, 0) => 0.0,
            (true, _) => spacing.last * 100f64.powf((node - 1) as f64 / (n - 1.0) - 1.0),
        }
    }

    /// Depths of whole ways.
    pub fn exits(&self) -> &[f64] {
        &self.tau[self.tau.len() - self.fineness.n_angular.pow(2)..]
    }

    /// Depth at `line` from the light, linear between nodes and directions; at the edges of a whole sphere's
    /// square the nearest direction's.
    pub fn at(&self, line: DVec3) -> f64 {
        let [right, up, axis] = self.spacing.frame;
        let r = line.length();
        // On the light itself, where no direction is.
        if r == 0.0 {
            return 0.0;
        }
        let n_angular = self.fineness.n_angular;
        let at = octahedral::from_direction(DVec3::new(line.dot(right), line.dot(up), line.dot(axis)));
        let place = |side: usize| {
            let texel =
                (at[side] - self.spacing.low[side]) / self.spacing.extent[side] * n_angular as f64 - 0.5;
            texel.clamp(0.0, (n_angular - 1) as f64)
        };
        let last = (self.fineness.n_radial - 1) as f64;
        let second = 0.01 * self.spacing.last;
        let node = match self.spacing.is_log {
            false => last * (r - self.spacing.first) / (self.spacing.last - self.spacing.first),
            true if r < second => r / second,
            true => 1.0 + (last - 1.0) * (r / second).ln() / 100f64.ln(),
        };
        let dims = [n_angular, n_angular, self.fineness.n_radial];
        let (x, y, z) = (place(0), place(1), node.clamp(0.0, last));
        let mut sum = 0.0;
        for corner in 0..8 {
            let mut weight = 1.0;
            let mut index = [0; 3];
            for (axis, at) in [x, y, z].into_iter().enumerate() {
                let low = at.floor().min((dims[axis] - 2) as f64);
                let step = corner >> axis & 1;
                weight *= if step == 1 { at - low } else { 1.0 - at + low };
                index[axis] = low as usize + step;
            }
            sum += weight * self.tau[index[0] + n_angular * (index[1] + n_angular * index[2])];
        }
        sum
    }
}

/// As [`tau_along`], within the box between the outermost centers, which are void: as shaders walk.
fn tau_inside(sigma_t: &Field<f64>, h: f64, from: DVec3, toward: DVec3, length: f64) -> f64 {
    let last = DVec3::from_array(sigma_t.dims.map(|n| (n - 1) as f64));
    let (mut start, mut end) = (0.0, length);
    for axis in 0..3 {
        if toward[axis].abs() < 1e-12 {
            if from[axis] < 0.0 || from[axis] > last[axis] {
                return 0.0;
            }
            continue;
        }
        let (a, b) = (-from[axis] / toward[axis], (last[axis] - from[axis]) / toward[axis]);
        start = f64::max(start, a.min(b));
        end = f64::min(end, a.max(b));
    }
    if end <= start {
        return 0.0;
    }
    let n_steps = (end - start).ceil();
    let step = (end - start) / n_steps;
    let at = |i: usize| sigma_t.trilinear_zero(from + toward * (start + (i as f64 + 0.5) * step));
    (0..n_steps as usize).map(at).sum::<f64>() * step * h
}

/// Unscaled optical depth from the point `position_in_index` to the cells' corners.
pub fn tau_corners_walk_point(sigma_t: &Field<f64>, h: f64, position_in_index: DVec3) -> Field<f64> {
    corner_field(sigma_t, |corner| {
        let to_light = position_in_index - corner;
        let toward = to_light.normalize_or_zero();
        tau_along(sigma_t, h, corner, toward, to_light.length())
    })
}

/// Mean irradiance [1/m²] of each cell, across the line to a light of 1 W/sr.
pub fn mean_irradiance_point(
    tau_corners: &Field<f64>,
    k: f64,
    h: f64,
    position_in_index: DVec3,
) -> Field<f64> {
    let center_in_index = DVec3::from_array(tau_corners.dims.map(|n| (n - 2) as f64 / 2.0));
    let mean = mean_over_cells(tau_corners, k, center_in_index - position_in_index);
    Field::from_fn(mean.dims, |cell| {
        let to_cell = DVec3::from_array(cell.map(|i| i as f64)) - position_in_index;
        mean.at(cell) * mean_inverse_square(to_cell * h, h)
    })
}

/// r⁻² [1/m²] for a cell of edge `h` whose center is at `center_m` from the light: its mean over
/// the cell where that is near, else its value at the center.
fn mean_inverse_square(center_m: DVec3, h: f64) -> f64 {
    if center_m.length() >= h {
        return 1.0 / center_m.length_squared();
    }
    // r⁻² = ∇·(r/r²): the integral over the cell is that of (distance to the face's plane)/r² over
    // its faces.
    let (low, high) = (center_m - 0.5 * h, center_m + 0.5 * h);
    let faces = (0..3).map(|axis| {
        let (u, v) = ((axis + 1) % 3, (axis + 2) % 3);
        let face = |distance| face_integral(distance, [low[u], high[u]], [low[v], high[v]]);
        face(high[axis]) - face(low[axis])
    });
    faces.sum::<f64>() / (h * h * h)
}

/// ∫∫ d/(d² + u² + v²) du dv for the signed distance `d`.
fn face_integral(d: f64, [u0, u1]: [f64; 2], [v0, v1]: [f64; 2]) -> f64 {
    if d == 0.0 {
        return 0.0;
    }
    // Along u in closed form, with a² = d² + v²; v = |d| sinh s leaves a smooth function of s.
    let (s0, s1) = ((v0 / d.abs()).asinh(), (v1 / d.abs()).asinh());
    let ds = (s1 - s0) / N_ALONG_FACE as f64;
    let integrand = |i| {
        let a = d.abs() * (s0 + (i as f64 + 0.5) * ds).cosh();
        (u1 / a).atan() - (u0 / a).atan()
    };
    d * ds * (0..N_ALONG_FACE).map(integrand).sum::<f64>()
}

/// Samples of the midpoint rule across a face.
const N_ALONG_FACE: usize = 64;

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn vacuum_has_the_inverse_square() {
        let tau = tau_corners_walk_point(&Field::filled([6, 5, 4], 0.0), 0.5, DVec3::splat(1.2));
        assert!(tau.data.iter().all(|tau| *tau == 0.0));
        let e = mean_irradiance_point(&tau, 1.0, 0.5, DVec3::new(1.0, 2.0, -7.0));
        assert!((e.at([1, 2, 3]) * 25.0 - 1.0).abs() < 1e-15);
        assert!((e.at([5, 2, 3]) * (4.0 + 25.0) - 1.0).abs() < 1e-15);
    }

    #[test]
    fn homogeneous_medium_has_its_closed_form() {
        // Light and corners inside, where the density is constant: tau = sigma r, to rounding.
        let (sigma, h) = (0.7, 0.5);
        let light = DVec3::new(3.3, 4.1, 2.6);
        let tau = tau_corners_walk_point(&Field::filled([9, 9, 9], sigma), h, light);
        for index in [[3, 5, 3], [8, 1, 7], [1, 1, 1]] {
            let corner = DVec3::from_array(index.map(|i| i as f64)) - 0.5;
            let expected = sigma * h * (corner - light).length();
            assert!((tau.at(index) - expected).abs() < 1e-14, "{index:?}");
        }
    }

    #[test]
    fn a_cell_near_the_light_has_the_mean_of_the_inverse_square() {
        // The midpoint rule over 120³ points, of a cell that the light is outside of: curvature
        // 6 r⁻⁴ over 24 · 120² is 1e-4 of r⁻² at r = 0.6 − ½.
        let center = DVec3::new(0.6, 0.3, -0.4);
        let points = Field::from_fn([120; 3], |index| {
            let offset = DVec3::from_array(index.map(|i| (i as f64 + 0.5) / 120.0 - 0.5));
            1.0 / (center + offset).length_squared()
        });
        let expected = points.data.iter().sum::<f64>() / points.data.len() as f64;
        let found = mean_inverse_square(2.0 * center, 2.0) * 4.0;
        assert!((found / expected - 1.0).abs() < 1e-4, "{found} against {expected}");
    }

    #[test]
    fn a_cell_around_the_light_has_a_finite_mean() {
        // A ball of the cell's volume has the mean 3/radius² = 7.796; a cube, less compact, a
        // little less, and eight cubes that share the corner at the light a quarter of it each.
        let centered = mean_inverse_square(DVec3::ZERO, 1.0);
        assert!((7.5..7.796).contains(&centered), "{centered}");
        let corner = mean_inverse_square(DVec3::splat(0.5), 1.0);
        // Midpoint rule in s on 64 steps of 0.03: (0.03)²/24.
        assert!((corner / (centered / 4.0) - 1.0).abs() < 1e-4, "{corner}");
        let on_a_face = mean_inverse_square(DVec3::new(0.5, 0.1, 0.2), 1.0);
        let beside_it = mean_inverse_square(DVec3::new(0.5 + 1e-9, 0.1, 0.2), 1.0);
        assert!((on_a_face / beside_it - 1.0).abs() < 1e-7, "{on_a_face} {beside_it}");
    }

    #[test]
    fn edges_point_to_the_center_of_the_grid() {
        // The light stands to the side along y; tau varies along y alone.
        let tau = Field::from_fn([5, 5, 5], |[_, y, _]| 0.5 * y as f64);
        let e = mean_irradiance_point(&tau, 2.0, 1.0, DVec3::new(1.5, -20.0, 1.0));
        let expected = crate::optics::transmittance::mean_exp(1.0, 2.0) / (441.0 + 0.25);
        assert!((e.at([1, 1, 1]) / expected - 1.0).abs() < 1e-14);
    }
}
