//! Extremes of maps, media, surfaces and cameras through all that a picture under an environment takes:
//! importance, split, prefilter, beams, residual, march.

use std::sync::Arc;

use glam::DVec3;
use serde_json::{Value as Json, json};

use super::{Rendered, assert_healthy};
use crate::camera::Camera;
use crate::geometry::Mesh;
use crate::gpu::Gpu;
use crate::graph::{PortType, Value};
use crate::image::{ALPHA, Image};
use crate::light::environment::{Environment, Map, Stack};
use crate::nodes::testing::{Filling, Random, Scene, gpu, largest, mesh, output, run, sun};

const SUN: f32 = 1e5;

fn map(width: usize, height: usize, texel: impl Fn(usize, usize) -> [f32; 3]) -> Value {
    let texels = (0..width * height).map(|n| texel(n % width, n / width)).collect();
    let map = Map { width, height, texels: Arc::new(texels), scale: 1.0, rotate_y: 0.3, stack: None };
    Value::new(PortType::Environment, 0, Environment::Map(map))
}

/// A sun in one texel of a sky, the darkest map, one bright pixel, the smallest map.
fn maps() -> Vec<(&'static str, Value)> {
    let mut random = Random(9);
    let small: Vec<[f32; 3]> = (0..8).map(|_| [0.0; 3].map(|_: f32| random.unit() as f32)).collect();
    let at = |x: usize, y: usize| (x, y) == (13, 5);
    vec![
        (
            "sun",
            map(32, 16, |x, y| if at(x, y) { [SUN; 3] } else { [0.3 + 0.01 * (x % 5) as f32, 0.3, 0.4] }),
        ),
        ("black", map(32, 16, |_, _| [0.0; 3])),
        ("pixel", map(32, 16, |x, y| if at(x, y) { [0.0, SUN, 0.0] } else { [0.0; 3] })),
        ("4x2", map(4, 2, |x, y| small[4 * y + x])),
    ]
}

/// Looks at the middle of the medium from a place of index space.
fn camera(scene: &Scene, eye: DVec3) -> Value {
    let world_from_index = scene.lattice().world_from_index;
    let center = DVec3::from_array(scene.sigma_t.dims.map(|n| (n - 1) as f64 / 2.0));
    let camera = Camera {
        position: world_from_index.transform_point3(eye),
        look_at: world_from_index.transform_point3(center + DVec3::new(0.1, 0.2, 0.3)),
        up: DVec3::Y,
        fov_y_deg: 60.0,
        width: 8,
        height: 8,
    };
    Value::new(PortType::Camera, 0, camera)
}

/// How a picture is made.
#[derive(Debug, Clone)]
struct Chain {
    /// Of the camera, in index space.
    eye: DVec3,
    beams: Json,
    residual: Json,
}

impl Chain {
    fn render(&self, gpu: &Gpu, scene: &Scene, map: &Value, surfaces: &[&Value]) -> Rendered {
        let medium = scene.medium(gpu);
        let camera = camera(scene, self.eye);
        let importance =
            output(gpu, "importance_propagation", json!({}), &[("medium", &medium), ("camera", &camera)]);
        let inputs = [("environment", map), ("importance", &importance)];
        let split = output(gpu, "light_decomposition", json!({ "count": 5 }), &inputs);
        let inputs = [("environment", map), ("ordinates", &split), ("medium", &medium)];
        let ready = run(gpu, "prefilter", json!({}), &inputs).unwrap();
        let lit_by_surfaces: Vec<_> = surfaces.iter().map(|surface| ("surfaces", *surface)).collect();
        let with_surfaces = |inputs: &[(&'static str, &Value)]| {
            let all = inputs.iter().map(|(port, value)| (*port, *value));
            all.chain(lit_by_surfaces.iter().copied())
                .map(|(port, value)| (port, value.clone()))
                .collect::<Vec<_>>()
        };
        let output = |id: &str, params: &Json, inputs: &[(&'static str, &Value)]| {
            let inputs = with_surfaces(inputs);
            let inputs: Vec<_> = inputs.iter().map(|(port, value)| (*port, value)).collect();
            output(gpu, id, params.clone(), &inputs)
        };
        let beams =
            output("principal_propagation", &self.beams, &[("medium", &medium), ("ordinates", &ready[0])]);
        let residual =
            output("isotropic_residual", &self.residual, &[("medium", &medium), ("beams", &beams)]);
        let inputs = [
            ("medium", &medium),
            ("beams", &beams),
            ("residual", &residual),
            ("camera", &camera),
            ("environment", &ready[1]),
        ];
        let image = output("raymarch", &json!({}), &inputs).get::<Image>().clone();
        Rendered { residual, image }
    }
}

const OUTSIDE: DVec3 = DVec3::new(12.0, -5.0, 13.5);
/// In the middle of the medium, where a plate lies.
const INSIDE: DVec3 = DVec3::new(3.0, 2.0, 2.5);

#[test]
fn every_map_in_every_medium() {
    let Some(gpu) = gpu() else { return };
    let fillings = [Filling::Homogeneous, Filling::Random, Filling::Binary];
    let beams = [
        json!({}),
        json!({ "peak": "widening" }),
        json!({ "scheme": "scan" }),
        json!({ "scheme": "literal" }),
    ];
    let residuals =
        [json!({ "quality": "draft" }), json!({ "quality": "thick" }), json!({ "directions": 26 })];
    let mut n_cases = 0;
    for (name, map) in maps() {
        for (n, g) in [-0.99, 0.0, 0.3, 0.95, 0.999].into_iter().enumerate() {
            let tau_per_cell = [1e-6, 0.7, 1e4][(n + n_cases / 5) % 3];
            let mut scene = Scene::new([7, 5, 6], fillings[n_cases % 3], tau_per_cell / 0.25);
            (scene.g, scene.albedo) = (g, [[1.0, 0.999, 0.5, 0.0][n_cases % 4]; 3]);
            let chain = Chain {
                eye: if n_cases % 5 == 0 { INSIDE } else { OUTSIDE },
                beams: beams[n_cases % 4].clone(),
                residual: residuals[n_cases % 3].clone(),
            };
            let what = format!("{name}, g {g}, albedo {}, tau {tau_per_cell}, {chain:?}", scene.albedo[0]);
            let rendered = chain.render(gpu, &scene, &map, &[]);
            assert_healthy(gpu, &what, &rendered);
            let beauty = rendered.image.beauty();
            assert!(name != "black" || beauty.iter().all(|value| *value == 0.0), "{what}: {beauty:?}");
            n_cases += 1;
        }
    }
    assert_eq!(n_cases, 20);
}

#[test]
fn what_the_stack_takes_back_is_taken_from_single_scattering() {
    let Some(gpu) = gpu() else { return };
    let scene = Scene { g: 0.6, albedo: [0.9; 3], ..Scene::new([7, 5, 6], Filling::Homogeneous, 0.4) };
    let medium = scene.medium(gpu);
    let beams = scene.propagate(gpu, &medium, &[sun(DVec3::new(0.4, -0.3, 0.8), 3.0)], [0.0; 3]);
    let seen = |taken: Option<f32>| {
        let texels = vec![[-taken.unwrap_or(0.0); 3]; 16 * 4 * 2];
        let stack =
            taken.map(|_| Arc::new(Stack { width: 4, height: 2, texels, turns: [[0.2, 0.5, 1.0]; 16] }));
        let texels = Arc::new(vec![[0.0; 3]; 8]);
        let map = Map { width: 4, height: 2, texels, scale: 1.0, rotate_y: 0.0, stack };
        let sky = Value::new(PortType::Environment, 0, Environment::Map(map));
        let camera = camera(&scene, OUTSIDE);
        let inputs = [("medium", &medium), ("beams", &beams), ("camera", &camera), ("environment", &sky)];
        output(gpu, "raymarch", json!({}), &inputs).get::<Image>().clone()
    };
    let (plain, less, none) = (seen(None), seen(Some(1e-3)), seen(Some(1e3)));
    let [beauty, less_beauty] = [&plain, &less].map(|image| image.beauty().iter().map(|v| f64::from(*v)));
    let coverage = plain.layers[ALPHA].data.iter().flat_map(|alpha| [f64::from(*alpha); 3]);
    let mut n_seen = 0;
    for ((beauty, less), coverage) in beauty.zip(less_beauty).zip(coverage) {
        let tau = -(-coverage).ln_1p();
        // e^{x − tau} of the stack, x = albedo g² tau.
        let taken = 1e-3 * (-(1.0 - 0.9 * 0.36) * tau).exp();
        // Where no matter is there is nothing to give.
        let expected = (beauty - taken).max(0.0);
        assert!((less - expected).abs() < 1e-5 * beauty + 1e-9, "{less} of {beauty}, less {taken}");
        n_seen += usize::from(beauty > 2.0 * taken);
    }
    assert!(n_seen > 15, "{n_seen}");
    assert!(less.layers.values().all(|layer| layer.data.iter().all(|value| *value >= 0.0)));
    assert!(none.beauty().iter().all(|value| *value == 0.0));
}

/// Triangles of index space as a surface of this reflectance.
fn surface(scene: &Scene, triangles: &[[DVec3; 3]], reflectance: f64) -> Value {
    Value::new::<Mesh>(PortType::Surface, 0, mesh(&scene.lattice(), triangles, [reflectance; 3]))
}

/// Two triangles across z.
fn plate(low: f64, high: f64, z: f64) -> Vec<[DVec3; 3]> {
    let [a, b, c, d] = [(low, low), (high, low), (high, high), (low, high)].map(|(x, y)| DVec3::new(x, y, z));
    vec![[a, b, c], [a, c, d]]
}

#[test]
fn surfaces_in_every_place() {
    let Some(gpu) = gpu() else { return };
    let sliver = [DVec3::new(1.0, 1.0, 2.2), DVec3::new(4.0, 1.0, 2.2), DVec3::new(2.0, 1.0 + 1e-12, 2.2)];
    let dust = [DVec3::splat(2.0), DVec3::splat(2.0) + 1e-9 * DVec3::X, DVec3::splat(2.0) + 1e-9 * DVec3::Y];
    let shapes = [
        ("a plate inside", plate(-3.0, 12.0, 2.5)),
        ("a plate through corners of cells", plate(0.5, 3.5, 3.5)),
        ("a plate on the boundary", plate(-9.0, 15.0, -0.5)),
        ("a plane to the horizon", plate(-1e6, 1e6, -2.0)),
        ("a sliver and dust", vec![sliver, dust]),
    ];
    let eyes = [INSIDE, OUTSIDE, DVec3::new(2.0, 2.0, -0.5), DVec3::new(40.0, 3.0, -2.0)];
    let mut n_cases = 0;
    for (name, triangles) in &shapes {
        for (n, (map_name, map)) in maps().into_iter().enumerate() {
            let tau_per_cell = [1e-6, 1.0, 1e4][(n + n_cases / 4) % 3];
            let mut scene = Scene::new([7, 5, 6], Filling::Random, tau_per_cell / 0.25);
            (scene.g, scene.albedo) = ([0.0, 0.9, -0.5][n_cases % 3], [[1.0, 0.5][n_cases % 2]; 3]);
            let surface = surface(&scene, triangles, [1.0, 0.5, 0.0][n_cases / 2 % 3]);
            let chain = Chain {
                eye: eyes[(n + n_cases / 4) % 4],
                beams: if n_cases % 3 == 1 { json!({ "peak": "widening" }) } else { json!({}) },
                residual: json!({ "quality": "draft" }),
            };
            let what = format!("{name}, {map_name}, tau {tau_per_cell}, {chain:?}");
            let rendered = chain.render(gpu, &scene, &map, &[&surface]);
            let values = rendered.values();
            assert!(values.iter().all(|value| value.is_finite() && *value >= 0.0), "{what}: {values:?}");
            let state = rendered.state(gpu);
            assert!(state.iter().all(|value| value.is_finite()), "{what}");
            // What surfaces hide of ambient light is taken off what is already there.
            let least = state.iter().step_by(4).copied().fold(0.0, f64::min);
            assert!(least >= -1e-6 * largest(&state), "{what}: {least} of {}", largest(&state));
            n_cases += 1;
        }
    }
    assert_eq!(n_cases, 20);
}
