use glam::DVec3;
use serde_json::json;

use super::WalkParams;
use crate::graph::Value;
use crate::nodes::oracle_scene::corners::tau_along;
use crate::nodes::principal_propagation::oracle::tau_corners_walk;
use crate::nodes::raymarch::oracle::{Ray, box_interval};
use crate::nodes::spherical_propagation::oracle::tau_corners_walk_point;
use crate::nodes::testing::{
    Filling, Random, Scene, assert_close, assert_layout, filtered, gpu, output, point, sun, taus,
};
use crate::volume::field::Field;
use crate::wire::{Beam, BeamTexel, Beams, Medium, Place, ShapeTexel};

/// Relative error of a half float that was cut, not rounded: stores to textures may, and lavapipe does.
const HALF: f64 = 1.0 / 1024.0;
/// Spacing of the smallest half floats.
const HALF_MIN: f64 = 6e-8;

/// The oracle's sum over the samples that the shader takes: between the centers of the outermost cells,
/// which are void, not from the corner on. Where rounding decides between two numbers of steps, the sum
/// that is nearer to `found`.
fn reference(scene: &Scene, beam: &Beam, corner: DVec3, found: f64) -> f64 {
    let dims = scene.sigma_t.dims;
    if dims.iter().any(|n| *n < 3) {
        return 0.0;
    }
    let inner = Field::from_fn(dims.map(|n| n - 2), |cell| scene.sigma_t.at(cell.map(|i| i + 1)));
    let (direction, reach) = match beam.place {
        Place::Parallel(direction) => (-direction.as_vec3().as_dvec3(), f64::INFINITY),
        Place::Point(position) => {
            let line = position.as_vec3().as_dvec3() - corner;
            (line.normalize_or_zero(), line.length())
        }
    };
    let high = DVec3::from_array(dims.map(|n| (n - 1) as f64));
    let Some([start, end]) = box_interval(&Ray { origin: corner, direction }, DVec3::ZERO, high) else {
        return 0.0;
    };
    let span = end.min(reach) - start;
    let from = corner + start * direction - 1.0;
    let sum = |span| tau_along(&inner, scene.cell_m, from, direction, span);
    // Positions of f32 in grids of some 20 cells are 2e-6 off.
    let (less, more) = (sum(span * (1.0 - 1e-6)), sum(span * (1.0 + 1e-6)));
    if (less - found).abs() < (more - found).abs() { less } else { more }
}

fn assert_walked(what: &str, scene: &Scene, lights: &[Beam]) {
    let Some(gpu) = gpu() else { return };
    let medium = scene.medium(gpu);
    let beams = scene.propagate(gpu, &medium, lights, [0.0; 3]);
    let beams: &Beams = beams.get();
    assert_eq!(beams.beams.len(), lights.len());
    let largest = scene.sigma_t.data.iter().copied().fold(0.0, f64::max);
    // f32: each of up to 30 samples is at a position that is 2e-6 cells off, and has eight roundings.
    let absolute = HALF_MIN + filtered(gpu, 3e-6) * 30.0 * largest * scene.cell_m;
    for (n, (beam, found)) in beams.beams.iter().zip(taus(gpu, beams)).enumerate() {
        let expected: Vec<f64> = (0..found.data.len())
            .map(|idx| {
                let corner = DVec3::from_array(found.index_of(idx).map(|i| i as f64)) - 0.5;
                reference(scene, beam, corner, found.data[idx])
            })
            .collect();
        assert_close(&format!("{what}, beam {n}"), &found.data, &expected, HALF, absolute);
    }
}

#[test]
fn parallel_light_of_any_direction_and_number() {
    let mut random = Random(3);
    for dims in [[1, 1, 1], [5, 3, 2], [5, 3, 4], [17, 9, 4]] {
        for filling in [Filling::Random, Filling::Binary] {
            // Packs hold four beams.
            for n_beams in [1, 3, 4, 5, 9] {
                let mut lights: Vec<Beam> = (0..n_beams).map(|_| sun(random.direction(), 1.0)).collect();
                lights[0] = sun([DVec3::X, DVec3::NEG_Y, DVec3::Z][n_beams % 3], 1.0);
                let scene = Scene::new(dims, filling, 3.0);
                assert_walked(&format!("{dims:?} {filling:?} {n_beams}"), &scene, &lights);
            }
        }
    }
}

#[test]
fn point_lights_inside_and_outside() {
    let lights = [
        point(DVec3::new(4.3, 3.1, 1.4), 1.0),
        point(DVec3::new(-20.0, 3.0, 50.0), 1.0),
        point(DVec3::new(4.0, 4.0, 12.0), 1.0),
        point(DVec3::new(3.5, 3.5, 1.5), 1.0),
        point(DVec3::new(1e3, -2e3, 1e3), 1.0),
    ];
    for filling in [Filling::Homogeneous, Filling::Random, Filling::Binary] {
        let scene = Scene::new([9, 8, 5], filling, 2.0);
        assert_walked(&format!("{filling:?}"), &scene, &lights);
    }
}

#[test]
fn walks_agree_with_the_oracles_own() {
    // The oracle begins at the corner and ends a cell outside the last center, so its samples stand
    // elsewhere: along a line through random cells midpoint sums differ by up to 0.23 of a
    // cell's largest depth. A wrong direction, place or scale errs by whole depths.
    let Some(gpu) = gpu() else { return };
    let scene = Scene::new([16, 16, 16], Filling::Random, 1.0);
    let medium = scene.medium(gpu);
    let light = DVec3::new(0.3, -0.5, 0.8).normalize();
    let position = DVec3::new(3.0, 20.0, 5.0);
    let expected = [
        tau_corners_walk(&scene.sigma_t, scene.cell_m, light),
        tau_corners_walk_point(&scene.sigma_t, scene.cell_m, position),
    ];
    for (light, expected) in [sun(light, 1.0), point(position, 1.0)].into_iter().zip(expected) {
        let beams = scene.propagate(gpu, &medium, &[light], [0.0; 3]);
        let found = taus(gpu, beams.get()).remove(0);
        let mean = |field: &Field<f64>| field.data.iter().sum::<f64>() / field.data.len() as f64;
        assert_close("mean", &[mean(&found)], &[mean(&expected)], 5e-3, 0.0);
        assert_close("tau", &found.data, &expected.data, 0.0, 0.3 * scene.cell_m);
    }
}

/// tau from a corner towards the light, of a shape of extinction 2 around the origin.
fn closed_form(kind: &str, p_m: DVec3, toward: DVec3) -> f64 {
    if kind == "box" {
        let ray = Ray { origin: p_m, direction: toward };
        let interval = box_interval(&ray, DVec3::new(-1.0, -0.75, -0.5), DVec3::new(1.0, 0.75, 0.5));
        return interval.map_or(0.0, |[start, end]| 2.0 * (end - start));
    }
    let axes = DVec3::new(1.0, 0.75, 0.5);
    let (o, d) = (p_m / axes, toward / axes);
    let (a, b, c) = (d.dot(d), o.dot(d), o.dot(o) - 1.0);
    let root = (b * b - a * c).max(0.0).sqrt() / a;
    2.0 * ((root - b / a).max(0.0) - (-root - b / a).max(0.0))
}

#[test]
fn homogeneous_shapes_have_their_closed_form() {
    let Some(gpu) = gpu() else { return };
    for kind in ["sphere", "box"] {
        let shape = json!({ "kind": kind, "size": [2.0, 1.5, 1.0], "resolution": 12 });
        let volume = output(gpu, "shape", shape, &[]);
        let medium = output(gpu, "medium", json!({ "density_scale": 2.0 }), &[("volume", &volume)]);
        let lattice = &medium.get::<Medium>().lattice;
        let travel = DVec3::new(0.2, -0.9, 0.3).normalize();
        let sun = json!({ "direction": travel.to_array() });
        let sun = output(gpu, "sun", sun, &[]);
        let ordinates = output(gpu, "light_decomposition", json!({}), &[("lights", &sun)]);
        let inputs: [(&str, &Value); 2] = [("medium", &medium), ("ordinates", &ordinates)];
        let beams = output(gpu, "principal_propagation", json!({}), &inputs);
        let found = taus(gpu, beams.get()).remove(0);
        let expected: Vec<f64> = (0..found.data.len())
            .map(|idx| {
                let corner = DVec3::from_array(found.index_of(idx).map(|i| i as f64)) - 0.5;
                closed_form(kind, lattice.world_from_index.transform_point3(corner), -travel)
            })
            .collect();
        // Grazing chords go with the root of a difference whose rounding is 1e-6: 2e-3 of a radius.
        assert_close(kind, &found.data, &expected, HALF, 4e-3);
        assert!(expected.iter().any(|tau| *tau > 1.4));
    }
}

#[test]
fn depths_beyond_half_floats_end_at_their_largest() {
    let Some(gpu) = gpu() else { return };
    let scene = Scene::new([8, 8, 8], Filling::Homogeneous, 1e6);
    let medium = scene.medium(gpu);
    let suns = [sun(DVec3::Z, 1.0), sun(DVec3::Z, 2.0), sun(DVec3::Z, 3.0)];
    let deepest = |beams: &Beams| taus(gpu, beams).iter().map(|tau| tau.at([4, 4, 8])).collect::<Vec<_>>();
    // One or two beams are stored in 32 bits: six cells of 0.25 m.
    let two = scene.propagate(gpu, &medium, &suns[..2], [0.0; 3]);
    assert_close("32 bits", &deepest(two.get()), &[1.5e6; 2], 1e-5, 0.0);
    let three = scene.propagate(gpu, &medium, &suns, [0.0; 3]);
    assert_eq!(deepest(three.get()), [65504.0; 3]);
    // Those of 32 bits are bounded when they are merged; a part is filled up to four with dark beams.
    let one = scene.propagate(gpu, &medium, &suns[..1], [0.0; 3]);
    let lattice = &medium.get::<Medium>().lattice;
    let merged = Beams::merge(gpu, lattice, &[two.get(), one.get()]).unwrap();
    assert_eq!(deepest(&merged)[..2], [65504.0; 2]);
    assert_eq!(deepest(&merged)[4], 65504.0);
    let extreme = Scene::new([8, 8, 8], Filling::Homogeneous, 1e38);
    let medium = extreme.medium(gpu);
    let beams = extreme.propagate(gpu, &medium, &suns[..1], [0.0; 3]);
    assert_eq!(deepest(beams.get()), [f64::from(1e30_f32)]);
}

#[test]
fn merged_packs_are_those_of_the_parts() {
    let Some(gpu) = gpu() else { return };
    let scene = Scene::new([9, 6, 7], Filling::Random, 3.0);
    let medium = scene.medium(gpu);
    let lattice = &medium.get::<Medium>().lattice;
    let along = [
        [0.3, 0.2, 0.9],
        [-0.8, 0.5, 0.1],
        [0.1, -1.0, 0.3],
        [0.0, 0.0, -1.0],
        [1.0, 0.2, 0.2],
        [0.4, 0.6, 0.5],
    ];
    let suns = along.map(|direction| sun(DVec3::from_array(direction), 1.0));
    let [one, other, six] =
        [&suns[..1], &suns[1..2], &suns[..]].map(|suns| scene.propagate(gpu, &medium, suns, [0.0; 3]));
    // Packs are copied as they are: the second part's begin where the first one's has been filled up.
    let merged = Beams::merge(gpu, lattice, &[one.get(), six.get()]).unwrap();
    assert_eq!(taus(gpu, &merged)[4..10], taus(gpu, six.get()));
    let two = Beams::merge(gpu, lattice, &[one.get(), other.get()]).unwrap();
    let singles = [taus(gpu, one.get()), taus(gpu, other.get())].concat();
    assert_eq!(taus(gpu, &two), singles);
    // Single ones become a pack, in half floats.
    let merged = taus(gpu, &Beams::merge(gpu, lattice, &[&two, six.get()]).unwrap());
    for (found, single) in merged.iter().zip(&singles) {
        assert_close("packed", &found.data, &single.data, HALF, HALF_MIN);
    }
    assert_eq!(merged[4..10], taus(gpu, six.get()));
}

#[test]
fn layouts_are_those_of_the_shader() {
    const PACKED: [(&str, &str); 2] = [("pack", "4"), ("format", "rgba16float")];
    assert_layout::<WalkParams>("walk.wgsl", "WalkParams", &PACKED);
    assert_layout::<ShapeTexel>("walk.wgsl", "Shape", &PACKED);
    assert_layout::<BeamTexel>("walk.wgsl", "Beam", &PACKED);
}
