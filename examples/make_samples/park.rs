//! A park at night: a path between lanterns and bare trees, and the mist over it; a wall with a hole.
//!
//! The path runs along −z, y is up. Units: meters; the mist's density is from 0 to about 1.

use std::f64::consts::{PI, TAU};

use glam::{DMat4, DVec2, DVec3, IVec3, Vec3, dvec2, dvec3};
use rayon::prelude::*;
use tyndall::volume::grid::Grid;
use tyndall::volume::shapes::noise::{Random, fbm, smoothstep};

use super::solid::Solid;

const LANTERN_X: f64 = 1.7;
const LANTERNS_Z: [f64; 6] = [2.4, -0.6, -3.6, -6.6, -9.6, -12.6];

/// Mist that lies on the ground and gets thin above.
pub fn mist() -> Grid {
    let voxel_m = 0.15;
    let (low, dims) = (dvec3(-7.0, 0.0, -17.0), [94, 26, 147]);
    let map = DMat4::from_translation(low) * DMat4::from_scale(DVec3::splat(voxel_m));
    let mut values = vec![0.0; dims.iter().product()];
    values.par_chunks_mut(dims[0]).enumerate().for_each(|(row, values)| {
        for (i, value) in values.iter_mut().enumerate() {
            let index = dvec3(i as f64, (row % dims[1]) as f64, (row / dims[1]) as f64);
            let p = map.transform_point3(index).as_vec3();
            let banks = fbm(Vec3::new(0.28 * p.x, 0.7 * p.y, 0.28 * p.z), 5, 40);
            let top = 1.9 + 1.5 * fbm(Vec3::new(0.22 * p.x, 0.0, 0.22 * p.z), 3, 50);
            let height = smoothstep(top + 0.9, top - 1.4, p.y);
            // Nothing at the sides, so that no edge is seen.
            let out = [(p.x.abs() - 5.2) / 1.6, (p.z - 2.5) / 2.4, (-14.0 - p.z) / 2.8];
            let sides: f32 = out.iter().map(|&t| smoothstep(1.0, 0.0, t)).product();
            let density = sides * height * smoothstep(-0.55, 0.6, banks);
            *value = if density < 0.004 { 0.0 } else { (density * 256.0).round() / 256.0 };
        }
    });
    Grid::from_dense("density", 0.0, map, IVec3::ZERO, dims, &values)
}

/// Posts with a lantern on each, which is open at its sides: the light hangs 2.3 m high in its middle.
pub fn lanterns() -> Solid {
    let mut lanterns = Solid::default();
    let upright = DMat4::from_rotation_z(0.5 * PI);
    let post = [
        [0.0, 0.14],
        [0.1, 0.14],
        [0.14, 0.1],
        [0.3, 0.075],
        [0.34, 0.05],
        [1.9, 0.035],
        [1.93, 0.06],
        [1.98, 0.06],
        [2.0, 0.03],
        [2.04, 0.05],
        [2.06, 0.13],
        [2.08, 0.13],
        [2.08, 0.0],
    ];
    let roof = [[2.5, 0.2], [2.53, 0.21], [2.66, 0.07], [2.7, 0.03], [2.76, 0.035], [2.8, 0.0]];
    let mut one = Solid::default();
    one.add(&Solid::turned(&post, 12), upright);
    one.add(&Solid::turned(&roof, 12), upright);
    for n in 0..6 {
        let t = TAU * f64::from(n) / 6.0;
        let out = dvec3(t.cos(), 0.0, t.sin());
        one.add(
            &Solid::pipe(&[0.12 * out + 2.07 * DVec3::Y, 0.18 * out + 2.52 * DVec3::Y], 0.008, 4),
            DMat4::IDENTITY,
        );
    }
    for (x, z) in LANTERNS_Z.iter().flat_map(|&z| [(-LANTERN_X, z), (LANTERN_X, z)]) {
        lanterns.add(&one, DMat4::from_translation(dvec3(x, 0.0, z)));
    }
    lanterns
}

pub fn trees() -> Solid {
    let mut random = Random::new(31);
    let mut trees = Solid::default();
    for (x, z) in
        [(-3.6, 0.6), (3.9, -0.9), (-4.3, -3.6), (4.6, -5.2), (-3.5, -7.2), (3.4, -9.4), (-4.8, -10.6)]
    {
        let trunk = dvec3(x, -0.1, z);
        branch(&mut trees, &mut random, trunk, DVec3::Y, 1.7, 0.16, 0);
    }
    trees
}

/// A limb and what grows out of it.
fn branch(
    trees: &mut Solid,
    random: &mut Random,
    from: DVec3,
    along: DVec3,
    length: f64,
    radius: f64,
    level: usize,
) {
    let mut bend = || 0.16 * random.direction().as_dvec3();
    let middle = from + length * (0.5 * along + 0.5 * bend());
    let to = from + length * (along + bend());
    let sides = [9, 7, 5, 4, 3][level];
    trees.add(
        &Solid::limb(&[from, middle, to], &[radius, 0.82 * radius, 0.66 * radius], sides),
        DMat4::IDENTITY,
    );
    if level == 4 {
        return;
    }
    for _ in 0..[3, 3, 3, 2][level] {
        let out = (along + 0.85 * random.direction().as_dvec3() + 0.12 * DVec3::Y).normalize();
        let share = f64::from(random.within(0.6, 0.82));
        branch(trees, random, to, out, share * length, 0.62 * radius, level + 1);
    }
}

/// Lawn on both sides of the path, and the path.
pub fn grounds() -> [Solid; 2] {
    let grid = |from: f64, to: f64, n: usize| -> Vec<f64> {
        (0..=n).map(|k| from + (to - from) * k as f64 / n as f64).collect()
    };
    let rough = |x: f64, z: f64| f64::from(fbm(Vec3::new(0.9 * x as f32, 0.0, 0.9 * z as f32), 3, 60));
    let mut lawn = Solid::default();
    for side in [-1.0, 1.0] {
        let xs = grid(side * 1.15, side * 12.0, 36);
        lawn.add(&Solid::field(&xs, &grid(-24.0, 7.0, 80), |x, z| 0.05 * rough(x, z)), DMat4::IDENTITY);
    }
    let path = Solid::field(&grid(-1.2, 1.2, 8), &grid(-24.0, 7.0, 80), |x, z| {
        0.05 - 0.03 * x * x + 0.01 * rough(4.0 * x, 4.0 * z)
    });
    [lawn, path]
}

/// A wall across x with a round hole around the x axis.
pub fn wall() -> Solid {
    let (half, radius, n) = (4.0, 0.13, 64);
    let ring = |r: f64| -> Vec<DVec2> {
        (0..=n).map(|k| TAU * f64::from(k) / f64::from(n)).map(|t| r * dvec2(t.cos(), t.sin())).collect()
    };
    let square: Vec<DVec2> = ring(1.0).iter().map(|p| *p * half / p.abs().max_element()).collect();
    let turned = DMat4::from_rotation_y(0.5 * PI);
    let mut wall = Solid::default();
    wall.add(&Solid::between(&ring(radius), &square), turned);
    wall
}
