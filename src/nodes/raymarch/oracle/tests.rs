use std::f64::consts::PI;

use glam::DMat4;

use super::*;
use crate::nodes::oracle_scene::constant_light;
use crate::optics::blackbody::blackbody_rgb;
use crate::optics::transmittance::one_minus_exp;

fn medium(dims: [usize; 3], sigma: f64, albedo: f64, g: f64) -> OracleMedium {
    OracleMedium { sigma_t: Field::filled(dims, sigma), h: 0.5, albedo, g }
}

fn beam(light: BeamLight) -> OracleBeam {
    // These tests give tau in closed form; the field is not read.
    OracleBeam { light, tau_corners: Field::filled([1, 1, 1], f64::NAN), ahead_corners: None, window: None }
}

fn scene<'a>(
    medium: &'a OracleMedium,
    beams: &'a [OracleBeam],
    residual: &'a Field<DVec4>,
    peak_table: &'a [f32],
) -> MarchScene<'a> {
    let least_k = medium.scaled().k;
    MarchScene {
        medium,
        beams,
        residual,
        emission: None,
        ambient: 0.0,
        peak_table,
        backward_table: &[],
        step: 0.5,
        least_k,
    }
}

const ALONG_Z: Ray = Ray { origin: DVec3::new(1.5, 1.5, -10.0), direction: DVec3::Z };

#[test]
fn a_medium_that_only_absorbs_lets_through_the_exponential() {
    // 8 centers of constant sigma and two ramps of half a cell's worth each: tau = sigma h 8; steps
    // of half a cell lie on the kinks, so the midpoint rule is exact. Twenty roundings.
    let medium = medium([4, 4, 8], 0.7, 0.0, 0.3);
    let residual = constant_light([4, 4, 8], 0.0);
    let mut scene = scene(&medium, &[], &residual, &[]);
    scene.ambient = 3.0;
    let seen = march_ray(&scene, &ALONG_Z);
    let tau: f64 = 0.7 * 0.5 * 8.0;
    assert!((seen.tau - tau).abs() < 1e-14);
    assert!((seen.radiance() / (3.0 * (-tau).exp()) - 1.0).abs() < 1e-14);
    let beside = Ray { origin: DVec3::new(9.0, 1.5, -10.0), ..ALONG_Z };
    let seen = march_ray(&scene, &beside);
    assert_eq!((seen.tau, seen.radiance()), (0.0, 3.0));
    let inside = Ray { origin: DVec3::new(1.5, 1.5, 2.0), ..ALONG_Z };
    assert!((march_ray(&scene, &inside).tau - tau * 5.5 / 8.0).abs() < 1e-14);
}

#[test]
fn constant_light_is_seen_through_anything_at_albedo_one() {
    // (1 − e^{−k tau}) L of the residual and e^{−k tau} L from behind, step by step exact.
    for g in [-0.9, 0.0, 0.85, 0.999] {
        for sigma in [1e-6, 1.0, 1e4] {
            let medium = medium([4, 4, 8], sigma, 1.0, g);
            let residual = constant_light([4, 4, 8], 0.25);
            let mut scene = scene(&medium, &[], &residual, &[]);
            scene.ambient = 0.25;
            let direction = DVec3::new(0.3, -0.1, 0.9).normalize();
            let origin = DVec3::new(0.5, 2.0, -3.0);
            let seen = march_ray(&scene, &Ray { origin, direction });
            assert!((seen.radiance() - 0.25).abs() < 1e-13, "g {g} sigma {sigma}: {seen:?}");
            assert!(seen.tau > 3.0 * sigma && seen.residual > 0.0, "g {g} {sigma}: {seen:?}");
        }
    }
}

#[test]
fn single_scattering_of_a_slab_has_its_closed_form() {
    // Lit and seen from the same side: albedo E HG(−1) (1 − e^{−2 tau})/2, however the peak is
    // scaled. W0 is exact; e^{−tau_n} at the mean of a pair of d = 0.05 each lacks half its variance,
    // (2d)²/24, and the mean of the middles is d²/12 off that of the pair, both together d²/4; weights
    // e^{−k tau} instead of e^{−tau} bring (1 − k) d²/4 more: 9.9e-4 at the least k, 0.424.
    let sigma = 5.0;
    for g in [-0.6, 0.0, 0.8] {
        let medium = medium([4, 4, 4], sigma, 0.9, g);
        let residual = constant_light([4, 4, 4], 0.0);
        let light = BeamLight::Parallel { direction: DVec3::Z, irradiance: 3.0, spread: 1.0 };
        let beams = [beam(light)];
        let table = peak::peak_table(g);
        let mut scene = scene(&medium, &beams, &residual, &table);
        scene.step = 0.02;
        let tau_at = |p: DVec3| sigma * 0.5 * p.z;
        let seen = march_through(
            &scene,
            &Ray { origin: DVec3::ZERO, direction: DVec3::Z },
            Some([0.0, 4.0]),
            |_| sigma,
            |_, p| tau_at(p),
        );
        let expected = 0.9 * 3.0 * hg(-1.0, g) * one_minus_exp(2.0 * sigma * 2.0) / 2.0;
        assert!((seen.single / expected - 1.0).abs() < 1e-3, "g {g}: {seen:?} {expected}");
        assert_eq!(seen.forward > 0.0, g > 0.0, "g {g}: {seen:?}");
        assert!((seen.tau - 10.0).abs() < 1e-12);
    }
}

#[test]
fn forward_peak_of_a_thin_layer_is_its_product() {
    // All behind tau_n, the layer so thin that tau_c = 1e-7 does nothing: forward = albedo tau
    // (e^{−k tau_n} − e^{−tau_n}) E K(albedo tau_n; mu).
    let (g, albedo, tau_n) = (0.75, 0.9, 2.5);
    let medium = medium([4, 4, 4], 1e-7, albedo, g);
    let residual = constant_light([4, 4, 4], 0.0);
    let direction = DVec3::new(0.6, 0.0, -0.8);
    let light = BeamLight::Parallel { direction, irradiance: 2.0, spread: 0.9 };
    let beams = [beam(light)];
    let table = peak::peak_table(g);
    let scene = scene(&medium, &beams, &residual, &table);
    let seen = march_through(
        &scene,
        &Ray { origin: DVec3::ZERO, direction: DVec3::Z },
        Some([0.0, 2.0]),
        |_| 1e-7,
        |_, _| tau_n,
    );
    let k = 1.0 - albedo * g * g;
    let common = albedo * 1e-7 * 2.0;
    let peak = peak::lookup(&table, albedo * tau_n, 0.8);
    let forward = common * ((-k * tau_n).exp() - (-tau_n).exp()) * peak;
    let single = common * (-tau_n).exp() * hg(0.8, 0.9 * g);
    assert!((seen.forward / forward - 1.0).abs() < 1e-6, "{seen:?} {forward}");
    assert!((seen.single / single - 1.0).abs() < 1e-6, "{seen:?} {single}");
}

#[test]
fn the_lobe_of_the_residual_faces_its_flux() {
    // sigma_s* q(−v)/sigma_t* (1 − e^{−k tau}); a constant source is exact in every step.
    for g in [-0.8, 0.5] {
        let medium = medium([4, 4, 4], 2.0, 0.9, g);
        let scaled = medium.scaled();
        let flux = DVec3::new(0.1, 0.2, -0.6);
        let residual = Field::filled([4, 4, 4], DVec4::from((1.0, flux)));
        let scene = scene(&medium, &[], &residual, &[]);
        let seen = march_ray(&scene, &ALONG_Z);
        let a = (scaled.g_star.abs() * flux.length()).min(0.5);
        let b = (1.0 - (1.0 - 3.0 * a * a).sqrt()) / a;
        let cosine = scaled.g_star.signum() * -flux.z / flux.length();
        let lobe = (1.0 + b * cosine).powi(2) / (4.0 * PI * (1.0 + b * b / 3.0));
        let expected = scaled.sigma_s_ratio / scaled.k * lobe * one_minus_exp(scaled.k * 2.0 * 0.5 * 4.0);
        assert!((seen.residual / expected - 1.0).abs() < 1e-13, "g {g}: {seen:?} {expected}");
    }
}

#[test]
fn emission_adds_up_and_is_absorbed() {
    // In void: eps times the length, the fade of half a cell at both ends included. In an absorbing
    // medium, where both fade alike, eps/sigma (1 − e^{−tau}), to the midpoint rule in the fade.
    let residual = constant_light([4, 4, 8], 0.0);
    let glow = |dims: [usize; 3], flame_from_index: DMat4| OracleEmission {
        flame: Field::filled(dims, 3.0 / blackbody_rgb(1900.0, 2000.0)[1]),
        flame_from_index,
        kelvin_above: Field::filled([1; 3], 0.0),
        kelvin_outside: 1900.0,
        kelvin_from_index: DMat4::IDENTITY,
        reference_kelvin: 2000.0,
        channel: 1,
    };
    let emission = glow([4, 4, 8], DMat4::IDENTITY);
    for (sigma, expected, tolerance) in [(0.0, 3.0 * 4.0, 1e-14), (0.5, 6.0 * one_minus_exp(2.0), 1e-14)] {
        let medium = medium([4, 4, 8], sigma, 0.0, 0.0);
        let mut scene = scene(&medium, &[], &residual, &[]);
        scene.emission = Some(&emission);
        let seen = march_ray(&scene, &ALONG_Z);
        assert!((seen.emission / expected - 1.0).abs() < tolerance, "{sigma}: {seen:?}");
    }
    // On a grid three times as fine the fade is a third as long: a cell's width stays.
    let finer = DMat4::from_scale(DVec3::splat(3.0)) * DMat4::from_translation(DVec3::splat(0.5));
    let fine = glow([12, 12, 24], DMat4::from_translation(DVec3::splat(-0.5)) * finer);
    let medium = medium([4, 4, 8], 0.0, 0.0, 0.0);
    let mut scene = scene(&medium, &[], &residual, &[]);
    scene.emission = Some(&fine);
    scene.step = 1.0 / 6.0;
    assert!((march_ray(&scene, &ALONG_Z).emission / 12.0 - 1.0).abs() < 1e-13);
}

#[test]
fn a_point_light_falls_off_with_the_square() {
    // Airlight of a thin medium, isotropic: sigma I/4π ∫ ds/(b² + s²) = sigma I/(4π b) [atan(s/b)].
    // Midpoint rule: (dl/b)²/24 · 2 at b = 1 m, pairs of dl = 0.1 m.
    let medium = medium([10, 10, 20], 1e-9, 1.0, 0.0);
    let residual = constant_light([10, 10, 20], 0.0);
    let light = BeamLight::Point { position_in_index: DVec3::new(3.0, 4.0, 10.0), intensity: 7.0 };
    let beams = [beam(light)];
    let table = peak::peak_table(0.0);
    let mut scene = scene(&medium, &beams, &residual, &table);
    scene.step = 0.1;
    let march = |origin: DVec3| {
        let ray = Ray { origin, direction: DVec3::Z };
        march_through(&scene, &ray, Some([0.0, 20.0]), |_| 1e-9, |_, _| 0.0)
    };
    let expected = 1e-9 * 7.0 / (4.0 * PI) * 2.0 * 5f64.atan();
    let seen = march(DVec3::new(5.0, 4.0, 0.0));
    assert!((seen.single / expected - 1.0).abs() < 5e-4, "{seen:?} {expected}");
    // Past the light at a tenth of a pair, with a sample there: dl (3/(0.62 dl)² + 2 Σ 1/(j² + 0.01)
    // dl⁻²), the sum cut at j = 50, is 10 (7.80 + 3.22) in place of 2 atan 5 = 2.75.
    let through = march(DVec3::new(3.02, 4.0, -0.1));
    assert!((through.single / seen.single / 40.1 - 1.0).abs() < 0.01, "{through:?} {seen:?}");
}

#[test]
fn fields_are_looked_up_where_they_stand() {
    // tau at corners linear in z, light isotropic, thin: the mean of e^{−tau} over the ray.
    let medium = medium([4, 4, 8], 1e-9, 1.0, 0.0);
    let residual = constant_light([4, 4, 8], 0.0);
    let light = BeamLight::Parallel { direction: DVec3::X, irradiance: 1.0, spread: 1.0 };
    let tau_corners = Field::from_fn([5, 5, 9], |[_, _, z]| z as f64);
    let beams = [OracleBeam { light, tau_corners, ahead_corners: None, window: None }];
    let table = peak::peak_table(0.0);
    let mut scene = scene(&medium, &beams, &residual, &table);
    scene.step = 0.01;
    let origin = DVec3::new(1.5, 1.5, 1.0);
    let seen = march_ray(&scene, &Ray { origin, direction: DVec3::Z });
    // Center z sees tau z + ½; from 1 to 7 the density is constant, then it fades to 8, where tau
    // stays at 8 from 7.5 on. Midpoint rule: (0.01)²/24.
    let inner = (-1.5f64).exp() - (-7.5f64).exp();
    let fade: f64 = (0..1000)
        .map(|i| {
            let z = (i as f64 + 0.5) / 1000.0;
            (1.0 - z) * (-(7.5 + z).min(8.0)).exp() / 1000.0
        })
        .sum();
    let expected = 1e-9 * 0.5 / (4.0 * PI) * (inner + fade);
    assert!((seen.single / expected - 1.0).abs() < 1e-4, "{seen:?} {expected}");
}

#[test]
fn the_interval_begins_at_the_eye() {
    let high = DVec3::splat(4.0);
    let ray = |origin, direction| Ray { origin, direction };
    let interval = |ray: &Ray| box_interval(ray, DVec3::ZERO, high);
    assert_eq!(interval(&ray(DVec3::new(1.0, 1.0, -2.0), DVec3::Z)), Some([2.0, 6.0]));
    assert_eq!(interval(&ray(DVec3::new(1.0, 1.0, 3.0), DVec3::Z)), Some([0.0, 1.0]));
    assert_eq!(interval(&ray(DVec3::new(1.0, 1.0, 3.0), DVec3::NEG_Z)), Some([0.0, 3.0]));
    assert_eq!(interval(&ray(DVec3::new(1.0, 1.0, 9.0), DVec3::Z)), None);
    assert_eq!(interval(&ray(DVec3::new(9.0, 1.0, 0.0), DVec3::Z)), None);
}

#[test]
fn a_far_point_light_is_a_beam() {
    // At the distance of 1e6 cells directions and r⁻² differ by 1e-5.
    let (g, tau_n) = (0.6, 1.5);
    let medium = medium([4, 4, 4], 1.0, 0.9, g);
    let residual = constant_light([4, 4, 4], 0.0);
    let direction = DVec3::new(0.6, 0.0, -0.8);
    let table = peak::peak_table(g);
    let march = |light| {
        let beams = [beam(light)];
        let scene = scene(&medium, &beams, &residual, &table);
        let ray = Ray { origin: DVec3::ZERO, direction: DVec3::Z };
        march_through(&scene, &ray, Some([0.0, 3.0]), |_| 1.0, |_, _| tau_n)
    };
    let parallel = march(BeamLight::Parallel { direction, irradiance: 2.0, spread: 1.0 });
    let (position_in_index, distance_m) = (-1e6 * direction, 1e6 * medium.h);
    let intensity = 2.0 * distance_m * distance_m;
    let point = march(BeamLight::Point { position_in_index, intensity });
    assert!((point.single / parallel.single - 1.0).abs() < 5e-5, "{point:?} {parallel:?}");
    assert!((point.forward / parallel.forward - 1.0).abs() < 5e-5, "{point:?} {parallel:?}");
}
