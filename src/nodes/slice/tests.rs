use glam::{DMat4, DVec3};
use serde_json::{Value as Json, json};

use crate::graph::{PortType, Value};
use crate::image::{ALPHA, Colormap, Image, Table};
use crate::nodes::testing::{Filling, Scene, full_output, gpu, output, run, states, sun, taus};
use crate::optics::spectrum::luminance;
use crate::volume::{Dense, Volume};
use crate::wire::Residual;

/// Of the world's meters, at the voxels of a box 4 x 6 x 8 m whose corner is the origin.
fn field(p: DVec3) -> f64 {
    20.0 + 2.0 * p.x + 3.0 * p.y - p.z
}

fn volume() -> Value {
    let mut dense = Dense::centered([8, 12, 16], 0.5);
    dense.world_from_index =
        DMat4::from_translation(DVec3::splat(0.25)) * DMat4::from_scale(DVec3::splat(0.5));
    for (idx, value) in dense.values.iter_mut().enumerate() {
        let index = DVec3::new((idx % 8) as f64, (idx / 8 % 12) as f64, (idx / 96) as f64);
        *value = field(dense.world_from_index.transform_point3(index)) as f32;
    }
    Value::new(PortType::Volume, 0, Volume::from_shape(dense, None, DMat4::IDENTITY))
}

fn slice(params: Json) -> Option<Image> {
    let gpu = gpu()?;
    let value = output(gpu, "slice", params, &[("volume", &volume())]);
    Some(value.get::<Image>().clone())
}

/// What is wrong with the values, where a pixel's center is `position(column, row)`.
fn compare(image: &Image, position: impl Fn(f64, f64) -> DVec3) {
    let mut n_compared = 0;
    for (idx, value) in image.layers["value"].data.iter().enumerate() {
        let p = position((idx % image.width) as f64, (idx / image.width) as f64);
        // Half a voxel within the box the field is linear.
        let is_inner = [4.0, 6.0, 8.0].into_iter().zip(p.to_array()).all(|(n, x)| x >= 0.25 && x <= n - 0.25);
        if is_inner {
            n_compared += 1;
            // Values up to 46 as f32, read and written: two roundings.
            assert!((f64::from(*value) - field(p)).abs() < 46.0 * 2.0 * f64::from(f32::EPSILON), "{p}");
        }
    }
    assert!(n_compared > 100, "{n_compared}");
}

#[test]
fn axes_cut_a_linear_field() {
    let Some(image) = slice(json!({ "axis": "z", "position": 1.5, "resolution": 24 })) else { return };
    // 4 x 6 m: pixels of a quarter meter, x to the right, y up.
    assert_eq!((image.width, image.height), (16, 24));
    compare(&image, |x, y| DVec3::new(0.25 * (x + 0.5), 6.0 - 0.25 * (y + 0.5), 1.5));
    let image = slice(json!({ "axis": "x", "resolution": 32 })).unwrap();
    // Seen from +x: −z to the right, y up; in the middle.
    assert_eq!((image.width, image.height), (32, 24));
    compare(&image, |x, y| DVec3::new(2.0, 6.0 - 0.25 * (y + 0.5), 8.0 - 0.25 * (x + 0.5)));
    let image = slice(json!({ "axis": "y", "position": 2.0, "resolution": 32 })).unwrap();
    // From above: x to the right, −z up.
    assert_eq!((image.width, image.height), (16, 32));
    compare(&image, |x, y| DVec3::new(0.25 * (x + 0.5), 2.0, 0.25 * (y + 0.5)));
}

#[test]
fn a_free_plane_lies_crooked() {
    let params = json!({ "axis": "free", "normal": [1, 0, 1], "origin": [2, 3, 4], "resolution": 48 });
    let Some(image) = slice(params) else { return };
    // Along (1, 0, −1)/√2 the box is (4 + 8)/√2 m wide, centered on its middle.
    let width = 12.0 / 2f64.sqrt();
    let pixel = width / 48.0;
    assert_eq!((image.width, image.height), (48, (6.0 / pixel).ceil() as usize));
    let right = DVec3::new(1.0, 0.0, -1.0) / 2f64.sqrt();
    let height = image.height as f64;
    compare(&image, |x, y| {
        DVec3::new(2.0, 3.0, 4.0) + (x - 23.5) * pixel * right + DVec3::Y * (0.5 * height - 0.5 - y) * pixel
    });
}

#[test]
fn colors_are_those_of_the_map() {
    let params = json!({ "position": 1.5, "resolution": 24, "range": [20, 40], "colormap": "magma" });
    let Some(image) = slice(params) else { return };
    let map = Colormap::named("magma").unwrap();
    for ((value, color), alpha) in
        image.layers["value"].data.iter().zip(image.pixels()).zip(&image.layers[ALPHA].data)
    {
        assert_eq!(*alpha, 1.0);
        for (found, expected) in color.iter().zip(map.linear((f64::from(*value) - 20.0) / 20.0)) {
            // The value was f64 for the color: an ulp of it moves a color by less than 1e-5.
            assert!((found - expected).abs() < 1e-5);
        }
    }
    // Beside the box there is what stands outside, black and uncovered.
    let image = slice(json!({ "position": 100.0, "resolution": 4 })).unwrap();
    assert!(
        image.layers["value"]
            .data
            .iter()
            .chain(image.beauty())
            .chain(&image.layers[ALPHA].data)
            .all(|x| *x == 0.0)
    );
}

#[test]
fn a_medium_shows_its_extinction() {
    let Some(gpu) = gpu() else { return };
    let scene = Scene::new([16, 16, 16], Filling::Homogeneous, 3.0);
    let image = output(gpu, "slice", json!({ "resolution": 32 }), &[("medium", &scene.medium(gpu))]);
    let image: &Image = image.get();
    let value = &image.layers["value"].data;
    // The middle of a medium that is the same everywhere but on its border.
    assert_eq!(value[16 * image.width + 16], 3.0);
}

/// Three numbers of the table's row.
fn point(plane: &Table, name: &str) -> DVec3 {
    let column = |axis: &str| plane.column(&format!("{name}_{axis}_m")).unwrap()[0];
    DVec3::new(column("x"), column("y"), column("z"))
}

#[test]
fn the_table_says_where_the_plane_lies() {
    let Some(gpu) = gpu() else { return };
    let params = json!({ "axis": "x", "position": 1.5, "resolution": 32, "range": [20, 40] });
    let values = run(gpu, "slice", params, &[("volume", &volume())]).unwrap();
    let plane: &Table = values[1].get();
    // 8 m of z across, 6 m of y down, seen from +x: quarters of a meter are exact.
    assert_eq!(point(plane, "first"), DVec3::new(1.5, 5.875, 7.875));
    assert_eq!(point(plane, "right"), DVec3::new(0.0, 0.0, -0.25));
    assert_eq!(point(plane, "down"), DVec3::new(0.0, -0.25, 0.0));
    let column = |name: &str| plane.column(name).unwrap()[0];
    assert_eq!(
        [column("low"), column("high"), column("position_m"), column("from_m"), column("to_m")],
        [20.0, 40.0, 1.5, 0.0, 4.0]
    );
}

/// What is wrong with a slice of a field of the solver; `expected` is of index coordinates of the scene's lattice.
fn compare_in_index(scene: &Scene, values: &[Value], expected: impl Fn(DVec3) -> f64) {
    let (image, plane): (&Image, &Table) = (values[0].get(), values[1].get());
    let (first, right, down) = (point(plane, "first"), point(plane, "right"), point(plane, "down"));
    let index_from_world = scene.lattice().index_from_world();
    let mut n_compared = 0;
    for (idx, value) in image.layers["value"].data.iter().enumerate() {
        let p = first + (idx % image.width) as f64 * right + (idx / image.width) as f64 * down;
        let index = index_from_world.transform_point3(p);
        if image.layers[ALPHA].data[idx] == 1.0 {
            n_compared += 1;
            let expected = expected(index);
            // Trilinear between f32 numbers of a few units: the value's own rounding, and that of the index
            // (1e-15) times a slope of at most all of it a cell.
            let tolerance = 2.0 * f64::from(f32::EPSILON) * expected.abs() + 1e-7;
            assert!((f64::from(*value) - expected).abs() <= tolerance, "{index}: {value} {expected}");
        }
    }
    assert!(n_compared > 100, "{n_compared}");
}

#[test]
fn a_beam_shows_its_depth_and_a_residual_its_fluence() {
    let Some(gpu) = gpu() else { return };
    let scene = Scene { albedo: [0.9, 0.5, 0.99], ..Scene::new([9, 6, 5], Filling::Random, 3.0) };
    let medium = scene.medium(gpu);
    let mut suns = vec![sun(DVec3::new(0.3, -0.2, 0.9), 3.0)];
    for n_suns in [1, 5] {
        while suns.len() < n_suns {
            suns.push(sun(DVec3::new(0.2 * suns.len() as f64, 1.0, -0.3), 1.0));
        }
        let beams = scene.propagate(gpu, &medium, &suns, [0.0; 3]);
        let tau = taus(gpu, beams.get());
        // The last is in a pack of its own, where there is more than one.
        let beam = n_suns - 1;
        let params = json!({ "axis": "free", "normal": [1, 2, 0.5], "resolution": 40, "beam": beam });
        let values = run(gpu, "slice", params, &[("beams", &beams)]).unwrap();
        compare_in_index(&scene, &values, |index| tau[beam].trilinear_zero(index + 0.5));
        let refused = run(gpu, "slice", json!({ "beam": n_suns }), &[("beams", &beams)]).unwrap_err();
        let last = n_suns - 1;
        assert_eq!(
            refused.to_string(),
            format!("beam is {n_suns}; there are 0..={last} with depths on the medium's grid")
        );
        let inputs = [("medium", &medium), ("beams", &beams)];
        let residual = full_output(gpu, "isotropic_residual", json!({ "quality": "draft" }), &inputs);
        let phi = states(gpu, &residual);
        let color = residual.get::<Residual>().channels.color;
        let params = json!({ "axis": "y", "resolution": 40 });
        let values = run(gpu, "slice", params, &[("residual", &residual)]).unwrap();
        compare_in_index(&scene, &values, |index| {
            let of = |c: usize| color[c] * phi[c % phi.len()].trilinear_zero(index).x;
            luminance([of(0), of(1), of(2)])
        });
    }
}

#[test]
fn what_cannot_be_cut_is_refused() {
    let Some(gpu) = gpu() else { return };
    let volume = volume();
    let refused =
        |params: Json, inputs: &[(&str, &Value)]| run(gpu, "slice", params, inputs).unwrap_err().to_string();
    assert_eq!(refused(json!({}), &[]), "nothing is wired: wire a volume, medium, beams or residual");
    let medium = Scene::new([4, 4, 4], Filling::Homogeneous, 1.0).medium(gpu);
    let error = refused(json!({}), &[("volume", &volume), ("medium", &medium)]);
    assert_eq!(error, "volume and medium are all wired: keep one of them");
    let error = refused(json!({ "range": [2, 1] }), &[("volume", &volume)]);
    assert_eq!(error, "range is [2.0, 1.0]; write the smaller number first");
    let error = refused(json!({ "grid": "flame" }), &[("volume", &volume)]);
    assert_eq!(error, "no grid 'flame': a shape has one grid, 'density'");
}
