//! f64 oracle of what arrives on a surface: irradiance of beams on one side of a point.
//!
//! Surfaces are tried one by one (`geometry/oracle.rs`), depths are midpoint sums of the trilinear extinction.

use glam::DVec3;

use crate::geometry::oracle::{Ray, nearest};
use crate::nodes::oracle_scene::OracleMedium;
use crate::nodes::oracle_scene::corners::tau_along;
use crate::wire::{Beam, Place};

/// [W/m²] at `p` on the side of `normal`, in index space, of one channel of the beams.
pub(super) fn irradiance(
    medium: &OracleMedium,
    triangles: &[[DVec3; 3]],
    beams: &[Beam],
    channel: usize,
    p: DVec3,
    normal: DVec3,
) -> f64 {
    let k = medium.scaled().k;
    let of_beam = |beam: &Beam| {
        let (toward, reach, falloff) = match beam.place {
            Place::Parallel(direction) => (-direction, 1e6, 1.0),
            Place::Point(position) => {
                let line = position - p;
                let toward = line.normalize();
                let along = beam.facing.map_or(1.0, |facing| 4.0 * facing.dot(-toward).max(0.0));
                (toward, line.length(), along / (line.length() * medium.h).powi(2))
            }
        };
        let cosine = normal.dot(toward);
        let hit = nearest(triangles, Ray { origin: p, direction: toward }, 1e-3, 0.0);
        if cosine <= 0.0 || hit.is_some_and(|hit| hit.t < reach - 1e-3) {
            return 0.0;
        }
        let tau = tau_along(&medium.sigma_t, medium.h, p, toward, reach);
        beam.power[channel] * falloff * cosine * (-k * tau).exp()
    };
    beams.iter().map(of_beam).sum()
}
