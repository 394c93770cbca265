//! The literal scheme on the GPU against its oracle.

use glam::{DVec3, DVec4};
use serde_json::json;

use super::oracle::Literal;
use super::{AddParams, HopParams, LEAST_ANISOTROPY};
use crate::gpu::Gpu;
use crate::graph::{PortType, Value};
use crate::light::{Ordinate, Ordinates};
use crate::nodes::principal_propagation::aligned::{Aligned, AlignedTexel};
use crate::nodes::testing::{
    Filling, Scene, assert_close, assert_layout, filtered, flat, gpu, largest, layers, output,
};
use crate::volume::field::Field;
use crate::wire::Beams;

/// An ordinate along a direction of the scene's index space.
fn ordinate(scene: &Scene, direction: DVec3, irradiance: [f64; 3], a0: f64) -> Ordinate {
    let direction = scene.lattice().world_from_index.transform_vector3(direction).normalize();
    Ordinate { direction, irradiance, a0, region: None, window: None }
}

/// (phi, F) of each channel after so many iterations.
fn propagate(gpu: &Gpu, scene: &Scene, ordinates: &[Ordinate], iterations: usize) -> Vec<Vec<f64>> {
    let ordinates = Ordinates { ordinates: ordinates.to_vec(), ..Ordinates::default() };
    let ordinates = Value::new(PortType::Ordinates, 0, ordinates);
    let medium = scene.medium(gpu);
    let inputs = [("medium", &medium), ("ordinates", &ordinates)];
    let params = json!({ "scheme": "literal", "iterations": iterations });
    let beams = output(gpu, "principal_propagation", params, &inputs);
    let beams: &Beams = beams.get();
    assert!(beams.beams.is_empty());
    let field = &beams.fields[0];
    layers(gpu, &field.moments, field.channels.count).iter().map(flat).collect()
}

/// The oracle's (phi, F) for 1 W/m².
fn expected(scene: &Scene, direction: DVec3, albedo: f64, a0: f64, iterations: usize) -> Vec<f64> {
    // As the node does: through the world and back.
    let lattice = scene.lattice();
    let world = lattice.world_from_index.transform_vector3(direction).normalize();
    let direction = lattice.direction_in_index(world);
    let grid = Aligned::new(&lattice, direction);
    let point = |[x, y, z]: [usize; 3]| DVec3::new(x as f64, y as f64, z as f64);
    let sigma_t = Field::from_fn(grid.dims, |cell| {
        scene.sigma_t.trilinear_zero(grid.origin + grid.index_from_aligned * point(cell))
    });
    let literal = Literal { h: scene.cell_m, albedo, g: scene.g, a0, is_slab: false };
    let n_hops = if iterations == 0 { grid.dims.into_iter().max().unwrap() } else { iterations };
    let settled = literal.propagate(&sigma_t, n_hops);
    let gathered = Field::from_fn(lattice.dims, |cell| {
        let p = grid.index_from_aligned.transpose() * (point(cell) - grid.origin);
        let flux = settled.flux.trilinear_clamp(p) * direction;
        DVec4::new(settled.phi.trilinear_clamp(p), flux.x, flux.y, flux.z)
    });
    flat(&gathered)
}

/// Hops of a dozen roundings each; positions of cells are off by 1e-6, extinctions by that of their
/// differences, and a few hops multiply it.
const TOLERANCE: f64 = 2e-5;

#[test]
fn agrees_with_the_oracle() {
    let Some(gpu) = gpu() else { return };
    for (dims, filling, g, albedo, a0) in [
        ([8, 8, 8], Filling::Random, 0.8, 0.95, 1.0),
        ([12, 7, 9], Filling::Random, -0.6, 0.5, 0.9),
        ([4, 16, 8], Filling::Binary, 0.99, 1.0, 1.0),
        ([8, 8, 8], Filling::Homogeneous, 0.0, 1.0, 0.05),
    ] {
        let scene = Scene { g, albedo: [albedo; 3], ..Scene::new(dims, filling, 6.0) };
        for direction in [DVec3::Z, DVec3::NEG_X, DVec3::new(0.3, -0.8, 0.5), DVec3::new(-0.6, 0.6, 0.6)] {
            for iterations in [0, 1, 20] {
                let direction = direction.normalize();
                let found = propagate(gpu, &scene, &[ordinate(&scene, direction, [1.0; 3], a0)], iterations);
                let expected = expected(&scene, direction, albedo, a0, iterations);
                let what = format!("{dims:?} along {direction}, {iterations} iterations");
                assert_eq!(found.len(), 1);
                let tolerance = filtered(gpu, TOLERANCE);
                assert_close(&what, &found[0], &expected, 0.0, tolerance * largest(&expected));
            }
        }
    }
}

#[test]
fn channels_and_ordinates_are_added() {
    let Some(gpu) = gpu() else { return };
    let mut scene = Scene { g: 0.6, ..Scene::new([8, 8, 8], Filling::Random, 4.0) };
    scene.albedo = [1.0, 0.7, 0.2];
    let lights = [
        (DVec3::new(0.2, 0.1, 0.9).normalize(), [2.0, 1.0, 0.5], 1.0),
        (DVec3::new(-0.7, 0.6, 0.1).normalize(), [0.1, 3.0, 1.0], 0.8),
    ];
    let ordinates = lights.map(|(direction, irradiance, a0)| ordinate(&scene, direction, irradiance, a0));
    let found = propagate(gpu, &scene, &ordinates, 0);
    assert_eq!(found.len(), 3);
    for c in 0..3 {
        let mut sum = vec![0.0; found[c].len()];
        for (direction, irradiance, a0) in lights {
            let one = expected(&scene, direction, scene.albedo[c], a0, 0);
            sum.iter_mut().zip(one).for_each(|(sum, one)| *sum += irradiance[c] * one);
        }
        let tolerance = filtered(gpu, TOLERANCE) * largest(&sum);
        assert_close(&format!("channel {c}"), &found[c], &sum, 0.0, tolerance);
    }
}

#[test]
fn extremes_stay_finite_and_realizable() {
    let Some(gpu) = gpu() else { return };
    for g in [-0.99, 0.0, 0.999] {
        for albedo in [0.0, 1.0] {
            for (filling, sigma_t) in
                [(Filling::Binary, 4e4), (Filling::Random, 1e-6), (Filling::Binary, 1e30)]
            {
                let scene = Scene { g, albedo: [albedo; 3], ..Scene::new([5, 8, 3], filling, sigma_t) };
                let light = ordinate(&scene, DVec3::new(0.1, 0.9, 0.3), [1e5; 3], 1.0);
                let found = propagate(gpu, &scene, &[light], 30);
                for state in found[0].chunks_exact(4) {
                    let flux = DVec3::new(state[1], state[2], state[3]).length();
                    assert!(state[0] >= 0.0 && flux <= state[0] * 1.000_01, "g {g} {albedo}: {state:?}");
                    assert!(state[0].is_finite());
                }
            }
        }
    }
}

#[test]
fn without_light_it_is_dark() {
    let Some(gpu) = gpu() else { return };
    let scene = Scene::new([4, 4, 4], Filling::Random, 1.0);
    assert!(propagate(gpu, &scene, &[], 0)[0].iter().all(|value| *value == 0.0));
}

#[test]
fn layouts_are_the_shaders() {
    let least = format!("{LEAST_ANISOTROPY:?}");
    let choices = [("least_anisotropy", least.as_str())];
    assert_layout::<AlignedTexel>("principal_propagation/literal_hop.wgsl", "Aligned", &choices);
    assert_layout::<HopParams>("principal_propagation/literal_hop.wgsl", "HopParams", &choices);
    assert_layout::<AddParams>("principal_propagation/literal_add.wgsl", "AddParams", &[]);
}
