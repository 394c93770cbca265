//! Fields of the literal scheme through the residual.

use glam::DVec3;
use serde_json::json;

use super::FieldParams;
use crate::gpu::Gpu;
use crate::graph::{PortType, Value};
use crate::light::{Ordinate, Ordinates};
use crate::nodes::testing::{
    Filling, Scene, assert_close, assert_layout, flat, gpu, largest, layers, output, run, states, sun,
};
use crate::wire::{Beams, Medium};

fn scene() -> Scene {
    Scene { g: 0.7, ..Scene::new([8, 8, 8], Filling::Random, 3.0) }
}

/// Light of this irradiance by the literal scheme.
fn literal(gpu: &Gpu, medium: &Value, irradiance: [f64; 3], ambient: [f64; 3]) -> Value {
    let direction = DVec3::new(0.3, -0.2, 0.9).normalize();
    let ordinate = Ordinate { direction, irradiance, a0: 1.0, region: None, window: None };
    let ordinates = Ordinates { ordinates: vec![ordinate], ambient, ..Ordinates::default() };
    let ordinates = Value::new(PortType::Ordinates, 0, ordinates);
    let inputs = [("medium", medium), ("ordinates", &ordinates)];
    output(gpu, "principal_propagation", json!({ "scheme": "literal" }), &inputs)
}

/// phi and F of every channel of the residual.
fn residual(gpu: &Gpu, medium: &Value, beams: &[&Value]) -> Vec<Vec<f64>> {
    let mut inputs = vec![("medium", medium)];
    inputs.extend(beams.iter().map(|beams| ("beams", *beams)));
    let residual = output(gpu, "isotropic_residual", json!({ "quality": "fast" }), &inputs);
    states(gpu, &residual).iter().map(flat).collect()
}

/// phi and F of every channel of a field.
fn of_field(gpu: &Gpu, beams: &Value) -> Vec<Vec<f64>> {
    let field = &beams.get::<Beams>().fields[0];
    layers(gpu, &field.moments, field.channels.count).iter().map(flat).collect()
}

#[test]
fn a_field_comes_out_as_it_went_in() {
    let Some(gpu) = gpu() else { return };
    for (albedo, irradiance) in
        [([0.9; 3], [3.0; 3]), ([0.9; 3], [3.0, 1.5, 0.0]), ([0.9, 0.8, 0.3], [3.0; 3])]
    {
        let medium = Scene { albedo, ..scene() }.medium(gpu);
        let beams = literal(gpu, &medium, irradiance, [0.0; 3]);
        let expected = of_field(gpu, &beams);
        let found = residual(gpu, &medium, &[&beams]);
        assert_eq!(found.len(), if albedo == [0.9; 3] { 1 } else { 3 });
        for (found, expected) in found.iter().zip(&expected) {
            assert!(largest(expected) > 0.1);
            // What is not realizable in f32 is off by a few roundings.
            assert_close("field", found, expected, 1e-6, 1e-6 * largest(expected));
        }
    }
}

#[test]
fn other_light_is_added() {
    let Some(gpu) = gpu() else { return };
    // In red from the literal scheme, green from beams and blue from everywhere, all three channels are apart.
    let scene = scene();
    let medium = scene.medium(gpu);
    let red = literal(gpu, &medium, [2.0, 0.0, 0.0], [0.0, 0.0, 1.0]);
    let mut green = sun(DVec3::new(0.2, 0.3, -0.9), 1.0);
    green.power = [0.0, 1.0, 0.0];
    let green = scene.propagate(gpu, &medium, &[green], [0.0; 3]);
    let found = residual(gpu, &medium, &[&red, &green]);
    let expected_red = of_field(gpu, &red);
    assert_close("red", &found[0], &expected_red[0], 1e-6, 1e-6 * largest(&expected_red[0]));
    let expected_green = residual(gpu, &medium, &[&green]);
    // Two solutions of the same f32 equations, one of them as one channel.
    assert_close("green", &found[1], &expected_green[0], 1e-5, 1e-6 * largest(&expected_green[0]));
    // A constant environment is exact only at albedo 1, but it is there.
    let blue: Vec<f64> = found[2].iter().copied().step_by(4).collect();
    assert!(blue.iter().all(|phi| (4.0..4.0 * std::f64::consts::PI * 1.001).contains(phi)), "{blue:?}");
}

#[test]
fn two_fields_are_a_sum() {
    let Some(gpu) = gpu() else { return };
    let medium = scene().medium(gpu);
    let beams = literal(gpu, &medium, [1.0; 3], [0.0; 3]);
    let field = of_field(gpu, &beams);
    let twice: Vec<f64> = field[0].iter().map(|value| 2.0 * value).collect();
    let found = residual(gpu, &medium, &[&beams, &beams]);
    assert_close("twice", &found[0], &twice, 1e-6, 1e-6 * largest(&twice));
}

#[test]
fn surfaces_are_refused() {
    let Some(gpu) = gpu() else { return };
    let scene = scene();
    let medium = scene.medium(gpu);
    let plate = scene.plate([0.0, 0.0], [5.0, 5.0], 9.0);
    let beams = literal(gpu, &medium, [1.0; 3], [0.0; 3]);
    let inputs = [("medium", &medium), ("beams", &beams), ("surfaces", &plate)];
    let error = run(gpu, "isotropic_residual", json!({}), &inputs).err().unwrap().to_string();
    assert!(error.contains("scheme literal has none"), "{error}");
    let ordinates = Value::new(PortType::Ordinates, 0, Ordinates::default());
    let inputs = [("medium", &medium), ("ordinates", &ordinates), ("surfaces", &plate)];
    let error = run(gpu, "principal_propagation", json!({ "scheme": "literal" }), &inputs);
    let error = error.err().unwrap().to_string();
    assert!(error.contains("scheme literal knows no surfaces"), "{error}");
    assert_eq!(medium.get::<Medium>().lattice, beams.get::<Beams>().lattice);
}

#[test]
fn layout_is_the_shaders() {
    assert_layout::<FieldParams>("isotropic_residual/add_field.wgsl", "FieldParams", &[]);
}
