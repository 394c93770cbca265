use std::f64::consts::PI;

use glam::{DMat4, DVec3};
use serde_json::{Value as Json, json};

use super::EmissionParams;
use crate::camera::Camera;
use crate::gpu::Gpu;
use crate::graph::{PortType, Value};
use crate::image::{ALPHA, BEAUTY, Image};
use crate::nodes::testing::{
    assert_close, assert_layout, filtered, gpu, largest, output, run, states, volume,
};
use crate::optics::blackbody::blackbody_rgb;
use crate::volume::Dense;
use crate::wire::{Medium, Residual};

/// Voxels of one value.
fn voxels(dims: [usize; 3], value: f32, first: DVec3) -> Dense {
    let world_from_index = DMat4::from_scale(DVec3::splat(0.25)) * DMat4::from_translation(first);
    Dense { dims, values: vec![value; dims.iter().product()], world_from_index }
}

/// Parameters of a medium whose flame and smoke are one grid, of one temperature.
fn even(kelvin: f64, more: Json) -> Json {
    let mut params = json!({
        "emission": { "temperature": "density", "flame": "density" },
        "kelvin_per_unit": 0, "kelvin_offset": kelvin,
    });
    params.as_object_mut().unwrap().extend(more.as_object().unwrap().clone());
    params
}

/// Residual and picture of a medium by its own light.
fn seen(gpu: &Gpu, medium: &Value) -> (Value, Image) {
    let residual = output(gpu, "isotropic_residual", json!({}), &[("medium", medium)]);
    let camera = Camera {
        position: DVec3::new(7.0, 5.0, 9.0),
        look_at: DVec3::new(1.0, 1.0, 1.0),
        up: DVec3::Y,
        fov_y_deg: 20.0,
        width: 9,
        height: 9,
    };
    let camera = Value::new(PortType::Camera, 0, camera);
    let inputs = [("medium", medium), ("residual", &residual), ("camera", &camera)];
    let image = output(gpu, "raymarch", json!({}), &inputs).get::<Image>().clone();
    (residual, image)
}

fn layer(image: &Image, name: &str) -> Vec<f64> {
    image.layers[name].data.iter().map(|value| f64::from(*value)).collect()
}

#[test]
fn an_even_glow_is_a_black_body_as_far_as_it_is_opaque() {
    // eps = S sigma_t everywhere, so that L = S (1 - e^-tau) along any ray, where nothing scatters.
    let Some(gpu) = gpu() else { return };
    let smoke = volume(&[("density", &voxels([8; 3], 1.0, DVec3::ZERO), 0.0)]);
    for density_scale in [1e-3, 1.0, 2.8] {
        let params = json!({ "density_scale": density_scale, "albedo": 0, "emission_scale": 2.0 });
        let medium = output(gpu, "medium", even(1700.0, params), &[("volume", &smoke)]);
        let (_, image) = seen(gpu, &medium);
        let color = blackbody_rgb(1700.0, 2000.0).map(|value| value * 2.0 / density_scale);
        let alpha = layer(&image, ALPHA);
        assert!(alpha.contains(&0.0) && largest(&alpha) > 0.5 * density_scale.min(1.0));
        let expected: Vec<f64> = alpha.iter().flat_map(|a| color.map(|value| value * a)).collect();
        // The table is 2e-5 off; alpha of thin smoke is the difference of 1 and a number close to it.
        let tolerance = filtered(gpu, 1e-4);
        let absolute = 1e-6 * color[0];
        assert_close("emission", &layer(&image, "emission"), &expected, tolerance, absolute);
        assert_close("beauty", &layer(&image, BEAUTY), &expected, tolerance, absolute);
    }
}

#[test]
fn flame_without_smoke_is_as_bright_as_it_is_long() {
    let Some(gpu) = gpu() else { return };
    let flame = voxels([20, 4, 4], 0.5, DVec3::ZERO);
    let smoke = voxels([1; 3], 0.0, DVec3::ZERO);
    let volume = volume(&[("density", &smoke, 0.0), ("flame", &flame, 0.0), ("temperature", &flame, 0.5)]);
    let params = json!({ "emission": {}, "kelvin_per_unit": 4000 });
    let medium = output(gpu, "medium", params, &[("volume", &volume)]);
    // A view along the flame: 20 voxels of 0.25 m at 0.5.
    let camera = Camera {
        position: DVec3::new(-100.0, 0.375, 0.375),
        look_at: DVec3::new(0.0, 0.375, 0.375),
        up: DVec3::Y,
        fov_y_deg: 0.001,
        width: 1,
        height: 1,
    };
    let camera = Value::new(PortType::Camera, 0, camera);
    let image = output(gpu, "raymarch", json!({}), &[("medium", &medium), ("camera", &camera)]);
    let image: &Image = image.get();
    let expected = blackbody_rgb(2000.0, 2000.0).map(|value| value * 0.5 * 20.0 * 0.25);
    // Steps of the ray see the ramps at both ends as sums of their middles.
    assert_close("beauty", &layer(image, BEAUTY), &expected, 5e-3, 0.0);
    assert_eq!(layer(image, ALPHA), [0.0]);
}

#[test]
fn all_that_is_emitted_leaves_white_smoke() {
    let Some(gpu) = gpu() else { return };
    let smoke = volume(&[("density", &voxels([10, 8, 9], 1.0, DVec3::ZERO), 0.0)]);
    let medium = output(gpu, "medium", even(2000.0, json!({})), &[("volume", &smoke)]);
    let emission = medium.get::<Medium>().emission.as_ref().unwrap();
    let cells: Vec<[f32; 4]> = gpu.read_texture(&emission.cells).unwrap();
    let sum: f64 = cells.iter().map(|cell| f64::from(cell[1])).sum();
    // The points of a trilinear voxel add up to it.
    let expected = 720.0 * blackbody_rgb(2000.0, 2000.0)[1];
    assert_close("emitted", &[sum], &[expected], filtered(gpu, 1e-4), 0.0);
    let params = json!({ "quality": "reference" });
    let residual = output(gpu, "isotropic_residual", params, &[("medium", &medium)]);
    let balance = residual.get::<Residual>().balance;
    // What the last sweep lets out is what is emitted, once it has settled.
    assert!(balance.iter().all(|factor| (factor - 1.0).abs() < 1e-4), "{balance:?}");
    // With sigma_t 1 and 2.5 m across, light is scattered and the middle is brighter than void would be.
    let phi = largest(&states(gpu, &residual)[1].data.iter().map(|state| state.x).collect::<Vec<_>>());
    let color = blackbody_rgb(2000.0, 2000.0)[1];
    assert!(phi > 4.0 * PI * color * 1.1 && phi < 4.0 * PI * color * 3.0, "{phi} {color}");
}

#[test]
fn extremes_are_finite() {
    let Some(gpu) = gpu() else { return };
    let smoke = volume(&[("density", &voxels([8; 3], 1.0, DVec3::ZERO), 0.0)]);
    for kelvin in [-1e20, 0.0, 600.0, 1e6, 1e20] {
        for density_scale in [0.0, 1e-6, 1e4] {
            for albedo in [0.0, 1.0] {
                let what = format!("{kelvin} K, sigma_t {density_scale}, albedo {albedo}");
                let params = json!({ "density_scale": density_scale, "albedo": albedo, "g": 0.9, "max_resolution": 8 });
                let medium = output(gpu, "medium", even(kelvin, params), &[("volume", &smoke)]);
                let (residual, image) = seen(gpu, &medium);
                let values: Vec<f64> = image.layers.keys().flat_map(|name| layer(&image, name)).collect();
                assert!(values.iter().all(|value| value.is_finite() && *value >= 0.0), "{what}");
                for state in &states(gpu, &residual) {
                    assert!(state.data.iter().all(|light| light.is_finite() && light.x >= 0.0), "{what}");
                }
                assert_eq!(largest(&layer(&image, BEAUTY)) > 1e-30, kelvin > 599.0, "{what}");
            }
        }
    }
}

#[test]
fn what_cannot_be_computed_is_refused() {
    let Some(gpu) = gpu() else { return };
    let smoke = voxels([2; 3], 1.0, DVec3::ZERO);
    let below = voxels([2; 3], -1.0, DVec3::ZERO);
    let volume = volume(&[("density", &smoke, 0.0), ("cold", &below, 0.0), ("warm", &smoke, 0.5)]);
    let refused =
        |params: Json| run(gpu, "medium", params, &[("volume", &volume)]).err().unwrap().to_string();
    let found = refused(json!({ "emission": { "flame": "fire" } }));
    assert!(
        found.starts_with("emission.flame: ") && found.contains("`fire`; there are `density`"),
        "{found}"
    );
    let found = refused(json!({ "emission": { "flame": "density", "temperature": "t" } }));
    assert!(found.starts_with("emission.temperature: ") && found.contains("`cold`"), "{found}");
    let found = refused(json!({ "emission": { "flame": "cold", "temperature": "warm" } }));
    assert!(found.starts_with("emission.flame: grid 'cold' holds -1.0"), "{found}");
    let found = refused(json!({ "emission": { "flame": "warm", "temperature": "cold" } }));
    assert!(found.starts_with("emission.flame: grid 'warm' has the background 0.5"), "{found}");
}

#[test]
fn what_is_too_bright_is_refused() {
    let Some(gpu) = gpu() else { return };
    let smoke = volume(&[("density", &voxels([2; 3], 1.0, DVec3::ZERO), 0.0)]);
    let refused = |params: Json| run(gpu, "medium", params, &[("volume", &smoke)]).err().unwrap().to_string();
    let found = refused(even(3000.0, json!({ "emission_scale": 1e29 })));
    assert!(found.ends_with("lower emission_scale, or raise reference_kelvin"), "{found}");
    let found = refused(even(1e30, json!({ "kelvin_per_unit": 1e30 })));
    assert!(found.ends_with("at most 1e30 K are computed: lower kelvin_per_unit"), "{found}");
}

#[test]
fn nothing_glows_without_flame() {
    let Some(gpu) = gpu() else { return };
    let smoke = volume(&[("density", &voxels([2; 3], 1.0, DVec3::ZERO), 0.0)]);
    for params in [json!({}), even(2000.0, json!({ "emission_scale": 0 }))] {
        let medium = output(gpu, "medium", params, &[("volume", &smoke)]);
        assert!(medium.get::<Medium>().emission.is_none());
    }
}

#[test]
fn layouts_are_those_of_the_shader() {
    assert_layout::<EmissionParams>("emission.wgsl", "EmissionParams", &[]);
    assert_layout::<crate::wire::Heat>("lib/emission.wgsl", "Heat", &[]);
}
