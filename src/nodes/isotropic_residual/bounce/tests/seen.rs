//! What a camera finds on surfaces.

use std::f64::consts::PI;

use glam::{DVec4, Vec3};

use super::super::points::tests::{Look, look_up};
use super::*;
use crate::nodes::testing::full_output;
use crate::wire::{Beams, Surfaces};

/// Looks at points of triangles, as numbered, along directions.
type Looks<'a> = &'a dyn Fn(&[[Vec3; 3]]) -> Vec<(Vec3, usize, Vec3)>;

/// Irradiance at points of a surface.
fn seen(gpu: &Gpu, medium: &Value, beams: &Value, surface: &Value, looks: Looks) -> Vec<[f64; 3]> {
    let inputs = [("medium", medium), ("beams", beams), ("surfaces", surface)];
    let residual = output(gpu, "isotropic_residual", json!({ "quality": "reference" }), &inputs);
    let residual: &Residual = residual.get();
    let light = residual.surface_light.as_ref().unwrap();
    assert!(light.is_of(&Surfaces::new(gpu, &residual.lattice, &[surface.get::<Mesh>()]).unwrap()));
    let look = |(p, triangle, direction): (Vec3, usize, Vec3)| Look {
        p: p.to_array(),
        triangle: triangle as u32,
        direction: direction.extend(0.0).to_array(),
    };
    let looks: Vec<Look> = looks(&light.surfaces().corners).into_iter().map(look).collect();
    look_up(gpu, light, &looks)
}

fn middle([a, b, c]: [Vec3; 3]) -> Vec3 {
    (a + b + c) / 3.0
}

/// The triangles of a plane around one of its points, in which that may lie on an edge.
fn around(triangles: &[[Vec3; 3]], p: Vec3) -> Vec<usize> {
    let holds = |[a, b, c]: &[Vec3; 3]| {
        let whole = (b - a).cross(c - a);
        let area = |from: &Vec3, to: &Vec3| (to - from).cross(p - from).dot(whole) / whole.length_squared();
        [area(a, b), area(b, c), area(c, a)].iter().all(|share| *share > -1e-4)
    };
    (0..triangles.len()).filter(|n| holds(&triangles[*n])).collect()
}

#[test]
fn a_floor_gets_the_sky_and_wide_beams() {
    // In a void pi L of the sky on both sides, and E cos of a wide beam on the upper one; the narrow sun is
    // not for corners.
    let Some(gpu) = gpu() else { return };
    let scene = Scene { g: 0.0, ..Scene::new([6, 5, 4], Filling::Homogeneous, 1e-5) };
    let medium = scene.medium(gpu);
    let floor = scene.plate([-40.0, -30.0], [40.0, 30.0], -2.3);
    let wide = Beam { a0: 0.999, power: [3.0, 2.0, 1.0], ..sun(DVec3::new(0.6, 0.0, -0.8), 1.0) };
    let sky = [1.0, 0.5, 0.25];
    let lights = [wide, sun(DVec3::NEG_Z, 100.0)];
    let beams = scene.propagate_behind(gpu, &medium, &lights, sky, &[&floor]);
    let found = seen(gpu, &medium, &beams, &floor, &|triangles| {
        let both = |(n, triangle): (usize, &[Vec3; 3])| {
            [Vec3::NEG_Z, Vec3::Z].map(|direction| (middle(*triangle), n, direction))
        };
        triangles.iter().enumerate().flat_map(both).collect()
    });
    assert!(found.len() > 100, "{}", found.len());
    for (idx, irradiance) in found.iter().enumerate() {
        let direct = if idx % 2 == 0 { 0.8 } else { 0.0 };
        let expected: Vec<f64> = (0..3).map(|c| PI * sky[c] + direct * wide.power[c]).collect();
        // The medium takes less than 1e-4.
        assert_close("irradiance", irradiance, &expected, 2e-4, 0.0);
    }
}

#[test]
fn light_is_one_across_the_triangles_of_a_plate() {
    let Some(gpu) = gpu() else { return };
    let scene = Scene { g: 0.3, ..Scene::new([8, 8, 8], Filling::Random, 3.0) };
    let medium = scene.medium(gpu);
    let floor = scene.plate([-6.0, -6.0], [14.0, 14.0], -1.2);
    let wide = Beam { a0: 0.99, ..sun(DVec3::new(0.3, 0.1, -0.9), 2.0) };
    let beams = scene.propagate_behind(gpu, &medium, &[wide], [0.5; 3], &[&floor]);
    let along = |n: usize| Vec3::new(-6.0, -6.0, -1.2) + 20.0 * n as f32 / 100.0 * Vec3::new(1.0, 1.0, 0.0);
    let found = seen(gpu, &medium, &beams, &floor, &|triangles| {
        let both = |n: usize| {
            let around = around(triangles, along(n));
            [around[0], around[around.len() - 1]].map(|triangle| (along(n), triangle, Vec3::NEG_Z))
        };
        (0..=100).flat_map(both).collect()
    });
    let one: Vec<f64> = found.iter().step_by(2).map(|e| e[0]).collect();
    let other: Vec<f64> = found.iter().skip(1).step_by(2).map(|e| e[0]).collect();
    let (least, most) = one.iter().fold((f64::MAX, 0.0_f64), |(low, high), e| (low.min(*e), high.max(*e)));
    assert!(most > 1.5 * least, "{least} .. {most}");
    // Coordinates in a triangle err by some ulps of products of lengths of 20.
    assert_close("irradiance", &one, &other, 1e-4, 0.0);
}

#[test]
fn no_light_counts_twice_in_a_ball() {
    // What scatters without loss brings all that a ball sends to the ball: its mean irradiance rises by
    // reflectance + reflectance^2 times that of the lamp, whatever the medium's depth.
    let Some(gpu) = gpu() else { return };
    let scene = Scene { albedo: [1.0; 3], g: 0.0, ..Scene::new([8, 8, 8], Filling::Homogeneous, 1.0) };
    let medium = scene.medium(gpu);
    let mean = |reflectance: f64| {
        let (ball, mut lamp, irradiance) = ball_around(&scene, reflectance);
        lamp.place = Place::Point(DVec3::new(3.5, 3.5, 10.5));
        let beams = scene.propagate_behind(gpu, &medium, &[lamp], [0.0; 3], &[&ball]);
        assert_eq!(beams.get::<Beams>().beams.len(), 1);
        let found = seen(gpu, &medium, &beams, &ball, &|triangles| {
            let outwards = |(n, triangle): (usize, &[Vec3; 3])| {
                (middle(*triangle), n, middle(*triangle) - Vec3::splat(3.5))
            };
            triangles.iter().enumerate().map(outwards).collect()
        });
        found.iter().map(|e| e[0]).sum::<f64>() / found.len() as f64 / irradiance
    };
    let (black, grey) = (mean(0.0), mean(0.6));
    // Light that nothing scatters is narrow: of the rest there is some, and less than all.
    assert!(black > 0.05 && black < 1.0, "{black}");
    // As for phi inside: the ball's flat triangles (2 %) of unequal areas, and its near side (1 %); 16
    // directions see the medium 1 % too bright. Were light from patches counted twice, this were 13 % more.
    let expected = 0.6 * 1.6;
    assert!(((grey - black) / expected - 1.0).abs() < 0.05, "{} against {expected}", grey - black);
}

/// phi and F of the cells above a floor in a sky of 1 W/(m2 sr), and E on the floor's upper side.
fn under_sky(gpu: &Gpu, scene: &Scene, reflectance: f64) -> (Vec<DVec4>, f64) {
    let medium = scene.medium(gpu);
    let corner = |x: f64, y: f64| DVec3::new(400.0 * x, 400.0 * y, -2.3);
    let [a, b, c, d] = [corner(-1.0, -1.0), corner(1.0, -1.0), corner(1.0, 1.0), corner(-1.0, 1.0)];
    let floor = mesh(&scene.lattice(), &[[a, b, c], [a, c, d]], [reflectance; 3]);
    let floor = Value::new::<Mesh>(PortType::Surface, 0, floor);
    let beams = scene.propagate_behind(gpu, &medium, &[], [1.0; 3], &[&floor]);
    let inputs = [("medium", &medium), ("beams", &beams), ("surfaces", &floor)];
    let residual = output(gpu, "isotropic_residual", json!({ "quality": "reference" }), &inputs);
    let state = states(gpu, &residual).remove(0).data;
    let p = Vec3::new(1.0, 1.0, -2.3);
    let looks: Looks = &|triangles| vec![(p, around(triangles, p)[0], Vec3::NEG_Z)];
    (state, seen(gpu, &medium, &beams, &floor, looks)[0][0])
}

#[test]
fn a_black_floor_hides_the_sky_below() {
    // Of phi = 4 pi L one half is left, and F is that from above: pi L downwards.
    let Some(gpu) = gpu() else { return };
    let scene = Scene { albedo: [1.0; 3], g: 0.0, ..Scene::new([6, 5, 4], Filling::Homogeneous, 1e-4) };
    let (state, irradiance) = under_sky(gpu, &scene, 0.0);
    for light in state {
        assert_close("phi, F", &[light.x, light.w], &[2.0 * PI, -PI], 1e-3, 2e-3);
        // The half of 32 directions the golden angle apart leaves 5 % of the flux to the sides.
        assert_close("F to the sides", &[light.y, light.z], &[0.0; 2], 0.0, 0.06 * PI + 2e-3);
    }
    assert_close("E", &[irradiance], &[PI], 1e-3, 0.0);
}

#[test]
fn a_white_floor_is_as_bright_as_the_sky() {
    // Where nothing is lost radiance is that of the sky everywhere, whatever the medium's depth.
    let Some(gpu) = gpu() else { return };
    let scene = Scene { albedo: [1.0; 3], g: 0.3, ..Scene::new([8, 8, 8], Filling::Random, 3.0) };
    let (state, irradiance) = under_sky(gpu, &scene, 1.0);
    for light in state {
        assert_close("phi, F", &light.to_array(), &[4.0 * PI, 0.0, 0.0, 0.0], 0.0, 0.01 * 4.0 * PI);
    }
    assert_close("E", &[irradiance], &[PI], 0.01, 0.0);
}

#[test]
fn a_plate_inside_hides_what_the_medium_left_of_the_sky() {
    // In the middle of a medium that only absorbs, a black plate below a cell takes half of its light: that of
    // the sky through the other half of the medium, not the sky's own.
    let Some(gpu) = gpu() else { return };
    let scene = Scene { albedo: [0.0; 3], g: 0.0, ..Scene::new([9, 9, 9], Filling::Homogeneous, 0.3) };
    let medium = scene.medium(gpu);
    let phi = |surfaces: &[&Value]| {
        let beams = scene.propagate_behind(gpu, &medium, &[], [1.0; 3], surfaces);
        let mut inputs = vec![("medium", &medium), ("beams", &beams)];
        inputs.extend(surfaces.iter().map(|surface| ("surfaces", *surface)));
        let params = json!({ "quality": "reference", "directions": 50 });
        // Nothing scatters, so that it would be left out.
        let residual = full_output(gpu, "isotropic_residual", params, &inputs);
        states(gpu, &residual)[0].data[4 + 9 * (4 + 9 * 4)].x
    };
    let corners = [(-900.0, -900.0), (900.0, -900.0), (0.0, 900.0)].map(|(x, y)| DVec3::new(x, y, 3.99));
    let plate = Value::new::<Mesh>(PortType::Surface, 0, mesh(&scene.lattice(), &[corners], [0.0; 3]));
    let (open, half) = (phi(&[]), phi(&[&plate]));
    // Rays see a medium that fades over its outermost cells, the solver one that ends in steps: up to 0.04 in
    // depth, and 32 directions here are 50 there. Were the medium not in the way, a quarter were left.
    assert!((half / open - 0.5).abs() < 0.04, "{half} of {open}");
    assert!(open < 0.8 * 4.0 * PI);
}
