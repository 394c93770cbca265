//! f64 oracle of the raymarch: what a camera ray sees of the medium.
//!
//! March in pairs of steps. sigma_t is that of the middle of each step; light is evaluated once a pair,
//! at the mean of the two middles weighted by how much of each is seen (in the clearest channel), with tau_c the camera's optical
//! depth averaged alike. Integrated over the pair exactly, for what is constant in a step: of light that
//! nothing deflects W0 = ∫ e^{−tau} sigma_t dl, of light scattered anew, where extinction is sigma_t* =
//! k sigma_t, W = ∫ e^{−k tau} sigma_t dl. A beam of unattenuated irradiance E_n then adds albedo E_n
//! \[W0 e^{−tau_n} HG(g a0; mu) + (W e^{−k tau_n} − W0 e^{−tau_n}) K(albedo (tau_n + tau_c); mu)\],
//! the residual W times its lobe per sigma_t, and emission its own at each step. The first term is exact single
//! scattering, the second the forward peak (`optics/peak.rs`); where light goes to and fro along a beam, W0 times
//! both streams and their phases in its place (`optics/backward.rs`). Behind the medium stands e^{−k tau} of
//! a constant ambient radiance: e^{−tau} of it is seen sharp, the rest was scattered forward.
//!
//! In: index space as in `oracle_scene.rs`; sigma_t trilinear, zero outside; tau of the light
//! trilinear between corners; the residual trilinear between centers; emission at the grids' own
//! voxels. Out: radiance by layers [W/(m² sr)].
//! Limits: one table of K for all spreads a0; of an environment's stack only the bent ways (`bend.rs`); near a point light r⁻²
//! is that of the pair. Tested with closed forms; as a chain in `oracle_scene/tests.rs`.

pub mod bend;
pub mod sums;

use std::f64::consts::PI;

use glam::{DVec3, DVec4};

use crate::light::Window;
use crate::nodes::oracle_scene::{BeamLight, OracleBeam, OracleEmission, OracleMedium};
use crate::optics::backward::{self, Streams};
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
    /// What it emits.
    pub emission: Option<&'a OracleEmission>,
    /// Constant radiance behind the medium.
    pub ambient: f64,
    /// `peak_table(g)` of the medium's g.
    pub peak_table: &'a [f32],
    /// `backward::table(g)`, for beams along which light goes to and fro.
    pub backward_table: &'a [f32],
    /// Longest step, in cells.
    pub step: f64,
    /// The least k of all channels: what is seen of a step in it says where a pair is lit.
    pub least_k: f64,
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
    /// ∫ (1 − tau/T)² t dtau over ∫ (1 − tau/T)² dtau [cells]: where an environment's light bends.
    pub elbow: f64,
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
    let beams_at =
        |p: DVec3, segment: &Segment| light_of_beams(scene, ray.direction, p, segment, &tau_to_light);
    march_with(scene, ray, interval, sigma_t_at, beams_at)
}

/// The same, with what beams send to the eye from a segment given: scattered once, and what the peak adds.
fn march_with(
    scene: &MarchScene,
    ray: &Ray,
    interval: Option<[f64; 2]>,
    sigma_t_at: impl Fn(DVec3) -> f64,
    beams_at: impl Fn(DVec3, &Segment) -> [f64; 2],
) -> Marched {
    let mut seen = Marched::default();
    let scaled = scene.medium.scaled();
    let mut depths = Vec::new();
    if let Some([start, end]) = interval {
        let n_pairs = (0.5 * (end - start) / scene.step).ceil();
        let step = 0.5 * (end - start) / n_pairs;
        let step_m = step * scene.medium.h;
        for pair in 0..n_pairs as usize {
            let mut segment = Segment { length_m: 2.0 * step_m, ..Default::default() };
            // Weights, weighted t, weighted optical depth.
            let mut toward = [0.0; 3];
            for half in 0..2 {
                let t = start + ((2 * pair + half) as f64 + 0.5) * step;
                let p = ray.origin + ray.direction * t;
                let sigma_t = sigma_t_at(p);
                let depth = sigma_t * step_m;
                let seen_m = (-scaled.k * seen.tau).exp() * mean_transmittance(scaled.k * depth) * step_m;
                if let Some(emission) = scene.emission {
                    seen.emission += seen_m * emission.at(p);
                }
                let reach = |k: f64| (-k * seen.tau).exp() * mean_transmittance(k * depth) * depth;
                segment.sharp += reach(1.0);
                segment.reach += reach(scaled.k);
                for (sum, value) in toward.iter_mut().zip([1.0, t, seen.tau + 0.5 * depth]) {
                    *sum += reach(scene.least_k) * value;
                }
                seen.tau += depth;
                depths.push([depth, seen.tau - 0.5 * depth, t]);
            }
            if toward[0] > 0.0 {
                segment.tau_c = toward[2] / toward[0];
                let p = ray.origin + ray.direction * (toward[1] / toward[0]);
                let [single, forward] = beams_at(p, &segment);
                seen.single += single;
                seen.forward += forward;
                seen.residual += segment.reach * residual_at(scene, p, ray.direction);
            }
        }
    }
    let weights = || depths.iter().map(|[depth, tau, t]| (depth * (1.0 - tau / seen.tau).powi(2), t));
    let elbow = weights().map(|(weight, t)| weight * t).sum::<f64>()
        / weights().map(|(weight, _)| weight).sum::<f64>();
    seen.elbow = if seen.tau > 0.0 { elbow } else { 0.0 };
    seen.background = scene.ambient * (-scaled.k * seen.tau).exp();
    seen
}

/// Two steps of a ray whose light is evaluated at one point.
#[derive(Clone, Copy, Debug, Default)]
struct Segment {
    /// W0 of the module's text.
    sharp: f64,
    /// W.
    reach: f64,
    /// Optical depth from the eye to the point.
    tau_c: f64,
    /// Of both steps.
    length_m: f64,
}

/// What all beams send along a ray from a segment whose point is `p`: scattered once, and what the peak adds.
fn light_of_beams(
    scene: &MarchScene,
    ray_direction: DVec3,
    p: DVec3,
    segment: &Segment,
    tau_to_light: impl Fn(usize, DVec3) -> f64,
) -> [f64; 2] {
    let medium = scene.medium;
    let mut sums = [0.0; 2];
    for (index, beam) in scene.beams.iter().enumerate() {
        let irradiance = match beam.light {
            BeamLight::Parallel { irradiance, .. } => irradiance,
            BeamLight::Point { position_in_index, intensity } => {
                intensity * inverse_square((p - position_in_index).length() * medium.h, segment.length_m)
            }
        };
        let tau_n = tau_to_light(index, p);
        let unscattered = segment.sharp * (-tau_n).exp();
        let deflected = (segment.reach * (-medium.scaled().k * tau_n).exp() - unscattered).max(0.0);
        let [single, peak] = phases(scene, beam, p, ray_direction, tau_n + segment.tau_c);
        sums[0] += medium.albedo * irradiance * unscattered * single;
        sums[1] += medium.albedo * irradiance * deflected * peak;
        if let Some(ahead) = &beam.ahead_corners {
            let Streams { on, back, kappa } =
                Streams::new(medium.albedo, medium.g, tau_n, ahead.trilinear_clamp(p + 0.5));
            let lit = segment.sharp * (-kappa * tau_n).exp();
            let mu = -beam.light.direction_at(p).dot(ray_direction);
            let [even, odd] =
                [(0, mu), (1, -mu)].map(|(row, mu)| backward::lookup(scene.backward_table, row, mu));
            sums[1] += medium.albedo * irradiance * ((lit * on - unscattered) * even + lit * back * odd);
        }
    }
    sums
}

/// HG and K [1/sr] of a beam at `p` towards the eye of a ray, less what its window leaves to the environment's
/// stack; `depth` is tau_n + tau_c.
fn phases(scene: &MarchScene, beam: &OracleBeam, p: DVec3, ray_direction: DVec3, depth: f64) -> [f64; 2] {
    let medium = scene.medium;
    let mu = -beam.light.direction_at(p).dot(ray_direction);
    let peak = peak::lookup(scene.peak_table, medium.albedo * depth, mu);
    let kept = |phase: f64| match beam.window {
        Some(window) if medium.g > 0.0 => without_forward(phase, mu, medium.g, window),
        _ => phase,
    };
    [kept(hg(mu, medium.g * beam.light.spread())), kept(peak)]
}

/// The residual's radiance per unit of optical depth, along a ray.
fn residual_at(scene: &MarchScene, p: DVec3, ray_direction: DVec3) -> f64 {
    let scaled = scene.medium.scaled();
    let light = scene.residual.trilinear_clamp(p);
    let flux = DVec3::new(light.y, light.z, light.w);
    let ratio = scaled.sigma_s_ratio;
    SquaredLinearLobe::new(ratio * light.x, ratio * scaled.g_star * flux).eval(-ray_direction)
}

/// A phase function less what the environment's stack carries of it: W + (phase − W)(1 − w(mu)), W the part as
/// even as the residual's sources, \[(1−f) + 3(g−f) mu\]₊/4π, and w a smooth step from 0 at the window's outer
/// angle to its share at its inner one.
fn without_forward(phase: f64, mu: f64, g: f64, window: Window) -> f64 {
    let [inner, outer] = window.cosines();
    let part = ((mu - outer) / (inner - outer)).clamp(0.0, 1.0);
    let even = ((1.0 - g * g) + 3.0 * (g - g * g) * mu).max(0.0) / (4.0 * PI);
    even + (phase - even) * (1.0 - window.share * part * part * (3.0 - 2.0 * part))
}

/// r⁻² [1/m²] at the distance `r_m` from a point light, as a segment sees it: within the ball whose
/// volume is the cube of its length it is the ball's mean, 3/radius², so it is finite everywhere.
fn inverse_square(r_m: f64, length_m: f64) -> f64 {
    let radius = BALL_RADIUS_PER_EDGE * length_m;
    if r_m < radius { 3.0 / (radius * radius) } else { 1.0 / (r_m * r_m) }
}

/// Radius of the ball that has the volume of a cube, over the cube's edge: (3/4π)^{1/3}.
const BALL_RADIUS_PER_EDGE: f64 = 0.62;

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
