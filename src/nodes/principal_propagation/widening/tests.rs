//! The widening peak on the GPU against its oracle.

use glam::DVec3;
use serde_json::json;

use super::oracle::Widening;
use super::{Aligned, AlignedTexel, DiffuseParams, WidenGatherParams, WidenParams};
use crate::gpu::Gpu;
use crate::graph::{PortType, Value};
use crate::light::{Ordinate, Ordinates};
use crate::nodes::oracle_scene::corners::HIDDEN;
use crate::nodes::testing::{
    Filling, Scene, assert_close, assert_layout, filtered_times, flat, full_output, gpu, output, run, states,
    taus,
};
use crate::volume::field::Field;
use crate::wire::Beams;

/// A wall across z, which hides what is behind it [cells].
const WALL: ([f64; 2], [f64; 2], f64) = ([-20.0, -20.0], [3.3, 4.6], 2.2);

fn ordinates(scene: &Scene, directions: &[DVec3]) -> Value {
    let ordinate = |direction: &DVec3| Ordinate {
        direction: scene.lattice().world_from_index.transform_vector3(*direction).normalize(),
        irradiance: [1.0; 3],
        a0: 1.0,
        region: None,
        window: None,
    };
    let ordinates = directions.iter().map(ordinate).collect();
    Value::new(PortType::Ordinates, 0, Ordinates { ordinates, ..Ordinates::default() })
}

/// Widening beams of 1 W/m².
fn widened(gpu: &Gpu, scene: &Scene, medium: &Value, directions: &[DVec3], walls: &[Value]) -> Value {
    let ordinates = ordinates(scene, directions);
    let mut inputs = vec![("medium", medium), ("ordinates", &ordinates)];
    inputs.extend(walls.iter().map(|wall| ("surfaces", wall)));
    full_output(gpu, "principal_propagation", json!({ "peak": "widening" }), &inputs)
}

/// The depths of E* as a field of their own.
fn star_depths(gpu: &Gpu, beams: &Beams) -> Vec<Field<f64>> {
    taus(gpu, &Beams { tau: beams.peak.clone(), ..beams.clone() })
}

/// The oracle's E* at the corners, from the straight beam's depths without shadows.
fn expected(scene: &Scene, tau: &Field<f64>, direction: DVec3, has_wall: bool) -> Field<f64> {
    let lattice = scene.lattice();
    let world = lattice.world_from_index.transform_vector3(direction).normalize();
    let direction = lattice.direction_in_index(world);
    let grid = Aligned::new(&lattice, direction);
    let in_index = |u: f64, v: f64, w: f64| grid.origin + grid.index_from_aligned * DVec3::new(u, v, w);
    let sigma_t = Field::from_fn(grid.dims, |[u, v, w]| {
        scene.sigma_t.trilinear_zero(in_index(u as f64, v as f64, w as f64))
    });
    let is_lit = |[u, v]: [usize; 2], face: usize| {
        let p = in_index(u as f64, v as f64, face as f64 - 0.5);
        let (low, high, z) = WALL;
        let t = (p.z - z) / direction.z;
        let met = p - t * direction;
        let reach = if face == 0 { f64::INFINITY } else { 1.0 };
        let is_met = t > 0.0 && t < reach;
        !(has_wall && is_met && (low[0]..high[0]).contains(&met.x) && (low[1]..high[1]).contains(&met.y))
    };
    let widening = Widening { h: scene.cell_m, albedo: scene.albedo[0], g: scene.g };
    let k = scene.oracle(0).scaled().k;
    let widened = widening.propagate(&sigma_t, is_lit);
    Field::from_fn(tau.dims, |corner| {
        let p = DVec3::from_array(corner.map(|i| i as f64)) - 0.5 - grid.origin;
        let p = grid.index_from_aligned.transpose() * p + DVec3::new(0.0, 0.0, 0.5);
        let (star, straight) = (widened.star.trilinear_clamp(p), widened.straight.trilinear_clamp(p));
        (-k * tau.at(corner)).exp() * star / straight
    })
}

#[test]
fn agrees_with_the_oracle() {
    let Some(gpu) = gpu() else { return };
    let directions =
        [DVec3::Z, DVec3::NEG_Z, DVec3::new(0.3, -0.5, 0.8), DVec3::new(0.1, 0.9, 0.4)].map(DVec3::normalize);
    for (dims, g, albedo, sigma_t) in [([8, 8, 8], 0.8, 1.0, 6.0), ([12, 7, 9], 0.95, 0.9, 20.0)] {
        let scene = Scene { g, albedo: [albedo; 3], ..Scene::new(dims, Filling::Random, sigma_t) };
        let medium = scene.medium(gpu);
        let k = scene.oracle(0).scaled().k;
        let wall = scene.plate(WALL.0, WALL.1, WALL.2);
        // Alone in f32, and four in a texel of half floats.
        for (n_beams, has_wall) in [(1, false), (1, true), (4, false), (4, true)] {
            let walls = if has_wall { vec![wall.clone()] } else { Vec::new() };
            for four in directions.chunks(n_beams) {
                let beams = widened(gpu, &scene, &medium, four, &walls);
                let beams: &Beams = beams.get();
                let alone = widened(gpu, &scene, &medium, four, &[]);
                let straight = taus(gpu, alone.get());
                for (n, depths) in star_depths(gpu, beams).iter().enumerate() {
                    let what = format!("{dims:?} along {}, wall {has_wall}, {n_beams}", four[n]);
                    let found: Vec<f64> = depths.data.iter().map(|tau| (-k * tau).exp()).collect();
                    let expected = expected(&scene, &straight[n], four[n], has_wall);
                    // A slice is some fifty roundings, a grid ten to twenty slices. A half float of a depth
                    // is off by 5e-4 of it, and of e^{-x} that is at most 5e-4 / e, and once more for tau.
                    let f32_error = 3e-5;
                    let tolerance = if n_beams == 1 { f32_error } else { f32_error + 2.0 * 5e-4 / 2.7 };
                    // Where filters weigh in 8 bits, twice: in the depths along the beam and in those of its peak.
                    let tolerance = filtered_times(gpu, tolerance, 2.0);
                    assert_close(&what, &found, &expected.data, tolerance, tolerance);
                }
            }
        }
    }
}

#[test]
fn light_comes_around_an_edge() {
    // In the middle of a wall's shadow a straight beam leaves nothing; behind its edge the peak does.
    let Some(gpu) = gpu() else { return };
    let scene = Scene { g: 0.9, albedo: [1.0; 3], ..Scene::new([16, 16, 16], Filling::Homogeneous, 2.0) };
    let medium = scene.medium(gpu);
    let wall = scene.plate([-1.0, -20.0], [7.3, 40.0], -0.8);
    let beams = widened(gpu, &scene, &medium, &[DVec3::Z], &[wall]);
    let beams: &Beams = beams.get();
    let (straight, star) = (&taus(gpu, beams)[0], &star_depths(gpu, beams)[0]);
    let k = scene.oracle(0).scaled().k;
    let light = |x: usize| (-k * star.at([x, 8, 14])).exp();
    for x in [6, 7] {
        assert_eq!(straight.at([x, 8, 14]), HIDDEN);
        assert!(light(x) > 0.02, "{x}: {}", light(x));
    }
    assert!(light(7) > light(5) && light(5) > light(3));
    // At the edge about half is left of what passes far from it.
    let lit = (-k * straight.at([8, 8, 14])).exp();
    let edge = 0.5 * (light(7) + light(8)) / lit;
    assert!((0.4..0.6).contains(&edge), "{edge}");
}

#[test]
fn what_does_not_scatter_forward_has_no_peak() {
    let Some(gpu) = gpu() else { return };
    for g in [0.0, -0.5] {
        let scene = Scene { g, ..Scene::new([5, 5, 5], Filling::Random, 2.0) };
        let medium = scene.medium(gpu);
        let beams = widened(gpu, &scene, &medium, &[DVec3::Z], &[]);
        assert!(beams.get::<Beams>().peak.is_none());
    }
}

#[test]
fn the_residual_takes_its_light() {
    // As if the depths of E* were those of the beam.
    let Some(gpu) = gpu() else { return };
    let scene = Scene { g: 0.9, ..Scene::new([8, 8, 8], Filling::Random, 8.0) };
    let medium = scene.medium(gpu);
    let wall = scene.plate(WALL.0, WALL.1, WALL.2);
    let wide = widened(gpu, &scene, &medium, &[DVec3::new(0.2, 0.1, 1.0)], &[wall]);
    let beams: &Beams = wide.get();
    let residual = |beams: Beams| {
        let beams = Value::new(PortType::Beams, 0, beams);
        let inputs = [("medium", &medium), ("beams", &beams)];
        flat(&states(gpu, &output(gpu, "isotropic_residual", json!({ "quality": "fast" }), &inputs))[0])
    };
    let as_peak = residual(beams.clone());
    let as_tau = residual(Beams { tau: beams.peak.clone(), peak: None, ..beams.clone() });
    let straight = residual(Beams { peak: None, ..beams.clone() });
    assert_eq!(as_peak, as_tau);
    assert_ne!(as_peak, straight);
}

#[test]
fn merged_beams_keep_their_peaks() {
    // One light that widens, and two that do not: their E* is that of their depth.
    let Some(gpu) = gpu() else { return };
    let scene = Scene { g: 0.9, ..Scene::new([8, 8, 8], Filling::Random, 8.0) };
    let medium = scene.medium(gpu);
    let lattice = scene.lattice();
    let one = widened(gpu, &scene, &medium, &[DVec3::Z], &[]);
    let light = ordinates(&scene, &[DVec3::X, DVec3::NEG_Y]);
    let inputs = [("medium", &medium), ("ordinates", &light)];
    let two = output(gpu, "principal_propagation", json!({}), &inputs);
    let merged = Beams::merge(gpu, &lattice, &[one.get(), two.get()]).unwrap();
    let (stars, depths) = (star_depths(gpu, &merged), taus(gpu, &merged));
    let expected = star_depths(gpu, one.get());
    // Texels of four are half floats: an ulp.
    assert_close("widening", &stars[0].data, &expected[0].data, 1e-3, 1e-6);
    assert_ne!(stars[0], depths[0]);
    assert_eq!(stars[4..6], depths[4..6]);
    assert_close("straight", &depths[4].data, &taus(gpu, two.get())[0].data, 1e-3, 1e-6);
    let straight = Beams::merge(gpu, &lattice, &[two.get(), two.get()]).unwrap();
    assert!(straight.peak.is_none());
}

#[test]
fn extremes_are_finite() {
    let Some(gpu) = gpu() else { return };
    for (filling, sigma_t) in [(Filling::Binary, 4e4), (Filling::Random, 1e-6), (Filling::Binary, 1e30)] {
        for (g, albedo) in [(0.999, 1.0), (0.5, 0.0), (1e-3, 1.0)] {
            let scene = Scene { g, albedo: [albedo; 3], ..Scene::new([5, 8, 3], filling, sigma_t) };
            let (medium, k) = (scene.medium(gpu), scene.oracle(0).scaled().k);
            let beams = widened(gpu, &scene, &medium, &[DVec3::new(0.1, 0.9, 0.3)], &[]);
            for depth in &star_depths(gpu, beams.get())[0].data {
                // Beside a cloud light is brighter by at most what the cloud spreads.
                let light = (-k * depth).exp();
                assert!(depth.is_finite() && light < 2.0, "g {g} {sigma_t}: {depth}");
            }
        }
    }
}

#[test]
fn the_literal_scheme_has_no_peak() {
    let Some(gpu) = gpu() else { return };
    let scene = Scene::new([4, 4, 4], Filling::Random, 1.0);
    let (medium, light) = (scene.medium(gpu), ordinates(&scene, &[DVec3::Z]));
    let inputs = [("medium", &medium), ("ordinates", &light)];
    let params = json!({ "scheme": "literal", "peak": "widening" });
    let error = run(gpu, "principal_propagation", params, &inputs).err().unwrap().to_string();
    assert!(error.contains("peak widening is for beams"), "{error}");
}

#[test]
fn layouts_are_the_shaders() {
    let share = [("least_share", "1e-5"), ("least_power", "1e-30")];
    assert_layout::<WidenParams>("principal_propagation/widen_pass.wgsl", "WidenParams", &share);
    assert_layout::<AlignedTexel>("principal_propagation/widen_pass.wgsl", "Aligned", &share);
    assert_layout::<DiffuseParams>("principal_propagation/widen_diffuse.wgsl", "DiffuseParams", &[]);
    let packed = [("pack", "4"), ("format", "rgba16float")];
    assert_layout::<WidenGatherParams>(
        "principal_propagation/widen_gather.wgsl",
        "WidenGatherParams",
        &packed,
    );
}
