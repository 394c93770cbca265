use std::f64::consts::PI;

use glam::DVec3;
use serde_json::json;

use super::{BounceParams, ROW, coarser};
use crate::geometry::Mesh;
use crate::gpu::{Gpu, Shader, wgsl_constant};
use crate::graph::{PortType, Value};
use crate::nodes::testing::{
    Filling, Scene, assert_close, assert_layout, ball, gpu, mesh, output, point, states, sun,
};
use crate::volume::field::Field;
use crate::wire::{Beam, Place, Residual};

/// phi and F, a field a channel, of this light with these surfaces.
fn solved(gpu: &Gpu, scene: &Scene, lights: &[Beam], surfaces: &[&Value]) -> Vec<Field<glam::DVec4>> {
    let medium = scene.medium(gpu);
    let beams = scene.propagate_behind(gpu, &medium, lights, [0.0; 3], surfaces);
    let mut inputs = vec![("medium", &medium), ("beams", &beams)];
    inputs.extend(surfaces.iter().map(|surface| ("surfaces", *surface)));
    let residual = output(gpu, "isotropic_residual", json!({ "quality": "reference" }), &inputs);
    assert_eq!(residual.get::<Residual>().lattice, scene.lattice());
    states(gpu, &residual)
}

#[test]
fn a_sunlit_floor_shines_upwards() {
    // Radiance L from all directions below: phi = 2 pi L, F = pi L upwards. The sum over 32 directions is
    // exact for both. What the medium itself scatters is 1e-4 of it.
    let Some(gpu) = gpu() else { return };
    let scene = Scene { albedo: [1.0; 3], g: 0.0, ..Scene::new([6, 5, 4], Filling::Homogeneous, 1e-4) };
    let (low, high) = ([-400.0, -400.0], [400.0, 400.0]);
    let corner = |x: f64, y: f64| DVec3::new(x, y, -2.3);
    let [a, b, c, d] =
        [corner(low[0], low[1]), corner(high[0], low[1]), corner(high[0], high[1]), corner(low[0], high[1])];
    let floor = mesh(&scene.lattice(), &[[a, b, c], [a, c, d]], [0.5, 0.25, 0.0]);
    let floor = Value::new::<Mesh>(PortType::Surface, 0, floor);
    let down = sun(DVec3::new(0.6, 0.0, -0.8), 3.0);
    let channels = solved(gpu, &scene, &[down], &[&floor]);
    assert_eq!(channels.len(), 3);
    for (state, reflectance) in channels.iter().zip([0.5, 0.25, 0.0]) {
        let radiance = reflectance * 3.0 * 0.8 / PI;
        for light in &state.data {
            let expected = [2.0 * PI * radiance, 0.0, 0.0, PI * radiance];
            // The half of 32 directions the golden angle apart leaves 5 % of the flux to the sides.
            assert_close("phi, F", &[light.x, light.w], &[expected[0], expected[3]], 1e-3, 2e-3);
            assert_close(
                "F to the sides",
                &[light.y, light.z],
                &expected[1..3],
                0.0,
                0.06 * expected[3] + 2e-3,
            );
        }
    }
}

/// A grey ball around the middle of a scene, and E of a lamp of 1 W/sr there on it.
fn ball_around(scene: &Scene, reflectance: f64) -> (Value, Beam, f64) {
    let center = DVec3::from_array(scene.sigma_t.dims.map(|n| (n - 1) as f64 / 2.0));
    let ball = mesh(&scene.lattice(), &ball(center, 3), [reflectance; 3]);
    let ball = Value::new::<Mesh>(PortType::Surface, 0, ball);
    (ball, point(center, 1.0), 1.0 / (10.0 * scene.cell_m).powi(2))
}

#[test]
fn a_ball_around_a_lamp_is_lit_by_itself() {
    // E = I / r^2 everywhere, radiance reflectance E / pi, and once more by what the first one sends:
    // L = reflectance (1 + reflectance) E / pi, phi = 4 pi L.
    let Some(gpu) = gpu() else { return };
    let scene = Scene { g: 0.0, ..Scene::new([6, 6, 6], Filling::Homogeneous, 1e-5) };
    let (ball, lamp, irradiance) = ball_around(&scene, 0.6);
    let found: Vec<f64> =
        solved(gpu, &scene, &[lamp], &[&ball])[0].data.iter().map(|light| light.x).collect();
    let expected = vec![4.0 * 0.6 * 1.6 * irradiance; found.len()];
    // Its 512 triangles are up to 1.2 % nearer to the lamp than its corners, and so 2.4 % brighter.
    assert_close("phi", &found, &expected, 0.025, 0.0);
}

#[test]
fn a_white_medium_loses_nothing_in_a_ball() {
    // What scatters without loss sends all power to the ball, whatever its depth, and a ball spreads what
    // it gets evenly over itself: its mean radiance is as without the medium. Radiance L from everywhere is L
    // everywhere inside, so that with the ball phi is 4 pi L more than without.
    let Some(gpu) = gpu() else { return };
    let scene = Scene { albedo: [1.0; 3], g: 0.0, ..Scene::new([8, 8, 8], Filling::Homogeneous, 1.0) };
    let (ball, mut lamp, irradiance) = ball_around(&scene, 0.6);
    // Beside the medium: in it, what a lamp gives to the cells around it is up to 6 % off.
    lamp.place = Place::Point(DVec3::new(3.5, 3.5, 10.5));
    let mean = |surfaces: &[&Value]| {
        let state = solved(gpu, &scene, &[lamp], surfaces).remove(0);
        state.data.iter().map(|light| light.x).sum::<f64>() / state.data.len() as f64
    };
    let more = mean(&[&ball]) - mean(&[]);
    let expected = 4.0 * 0.6 * 1.6 * irradiance;
    // The ball's flat triangles (2 %), and that the ball's near side is not as bright as its mean (1 %).
    assert!((more / expected - 1.0).abs() < 0.03, "{more} against {expected}");
}

#[test]
fn without_light_surfaces_are_black() {
    let Some(gpu) = gpu() else { return };
    let scene = Scene::new([5, 4, 4], Filling::Random, 1.0);
    let plate = scene.plate([-9.0, -9.0], [9.0, 9.0], -1.0);
    let states = solved(gpu, &scene, &[], &[&plate]);
    assert!(states[0].data.iter().all(|light| *light == glam::DVec4::ZERO));
}

#[test]
fn cells_that_look_for_patches_are_few_enough() {
    assert_eq!(coarser([64, 64, 64], 1 << 18), 1);
    assert_eq!(coarser([128, 96, 128], 1 << 18), 2);
    assert_eq!(coarser([128, 128, 128], 1 << 16), 4);
    assert_eq!(coarser([1024, 1024, 1024], 1 << 18), 16);
    // Odd grids cannot be halved.
    assert_eq!(coarser([1001, 64, 64], 1 << 16), 1);
}

#[test]
fn layouts_are_those_of_the_shaders() {
    assert_layout::<BounceParams>("isotropic_residual/bounce.wgsl", "BounceParams", &[]);
}

#[test]
fn rows_of_threads_are_as_long_in_the_shader() {
    let shader = Shader::expand("isotropic_residual/surface_point.wgsl", &[]).unwrap();
    assert_eq!(wgsl_constant(&shader, "ROW").unwrap(), [ROW as f64]);
}

mod seen;
