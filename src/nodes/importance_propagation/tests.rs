use glam::DVec3;
use serde_json::json;

use super::{N_RAYS, ViewParams, depths, oracle, ray_direction};
use crate::camera::Camera;
use crate::graph::{PortType, Value};
use crate::nodes::raymarch::oracle::Ray;
use crate::nodes::spherical_propagation::oracle::tau_corners_walk_point;
use crate::nodes::testing::{Filling, Scene, assert_close, assert_layout, filtered, gpu, output, with_run};
use crate::wire::{Importance, Medium, ShapeTexel};

fn camera(scene: &Scene) -> Camera {
    let world_from_index = scene.lattice().world_from_index;
    let center = DVec3::from_array(scene.sigma_t.dims.map(|n| (n - 1) as f64 / 2.0));
    Camera {
        position: world_from_index.transform_point3(center + DVec3::new(9.0, -17.0, 21.0)),
        look_at: world_from_index.transform_point3(center),
        up: DVec3::Y,
        fov_y_deg: 40.0,
        width: 30,
        height: 20,
    }
}

#[test]
fn rays_have_the_depths_of_the_oracle() {
    let Some(gpu) = gpu() else { return };
    for (dims, filling) in
        [([17, 9, 6], Filling::Random), ([8, 8, 8], Filling::Binary), ([3, 3, 3], Filling::Homogeneous)]
    {
        let scene = Scene::new(dims, filling, 2.0);
        let (medium, camera) = (scene.medium(gpu), camera(&scene));
        let frame = camera.frame().unwrap();
        let view = Value::new(PortType::Camera, 0, camera);
        let inputs = [("medium", &medium), ("camera", &view)];
        let found = with_run(gpu, "importance_propagation", json!({}), &inputs, |run| {
            depths(run, medium.get::<Medium>(), camera.position, frame).unwrap()
        });
        let found: Vec<f64> = found.into_iter().map(f64::from).collect();
        let index_from_world = scene.lattice().index_from_world();
        let origin = index_from_world.transform_point3(camera.position).as_vec3().as_dvec3();
        let expected: Vec<f64> = (0..N_RAYS * N_RAYS)
            .map(|idx| {
                let direction = index_from_world.transform_vector3(ray_direction(frame, idx)).normalize();
                let tau = |stretch| {
                    oracle::ray_tau(&scene.sigma_t, scene.cell_m, &Ray { origin, direction }, stretch)
                };
                // Positions of f32 some 30 cells away are 4e-6 off, of a span of at least one cell.
                let (less, more) = (tau(1.0 - 4e-6), tau(1.0 + 4e-6));
                if (less - found[idx]).abs() < (more - found[idx]).abs() { less } else { more }
            })
            .collect();
        assert!(expected.iter().any(|tau| *tau > 0.1) && expected.contains(&0.0));
        // Each of up to 20 samples is at a position that is 4e-6 cells off, and has eight roundings.
        let absolute = filtered(gpu, 6e-6) * 20.0 * 2.0 * scene.cell_m;
        assert_close(&format!("{dims:?} {filling:?}"), &found, &expected, 1e-6, absolute);
    }
}

#[test]
fn importance_and_its_field_leave_the_node() {
    let Some(gpu) = gpu() else { return };
    let scene = Scene { g: 0.8, ..Scene::new([16, 16, 16], Filling::Random, 1.0) };
    let (medium, camera) = (scene.medium(gpu), camera(&scene));
    let view = Value::new(PortType::Camera, 0, camera);
    let inputs = [("medium", &medium), ("camera", &view)];
    let value = output(gpu, "importance_propagation", json!({ "strength": 0.5 }), &inputs);
    let importance: &Importance = value.get();
    let [forward, ..] = camera.frame().unwrap();
    // A mean of 1: half of it even, half about the view.
    let (ahead, behind) = (importance.light.at(forward), importance.light.at(-forward));
    assert!(ahead > 3.0 && (0.5..0.6).contains(&behind), "{ahead} {behind}");
    let eye = scene.lattice().index_from_world().transform_point3(camera.position);
    let expected = tau_corners_walk_point(&scene.sigma_t, scene.cell_m, eye);
    let texels: Vec<f32> = gpu.read_texture(&importance.tau.texture).unwrap();
    let found: Vec<f64> = texels.into_iter().map(f64::from).collect();
    // As in the tests of the walk samples stand elsewhere than the oracle's: by up to 0.3 of a cell's largest depth,
    // of more corners a little more; a wrong place or scale errs by whole depths.
    assert_close("field", &found, &expected.data, 0.0, 0.4 * scene.cell_m);
}

#[test]
fn layouts_are_those_of_the_shader() {
    assert_layout::<ViewParams>("importance_propagation.wgsl", "ViewParams", &[]);
    assert_layout::<ShapeTexel>("importance_propagation.wgsl", "Shape", &[]);
}
