//! f64 oracle of principal propagation: the optical depth of a parallel beam.
//!
//! `tau(x)` = ∫ sigma_t ds from x against the direction of travel to where the medium ends, held at
//! the corners of the cells: a walk from every corner. The mean irradiance of a cell for a beam of
//! 1 W/m² is the mean of e^{−k tau} from its corners (`oracle_scene/corners.rs`).
//!
//! In: sigma_t [1/m] at cell centers, `h` in m. Out: tau at corners, dims + 1; mean irradiance at
//! cells. Limits: those of the walk and of the mean. Tested with slabs in closed form, along axes
//! and oblique.

use glam::DVec3;

use crate::nodes::oracle_scene::corners::{corner_field, mean_over_cells, tau_along};
use crate::volume::field::Field;

/// Unscaled optical depth at the cells' corners of light that travels along the unit vector
/// `direction`.
pub fn tau_corners_walk(sigma_t: &Field<f64>, h: f64, direction: DVec3) -> Field<f64> {
    corner_field(sigma_t, |corner| tau_along(sigma_t, h, corner, -direction, f64::INFINITY))
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
