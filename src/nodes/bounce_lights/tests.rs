use std::f64::consts::PI;

use glam::DVec3;
use serde_json::{Value as Json, json};

use super::points::{Point, SurfacePoint};
use super::{ArrivalParams, irradiances, oracle};
use crate::graph::{PortType, Value};
use crate::light::Light;
use crate::nodes::kind;
use crate::nodes::testing::{
    Filling, Random, Scene, assert_layout, full_output, gpu, mesh, output, point, run, sun, with_run,
};
use crate::wire::{Beam, Beams, Medium, Place, Surfaces};

fn lights_of(value: &Value) -> Vec<(DVec3, DVec3, [f64; 3])> {
    let of_light = |light: &Light| match light {
        Light::Surface { position, normal, power } => (*position, *normal, *power),
        other => panic!("{other:?}"),
    };
    value.get::<Vec<Light>>().iter().map(of_light).collect()
}

/// What is sent of this light from a plate under the medium, by its area and reflectance.
fn sent(scene: &Scene, suns: &[Beam], params: Json) -> Option<Vec<(DVec3, DVec3, [f64; 3])>> {
    let gpu = gpu()?;
    let medium = scene.medium(gpu);
    let beams = scene.propagate(gpu, &medium, suns, [0.0; 3]);
    let plate = scene.plate([2.0, 2.0], [10.0, 10.0], 1.0);
    let inputs = [("medium", &medium), ("beams", &beams), ("surfaces", &plate)];
    Some(lights_of(&output(gpu, "bounce_lights", params, &inputs)))
}

#[test]
fn power_that_is_sent_is_reflectance_times_what_arrives() {
    // A void, a sun at an angle, a plate of 8 x 8 cells of 0.25 m, grey of 0.5.
    let scene = Scene::new([12; 3], Filling::Homogeneous, 0.0);
    let direction = DVec3::new(0.6, 0.0, -0.8);
    let light = Beam { power: [3.0, 2.0, 0.0], ..sun(direction, 1.0) };
    for count in [1, 7, 64] {
        let Some(lights) = sent(&scene, &[light], json!({ "count": count })) else { return };
        assert_eq!(lights.len(), count);
        let up = scene.lattice().world_from_index.transform_vector3(DVec3::Z).normalize();
        for c in 0..3 {
            let sum: f64 = lights.iter().map(|(_, _, power)| power[c]).sum();
            // Areas are in f64, of corners and irradiances in f32.
            let expected = 0.5 * light.power[c] * 0.8 * 4.0;
            assert!((sum - expected).abs() <= 1e-5 * expected, "{count}, channel {c}: {sum} {expected}");
        }
        for (position, normal, _) in &lights {
            assert!((*normal - up).length() < 1e-6, "{normal}: the dark side shines");
            let at = scene.lattice().index_from_world().transform_point3(*position);
            assert!((at.z - 1.0).abs() < 1e-4 && at.x > 2.0 && at.x < 10.0, "{at}");
        }
    }
}

#[test]
fn the_medium_dims_what_arrives() {
    // Homogeneous: light through the 9.5 cells between the centers at 1 and 10 and half a cell of fading out.
    let sigma_t = 0.3;
    let scene = Scene { g: 0.0, ..Scene::new([12, 12, 12], Filling::Homogeneous, sigma_t) };
    let Some(lights) = sent(&scene, &[sun(DVec3::NEG_Z, 2.0)], json!({})) else { return };
    let sum: f64 = lights.iter().map(|(_, _, power)| power[0]).sum();
    // Midpoint samples of the fading cell, and points near the edges of the plate.
    let expected = 0.5 * 2.0 * 4.0 * f64::exp(-sigma_t * 9.5 * 0.25);
    assert!((sum / expected - 1.0).abs() < 0.02, "{sum} {expected}");
}

#[test]
fn arrival_is_the_oracles() {
    let Some(gpu) = gpu() else { return };
    let scene = Scene { albedo: [0.9, 0.5, 0.1], ..Scene::new([12, 11, 10], Filling::Random, 2.0) };
    let medium = scene.medium(gpu);
    // Walls that stand in each other's way.
    let mut random = Random(8);
    let triangles: Vec<[DVec3; 3]> = (0..12)
        .map(|_| {
            let at = DVec3::new(random.unit(), random.unit(), random.unit()) * 14.0 - 1.0;
            [(); 3].map(|()| (at + 5.0 * random.direction()).as_vec3().as_dvec3())
        })
        .collect();
    let mesh = mesh(&scene.lattice(), &triangles, [0.5, 0.25, 1.0]);
    let facing = Some(DVec3::new(0.0, 0.6, 0.8));
    let lights = [
        Beam { power: [3.0, 2.0, 1.0], ..sun(DVec3::new(0.3, -0.5, -0.8), 1.0) },
        point(DVec3::new(6.1, 5.3, 4.7), 2.0),
        Beam { facing, ..point(DVec3::new(2.1, 3.0, 3.3), 5.0) },
    ];
    let beams = Beams::new(&scene.lattice(), lights.to_vec());
    let surfaces = Surfaces::new(gpu, &scene.lattice(), &[&mesh]).unwrap();
    let points = super::points::sample(&surfaces.corners, [12, 11, 10], 400, 3);
    let value = Value::new(PortType::Beams, 0, beams.clone());
    let surface = Value::new(PortType::Surface, 0, mesh);
    let inputs = [("medium", &medium), ("beams", &value), ("surfaces", &surface)];
    let found = with_run(gpu, "bounce_lights", json!({}), &inputs, |run| {
        irradiances(run, medium.get::<Medium>(), &beams, &surfaces, &points).unwrap()
    });
    let seen: Vec<[DVec3; 3]> =
        surfaces.corners.iter().map(|corners| corners.map(|p| p.as_dvec3())).collect();
    let (mut n_lit, mut n_dark, mut n_off) = (0, 0, 0);
    for (idx, found) in found.iter().enumerate() {
        let Point { position, normal, .. } = points[idx / 2];
        let normal = if idx % 2 == 0 { normal } else { -normal };
        for (c, found) in found[..3].iter().enumerate() {
            let expected =
                oracle::irradiance(&scene.oracle(c), &seen, &lights, c, position.as_dvec3(), normal);
            n_lit += usize::from(expected > 0.0);
            n_dark += usize::from(expected == 0.0);
            // The shader walks between the centers of outermost cells, the oracle from the point on: midpoint sums
            // differ by up to 0.3 of a cell's depth of 0.5.
            n_off += usize::from((f64::from(*found) - expected).abs() > 0.2 * expected + 1e-6);
        }
    }
    // Rays that pass an edge within rounding, at places where the shadow's edge is.
    assert!(n_lit > 300 && n_dark > 300 && n_off < 12, "{n_lit} lit, {n_dark} dark, {n_off} off");
}

#[test]
fn a_plates_lights_are_a_plate() {
    // In a void the virtual lights of a lit plate light a point as the plate does: E of a uniform radiance,
    // summed over the plate.
    let scene = Scene::new([12; 3], Filling::Homogeneous, 0.0);
    let Some(lights) = sent(&scene, &[sun(DVec3::NEG_Z, 2.0)], json!({ "count": 256, "seed": 4 })) else {
        return;
    };
    let p = scene.lattice().world_from_index.transform_point3(DVec3::new(7.0, 5.0, 8.0));
    let fluence: f64 = lights
        .iter()
        .map(|(position, normal, power)| {
            let line = p - *position;
            power[0] / PI * normal.dot(line.normalize()).max(0.0) / line.length_squared()
        })
        .sum();
    // Radiance 0.5 * 2 / pi from all of the plate, 7 cells below, 8 x 8 cells.
    let n = 200;
    let expected: f64 = (0..n * n)
        .map(|idx| {
            let [x, y] = [idx % n, idx / n].map(|i| 2.0 + 8.0 * (i as f64 + 0.5) / n as f64);
            let line = DVec3::new(7.0 - x, 5.0 - y, 7.0);
            1.0 / PI * (7.0 / line.length()) / line.length_squared() * (8.0 / n as f64).powi(2)
        })
        .sum();
    // 256 lights, one in each of as many parts of the plate: half a percent.
    assert!((fluence / expected - 1.0).abs() < 0.02, "{fluence} {expected}");
}

#[test]
fn the_same_seed_gives_the_same_lights() {
    let scene = Scene::new([12; 3], Filling::Random, 1.0);
    let lights = |seed: u32| sent(&scene, &[sun(DVec3::NEG_Z, 2.0)], json!({ "seed": seed }));
    assert_eq!(lights(1), lights(1));
    assert!(gpu().is_none() || lights(1) != lights(2));
}

#[test]
fn without_light_there_are_none() {
    let scene = Scene::new([12; 3], Filling::Random, 1.0);
    let Some(lights) = sent(&scene, &[sun(DVec3::NEG_Z, 0.0)], json!({})) else { return };
    assert!(lights.is_empty());
    // Light that misses the plate.
    let aside = point(DVec3::new(6.0, 6.0, 1.0), 1.0);
    let missed = sent(&scene, &[aside], json!({})).unwrap();
    assert!(missed.iter().all(|(_, _, power)| power.iter().all(|watts| watts.is_finite())));
}

#[test]
fn what_is_foretold_is_as_many_lights() {
    let Some(gpu) = gpu() else { return };
    let scene = Scene::new([12; 3], Filling::Random, 1.0);
    let medium = scene.medium(gpu);
    let beams = scene.propagate(gpu, &medium, &[sun(DVec3::NEG_Z, 2.0)], [0.0; 3]);
    let plate = scene.plate([2.0, 2.0], [10.0, 10.0], 1.0);
    let inputs = [("medium", &medium), ("beams", &beams), ("surfaces", &plate)];
    let crate::nodes::Rules::Foretold(foretell) = kind("bounce_lights").unwrap().rules else { panic!() };
    let (foretold, told) = with_run(gpu, "bounce_lights", json!({}), &inputs, |run| {
        let values = foretell(run).unwrap();
        (lights_of(&values[0]).len(), run.report.borrow().clone())
    });
    let (done, said) = with_run(gpu, "bounce_lights", json!({}), &inputs, |run| {
        let values = (kind("bounce_lights").unwrap().run)(run).unwrap();
        (lights_of(&values[0]).len(), run.report.borrow().clone())
    });
    assert_eq!((foretold, told), (done, said));
    assert_eq!(done, 64);
}

#[test]
fn light_is_not_sent_back_twice() {
    let Some(gpu) = gpu() else { return };
    let scene = Scene::new([12; 3], Filling::Random, 1.0);
    let medium = scene.medium(gpu);
    let beams = scene.propagate(gpu, &medium, &[sun(DVec3::NEG_Z, 2.0)], [0.0; 3]);
    let plate = scene.plate([2.0, 2.0], [10.0, 10.0], 1.0);
    let inputs = [("medium", &medium), ("beams", &beams), ("surfaces", &plate)];
    let lights = output(gpu, "bounce_lights", json!({ "count": 8 }), &inputs);
    let inputs = [("medium", &medium), ("lights", &lights), ("surfaces", &plate)];
    let sent_back = full_output(gpu, "spherical_propagation", json!({}), &inputs);
    let Place::Point(_) = sent_back.get::<Beams>().beams[0].place else { panic!() };
    let inputs = [("medium", &medium), ("beams", &beams), ("beams", &sent_back), ("surfaces", &plate)];
    let error = run(gpu, "isotropic_residual", json!({}), &inputs).err().unwrap().to_string();
    assert!(error.contains("bounce_lights"), "{error}");
    assert!(run(gpu, "isotropic_residual", json!({}), &inputs[..3]).is_ok());
}

#[test]
fn layouts_are_those_of_the_shader() {
    const CHOICES: [(&str, &str); 1] = [("pack", "1")];
    assert_layout::<ArrivalParams>("bounce_lights.wgsl", "ArrivalParams", &CHOICES);
    assert_layout::<SurfacePoint>("bounce_lights.wgsl", "SurfacePoint", &CHOICES);
}
