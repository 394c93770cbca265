//! What must hold for every medium and light (DESIGN 8), through the nodes as a graph would run them.

use glam::DVec3;
use serde_json::json;

use super::testing::{
    Filling, Scene, assert_close, filtered, flat, gpu, largest, output, point, states, sun,
};
use crate::camera::Camera;
use crate::gpu::Gpu;
use crate::graph::{PortType, Value};
use crate::image::Image;
use crate::light::environment::Environment;
use crate::nodes::oracle_scene::constant_light;
use crate::volume::field::Field;
use crate::wire::{Beam, Place, Residual};

mod chain;

/// A scene's residual and picture.
struct Rendered {
    residual: Value,
    image: Image,
}

impl Rendered {
    /// The state of the first channel, phi and F in turns.
    fn state(&self, gpu: &Gpu) -> Vec<f64> {
        flat(&states(gpu, &self.residual)[0])
    }

    fn values(&self) -> Vec<f64> {
        self.image.layers.values().flat_map(|layer| &layer.data).map(|value| f64::from(*value)).collect()
    }
}

fn render(gpu: &Gpu, scene: &Scene, lights: &[Beam], ambient: f64, quality: &str) -> Rendered {
    let medium = scene.medium(gpu);
    let beams = scene.propagate(gpu, &medium, lights, [ambient; 3]);
    let inputs = [("medium", &medium), ("beams", &beams)];
    let residual = output(gpu, "isotropic_residual", json!({ "quality": quality }), &inputs);
    let lattice = scene.lattice();
    let center = DVec3::from_array(scene.sigma_t.dims.map(|n| (n - 1) as f64 / 2.0));
    let camera = Camera {
        position: lattice.world_from_index.transform_point3(center + DVec3::new(9.0, -7.0, 11.0)),
        look_at: lattice.world_from_index.transform_point3(center),
        up: DVec3::Y,
        fov_y_deg: 30.0,
        width: 8,
        height: 8,
    };
    let camera = Value::new(PortType::Camera, 0, camera);
    let sky = Value::new(PortType::Environment, 0, Environment::Constant([ambient; 3]));
    let inputs = [
        ("medium", &medium),
        ("beams", &beams),
        ("residual", &residual),
        ("camera", &camera),
        ("environment", &sky),
    ];
    let image = output(gpu, "raymarch", json!({}), &inputs).get::<Image>().clone();
    Rendered { residual, image }
}

fn assert_healthy(gpu: &Gpu, what: &str, rendered: &Rendered) {
    for state in &states(gpu, &rendered.residual) {
        for (idx, light) in state.data.iter().enumerate() {
            let cell = state.index_of(idx);
            assert!(light.is_finite(), "{what}: {light} in {cell:?}");
            let flux = DVec3::new(light.y, light.z, light.w).length();
            // Below the smallest normal number f32 has no digits to keep the relation with.
            let most = light.x * (1.0 + 1e-6) + f64::from(f32::MIN_POSITIVE);
            assert!(light.x >= 0.0 && flux <= most, "{what}: {light} in {cell:?}");
        }
    }
    let balance = rendered.residual.get::<Residual>().balance;
    assert!(balance.iter().all(|factor| factor.is_finite() && *factor > 0.0), "{what}: {balance:?}");
    let values = rendered.values();
    assert!(values.iter().all(|value| value.is_finite() && *value >= 0.0), "{what}: {values:?}");
    assert!(largest(&values) > 0.0, "{what}: nothing is there");
}

#[test]
fn every_field_is_finite_and_realizable() {
    let Some(gpu) = gpu() else { return };
    let lights = [sun(DVec3::new(0.4, -0.3, 0.8), 3.0), sun(DVec3::NEG_Y, 1.0)];
    let fillings = [Filling::Homogeneous, Filling::Random, Filling::Binary];
    let mut n_cases = 0;
    for g in [-0.99, -0.4, 0.0, 0.6, 0.95, 0.999] {
        for albedo in [0.0, 0.5, 0.999, 1.0] {
            for tau_per_cell in [1e-6, 1e-2, 1.0, 100.0, 1e4] {
                let filling = fillings[n_cases % 3];
                n_cases += 1;
                let mut scene = Scene::new([7, 5, 6], filling, tau_per_cell / 0.25);
                (scene.g, scene.albedo) = (g, [albedo; 3]);
                let what = format!("g {g} albedo {albedo} tau {tau_per_cell} {filling:?}");
                let ambient = if n_cases % 2 == 0 { 0.0 } else { 0.3 };
                assert_healthy(gpu, &what, &render(gpu, &scene, &lights, ambient, "draft"));
            }
        }
    }
    assert_eq!(n_cases, 120);
}

#[test]
fn point_lights_inside_are_finite_and_realizable() {
    let Some(gpu) = gpu() else { return };
    for place in [DVec3::new(3.0, 2.0, 2.0), DVec3::new(2.5, 2.5, 2.5), DVec3::new(-0.5, 2.0, 3.0)] {
        for tau_per_cell in [1e-6, 1.0, 1e4] {
            let scene = Scene::new([7, 5, 6], Filling::Binary, tau_per_cell / 0.25);
            let what = format!("light at {place}, tau {tau_per_cell}");
            assert_healthy(gpu, &what, &render(gpu, &scene, &[point(place, 5.0)], 0.0, "fast"));
        }
    }
}

fn scene() -> Scene {
    Scene { g: 0.7, ..Scene::new([12, 8, 10], Filling::Random, 4.0) }
}

#[test]
fn twice_the_light_is_twice_as_bright() {
    let Some(gpu) = gpu() else { return };
    let lights = |scale: f64| [sun(DVec3::new(0.4, -0.3, 0.8), 3.0 * scale), sun(DVec3::NEG_Y, scale)];
    let one = render(gpu, &scene(), &lights(1.0), 0.2, "default");
    // A power of two would only move exponents.
    for scale in [2.7, 1e5, 1e-5, 3e27, 1e-25] {
        let other = render(gpu, &scene(), &lights(scale), 0.2 * scale, "default");
        let compare = |what: &str, found: Vec<f64>, expected: Vec<f64>| {
            let found: Vec<f64> = found.iter().map(|value| value / scale).collect();
            assert_close(&format!("{what} x {scale}"), &found, &expected, 1e-5, 1e-5 * largest(&expected));
        };
        compare("state", other.state(gpu), one.state(gpu));
        let beauty = |rendered: &Rendered| rendered.image.beauty().iter().map(|v| f64::from(*v)).collect();
        compare("picture", beauty(&other), beauty(&one));
    }
}

/// A quarter turn about z of a vector.
fn turned(v: DVec3) -> DVec3 {
    DVec3::new(-v.y, v.x, v.z)
}

#[test]
fn a_quarter_turn_turns_the_light() {
    let Some(gpu) = gpu() else { return };
    let straight = scene();
    let [nx, ny, nz] = straight.sigma_t.dims;
    // Cell (x, y) comes to (ny - 1 - y, x).
    let back = |[x, y, z]: [usize; 3]| [y, ny - 1 - x, z];
    let sigma_t = Field::from_fn([ny, nx, nz], |cell| straight.sigma_t.at(back(cell)));
    let crooked = Scene { sigma_t, ..straight.clone() };
    let directions = [DVec3::new(0.4, -0.3, 0.8), DVec3::new(-0.6, -0.5, 0.1)];
    let medium = straight.medium(gpu);
    let turned_medium = crooked.medium(gpu);
    let solve = |scene: &Scene, medium: &Value, lights: &[Beam]| {
        let beams = scene.propagate(gpu, medium, lights, [0.1; 3]);
        let residual = output(gpu, "isotropic_residual", json!({}), &[("medium", medium), ("beams", &beams)]);
        states(gpu, &residual).remove(0)
    };
    let expected = solve(&straight, &medium, &directions.map(|d| sun(d, 1.0)));
    let found = solve(&crooked, &turned_medium, &directions.map(|d| sun(turned(d), 1.0)));
    let expected = Field::from_fn(found.dims, |cell| {
        let light = expected.at(back(cell));
        let flux = turned(DVec3::new(light.y, light.z, light.w));
        glam::DVec4::from((light.x, flux))
    });
    let expected = flat(&expected);
    // Optical depths are cut to half floats the same way where they are equal to rounding, but for a few
    // that lie on the edge of two: 1e-3 of tau there, e^-tau of it in phi. On devices that weigh with
    // 8 bits the samples of a walk differ too.
    let top = largest(&expected);
    assert_close("turned", &flat(&found), &expected, 1e-5, filtered(gpu, 1e-5) * top);
}

#[test]
fn two_lights_are_nearly_the_sum_of_each() {
    // Lobes are not linear: measured 1.1 % over many scenes, 3 % is promised.
    let Some(gpu) = gpu() else { return };
    let lights = [sun(DVec3::new(0.4, -0.3, 0.8), 3.0), sun(DVec3::new(-0.7, 0.6, 0.2), 2.0)];
    let both = render(gpu, &scene(), &lights, 0.0, "default");
    let each = lights.map(|light| render(gpu, &scene(), &[light], 0.0, "default"));
    let phi = |rendered: &Rendered| rendered.state(gpu).into_iter().step_by(4).collect::<Vec<_>>();
    let (both, [one, other]) = (phi(&both), each.each_ref().map(phi));
    let apart: f64 = both.iter().zip(one.iter().zip(&other)).map(|(both, (a, b))| (both - a - b).abs()).sum();
    let share = apart / both.iter().sum::<f64>();
    assert!(share < 0.03, "{share}");
    // It does see the difference of the lights.
    assert!(one.iter().zip(&other).map(|(a, b)| (a - b).abs()).sum::<f64>() > 0.1 * both.iter().sum::<f64>());
}

#[test]
fn a_constant_sky_fills_a_white_medium() {
    let Some(gpu) = gpu() else { return };
    for g in [-0.5, 0.0, 0.85] {
        let scene = Scene { g, albedo: [1.0; 3], ..Scene::new([16, 16, 16], Filling::Random, 2.0) };
        let rendered = render(gpu, &scene, &[], 0.25, "default");
        let expected = flat(&constant_light([16, 16, 16], 0.25));
        let found = rendered.state(gpu);
        let apart: f64 = found.iter().zip(&expected).map(|(a, b)| (a - b).abs()).sum();
        // The cascade starts from darkness: the oracle's own error is 0.13 % of phi at g -0.5.
        assert!(apart < 4e-3 * expected.iter().sum::<f64>(), "g {g}: {apart}");
        let beauty: Vec<f64> = rendered.image.beauty().iter().map(|value| f64::from(*value)).collect();
        assert_close(&format!("g {g}"), &beauty, &vec![0.25; beauty.len()], 4e-3, 0.0);
    }
}

#[test]
fn a_second_run_gives_the_same_bytes() {
    let Some(gpu) = gpu() else { return };
    let mut lights = vec![sun(DVec3::new(0.4, -0.3, 0.8), 3.0); 5];
    lights[3] = Beam {
        power: [1.0, 0.5, 0.2],
        place: Place::Parallel(DVec3::NEG_Y),
        a0: 0.8,
        window: None,
        facing: None,
    };
    let run = || {
        let rendered = render(gpu, &scene(), &lights, 0.2, "default");
        let states: Vec<Vec<f64>> = states(gpu, &rendered.residual).iter().map(flat).collect();
        let bits: Vec<u64> = states.concat().iter().map(|value| value.to_bits()).collect();
        let picture: Vec<u64> = rendered.values().iter().map(|value| value.to_bits()).collect();
        (bits, picture)
    };
    assert!(run() == run(), "two runs differ");
}
