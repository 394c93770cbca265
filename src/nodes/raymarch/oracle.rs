//! f64 oracle of the raymarch: what a camera ray sees of the medium.
//!
//! March with the delta-scaled extinction sigma_t* = k sigma_t; at the middle of a step, with tau_c
//! the camera's optical depth there and tau_c* = k tau_c, each beam n of unattenuated irradiance
//! E_n arrives as E* = E_n e^{−k tau_n} and, never scattered, as E0 = E_n e^{−tau_n − tau_c +
//! tau_c*}; S = Σ sigma_s \[E0 HG(g a0; mu) + (E* − E0) K(albedo (tau_n + tau_c); mu)\] + the
//! residual's lobe + emission, and a step of length dl adds e^{−tau*} S (1 − e^{−sigma_t*
//! dl})/sigma_t*. The first term is exact single scattering, the second the forward peak
//! (`optics/peak.rs`). Behind the medium stands e^{−k tau} of a constant ambient radiance: e^{−tau}
//! of it is seen sharp, the rest was scattered forward.
//!
//! In: index space as in `oracle_scene.rs`; sigma_t trilinear, zero outside; tau of the light
//! trilinear between corners; the residual trilinear between centers; emission on the cells or on a
//! grid finer by a whole number, trilinear, zero outside. Out: radiance by layers [W/(m² sr)].
//! Limits: one table of K for all spreads a0; no environment stack; near a point light r⁻²
//! is that of the step. Tested with closed forms; as a chain in `oracle_scene/tests.rs`.

use glam::{DVec3, DVec4};

use crate::nodes::oracle_scene::{BeamLight, OracleBeam, OracleMedium};
use crate::optics::lobe::SquaredLinearLobe;
use crate::optics::peak;
use crate::optics::phase::hg;
use crate::optics::transmittance::mean_transmittance;
use crate::volume::field::Field;

/// What a ray marches through.
#[derive(Clone, Copy, Debug)]
pub struct MarchScene<'a> {
    /// Medium.
    pub medium: &'a OracleMedium,
    /// Beams with their tau.
    pub beams: &'a [OracleBeam],
    /// (phi, F) at the cells.
    pub residual: &'a Field<DVec4>,
    /// Emitted radiance per meter [W/(m³ sr)].
    pub emission: Option<&'a Field<f64>>,
    /// Constant radiance behind the medium.
    pub ambient: f64,
    /// `peak_table(g)` of the medium's g.
    pub peak_table: &'a [f32],
    /// Longest step, in cells.
    pub step: f64,
}

/// A ray in index space.
#[derive(Clone, Copy, Debug)]
pub struct Ray {
    /// Start, in index coordinates.
    pub origin: DVec3,
    /// Unit direction.
    pub direction: DVec3,
}

/// What a ray sees.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Marched {
    /// Light of the beams scattered once.
    pub single: f64,
    /// What their forward peaks add.
    pub forward: f64,
    /// From the residual.
    pub residual: f64,
    /// Emitted.
    pub emission: f64,
    /// The ambient radiance behind the medium, sharp and scattered forward.
    pub background: f64,
    /// Unscaled optical depth of the ray.
    pub tau: f64,
}

impl Marched {
    /// All layers together [W/(m² sr)].
    pub fn radiance(&self) -> f64 {
        self.single + self.forward + self.residual + self.emission + self.background
    }
}

/// Marches a ray through the medium's grid.
pub fn march_ray(scene: &MarchScene, ray: &Ray) -> Marched {
    let dims = scene.medium.sigma_t.dims;
    let interval = box_interval(ray, DVec3::NEG_ONE, DVec3::from_array(dims.map(|n| n as f64)));
    march_through(
        scene,
        ray,
        interval,
        |p| scene.medium.sigma_t.trilinear_zero(p),
        |beam, p| scene.beams[beam].tau_corners.trilinear_clamp(p + 0.5),
    )
}

/// Marches over an interval of the ray, in cells, with sigma_t [1/m] and the tau of a beam given as
/// functions of the index position: what homogeneous shapes need, whose tau is a closed form.
pub fn march_through(
    scene: &MarchScene,
    ray: &Ray,
    interval: Option<[f64; 2]>,
    sigma_t_at: impl Fn(DVec3) -> f64,
    tau_to_light: impl Fn(usize, DVec3) -> f64,
) -> Marched {
    let mut seen = Marched::default();
    let medium = scene.medium;
    let scaled = medium.scaled();
    if let Some([start, end]) = interval {
        let n_steps = ((end - start) / scene.step).ceil();
        let step = (end - start) / n_steps;
        let step_m = step * medium.h;
        for index in 0..n_steps as usize {
            let p = ray.origin + ray.direction * (start + (index as f64 + 0.5) * step);
            let sigma_t = sigma_t_at(p);
            let depth = sigma_t * scaled.k * step_m;
            let weight = (-scaled.k * seen.tau).exp() * mean_transmittance(depth) * step_m;
            if let Some(emission) = scene.emission {
                seen.emission += weight * emission_at(medium, emission, p);
            }
            if sigma_t > 0.0 {
                let tau_c = seen.tau + 0.5 * sigma_t * step_m;
                let sigma_s = sigma_t * medium.albedo;
                for (index, beam) in scene.beams.iter().enumerate() {
                    let [single, forward] = beam_toward_eye(
                        scene,
                        &beam.light,
                        p,
                        ray.direction,
                        [tau_to_light(index, p), tau_c],
                        step_m,
                    );
                    seen.single += weight * sigma_s * single;
                    seen.forward += weight * sigma_s * forward;
                }
                let light = scene.residual.trilinear_clamp(p);
                let sigma_s_star = sigma_t * scaled.sigma_s_ratio;
                let flux = DVec3::new(light.y, light.z, light.w);
                let lobe =
                    SquaredLinearLobe::new(sigma_s_star * light.x, sigma_s_star * scaled.g_star * flux);
                seen.residual += weight * lobe.eval(-ray.direction);
            }
            seen.tau += sigma_t * step_m;
        }
    }
    seen.background = scene.ambient * (-scaled.k * seen.tau).exp();
    seen
}

/// Radiance per sigma_s [W/(m² sr)] that a beam sends from `p` against the ray, scattered once, and
/// by its forward peak; `taus` to the light and to the eye.
fn beam_toward_eye(
    scene: &MarchScene,
    light: &BeamLight,
    p: DVec3,
    ray_direction: DVec3,
    [tau_n, tau_c]: [f64; 2],
    step_m: f64,
) -> [f64; 2] {
    let medium = scene.medium;
    let irradiance = match *light {
        BeamLight::Parallel { irradiance, .. } => irradiance,
        BeamLight::Point { position_in_index, intensity } => {
            intensity * inverse_square((p - position_in_index).length() * medium.h, step_m)
        }
    };
    let mu = -light.direction_at(p).dot(ray_direction);
    let k = medium.scaled().k;
    let scaled = (-k * tau_n).exp();
    // E0 ≤ E*, where rounding would have it otherwise too.
    let unscattered = (-tau_n - tau_c + k * tau_c).exp().min(scaled);
    let peak = peak::lookup(scene.peak_table, medium.albedo * (tau_n + tau_c), mu);
    let single = irradiance * unscattered * hg(mu, medium.g * light.spread());
    [single, irradiance * (scaled - unscattered) * peak]
}

/// r⁻² [1/m²] at the distance `r_m` from a point light, as a step sees it: within the ball whose
/// volume is the cube of the step it is the ball's mean, 3/radius², so it is finite everywhere.
fn inverse_square(r_m: f64, step_m: f64) -> f64 {
    let radius = BALL_RADIUS_PER_EDGE * step_m;
    if r_m < radius { 3.0 / (radius * radius) } else { 1.0 / (r_m * r_m) }
}

/// Radius of the ball that has the volume of a cube, over the cube's edge: (3/4π)^{1/3}.
const BALL_RADIUS_PER_EDGE: f64 = 0.62;

/// Emitted radiance per meter at an index position.
fn emission_at(medium: &OracleMedium, emission: &Field<f64>, p: DVec3) -> f64 {
    let fine = (emission.dims[0] / medium.sigma_t.dims[0]) as f64;
    emission.trilinear_zero(fine * (p + 0.5) - 0.5)
}

/// Where a ray is between `low` and `high`, from its origin on; in the units of its direction.
pub fn box_interval(ray: &Ray, low: DVec3, high: DVec3) -> Option<[f64; 2]> {
    let (mut start, mut end) = (0.0f64, f64::INFINITY);
    for axis in 0..3 {
        let (o, d) = (ray.origin[axis], ray.direction[axis]);
        if d.abs() < 1e-12 {
            if o < low[axis] || o > high[axis] {
                return None;
            }
        } else {
            let (a, b) = ((low[axis] - o) / d, (high[axis] - o) / d);
            start = start.max(a.min(b));
            end = end.min(a.max(b));
        }
    }
    (end > start).then_some([start, end])
}

#[cfg(test)]
mod tests;
