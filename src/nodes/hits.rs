//! Rays against surfaces on the GPU (`shaders/lib/bvh.wgsl`), held against trying every triangle in f64.

use glam::{DVec3, Vec3};

use super::testing::{Filling, Random, Scene, assert_layout, ball, gpu, mesh};
use crate::geometry::oracle::{Ray, nearest};
use crate::gpu::{Bind, Gpu};
use crate::mirror;
use crate::volume::Lattice;
use crate::wire::{SurfaceNode, SurfaceTriangle, Surfaces};

mirror! {
    /// `HitsParams` of `shaders/hits.wgsl`.
    struct HitsParams {
        n_rays: u32,
        pad_0: u32,
        pad_1: u32,
        pad_2: u32,
    }
}

mirror! {
    /// `HitsRay` of `shaders/hits.wgsl`.
    struct HitsRay {
        origin: [f32; 4],
        direction: [f32; 4],
    }
}

mirror! {
    /// `HitsFound` of `shaders/hits.wgsl`.
    struct HitsFound {
        t: f32,
        triangle: u32,
        occluded: u32,
        pad: u32,
        normal: [f32; 4],
        reflectance: [f32; 4],
    }
}

const NONE: u32 = u32::MAX;
const FAR: f32 = 1e6;

fn lattice() -> Lattice {
    Scene::new([4, 4, 4], Filling::Homogeneous, 1.0).lattice()
}

fn find(gpu: &Gpu, surfaces: &Surfaces, rays: &[(Vec3, Vec3, f32)]) -> Vec<HitsFound> {
    let texel = |(origin, direction, reach): &(Vec3, Vec3, f32)| HitsRay {
        origin: origin.extend(*reach).to_array(),
        direction: direction.extend(0.0).to_array(),
    };
    let rays: Vec<HitsRay> = rays.iter().map(texel).collect();
    let list = gpu.buffer_from("rays", &rays, "").unwrap();
    let found = gpu.buffer("hits", (size_of::<HitsFound>() * rays.len()) as u64, "").unwrap();
    let params = HitsParams { n_rays: rays.len() as u32, pad_0: 0, pad_1: 0, pad_2: 0 };
    let [nodes, triangles] = surfaces.binds();
    let stage = gpu.stage("hits", &[]).unwrap();
    let bound = stage.bind(gpu, &params, &[nodes, triangles, Bind::Buffer(&list)], &[Bind::Buffer(&found)]);
    let mut recorder = gpu.recorder("hits");
    recorder.dispatch(&bound, [rays.len(), 1, 1]);
    recorder.finish().unwrap();
    gpu.read_buffer(&found).unwrap()
}

#[test]
fn the_gpu_finds_what_trying_all_finds() {
    let Some(gpu) = gpu() else { return };
    let lattice = lattice();
    let mut random = Random(21);
    let mut point = || DVec3::new(random.unit(), random.unit(), random.unit());
    for (n, size) in [(1, 60.0), (5, 30.0), (300, 10.0), (3000, 2.0)] {
        // In a cube of 60 cells, as f32 numbers.
        let triangles: Vec<[DVec3; 3]> = (0..n)
            .map(|_| {
                let at = 60.0 * point();
                [(); 3].map(|()| (at + size * point()).as_vec3().as_dvec3())
            })
            .collect();
        // Two meshes in one tree, told apart by their color.
        let (first, second) = triangles.split_at(n / 2);
        let meshes = [mesh(&lattice, first, [0.1, 0.2, 0.3]), mesh(&lattice, second, [0.4, 0.5, 0.6])];
        let surfaces = Surfaces::new(gpu, &lattice, &[&meshes[0], &meshes[1]]).unwrap();
        assert_eq!((surfaces.corners.len(), surfaces.is_empty()), (n, false));
        let rays: Vec<(Vec3, Vec3, f32)> = (0..2000)
            .map(|idx| {
                let origin = (180.0 * point() - 60.0).as_vec3();
                let target = (60.0 * point()).as_vec3();
                // Lengths other than 1, ends before the target, and rays along the axes.
                match idx % 4 {
                    0 => (origin, [Vec3::X, Vec3::NEG_Y, Vec3::Z][idx % 3], FAR),
                    1 => (origin, target - origin, 0.9),
                    _ => (origin, (target - origin).normalize(), FAR),
                }
            })
            .collect();
        let (mut n_hits, mut n_unsure) = (0, 0);
        for (found, (origin, direction, reach)) in find(gpu, &surfaces, &rays).iter().zip(&rays) {
            let ray = Ray { origin: origin.as_dvec3(), direction: direction.as_dvec3() };
            let near = |grown| {
                let reach = f64::from(*reach);
                nearest(&triangles, ray, 1e-3, grown).filter(|hit| hit.t < reach - 1e-3)
            };
            // Corners went through the world in f64 and are 4e-6 off in f32: rays that pass an edge by
            // less than 1e-4 of the triangle, and what is edge-on, may be seen otherwise.
            let (most, least) = (near(1e-4), near(-1e-4));
            if most != least {
                n_unsure += 1;
                continue;
            }
            assert_eq!(found.occluded == 1, most.is_some(), "{n} {ray:?} {most:?}");
            let Some(hit) = most else {
                // Between the ends of both kinds of rays there is room for one hit.
                assert!(found.triangle == NONE || found.t > reach - 2e-3, "{n} {ray:?} {found:?}");
                continue;
            };
            n_hits += 1;
            let [a, b, c] = triangles[hit.triangle];
            let normal = (b - a).cross(c - a).normalize();
            let facing = normal.dot(ray.direction.normalize()).abs();
            // Rounding of coordinates up to 120, seen at the angle of the surface.
            let tolerance = 1e-4 / (facing * ray.direction.length());
            assert!((f64::from(found.t) - hit.t).abs() < tolerance, "{n} {ray:?} {found:?} {hit:?}");
            if facing > 0.01 {
                let seen = Vec3::from_slice(&found.normal).as_dvec3();
                // Edges are as short as a tenth of a cell: 1e-4 of them.
                assert!(
                    seen.dot(normal).abs() > 1.0 - 1e-3 && seen.dot(ray.direction) < 0.0,
                    "{seen} {normal}"
                );
            }
            let color = if hit.triangle < n / 2 { [0.1, 0.2, 0.3, 0.0] } else { [0.4, 0.5, 0.6, 0.0] };
            assert_eq!(found.reflectance, color);
        }
        assert!(n_hits >= 5 && n_unsure < 20, "{n}: {n_hits} hits, {n_unsure} near edges");
    }
}

#[test]
fn no_ray_is_lost_between_triangles() {
    let Some(gpu) = gpu() else { return };
    let lattice = lattice();
    for center in [DVec3::ZERO, DVec3::new(300.0, -200.0, 500.0)] {
        let triangles = ball(center, 3);
        let surfaces = Surfaces::new(gpu, &lattice, &[&mesh(&lattice, &triangles, [0.5; 3])]).unwrap();
        let mut random = Random(5);
        let mut rays = Vec::new();
        for [a, b, _] in &triangles {
            // At the middle of an edge, at its end, and anywhere on it.
            for share in [0.5, 0.0, random.unit()] {
                let origin = (center + 3.0 * random.direction()).as_vec3();
                let target = a.lerp(*b, share).as_vec3();
                rays.push((origin, target - origin, FAR));
            }
        }
        for (found, ray) in find(gpu, &surfaces, &rays).iter().zip(&rays) {
            assert!(found.triangle != NONE && found.occluded == 1, "{ray:?} left the ball");
            // All aim at the surface: t is 1, up to the rounding of coordinates of 500.
            assert!((found.t - 1.0).abs() < 1e-3, "{ray:?}: {found:?}");
        }
    }
}

#[test]
fn without_surfaces_nothing_is_met() {
    let Some(gpu) = gpu() else { return };
    let surfaces = Surfaces::new(gpu, &lattice(), &[]).unwrap();
    assert!(surfaces.is_empty());
    let rays =
        [(Vec3::ZERO, Vec3::X, FAR), (Vec3::splat(-9.0), Vec3::ONE, FAR), (Vec3::ZERO, Vec3::NEG_Z, FAR)];
    for found in find(gpu, &surfaces, &rays) {
        assert_eq!((found.triangle, found.occluded, found.t), (NONE, 0, FAR));
    }
}

#[test]
fn surfaces_out_of_reach_are_refused() {
    let Some(gpu) = gpu() else { return };
    let lattice = lattice();
    let far = mesh(&lattice, &[[DVec3::ZERO, DVec3::X, 2e9 * DVec3::Y]], [0.5; 3]);
    let error = Surfaces::new(gpu, &lattice, &[&far]).err().unwrap().to_string();
    assert!(error.contains("cells from the medium"), "{error}");
}

#[test]
fn layouts_are_those_of_the_shader() {
    assert_layout::<HitsParams>("hits.wgsl", "HitsParams", &[]);
    assert_layout::<HitsRay>("hits.wgsl", "HitsRay", &[]);
    assert_layout::<HitsFound>("hits.wgsl", "HitsFound", &[]);
    assert_layout::<SurfaceNode>("hits.wgsl", "SurfaceNode", &[]);
    assert_layout::<SurfaceTriangle>("hits.wgsl", "SurfaceTriangle", &[]);
}
