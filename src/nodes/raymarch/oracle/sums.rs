//! f64 oracle of the gathering (`raymarch/sums.rs`): what all beams send to the eye, at the corners of cells.
//!
//! At a corner the sums over the beams of E_n e^{−tau_n} HG, E_n e^{−k tau_n} K and E_n e^{−tau_n} K, towards the
//! eye, with the eye's optical depth in K walked from there. Their logarithms are trilinear between corners. A
//! segment of a ray then sees albedo W0 times the first, and albedo times (W times the second − W0 times the
//! third), never less than none (W0, W: `raymarch/oracle.rs`).
//!
//! Limits: parallel beams alone. Of one beam this is the march that looks it up, but for the turning of the view
//! from corner to corner.

use glam::DVec3;

use super::{MarchScene, Marched, Ray, Segment, box_interval, march_with, phases};
use crate::nodes::oracle_scene::corners::tau_along;
use crate::nodes::oracle_scene::{OracleBeam, OracleMedium};
use crate::volume::field::Field;

/// Less than this is none.
pub const DARK: f64 = 1e-30;

/// Logarithms of the three sums at each corner, for an eye in index space.
pub fn gather(scene: &MarchScene, eye: DVec3) -> Field<DVec3> {
    let medium = scene.medium;
    let k = medium.scaled().k;
    Field::from_fn(medium.sigma_t.dims.map(|n| n + 1), |corner| {
        let p = DVec3::from_array(corner.map(|n| n as f64)) - 0.5;
        let to_eye = (eye - p).normalize();
        let tau_c = tau_to_eye(medium, &Ray { origin: p, direction: to_eye }, eye.distance(p));
        let of_beam = |beam: &OracleBeam| {
            let tau_n = beam.tau_corners.at(corner);
            let [single, peak] = phases(scene, beam, p, -to_eye, tau_n + tau_c);
            let lit = beam.light.power() * (-tau_n).exp();
            DVec3::new(lit * single, beam.light.power() * (-k * tau_n).exp() * peak, lit * peak)
        };
        let sum: DVec3 = scene.beams.iter().map(of_beam).sum();
        DVec3::from_array(sum.to_array().map(|sum| sum.max(DARK).ln()))
    })
}

/// Optical depth along a ray up to `reach` cells, between the centers of the outermost cells, which are void.
fn tau_to_eye(medium: &OracleMedium, ray: &Ray, reach: f64) -> f64 {
    let high = DVec3::from_array(medium.sigma_t.dims.map(|n| (n - 1) as f64));
    box_interval(ray, DVec3::ZERO, high).map_or(0.0, |[start, end]| {
        let from = ray.origin + start * ray.direction;
        tau_along(&medium.sigma_t, medium.h, from, ray.direction, end.min(reach) - start)
    })
}

/// Marches as `march_through` does, with the beams' light from such sums.
pub fn march_gathered(
    scene: &MarchScene,
    ray: &Ray,
    interval: Option<[f64; 2]>,
    sigma_t_at: impl Fn(DVec3) -> f64,
    sums: &Field<DVec3>,
) -> Marched {
    let beams_at = |p: DVec3, segment: &Segment| {
        let [single, reaching, unscattered] = sums.trilinear_clamp(p + 0.5).to_array().map(f64::exp);
        let deflected = segment.reach * reaching - segment.sharp * unscattered;
        [segment.sharp * single, deflected.max(0.0)].map(|light| scene.medium.albedo * light)
    };
    march_with(scene, ray, interval, sigma_t_at, beams_at)
}
