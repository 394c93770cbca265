use glam::{DMat4, DQuat, DVec3};
use serde_json::{Value as Json, json};

use super::MediumParams;
use crate::graph::{PortType, Value};
use crate::nodes::testing::{Random, assert_close, assert_layout, gpu, output, run};
use crate::volume::field::Field;
use crate::volume::{Dense, Volume};
use crate::wire::Medium;

/// Voxels with a random value each, every third of them void.
fn dense(dims: [usize; 3], world_from_index: DMat4) -> Dense {
    let mut random = Random(11);
    let values = Field::from_fn(dims, |[x, y, z]| {
        let value = random.unit() as f32;
        if (x + 2 * y + z) % 3 == 0 { 0.0 } else { value }
    });
    Dense { dims, values: values.data, world_from_index }
}

fn volume(dense: &Dense) -> Value {
    Value::new(PortType::Volume, 0, Volume::from_shape(dense.clone(), None, DMat4::IDENTITY))
}

/// Compares the node's cells with the mean of the trilinear voxels over `n_sub`³ points, and says how
/// long a cell is.
fn assert_resampled(what: &str, dense: &Dense, scale: f64, params: Json, n_sub: usize) -> f64 {
    let gpu = gpu().expect("asked before");
    let mut params = params;
    params["density_scale"] = json!(scale);
    let medium = output(gpu, "medium", params, &[("volume", &volume(dense))]);
    let medium: &Medium = medium.get();
    let found: Vec<f32> = gpu.read_texture(&medium.sigma_t).unwrap();
    let found: Vec<f64> = found.into_iter().map(f64::from).collect();
    let voxels = Field { dims: dense.dims, data: dense.values.iter().map(|v| f64::from(*v)).collect() };
    let voxel_from_cell = dense.world_from_index.inverse() * medium.lattice.world_from_index;
    let expected = Field::from_fn(medium.lattice.dims, |cell| {
        let points = Field::from_fn([n_sub; 3], |sub| {
            let at = |axis: usize| cell[axis] as f64 + (sub[axis] as f64 + 0.5) / n_sub as f64 - 0.5;
            voxels.trilinear_zero(voxel_from_cell.transform_point3(DVec3::new(at(0), at(1), at(2))))
        });
        scale * points.data.iter().sum::<f64>() / points.data.len() as f64
    });
    // Positions of f32 in grids of some 40 voxels are 4e-6 off, voxels differ by up to 1.
    assert_close(what, &found, &expected.data, 1e-5, 1e-5 * scale);
    assert!(expected.data.iter().any(|sigma| *sigma > 0.1 * scale), "{what}: void");
    // Nothing of the grid is cut off: the border is void, as samplers that clamp need it.
    let dims = medium.lattice.dims;
    for (idx, sigma) in found.iter().enumerate() {
        let cell = expected.index_of(idx);
        let is_border = (0..3).any(|axis| cell[axis] == 0 || cell[axis] + 1 == dims[axis]);
        assert!(!is_border || *sigma == 0.0, "{what}: {cell:?} of {dims:?} holds {sigma}");
    }
    assert_eq!(medium.sigma_t_max, scale * f64::from(dense.values.iter().copied().fold(0.0, f32::max)));
    medium.lattice.cell_m
}

#[test]
fn resampled_as_the_trilinear_grid() {
    if gpu().is_none() {
        return;
    }
    let dims = [12, 7, 9];
    let scaled = DMat4::from_translation(DVec3::new(3.0, -2.0, 1.0)) * DMat4::from_scale(DVec3::splat(0.5));
    let plain = dense(dims, scaled);
    assert_eq!(assert_resampled("identity", &plain, 1.0, json!({}), 1), 0.5);
    // 0.5 m of 3/m: 1.5 optical depths, in three for 0.7.
    let cell_m = assert_resampled("subdivided", &plain, 3.0, json!({}), 1);
    assert!((cell_m - 0.5 / 3.0).abs() < 1e-12, "{cell_m}");
    // So thin that cells of 1.2 m are not split again.
    let coarse = json!({ "max_resolution": 5 });
    let cell_m = assert_resampled("coarsened", &plain, 0.5, coarse, 3);
    assert!((cell_m - 0.5 * 12.0 / 5.0).abs() < 1e-12, "{cell_m}");
    let turned = scaled * DMat4::from_quat(DQuat::from_axis_angle(DVec3::new(0.6, 0.0, 0.8), 0.7));
    assert_resampled("rotated", &dense(dims, turned), 1.0, json!({}), 1);
    // Voxels of 0.5 x 1 x 0.5 m on cells of 0.5 m, along the world's axes.
    let uneven = scaled * DMat4::from_scale(DVec3::new(1.0, 2.0, 1.0));
    assert_eq!(assert_resampled("uneven", &dense(dims, uneven), 1.0, json!({}), 1), 0.5);
    assert_resampled(
        "one voxel",
        &Dense { values: vec![0.5], ..dense([1, 1, 1], scaled) },
        1.0,
        json!({}),
        1,
    );
}

#[test]
fn an_empty_grid_is_void() {
    let Some(gpu) = gpu() else { return };
    let empty = Dense { values: vec![0.0; 27], ..dense([3, 3, 3], DMat4::IDENTITY) };
    let medium = output(gpu, "medium", json!({}), &[("volume", &volume(&empty))]);
    let medium: &Medium = medium.get();
    let found: Vec<f32> = gpu.read_texture(&medium.sigma_t).unwrap();
    assert_eq!(found.len(), medium.lattice.dims.iter().product::<usize>());
    assert!(found.iter().all(|sigma| *sigma == 0.0));
    assert_eq!(medium.sigma_t_max, 0.0);
}

#[test]
fn extinctions_that_are_not_finite_are_refused() {
    let Some(gpu) = gpu() else { return };
    let grid = Dense { values: vec![10.0], ..dense([1, 1, 1], DMat4::IDENTITY) };
    let error = run(gpu, "medium", json!({ "density_scale": 1e308 }), &[("volume", &volume(&grid))]);
    assert_eq!(
        error.unwrap_err().to_string(),
        "density_scale 1e308 times the largest density 10.0 is no finite extinction: lower density_scale"
    );
}

#[test]
fn cells_of_too_many_voxels_are_refused() {
    let Some(gpu) = gpu() else { return };
    let row = volume(&Dense { values: vec![1.0; 200], ..dense([200, 1, 1], DMat4::IDENTITY) });
    let cells_of = |n: usize| run(gpu, "medium", json!({ "max_resolution": n }), &[("volume", &row)]);
    assert_eq!(
        cells_of(2).unwrap_err().to_string(),
        "a cell is 100.0 voxels long, at most 64 are sampled: raise max_resolution from 2 to 4 or more"
    );
    // What the message says is enough.
    assert!(cells_of(4).is_ok() && cells_of(3).is_err());
    // Voxels of which two edges nearly fall together.
    let mut sheared = DMat4::IDENTITY;
    sheared.y_axis = DVec3::new(1.0, 1e-3, 0.0).extend(0.0);
    let sheared = volume(&dense([2, 2, 2], sheared));
    let error = run(gpu, "medium", json!({}), &[("volume", &sheared)]).unwrap_err().to_string();
    assert!(error.ends_with("give the volume a map that shears its voxels less"), "{error}");
}

#[test]
fn layouts_are_those_of_the_shader() {
    assert_layout::<MediumParams>("medium.wgsl", "MediumParams", &[]);
}
