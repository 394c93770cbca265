use std::f64::consts::PI;
use std::sync::Arc;

use glam::DVec3;
use serde_json::json;

use crate::camera::Camera;
use crate::graph::{PortType, Value};
use crate::light::environment::{Environment, Map};
use crate::light::{Light, Ordinates};
use crate::nodes::testing::{Filling, Scene, gpu, output, run, with_shares};

fn sun(angular_diameter_deg: f64) -> Value {
    let direction = DVec3::new(0.6, 0.0, -0.8);
    let sun = Light::Sun { direction, irradiance: [3.0, 2.0, 1.0], angular_diameter_deg };
    Value::new(PortType::Light, 0, vec![sun])
}

#[test]
fn suns_pass_with_the_spread_of_their_disks() {
    let Some(gpu) = gpu() else { return };
    let suns = [sun(0.0), sun(60.0), sun(180.0)];
    let inputs: Vec<_> = suns.iter().map(|sun| ("lights", sun)).collect();
    let light = output(gpu, "light_decomposition", json!({}), &inputs);
    let light: &Ordinates = light.get();
    assert_eq!(light.ambient, [0.0; 3]);
    // The mean cosine of a cap of half angle t is (1 + cos t)/2; a hemisphere's is a half.
    let caps = [1.0, 0.5 * (1.0 + 0.75f64.sqrt()), 0.5];
    assert_eq!(light.ordinates.len(), 3);
    for (ordinate, a0) in light.ordinates.iter().zip(caps) {
        assert!((ordinate.a0 - a0).abs() < 1e-15, "{ordinate:?} {a0}");
        assert_eq!(ordinate.direction, DVec3::new(0.6, 0.0, -0.8));
        assert_eq!(ordinate.irradiance, [3.0, 2.0, 1.0]);
    }
}

#[test]
fn point_lights_are_sent_elsewhere() {
    let Some(gpu) = gpu() else { return };
    let light = Light::Point { position: DVec3::ZERO, intensity: [1.0; 3] };
    let light = Value::new(PortType::Light, 0, vec![light]);
    let error = run(gpu, "light_decomposition", json!({}), &[("lights", &light)]).unwrap_err();
    assert!(error.to_string().contains("wire it to spherical_propagation.lights"), "{error}");
}

#[test]
fn what_fades_keeps_light_without_a_direction() {
    let Some(gpu) = gpu() else { return };
    let medium = Scene::new([5, 5, 5], Filling::Homogeneous, 1.0).medium(gpu);
    let importance = |x: f64| {
        let position = DVec3::new(x, 0.0, 5.0);
        let view =
            Camera { position, look_at: DVec3::ZERO, up: DVec3::Y, fov_y_deg: 40.0, width: 8, height: 8 };
        let view = Value::new(PortType::Camera, 0, view);
        output(gpu, "importance_propagation", json!({}), &[("medium", &medium), ("camera", &view)])
    };
    // A belt about the equator, in one piece: its mean direction is none.
    let texels = (0..32 * 16).map(|idx| [f32::from(u8::from((4..12).contains(&(idx / 32)))); 3]).collect();
    let belt =
        Map { width: 32, height: 16, texels: Arc::new(texels), scale: 2.0, rotate_y: 0.0, stack: None };
    let fluence = (4..12).map(|row| 2.0 * 32.0 * belt.solid_angle(row)).sum::<f64>();
    let belt = Value::new(PortType::Environment, 0, Environment::Map(belt));
    let (one, other) = (importance(0.0), importance(3.0));
    let inputs = [("environment", &belt, 1.0), ("importance", &one, 0.25), ("importance", &other, 0.75)];
    let light = with_shares(gpu, "light_decomposition", json!({ "count": 1 }), &inputs, |run| {
        super::run(run).unwrap().remove(0)
    });
    let light: &Ordinates = light.get();
    assert!(light.ordinates.is_empty());
    // A sum of 256 texels.
    assert!((4.0 * PI * light.ambient[1] / fluence - 1.0).abs() < 1e-12, "{light:?}");
}

#[test]
fn constants_are_ambient_and_maps_keep_their_power() {
    let Some(gpu) = gpu() else { return };
    let constant = Value::new(PortType::Environment, 0, Environment::Constant([0.1, 0.2, 0.3]));
    let light = output(gpu, "light_decomposition", json!({}), &[("environment", &constant)]);
    assert_eq!(*light.get::<Ordinates>(), Ordinates { ambient: [0.1, 0.2, 0.3], ..Default::default() });
    // 2 everywhere and 3 more in one row: the row's solid angle in all ordinates together.
    let texels = (0..32 * 16).map(|idx| if idx / 32 == 4 { [5.0; 3] } else { [2.0; 3] }).collect();
    let map = Map { width: 32, height: 16, texels: Arc::new(texels), scale: 0.5, rotate_y: 0.3, stack: None };
    let expected = 0.5 * 3.0 * 32.0 * map.solid_angle(4);
    let map = Value::new(PortType::Environment, 0, Environment::Map(map));
    for method in ["median_cut", "uniform"] {
        let params = json!({ "count": 12, "method": method });
        let light = output(gpu, "light_decomposition", params, &[("environment", &map)]);
        let light: &Ordinates = light.get();
        assert_eq!(light.ambient, [1.0; 3]);
        assert!((2..=12).contains(&light.ordinates.len()));
        let power: f64 = light.ordinates.iter().map(|ordinate| ordinate.irradiance[1]).sum();
        // A sum of 32 texels.
        assert!((power / expected - 1.0).abs() < 1e-13, "{method}: {power} against {expected}");
    }
}

#[test]
fn a_sun_in_a_map_is_an_ordinate_of_its_own() {
    let Some(gpu) = gpu() else { return };
    let (width, height) = (64, 32);
    let lit = |sun: f32| {
        let mut texels: Vec<[f32; 3]> =
            (0..width * height).map(|idx| [0.2 + (idx % 7) as f32 * 0.1; 3]).collect();
        (0..2).for_each(|n| texels[9 * width + 20 + n] = [sun, 0.5 * sun, 0.25 * sun]);
        Map { width, height, texels: Arc::new(texels), scale: 2.0, rotate_y: 0.3, stack: None }
    };
    let map = lit(1e4);
    let towards = |column: f64| map.direction(column / width as f64, 9.5 / height as f64);
    let towards = (towards(20.5) + towards(21.5)).normalize();
    let irradiance = 2.0 * 2.0 * (1e4 - 0.2) * map.solid_angle(9);
    let sky = Value::new(PortType::Environment, 0, Environment::Map(map));
    for method in ["median_cut", "uniform"] {
        let params = json!({ "count": 8, "method": method });
        let light = output(gpu, "light_decomposition", params, &[("environment", &sky)]);
        let light: &Ordinates = light.get();
        assert!(light.ordinates.len() <= 8 && light.n_regions == 7);
        let suns: Vec<_> = light.ordinates.iter().filter(|ordinate| ordinate.region.is_none()).collect();
        assert_eq!(suns.len(), 1, "{method}");
        // Texels of f32, two of them.
        assert!((suns[0].irradiance[0] / irradiance - 1.0).abs() < 1e-6, "{suns:?} {irradiance}");
        assert!((suns[0].direction + towards).length() < 1e-12 && suns[0].a0 < 1.0 && suns[0].a0 > 0.99);
        // What is left is a sky: at most 1.6 from everywhere.
        let rest = light.ordinates.iter().filter(|ordinate| ordinate.region.is_some());
        assert!(rest.map(|ordinate| ordinate.irradiance[0]).sum::<f64>() < 1.6 * 4.0 * PI);
    }
    // A bright texel is none.
    let sky = Value::new(PortType::Environment, 0, Environment::Map(lit(40.0)));
    let light = output(gpu, "light_decomposition", json!({ "count": 8 }), &[("environment", &sky)]);
    let light: &Ordinates = light.get();
    assert!(light.n_regions == 8 && light.ordinates.iter().all(|ordinate| ordinate.region.is_some()));
}
