//! f64 oracle of principal propagation: the optical depth of a parallel beam.
//!
//! `tau(x)` = ∫ sigma_t ds from x against the direction of travel to where the medium ends, held at
//! the corners of the cells: a walk from every corner. The mean irradiance of a cell for a beam of
//! 1 W/m² is the mean of e^{−k tau} from its corners (`oracle_scene/corners.rs`). And the scan: a walk up to a
//! plane of corners, with what that plane has by a cubic.
//!
//! In: sigma_t [1/m] at cell centers, `h` in m. Out: tau at corners, dims + 1; mean irradiance at
//! cells. Limits: those of the walk and of the mean. Tested with slabs in closed form, along axes
//! and oblique.

use glam::DVec3;

use crate::nodes::oracle_scene::corners::{corner_field, largest_axis, mean_over_cells, tau_along};
use crate::volume::field::Field;

/// Unscaled optical depth at the cells' corners of light that travels along the unit vector
/// `direction`.
pub fn tau_corners_walk(sigma_t: &Field<f64>, h: f64, direction: DVec3) -> Field<f64> {
    corner_field(sigma_t, |corner| tau_along(sigma_t, h, corner, -direction, f64::INFINITY))
}

/// The same by a scan in slabs of so many planes. Cells at the border are void, and the light's way ends at their
/// centers.
pub fn tau_corners_scan(sigma_t: &Field<f64>, h: f64, direction: DVec3, slab: usize) -> Field<f64> {
    let along = largest_axis(direction);
    let [u, v] = [[1, 2], [0, 2], [0, 1]][along];
    let mut tau = Field::filled(sigma_t.dims.map(|n| n + 1), 0.0);
    let last = tau.dims[along] - 1;
    let is_up = direction[along] > 0.0;
    let coordinate = |met: usize| if is_up { met } else { last - met };
    for met in 1..=last {
        let known = (met - 1) / slab * slab;
        let margin = if known > 0 { 0.0 } else { 0.5_f64.copysign(direction[along]) };
        let until = coordinate(known) as f64 + margin;
        let steps = (until - coordinate(met) as f64) / -direction[along];
        let n_samples = steps.ceil();
        for idx in 0..tau.dims[u] * tau.dims[v] {
            let mut corner = [0; 3];
            (corner[along], corner[u], corner[v]) = (coordinate(met), idx % tau.dims[u], idx / tau.dims[u]);
            let place = DVec3::from_array(corner.map(|n| n as f64));
            let sample = |n: usize| {
                sigma_t.trilinear_zero(place - 0.5 - direction * ((n as f64 + 0.5) * steps / n_samples))
            };
            let near = (0..n_samples as usize).map(sample).sum::<f64>() * steps / n_samples * h;
            let crossing = place - steps * direction;
            let at = |i: i64, j: i64| {
                let mut corner = [coordinate(known) as i64; 3];
                corner[u] = crossing[u].floor() as i64 + i;
                corner[v] = crossing[v].floor() as i64 + j;
                tau.at(std::array::from_fn(|a| corner[a].clamp(0, tau.dims[a] as i64 - 1) as usize))
            };
            let [across, up] = [u, v].map(|axis| cubic(crossing[axis] - crossing[axis].floor()));
            let sum: f64 =
                (0..16).map(|n| across[n % 4] * up[n / 4] * at(n as i64 % 4 - 1, n as i64 / 4 - 1)).sum();
            let around = [at(0, 0), at(1, 0), at(0, 1), at(1, 1)];
            let [least, most] =
                [around.into_iter().fold(f64::INFINITY, f64::min), around.into_iter().fold(0.0, f64::max)];
            let [nx, ny, _] = tau.dims;
            tau.data[corner[0] + nx * (corner[1] + ny * corner[2])] = near + sum.clamp(least, most);
        }
    }
    tau
}

/// Weights of the cubic through four values at -1, 0, 1, 2 (Catmull and Rom).
fn cubic(f: f64) -> [f64; 4] {
    let (f2, f3) = (f * f, f * f * f);
    [-f + 2.0 * f2 - f3, 2.0 - 5.0 * f2 + 3.0 * f3, f + 4.0 * f2 - 3.0 * f3, f3 - f2]
        .map(|weight| 0.5 * weight)
}

/// Mean irradiance of each cell for a beam of 1 W/m², from the tau at its corners, of which the
/// share `k` counts.
pub fn mean_irradiance(tau_corners: &Field<f64>, k: f64, direction: DVec3) -> Field<f64> {
    mean_over_cells(tau_corners, k, direction)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn slab_has_its_closed_form() {
        // Along z: half a cell of ramp, then sigma each cell: tau = sigma h k at corner k. Only the
        // step over the kink at the first center errs, by at most sigma h / 8 (module doc).
        let (sigma, h) = (3.0, 0.25);
        let sigma_t = Field::filled([3, 4, 8], sigma);
        for (direction, flip) in [(DVec3::Z, false), (DVec3::NEG_Z, true)] {
            let tau = tau_corners_walk(&sigma_t, h, direction);
            assert_eq!(tau.dims, [4, 5, 9]);
            for k in 1..8 {
                let corner = if flip { 8 - k } else { k };
                let expected = sigma * h * k as f64;
                let found = tau.at([1, 2, corner]);
                assert!((found - expected).abs() <= sigma * h / 8.0, "{k}: {found}");
            }
        }
    }

    #[test]
    fn oblique_slab_is_longer_by_the_cosine() {
        // A wide slab with density in z alone, the corner far from the sides: tau(z)/mu0. The walk
        // takes steps of at most a cell, so of at most mu0 cells in z; two kinks, each an eighth.
        let (sigma, h, n) = (2.0, 0.5, 41);
        let sigma_t = Field::from_fn([n, n, 6], |[_, _, z]| if z < 3 { sigma } else { 0.0 });
        let direction = DVec3::new(0.6, 0.0, 0.8);
        let tau = tau_corners_walk(&sigma_t, h, direction);
        let expected = sigma * h * 3.0 / 0.8;
        assert!((tau.at([30, 20, 5]) - expected).abs() <= 2.0 * sigma * h / 8.0);
        assert_eq!(tau.at([30, 20, 0]), tau.at([30, 21, 0]));
    }

    #[test]
    fn a_scan_of_what_is_linear_is_a_walk() {
        // Cubics keep what is linear, here the depth of a density that rises along x and z, from plane to plane; midpoints
        // are exact on straight pieces, and kinks cost each way at most two eighths of a cell's depth of 40.
        let sigma_t = Field::from_fn([40, 9, 40], |[x, _, z]| {
            if x == 0 || z == 0 || x == 39 || z == 39 { 0.0 } else { (x + z) as f64 }
        });
        let direction = DVec3::new(0.3, 0.0, -0.8).normalize();
        let walk = tau_corners_walk(&sigma_t, 1.0, direction);
        for slab in [1, 5, 8, 100] {
            let scan = tau_corners_scan(&sigma_t, 1.0, direction, slab);
            for z in [2, 9, 20] {
                let [found, expected] = [&scan, &walk].map(|tau| tau.at([25, 4, z]));
                assert!((found - expected).abs() < 10.0, "{slab} {z}: {found} against {expected}");
            }
        }
    }

    #[test]
    fn a_slab_takes_what_the_beam_loses() {
        // Along the axis the edges telescope: Σ k sigma h Em = 1 − e^{−k tau}; the walk's tau at
        // the ends is off by up to sigma h/8, and so is the sum.
        let (sigma, h, k) = (3.0, 0.25, 0.7);
        let tau = tau_corners_walk(&Field::filled([3, 3, 8], sigma), h, DVec3::Z);
        let mean = mean_irradiance(&tau, k, DVec3::Z);
        let taken: f64 = (0..8).map(|z| k * sigma * h * mean.at([1, 1, z])).sum();
        let expected = 1.0 - (-k * sigma * h * 8.0).exp();
        assert!((taken - expected).abs() < k * sigma * h / 8.0, "{taken} against {expected}");
    }
}
