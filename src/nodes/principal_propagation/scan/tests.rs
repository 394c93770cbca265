use glam::DVec3;
use serde_json::json;

use super::super::oracle::tau_corners_scan;
use super::{COLUMN, PackParams, SLAB, ScanParams, scan};
use crate::gpu::{Gpu, Shader, wgsl_constant};
use crate::nodes::testing::{
    Filling, Random, Scene, assert_close, assert_layout, filtered, gpu, sun, taus, with_run,
};
use crate::nodes::walk::walk;
use crate::volume::field::Field;
use crate::wire::{Beam, Beams, Medium, ShapeTexel};

/// A half float that was cut.
const HALF: f64 = 1.0 / 1024.0;

/// Depths by scans of these beams, and by walks.
fn both(gpu: &Gpu, scene: &Scene, lights: &[Beam], is_scanned: &[bool]) -> [Vec<Field<f64>>; 2] {
    let value = scene.medium(gpu);
    let medium: &Medium = value.get();
    let inputs = [("medium", &value)];
    let atlases = with_run(gpu, "principal_propagation", json!({}), &inputs, |run| {
        [scan(run, medium, lights, is_scanned).unwrap(), walk(run, medium, lights).unwrap()]
    });
    atlases.map(|tau| {
        let beams = Beams { tau: Some(tau), ..Beams::new(&medium.lattice, lights.to_vec()) };
        taus(gpu, &beams)
    })
}

/// Slabs are 8 planes: these have five of them along their longest axis, of which the last is not whole.
const DIMS: [usize; 3] = [20, 18, 39];

#[test]
fn scans_are_those_of_the_oracle() {
    // f32: up to 40 samples, and the crossings of five planes, are at positions that are 4e-6 cells off, each of which is
    // that part of a cell's depth. A device's own filter has 256 steps a cell.
    let Some(gpu) = gpu() else { return };
    let mut random = Random(2);
    for filling in [Filling::Homogeneous, Filling::Random, Filling::Binary] {
        let scene = Scene::new(DIMS, filling, 3.0);
        let absolute = filtered(gpu, 4e-6) * 45.0 * 3.0 * scene.cell_m;
        let axes = [DVec3::X, DVec3::NEG_X, DVec3::Y, DVec3::NEG_Y, DVec3::Z, DVec3::NEG_Z];
        // Of equal components too.
        let equal = [DVec3::new(1.0, -1.0, 0.0), DVec3::new(0.0, 1.0, 1.0), DVec3::NEG_ONE];
        let axes = axes.into_iter().chain(equal.map(|v| v.normalize().as_vec3().as_dvec3()));
        let others = (0..6).map(|_| random.direction().as_vec3().as_dvec3()).collect::<Vec<_>>();
        for direction in axes.chain(others) {
            let [found, _] = both(gpu, &scene, &[sun(direction, 1.0)], &[true]);
            let expected = tau_corners_scan(&scene.sigma_t, scene.cell_m, direction, SLAB);
            assert!(expected.data.iter().any(|tau| *tau > 3.0));
            assert_close(&format!("{filling:?} {direction}"), &found[0].data, &expected.data, 1e-5, absolute);
        }
    }
}

#[test]
fn what_no_cell_resolves_is_lost_and_nothing_else() {
    // Cells of independent density, even in 0 ... s: a ray's samples differ from the next ray's by some s/4 each, all of
    // which may be lost of up to 39 - 8 cells: sqrt(31) / 4 = 1.4 cells' depth, three times that as the largest of 15 000
    // corners. The root of the mean square is s/sqrt(12) a sample, 1.6 cells' depth if all were lost; a cubic keeps more
    // than half (0.1 to 0.43 cells measured). The mean over corners is kept.
    let Some(gpu) = gpu() else { return };
    let mut random = Random(5);
    for n_beams in [1, 5] {
        let lights: Vec<Beam> = (0..n_beams).map(|_| sun(random.direction(), 1.0)).collect();
        let scene = Scene::new(DIMS, Filling::Random, 3.0);
        let of_cell = 3.0 * scene.cell_m;
        let [found, expected] = both(gpu, &scene, &lights, &[true; 5][..n_beams]);
        for (found, expected) in found.iter().zip(&expected) {
            let mean = |field: &Field<f64>| field.data.iter().sum::<f64>() / field.data.len() as f64;
            let pairs = || found.data.iter().zip(&expected.data);
            let rms = (pairs().map(|(a, b)| (a - b).powi(2)).sum::<f64>() / found.data.len() as f64).sqrt();
            let most = pairs().map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
            eprintln!("{n_beams}: {} against {}, rms {rms}, most {most}", mean(found), mean(expected));
            assert_close("mean", &[mean(found)], &[mean(expected)], 5e-3, 0.0);
            assert!(rms < 0.7 * of_cell && most < 4.2 * of_cell, "{rms}, {most} of {of_cell}");
        }
    }
}

#[test]
fn beams_that_are_not_scanned_are_walked() {
    let Some(gpu) = gpu() else { return };
    let scene = Scene::new(DIMS, Filling::Random, 3.0);
    let direction = DVec3::new(0.4, -0.5, 0.7).normalize();
    let lights = [sun(direction, 1.0); 5];
    let is_scanned = [true, false, true, false, false];
    let [found, expected] = both(gpu, &scene, &lights, &is_scanned);
    for n in [1, 3, 4] {
        // Cut to half floats, of the same numbers.
        assert_close(&format!("{n}"), &found[n].data, &expected[n].data, HALF, 0.0);
    }
    assert!(found[0].data == found[2].data && found[0].data != found[1].data);
}

#[test]
fn no_depth_swings_beyond_its_neighbors() {
    // One cell a million times as thick as the others: a cubic beside it would be negative, or dark where it is lit.
    let Some(gpu) = gpu() else { return };
    let mut scene = Scene::new(DIMS, Filling::Homogeneous, 1.0);
    let thick = [9, 9, 20];
    scene.sigma_t = Field::from_fn(DIMS, |cell| if cell == thick { 1e6 } else { scene.sigma_t.at(cell) });
    let direction = DVec3::new(0.1, 0.2, 1.0).normalize();
    let [found, _] = both(gpu, &scene, &[sun(direction, 1.0)], &[true]);
    // 40 cells of 0.25 m, and the way is longer by 3 %.
    let clear = found[0].data.iter().filter(|tau| (0.0..11.0).contains(*tau)).count();
    let [nx, ny, nz] = found[0].dims;
    // Behind the cell its shadow is up to 4 corners wide on each plane.
    assert!(clear >= nx * ny * nz - 21 * 16, "{clear} of {}", nx * ny * nz);
    assert!(found[0].data.iter().all(|tau| (0.0..1e30).contains(tau)));
}

#[test]
fn layouts_are_those_of_the_shaders() {
    const WHOLE: [(&str, &str); 1] = [("whole", "false")];
    const PACKED: [(&str, &str); 2] = [("pack", "4"), ("format", "rgba16float")];
    assert_layout::<ScanParams>("principal_propagation/scan.wgsl", "ScanParams", &WHOLE);
    assert_layout::<ShapeTexel>("principal_propagation/scan.wgsl", "Shape", &WHOLE);
    assert_layout::<PackParams>("principal_propagation/pack.wgsl", "PackParams", &PACKED);
    let choices = WHOLE.map(|(name, value)| (name, value.to_owned()));
    let shader = Shader::expand("principal_propagation/scan.wgsl", &choices).unwrap();
    assert_eq!(wgsl_constant(&shader, "COLUMN").unwrap(), [COLUMN as f64]);
}
