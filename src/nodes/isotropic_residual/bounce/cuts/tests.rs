use glam::{Vec2, Vec3};

use super::{SurfacePoint, corners, inward, middles};
use crate::gpu::{Bind, Gpu};
use crate::mirror;
use crate::nodes::testing::{Filling, Random, Scene, assert_close, assert_layout, gpu, mesh};
use crate::wire::{SurfaceLight, Surfaces};

mirror! {
    /// `LookupParams` of `shaders/lookup.wgsl`.
    struct LookupParams {
        n_looks: u32,
        pad_0: u32,
        pad_1: u32,
        pad_2: u32,
    }
}

mirror! {
    /// `Look` of `shaders/lookup.wgsl`.
    pub struct Look {
        p: [f32; 3],
        triangle: u32,
        direction: [f32; 4],
    }
}

/// What these looks find.
pub fn look_up(gpu: &Gpu, light: &SurfaceLight, surfaces: &Surfaces, looks: &[Look]) -> Vec<[f64; 3]> {
    assert!(light.is_of(surfaces));
    let [_, triangles] = surfaces.binds();
    let [irradiances, grids] = light.binds();
    let list = gpu.buffer_from("looks", looks, "").unwrap();
    let found = gpu.buffer("found", 16 * looks.len() as u64, "").unwrap();
    let params = LookupParams { n_looks: looks.len() as u32, pad_0: 0, pad_1: 0, pad_2: 0 };
    let inputs = [triangles, irradiances, grids, Bind::Buffer(&list)];
    let bound = gpu.stage("lookup", &[]).unwrap().bind(gpu, &params, &inputs, &[Bind::Buffer(&found)]);
    let mut recorder = gpu.recorder("lookup");
    recorder.dispatch(&bound, [looks.len(), 1, 1]);
    recorder.finish().unwrap();
    let found: Vec<[f32; 4]> = gpu.read_buffer(&found).unwrap();
    found.iter().map(|[red, green, blue, _]| [red, green, blue].map(|e| f64::from(*e))).collect()
}

#[test]
fn light_that_is_linear_stays_so_between_corners() {
    let Some(gpu) = gpu() else { return };
    let lattice = Scene::new([4, 4, 4], Filling::Homogeneous, 1.0).lattice();
    let mut random = Random(11);
    let mut point = |scale: f64| scale * random.direction();
    let triangles: Vec<[_; 3]> = (0..5).map(|_| [(); 3].map(|()| point(40.0))).collect();
    let surfaces = Surfaces::new(gpu, &lattice, &[&mesh(&lattice, &triangles, [0.5; 3])]).unwrap();
    let linear = |p: Vec3, side: f32| 100.0 + p.dot(Vec3::new(0.3, -0.2, 0.5)) + 50.0 * side;
    let on = |[a, b, c]: [Vec3; 3], [u, v]: [f32; 2]| a + u * (b - a) + v * (c - a);
    let (mut irradiances, mut grids) = (Vec::new(), Vec::new());
    for (corners_of, n) in surfaces.corners.iter().zip([1, 2, 3, 7, 50]) {
        grids.push([irradiances.len() as u32 / 2, n]);
        for at in corners(n) {
            let p = on(*corners_of, at);
            irradiances.extend([0.0, 1.0].map(|side| [linear(p, side), 0.0, -linear(p, side), 0.0]));
        }
    }
    let light = SurfaceLight {
        irradiances: gpu.buffer_from("irradiances", &irradiances, "").unwrap(),
        grids: gpu.buffer_from("grids", &grids, "").unwrap(),
        triangles: surfaces.corners.clone(),
    };
    let (mut looks, mut expected) = (Vec::new(), Vec::new());
    for n in 0..2000 {
        let triangle = n % 5;
        let [a, b, c] = surfaces.corners[triangle];
        let mut at = Vec2::new(random.unit() as f32, random.unit() as f32);
        if at.x + at.y > 1.0 {
            at = 1.0 - at;
        }
        // Corners and edges of the triangle, and of its cuts, too.
        let at = match n % 7 {
            0 => at.round(),
            1 => Vec2::new(at.x, 1.0 - at.x),
            2 => Vec2::new(at.x, 0.0),
            3 => (at * 7.0).floor() / 7.0,
            _ => at,
        };
        let p = on([a, b, c], at.to_array());
        let side = (n / 5) % 2;
        let normal = (b - a).cross(c - a).normalize() * [-1.0, 1.0][side];
        let direction = (normal + 0.5 * (b - a).normalize()).extend(0.0).to_array();
        looks.push(Look { p: p.to_array(), triangle: triangle as u32, direction });
        expected.push(f64::from(linear(p, side as f32)));
    }
    let found = look_up(gpu, &light, &surfaces, &looks);
    let of = |c: usize| found.iter().map(|e| e[c]).collect::<Vec<f64>>();
    // Coordinates in a triangle err by some ulps of products of lengths of 80, more where it is slim.
    assert_close("irradiance", &of(0), &expected, 2e-5, 0.0);
    assert_close("of another channel", &of(2), &expected.iter().map(|e| -e).collect::<Vec<_>>(), 2e-5, 0.0);
    assert!(of(1).iter().all(|e| *e == 0.0));
}

/// The cut of `shaders/lib/patches.wgsl` around this point.
fn patch_at(n: u32, [u, v]: [f32; 2]) -> u32 {
    let i = ((u * n as f32) as u32).min(n - 1);
    let j = ((v * n as f32) as u32).min(n - 1 - i);
    let is_upper = u * n as f32 - i as f32 + v * n as f32 - j as f32 > 1.0 && i + j < n - 1;
    n * n - (n - i) * (n - i) + 2 * j + u32::from(is_upper)
}

#[test]
fn patches_are_numbered_as_they_are_looked_up() {
    for n in [1, 2, 3, 17] {
        let middles: Vec<[f32; 2]> = middles(n).collect();
        assert_eq!(middles.len() as u32, n * n);
        assert!(middles.iter().enumerate().all(|(idx, at)| patch_at(n, *at) == idx as u32), "{n}");
    }
}

#[test]
fn corners_move_off_the_edges() {
    for n in [1, 4] {
        assert_eq!(corners(n).count() as u32, (n + 1) * (n + 2) / 2);
        for [u, v] in corners(n).map(|at| inward(n, at)) {
            let least = u.min(v).min(1.0 - u - v) * n as f32;
            assert!(least > 0.01, "{u} {v}: {least}");
        }
    }
}

#[test]
fn layouts_are_those_of_the_shaders() {
    assert_layout::<LookupParams>("lookup.wgsl", "LookupParams", &[]);
    assert_layout::<Look>("lookup.wgsl", "Look", &[]);
    let choices = [("pack", "1"), ("narrow", "true"), ("directions", "16"), ("channels", "1")];
    assert_layout::<SurfacePoint>("isotropic_residual/surface_light.wgsl", "SurfacePoint", &choices);
}
