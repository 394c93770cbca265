use glam::{Vec2, Vec3};

use super::{CANDIDATES, LEAST_SPACING, PIECES, POINTS, Points, Spacing, SurfacePoint, shared};
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
pub fn look_up(gpu: &Gpu, light: &SurfaceLight, looks: &[Look]) -> Vec<[f64; 3]> {
    let [_, triangles] = light.surfaces().binds();
    let [irradiances, corners] = light.binds();
    let list = gpu.buffer_from("looks", looks, "").unwrap();
    let found = gpu.buffer("found", 16 * looks.len() as u64, "").unwrap();
    let params = LookupParams { n_looks: looks.len() as u32, pad_0: 0, pad_1: 0, pad_2: 0 };
    let inputs = [triangles, irradiances, corners, Bind::Buffer(&list)];
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
    let (mut irradiances, mut corners) = (Vec::new(), Vec::new());
    for triangle in &surfaces.corners {
        let first = irradiances.len() as u32 / 2;
        // Not in the order of the corners.
        corners.push([first + 2, first, first + 1, 0]);
        for p in [triangle[1], triangle[2], triangle[0]] {
            irradiances.extend([0.0, 1.0].map(|side| [linear(p, side), 0.0, -linear(p, side), 0.0]));
        }
    }
    let light = SurfaceLight {
        irradiances: gpu.buffer_from("irradiances", &irradiances, "").unwrap(),
        corners: gpu.buffer_from("corners", &corners, "").unwrap(),
        whole: surfaces.corners.clone(),
        surfaces,
    };
    let surfaces = light.surfaces();
    let (mut looks, mut expected) = (Vec::new(), Vec::new());
    for n in 0..2000 {
        let triangle = n % 5;
        let [a, b, c] = surfaces.corners[triangle];
        let mut at = Vec2::new(random.unit() as f32, random.unit() as f32);
        if at.x + at.y > 1.0 {
            at = 1.0 - at;
        }
        // Corners and edges of the triangle, too.
        let at = match n % 7 {
            0 => at.round(),
            1 => Vec2::new(at.x, 1.0 - at.x),
            2 => Vec2::new(at.x, 0.0),
            _ => at,
        };
        let p = on([a, b, c], at.to_array());
        let side = (n / 5) % 2;
        let normal = (b - a).cross(c - a).normalize() * [-1.0, 1.0][side];
        let direction = (normal + 0.5 * (b - a).normalize()).extend(0.0).to_array();
        looks.push(Look { p: p.to_array(), triangle: triangle as u32, direction });
        expected.push(f64::from(linear(p, side as f32)));
    }
    let found = look_up(gpu, &light, &looks);
    let of = |c: usize| found.iter().map(|e| e[c]).collect::<Vec<f64>>();
    // Coordinates in a triangle err by some ulps of products of lengths of 80, more where it is slim.
    assert_close("irradiance", &of(0), &expected, 2e-5, 0.0);
    assert_close("of another channel", &of(2), &expected.iter().map(|e| -e).collect::<Vec<_>>(), 2e-5, 0.0);
    assert!(of(1).iter().all(|e| *e == 0.0));
}

/// A square of two triangles, of this half edge around the origin.
fn square(half: f32) -> [[Vec3; 3]; 2] {
    let [a, b, c, d] =
        [(-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0)].map(|(x, y)| half * Vec3::new(x, y, 0.0));
    [[a, b, c], [a, c, d]]
}

#[test]
fn points_stand_closer_near_the_medium() {
    let spacing = Spacing::new([33, 33, 33]);
    let half_diagonal = 16.0 * 3.0_f32.sqrt();
    assert_eq!(spacing.at(Vec3::splat(16.0)), LEAST_SPACING);
    assert_eq!(spacing.at(Vec3::new(32.0 + 0.9 * half_diagonal, 3.0, 3.0)), LEAST_SPACING);
    assert_eq!(spacing.at(Vec3::new(32.0 + 1.1 * half_diagonal, 3.0, 3.0)), 2.0 * LEAST_SPACING);
    assert_eq!(spacing.at(Vec3::new(3.0, -3.1 * half_diagonal, 3.0)), 4.0 * LEAST_SPACING);
}

#[test]
fn corners_share_points_where_surfaces_face_alike() {
    let spacing = Spacing::new([9, 9, 9]);
    let sheet = square(40.0);
    // Two triangles of a plane have four corners, and both triangles of one corner the same point.
    let (list, corners) = shared(&sheet, &spacing);
    assert_eq!(list.len(), 4);
    assert_eq!((corners[0][0], corners[0][2]), (corners[1][0], corners[1][1]));
    // Of what faces the other way, or lies two cells above, nothing is shared.
    let turned = sheet.map(|[a, b, c]| [a, c, b]);
    assert_eq!(shared(&[sheet, turned].concat(), &spacing).0.len(), 8);
    let above = sheet.map(|corners| corners.map(|p| p + 4.0 * Vec3::Z));
    assert_eq!(shared(&[sheet, above].concat(), &spacing).0.len(), 8);
    // A point lies inside of its triangle, in its plane.
    for point in list.concat() {
        let [a, b, c] = sheet[point.triangle as usize].map(|p| p.truncate());
        let p = Vec3::from_array(point.p);
        let inside = [(a, b), (b, c), (c, a)].map(|(from, to)| (to - from).perp_dot(p.truncate() - from));
        assert!(inside.iter().all(|area| *area > 0.0) && p.z == 0.0, "{p}");
    }
}

#[test]
fn points_are_few_enough() {
    // A ground of 40,000 cells, and 30,000 small triangles that all stand apart.
    let Some(gpu) = gpu() else { return };
    let lattice = Scene::new([16, 16, 16], Filling::Homogeneous, 1.0).lattice();
    let ground = square(20_000.0).to_vec();
    let dust: Vec<_> = (0..30_000)
        .map(|n| {
            square(0.1)[0].map(|p| p + Vec3::new((n % 30) as f32, (n / 30 % 30) as f32, (n / 900) as f32))
        })
        .collect();
    let both = [ground.clone(), dust.clone()].concat();
    for (triangles, least) in [(ground, 500), (dust, 2000), (both, 2000)] {
        let n_triangles = triangles.len();
        let triangles: Vec<_> = triangles.iter().map(|t| t.map(|p| p.as_dvec3())).collect();
        let surfaces = Surfaces::new(gpu, &lattice, &[&mesh(&lattice, &triangles, [0.5; 3])]).unwrap();
        let points = Points::new(gpu, [16; 3], &surfaces).unwrap();
        let n_points = points.candidates.len() / CANDIDATES;
        assert!((least..=POINTS).contains(&n_points), "{n_points} points");
        let n_pieces = points.surfaces.corners.len();
        assert!(n_pieces >= n_triangles && n_pieces <= n_triangles + PIECES, "{n_pieces} pieces");
    }
}

#[test]
fn points_move_out_of_the_dark() {
    let Some(gpu) = gpu() else { return };
    let lattice = Scene::new([16, 16, 16], Filling::Homogeneous, 1.0).lattice();
    // Many small triangles share the points of one square.
    let triangles: Vec<_> = (0..8)
        .map(|n| square(0.02)[0].map(|p| (p + Vec3::new(0.1 * n as f32, 0.0, 0.0)).as_dvec3()))
        .collect();
    let surfaces = Surfaces::new(gpu, &lattice, &[&mesh(&lattice, &triangles, [0.5; 3])]).unwrap();
    let settled = |light: &dyn Fn(usize) -> f32| -> Vec<u32> {
        let points = Points::new(gpu, [16; 3], &surfaces).unwrap();
        assert_eq!(points.candidates.len() % CANDIDATES, 0);
        let irradiances: Vec<[f32; 4]> =
            (0..2 * points.candidates.len()).map(|n| [0.0, 0.5 * light(n / 2), 0.0, 0.0]).collect();
        let irradiances = gpu.buffer_from("irradiances", &irradiances, "").unwrap();
        let of = points.candidates.clone();
        let settled = points.settled(gpu, &irradiances).unwrap();
        let list: Vec<SurfacePoint> = gpu.read_buffer(&settled.list).unwrap();
        assert_eq!(list.len(), settled.n_points);
        let slot = |(n, point): (usize, &SurfacePoint)| {
            let candidates = &of[CANDIDATES * n..CANDIDATES * (n + 1)];
            candidates.iter().position(|candidate| candidate.p == point.p).unwrap() as u32
        };
        list.iter().enumerate().map(slot).collect()
    };
    let brightest = CANDIDATES - 1;
    let first_has = |share: f32| move |n: usize| if n % CANDIDATES == brightest { 1.0 } else { share };
    assert!(settled(&first_has(0.3)).iter().all(|slot| *slot == 0));
    let moved = settled(&first_has(0.2));
    assert!(moved.iter().any(|slot| *slot as usize == brightest), "{moved:?}");
}

#[test]
fn layouts_are_those_of_the_shaders() {
    assert_layout::<LookupParams>("lookup.wgsl", "LookupParams", &[]);
    assert_layout::<Look>("lookup.wgsl", "Look", &[]);
    assert_layout::<SurfacePoint>("isotropic_residual/surface_point.wgsl", "SurfacePoint", &[]);
}
