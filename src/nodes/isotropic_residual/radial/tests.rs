use std::f64::consts::PI;

use glam::DVec3;
use serde_json::json;

use super::super::tests::gpu_sources;
use super::*;
use crate::gpu::Gpu;
use crate::graph::{PortType, Value};
use crate::light::Light;
use crate::nodes::spherical_propagation::oracle::RadialOracle;
use crate::nodes::testing::{Filling, Scene, assert_close, assert_layout, full_output, gpu};
use crate::wire::Fineness;

const INSIDE: DVec3 = DVec3::new(7.3, 6.1, 8.4);
const ON_A_CORNER: DVec3 = DVec3::new(6.5, 7.5, 5.5);
const BESIDE: DVec3 = DVec3::new(22.0, 6.0, 7.0);

fn surface(position: DVec3, normal: DVec3) -> (DVec3, Option<DVec3>) {
    (position, Some(normal))
}

/// Light of 2 W/sr, or of a virtual light of 8 pi W, on grids.
fn carried(
    gpu: &Gpu,
    scene: &Scene,
    medium: &Value,
    lights: &[(DVec3, Option<DVec3>)],
    params: serde_json::Value,
) -> Value {
    let world = scene.lattice().world_from_index;
    let list: Vec<Light> = lights
        .iter()
        .map(|(p, normal)| {
            let position = world.transform_point3(*p);
            match normal {
                None => Light::Point { position, intensity: [2.0; 3] },
                Some(normal) => Light::Surface {
                    position,
                    normal: world.transform_vector3(*normal).normalize(),
                    power: [8.0 * PI; 3],
                },
            }
        })
        .collect();
    let lights = Value::new(PortType::Light, 0, list);
    full_output(gpu, "spherical_propagation", params, &[("medium", medium), ("lights", &lights)])
}

fn assert_power(gpu: &Gpu, what: &str, scene: &Scene, lights: &[(DVec3, Option<DVec3>)]) {
    let medium = scene.medium(gpu);
    let beams = carried(gpu, scene, &medium, lights, json!({ "angular": 24, "radial": 24 }));
    let found = gpu_sources(gpu, &medium, &beams).remove(0);
    let given = found.data.iter().map(|q| q.x).sum::<f64>() * scene.cell_m.powi(3);
    let beams: &Beams = beams.get();
    let grids = beams.radial.as_ref().unwrap();
    let wanted: f64 =
        (0..lights.len()).map(|n| power(medium.get(), &beams.beams[n], grids, n, &Channels::RGB)[0]).sum();
    // Each of 4,000 texels has roundings of f32 that are independent; the sum itself is in f64.
    assert!((given / wanted - 1.0).abs() < 1e-5, "{what}: {given} W of {wanted} W");
    for q in &found.data {
        let moment = DVec3::new(q.y, q.z, q.w).length();
        assert!(q.is_finite() && q.x >= 0.0 && moment <= q.x * (1.0 + 1e-6), "{what}: {q}");
    }
}

#[test]
fn lights_give_what_their_rays_lose() {
    let Some(gpu) = gpu() else { return };
    type Case<'a> = (&'a str, &'a [(DVec3, Option<DVec3>)]);
    let cases: [Case; 7] = [
        ("inside", &[(INSIDE, None)]),
        ("on a corner", &[(ON_A_CORNER, None)]),
        ("on the face of the box", &[(DVec3::new(0.0, 6.0, 7.0), None)]),
        ("beside", &[(BESIDE, None)]),
        ("far away", &[(DVec3::new(900.0, 2000.0, -400.0), None)]),
        ("of a surface", &[surface(INSIDE, DVec3::new(0.6, 0.0, 0.8))]),
        ("all at once", &[(INSIDE, None), (BESIDE, None), (ON_A_CORNER, None), surface(INSIDE, DVec3::X)]),
    ];
    for (what, lights) in cases {
        for (filling, tau) in [
            (Filling::Homogeneous, 1e-6),
            (Filling::Random, 0.05),
            (Filling::Random, 0.7),
            (Filling::Binary, 3.0),
        ] {
            let scene = Scene { g: 0.5, ..Scene::new([16, 14, 17], filling, tau / 0.25) };
            assert_power(gpu, &format!("{what}, {filling:?}, tau {tau}"), &scene, lights);
        }
    }
    // As thick as can be: nothing gets out of the light's own cell.
    let scene = Scene::new([16, 14, 17], Filling::Homogeneous, 1e4 / 0.25);
    for light in [INSIDE, ON_A_CORNER] {
        assert_power(gpu, "tau 1e4", &scene, &[(light, None)]);
    }
}

#[test]
fn thin_media_take_the_inverse_square() {
    // Optical depths of 1e-6: Q0 is sigma_s* I r^-2, and nothing of a virtual light goes behind it.
    let Some(gpu) = gpu() else { return };
    let scene = Scene { g: 0.0, albedo: [0.5; 3], ..Scene::new([16, 14, 17], Filling::Homogeneous, 4e-6) };
    let normal = DVec3::new(0.6, 0.0, 0.8);
    let medium = scene.medium(gpu);
    for (light, is_even) in [((INSIDE, None), true), (surface(INSIDE, normal), false), ((BESIDE, None), true)]
    {
        let beams = carried(gpu, &scene, &medium, &[light], json!({ "scheme": "radial" }));
        let found = gpu_sources(gpu, &medium, &beams).remove(0);
        for (idx, q) in found.data.iter().enumerate() {
            let line = (DVec3::from_array(found.index_of(idx).map(|i| i as f64)) - light.0) * 0.25;
            let sigma_t = scene.sigma_t.data[idx];
            // A virtual light's edge crosses cells near its plane.
            let cosine = if is_even { 0.25 } else { normal.dot(line.normalize()) };
            if line.length() < 1.0 || sigma_t == 0.0 || cosine.abs() < 0.2 {
                continue;
            }
            // 2 W/sr, or 8 pi W by cos/pi.
            let intensity = if cosine < 0.0 { 0.0 } else { 8.0 * cosine };
            let expected = 0.5 * sigma_t * intensity / line.length_squared();
            // 2^3 samples of r^-2 four cells away: (1/48)/16; the tail of the cosine's turn is as small. The crop of
            // a light outside is multiplied to the telescoped sum of 32² directions, 0.3 % of rays along edges.
            assert!((q.x - expected).abs() <= 0.006 * expected + 1e-18, "{line}: {} {expected}", q.x);
        }
    }
}

#[test]
fn sources_are_the_oracles() {
    // Away from the light, where a cell has 2^3 samples: against the f64 grid at the same samples.
    let Some(gpu) = gpu() else { return };
    let scene = Scene { g: 0.6, ..Scene::new([16, 14, 17], Filling::Random, 2.0) };
    let medium = scene.medium(gpu);
    let beams = carried(gpu, &scene, &medium, &[(INSIDE, None)], json!({ "angular": 32, "radial": 32 }));
    let found = gpu_sources(gpu, &medium, &beams).remove(0);
    let oracle =
        RadialOracle::new(&scene.sigma_t, scene.cell_m, INSIDE, Fineness { n_angular: 32, n_radial: 32 });
    let scaled = scene.oracle(0).scaled();
    let (mut of_gpu, mut expected) = (Vec::new(), Vec::new());
    for (idx, q) in found.data.iter().enumerate() {
        let cell = DVec3::from_array(found.index_of(idx).map(|i| i as f64));
        // Beyond 2^3 samples, and away from the fold, which the oracle does not look across.
        if cell.distance(INSIDE) < 2.5 || cell.z < INSIDE.z + 1.0 {
            continue;
        }
        let mean: f64 = (0..8)
            .map(|n| {
                let offset = DVec3::new((n & 1) as f64, (n >> 1 & 1) as f64, (n >> 2) as f64) * 0.5 - 0.25;
                let line = cell + offset - INSIDE;
                (-scaled.k * oracle.at(line)).exp() / (line.length() * scene.cell_m).powi(2) / 8.0
            })
            .sum();
        of_gpu.push(q.x);
        expected.push(2.0 * scene.sigma_t.data[idx] * scaled.sigma_s_ratio * mean);
    }
    assert!(of_gpu.len() > 1000);
    // Depths up to 5 of which rounding decides a few midpoint samples, and the factor that makes the power exact.
    let (sum, wanted): (f64, f64) = (of_gpu.iter().sum(), expected.iter().sum());
    assert!((sum / wanted - 1.0).abs() < 0.01, "{sum} {wanted}");
    assert_close("Q0", &of_gpu, &expected, 0.05, 1e-9);
}

#[test]
fn what_lacks_goes_to_the_own_cell() {
    let cells = [Some(3), None, Some(5)];
    let powers = [[2.0, 1.0, 0.0], [1.0; 3], [6.0, 1.0, 0.0]];
    let (factor, own) = settle(&powers, [8.0, 6.0, 2.0], &cells, 0.5);
    // 9 W are wanted and 8 given: 1 W in 0.5 m³, 2 to 6. Of the second channel 3 of 6 W: half. The third has no
    // light of its own.
    assert_eq!(factor, [1.0, 0.5, 0.5]);
    assert_eq!(own.len(), 2);
    assert_eq!((own[0].cell, own[1].cell), (3, 5));
    assert!((own[0].power[0] - 0.5).abs() < 1e-7 && (own[1].power[0] - 1.5).abs() < 1e-7);
    assert_eq!((own[0].power[1], own[0].power[2]), (0.0, 0.0));
}

#[test]
fn layouts_are_those_of_the_shaders() {
    const CHOICES: [(&str, &str); 2] = [("shadows", "true"), ("pack", "1")];
    let shader = "isotropic_residual/radial_sources.wgsl";
    assert_layout::<RadialSourceParams>(shader, "RadialSourceParams", &CHOICES);
    let shader = "isotropic_residual/radial_settle.wgsl";
    assert_layout::<SettleParams>(shader, "SettleParams", &[]);
    assert_layout::<OwnCell>(shader, "OwnCell", &[]);
}
