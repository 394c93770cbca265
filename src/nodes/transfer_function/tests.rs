use glam::{DMat4, DVec3};
use serde_json::{Value as Json, json};

use super::oracle::March;
use super::{Point, PointTexel, TransferParams};
use crate::camera::Camera;
use crate::graph::{PortType, Value};
use crate::image::{ALPHA, Image};
use crate::nodes::scalar::Scalar;
use crate::nodes::testing::{Random, assert_close, assert_layout, filtered, gpu, output};
use crate::volume::{Dense, Volume};

const CAMERA: Camera = Camera {
    position: DVec3::new(4.0, 3.0, 9.0),
    look_at: DVec3::new(1.0, -0.5, 0.3),
    up: DVec3::Y,
    fov_y_deg: 35.0,
    width: 17,
    height: 13,
};

/// Smooth values from 0 to 2 that lie crooked in the world, voxels of 0.2 x 0.3 x 0.25 m.
fn dense() -> Dense {
    let dims = [14, 11, 9];
    let mut random = Random(3);
    let waves: Vec<(DVec3, f64)> = (0..4).map(|_| (0.8 * random.direction(), 6.0 * random.unit())).collect();
    let values = (0..dims.iter().product::<usize>()).map(|idx| {
        let index = DVec3::new((idx % 14) as f64, (idx / 14 % 11) as f64, (idx / 154) as f64);
        (1.0 + waves.iter().map(|(k, phase)| 0.25 * (k.dot(index) + phase).sin()).sum::<f64>()) as f32
    });
    let values = values.collect();
    let world_from_index = DMat4::from_translation(DVec3::new(-0.2, -1.5, -0.8))
        * DMat4::from_rotation_y(0.4)
        * DMat4::from_scale(DVec3::new(0.2, 0.3, 0.25));
    Dense { dims, values, world_from_index }
}

fn volume() -> Volume {
    Volume::from_shape(dense(), None, DMat4::IDENTITY)
}

fn picture(params: Json) -> Option<Image> {
    let volume = Value::new(PortType::Volume, 0, volume());
    let camera = Value::new(PortType::Camera, 0, CAMERA);
    let value = output(gpu()?, "transfer_function", params, &[("volume", &volume), ("camera", &camera)]);
    Some(value.get::<Image>().clone())
}

/// What `ray` gives for each pixel: light and coverage.
fn rays(ray: impl Fn(DVec3) -> ([f64; 3], f64)) -> (Vec<f64>, Vec<f64>) {
    let [forward, right, up] = CAMERA.frame().unwrap();
    let (mut light, mut alpha) = (Vec::new(), Vec::new());
    for row in 0..CAMERA.height {
        for column in 0..CAMERA.width {
            let x = 2.0 * (column as f64 + 0.5) / CAMERA.width as f64 - 1.0;
            let y = 1.0 - 2.0 * (row as f64 + 0.5) / CAMERA.height as f64;
            let (color, coverage) = ray((forward + x * right + y * up).normalize());
            light.extend(color);
            alpha.push(coverage);
        }
    }
    (light, alpha)
}

fn wide(values: &[f32]) -> Vec<f64> {
    values.iter().map(|x| f64::from(*x)).collect()
}

/// The way through the box in meters, by clipping it plane by plane.
fn way(scalar: &Scalar, direction: DVec3) -> f64 {
    let inside = |t: f64| {
        let index = scalar.index_of(CAMERA.position + t * direction);
        (0..3).all(|axis| index[axis] > -1.0 && index[axis] < scalar.dense.dims[axis] as f64)
    };
    let crossings = (0..3).flat_map(|axis| {
        let (a, b) = (scalar.index_of(CAMERA.position), scalar.index_of(CAMERA.position + direction));
        [-1.0, scalar.dense.dims[axis] as f64].map(|plane| (plane - a[axis]) / (b[axis] - a[axis]))
    });
    let mut crossings: Vec<f64> = crossings.collect();
    crossings.sort_by(f64::total_cmp);
    let pairs = crossings.windows(2).filter(|pair| inside(0.5 * (pair[0] + pair[1])));
    pairs.map(|pair| pair[1] - pair[0]).sum()
}

#[test]
fn one_color_is_the_closed_form() {
    let scalar = Scalar::of_grid(&volume(), "density").unwrap();
    let (color, opacity, extinction) = ([0.9, 0.5, 0.1], 0.5, 1.5);
    let closed = rays(|direction| {
        let alpha = 1.0 - (-opacity * extinction * way(&scalar, direction)).exp();
        (color.map(|c| c * alpha), alpha)
    });
    assert!(closed.1.iter().any(|alpha| *alpha > 0.5) && closed.1.contains(&0.0));
    let points = [Point { value: 0.3, color, opacity }];
    let march = March { scalar: &scalar, points: &points, extinction, step: 0.5 };
    let (light, alpha) = rays(|direction| march.ray(CAMERA.position, direction));
    // Some 60 steps of a few roundings in f64.
    assert_close("oracle", &light, &closed.0, 1e-12, 1e-12);
    assert_close("oracle's coverage", &alpha, &closed.1, 1e-12, 1e-12);
    let params = json!({ "points": [[0.3, 0.9, 0.5, 0.1, 0.5]], "extinction": 1.5 });
    let Some(image) = picture(params.clone()) else { return };
    // Ends of the way: eight roundings of coordinates up to 60 voxels, 0.2 m each, 7e-6 m of optical depth 1; then 60
    // sums of f32.
    assert_close("light", &wide(image.beauty()), &closed.0, 2e-5, 2e-5);
    assert_close("coverage", &wide(&image.layers[ALPHA].data), &closed.1, 2e-5, 2e-5);
    // What stands behind shows through.
    let mut before_light = params;
    before_light["background"] = json!([2, 2, 2]);
    let image = picture(before_light).unwrap();
    let behind = closed.0.iter().enumerate().map(|(n, c)| c + 2.0 * (1.0 - closed.1[n / 3]));
    assert_close("before light", &wide(image.beauty()), &behind.collect::<Vec<_>>(), 2e-5, 2e-5);
}

#[test]
fn curves_are_those_of_the_oracle() {
    let Some(gpu) = gpu() else { return };
    let scalar = Scalar::of_grid(&volume(), "density").unwrap();
    let rows = json!([[0.4, 0, 0, 1, 0], [0.9, 0, 1, 0, 0.2], [1.1, 1, 0.5, 0, 1], [1.6, 1, 1, 1, 0.3]]);
    let points: Vec<Point> = rows
        .as_array()
        .unwrap()
        .iter()
        .map(|row| {
            let x = |n: usize| row[n].as_f64().unwrap();
            Point { value: x(0), color: [x(1), x(2), x(3)], opacity: x(4) }
        })
        .collect();
    for step in [0.5, 1.3] {
        let march = March { scalar: &scalar, points: &points, extinction: 3.0, step };
        let (light, alpha) = rays(|direction| march.ray(CAMERA.position, direction));
        let params = json!({ "points": rows, "extinction": 3, "step": step });
        let image = picture(params).unwrap();
        // Positions are good to 1e-5 voxels, values change by 0.5 a voxel, opacities by 4 a value: 2e-5 of each step's
        // share; filtering weighs with 8 bits on hardware.
        let tolerance = filtered(gpu, 1e-4);
        assert_close("light", &wide(image.beauty()), &light, tolerance, tolerance);
        assert_close("coverage", &wide(&image.layers[ALPHA].data), &alpha, tolerance, tolerance);
    }
}

#[test]
fn a_map_spans_the_data() {
    let Some(image) = picture(json!({ "colormap": "gray" })) else { return };
    let alpha = &image.layers[ALPHA].data;
    assert!(alpha.iter().all(|a| (0.0..=1.0).contains(a)) && alpha.iter().any(|a| *a > 0.5));
    // Grey, and never brighter than it covers.
    assert!(image.pixels().iter().zip(alpha).all(|(c, a)| c[0] == c[1] && c[1] == c[2] && c[0] <= *a));
    let opaque = picture(json!({ "colormap": "gray", "extinction": 1e6 })).unwrap();
    assert!(opaque.beauty().iter().all(|x| x.is_finite()));
    let clear = picture(json!({ "extinction": 0 })).unwrap();
    assert!(clear.beauty().iter().all(|x| *x == 0.0));
}

#[test]
fn a_point_has_the_color_of_its_value() {
    let scalar = Scalar::of_grid(&volume(), "density").unwrap();
    let points = [
        Point { value: 1.0, color: [0.0, 0.5, 1.0], opacity: 0.0 },
        Point { value: 3.0, color: [1.0, 0.5, 0.0], opacity: 1.0 },
    ];
    let march = March { scalar: &scalar, points: &points, extinction: 1.0, step: 1.0 };
    assert_eq!(march.look_up(-5.0), ([0.0, 0.5, 1.0], 0.0));
    assert_eq!(march.look_up(1.0), ([0.0, 0.5, 1.0], 0.0));
    assert_eq!(march.look_up(1.5), ([0.25, 0.5, 0.75], 0.25));
    assert_eq!(march.look_up(3.0), ([1.0, 0.5, 0.0], 1.0));
    assert_eq!(march.look_up(99.0), ([1.0, 0.5, 0.0], 1.0));
}

#[test]
fn layouts_are_those_of_the_shader() {
    assert_layout::<TransferParams>("transfer_function.wgsl", "TransferParams", &[]);
    assert_layout::<PointTexel>("transfer_function.wgsl", "Point", &[]);
}
