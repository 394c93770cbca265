//! Where the fire burns: uneven ground, a ring of stones, logs.
//!
//! The fire stands in the origin, y is up. Units: meters.

use std::f64::consts::{PI, TAU};

use glam::{DMat4, DVec3, Vec3, dvec3};
use tyndall::volume::shapes::noise::{Random, fbm};

use super::solid::Solid;

const N_STONES: usize = 17;
const RING_RADIUS: f64 = 0.62;

/// Trodden earth, 30 m wide, finer near the fire.
pub fn ground() -> Solid {
    // Cubes of even steps: 2 cm in the middle, half a meter at the rim.
    let ticks: Vec<f64> = (-70..=70).map(|n| f64::from(n) / 70.0).map(|t| t * (1.6 + 13.4 * t * t)).collect();
    Solid::field(&ticks, &ticks, height)
}

fn height(x: f64, z: f64) -> f64 {
    let p = dvec3(x, 0.0, z).as_vec3();
    let r = x.hypot(z);
    // Trodden flat around the fire, rougher further away.
    let rough = 0.35 + 0.65 * (r / 2.5).min(1.0);
    let waves = 0.1 * fbm(0.55 * p, 3, 3) + 0.035 * fbm(2.7 * p, 3, 9) + 0.016 * fbm(9.0 * p, 3, 17);
    -0.07 + rough * f64::from(waves)
}

/// A ring of field stones.
pub fn stones() -> Solid {
    let mut random = Random::new(5);
    let mut all = Solid::default();
    for n in 0..N_STONES {
        let angle = TAU * (n as f64 + 0.3 * f64::from(random.within(-1.0, 1.0))) / N_STONES as f64;
        let r = RING_RADIUS + 0.035 * f64::from(random.within(-1.0, 1.0));
        let size = f64::from(random.within(0.095, 0.145));
        let flat = f64::from(random.within(0.62, 0.85));
        let (x, z) = (r * angle.cos(), r * angle.sin());
        let turn = DMat4::from_rotation_y(TAU * f64::from(random.unit()));
        let map = DMat4::from_translation(dvec3(x, height(x, z) + 0.45 * flat * size, z))
            * turn
            * DMat4::from_scale(size * dvec3(1.15, flat, 0.95));
        all.add(&stone(7 + n as u32), map);
    }
    all
}

/// A ball of radius 1, worn by noise.
fn stone(seed: u32) -> Solid {
    let at = |i: i32, j: i32| {
        let (theta, phi) = (PI * f64::from(i) / 12.0, TAU * f64::from(j) / 20.0);
        let p = dvec3(theta.sin() * phi.cos(), theta.cos(), theta.sin() * phi.sin());
        let q = p.as_vec3() + 10.0 * Vec3::splat(seed as f32);
        p * (1.0 + 0.28 * f64::from(fbm(1.1 * q, 2, seed)) + 0.06 * f64::from(fbm(4.0 * q, 2, seed)))
    };
    let mut solid = Solid::default();
    for i in 0..12 {
        for j in 0..20 {
            let [a, b, c, d] = [at(i, j), at(i, j + 1), at(i + 1, j + 1), at(i + 1, j)];
            // At the poles one half of the square has no area.
            if i > 0 {
                solid.triangle([a, b, c]);
            }
            if i < 11 {
                solid.triangle([a, c, d]);
            }
        }
    }
    solid
}

/// Logs that lie towards the middle, each on the ring at one end.
pub fn logs() -> Solid {
    let mut all = Solid::default();
    for (angle, length, radius) in
        [(0.4, 0.62, 0.05), (1.75, 0.56, 0.042), (3.0, 0.6, 0.055), (4.4, 0.5, 0.045), (5.5, 0.64, 0.05)]
    {
        let out = dvec3(f64::cos(angle), 0.0, f64::sin(angle));
        let side = dvec3(-out.z, 0.0, out.x);
        let points: Vec<DVec3> = (0..=6)
            .map(|n| {
                let t = f64::from(n) / 6.0;
                let bend = 0.02 * (PI * t + angle).sin();
                (0.1 + length * t) * out + bend * side + (0.02 + 0.15 * t) * DVec3::Y
            })
            .collect();
        all.add(&Solid::pipe(&points, radius, 14), DMat4::IDENTITY);
    }
    all
}
