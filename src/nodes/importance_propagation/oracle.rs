//! f64 oracle of the view's depths: ∫ sigma_t ds along a camera ray.
//!
//! Midpoint samples at most a cell apart between the centers of the outermost cells, which are void: the
//! samples that the shader takes. In: sigma_t [1/m], `h` (m), a ray in index space. Tested with a slab.

use glam::DVec3;

use crate::nodes::oracle_scene::corners::tau_along;
use crate::nodes::raymarch::oracle::{Ray, box_interval};
use crate::volume::field::Field;

/// Optical depth of the medium along a ray, with its length in it times `stretch`: next to 1, the other one
/// of two numbers of steps between which rounding decides.
pub fn ray_tau(sigma_t: &Field<f64>, h: f64, ray: &Ray, stretch: f64) -> f64 {
    let inner = Field::from_fn(sigma_t.dims.map(|n| n - 2), |cell| sigma_t.at(cell.map(|i| i + 1)));
    let last = DVec3::from_array(sigma_t.dims.map(|n| (n - 1) as f64));
    box_interval(ray, DVec3::ZERO, last).map_or(0.0, |[start, end]| {
        let from = ray.origin + start * ray.direction - 1.0;
        tau_along(&inner, h, from, ray.direction, (end - start) * stretch)
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_slab_has_its_depth() {
        // Two cells of 3/m within a border: ramps of one cell on both sides, 3 cells of 0.5 m in all.
        let sigma_t = Field::from_fn([9, 9, 4], |[_, _, z]| if z == 0 || z == 3 { 0.0 } else { 3.0 });
        let ray = Ray { origin: DVec3::new(4.0, 4.0, -10.0), direction: DVec3::Z };
        // Steps of one cell have their middles on the ramps' middles: exact.
        assert!((ray_tau(&sigma_t, 0.5, &ray, 1.0) - 3.0).abs() < 1e-12);
        let past = Ray { origin: DVec3::new(40.0, 4.0, -10.0), direction: DVec3::Z };
        assert_eq!(ray_tau(&sigma_t, 0.5, &past, 1.0), 0.0);
    }
}
