//! What an engine runs on, and where: rails, sleepers, ballast, a meadow.
//!
//! The meadow's triangles are small beside the track and grow with the distance from it, since light on
//! surfaces is known at their corners. Units: meters, rails along x, their tops at y = 0.

use glam::{DMat4, DVec2, DVec3, dvec2, dvec3};
use tyndall::volume::shapes::noise::{Random, fbm};

use super::solid::Solid;

/// Half of the distance between the rails' middles.
const HALF_GAUGE: f64 = 0.755;
const TRACK: [f64; 2] = [-90.0, 40.0];
/// From here on nobody sees single sleepers.
const SLEEPERS: [f64; 2] = [-45.0, 20.0];

pub fn rails() -> Solid {
    let half = [[0.035, 0.0], [0.035, -0.035], [0.01, -0.05], [0.01, -0.13], [0.07, -0.15], [0.07, -0.17]];
    let section: Vec<DVec2> =
        half.iter().rev().map(|&[z, y]| dvec2(-z, y)).chain(half.iter().map(|&[z, y]| dvec2(z, y))).collect();
    let mut rails = Solid::default();
    for z in [HALF_GAUGE, -HALF_GAUGE] {
        let places: Vec<DMat4> = spaced(TRACK[0], TRACK[1], 26)
            .map(|x| {
                DMat4::from_translation(dvec3(x, 0.0, z))
                    * DMat4::from_rotation_y(-std::f64::consts::FRAC_PI_2)
            })
            .collect();
        rails.add(&Solid::swept(&section, &places), DMat4::IDENTITY);
    }
    rails
}

pub fn sleepers() -> Solid {
    let mut sleepers = Solid::default();
    let one = Solid::block([-0.12, -0.28, -1.3], [0.12, -0.165, 1.3], 0.015);
    let n = ((SLEEPERS[1] - SLEEPERS[0]) / 0.65) as usize;
    for k in 0..n {
        sleepers.add(&one, DMat4::from_translation(dvec3(SLEEPERS[0] + 0.65 * k as f64, 0.0, 0.0)));
    }
    sleepers
}

pub fn ballast() -> Solid {
    let xs: Vec<f64> = spaced(SLEEPERS[0], SLEEPERS[1], 300).collect();
    let across = [-2.9, -2.5, -2.1, -1.8, -1.6, -1.4, -1.2, -1.0, -0.8, -0.6, -0.4, -0.2, 0.0];
    let zs: Vec<f64> = across.iter().copied().chain(across.iter().rev().skip(1).map(|z| -z)).collect();
    let mut bed = Solid::field(&xs, &zs, bed_height);
    for ends in [[TRACK[0], SLEEPERS[0]], [SLEEPERS[1], TRACK[1]]] {
        let far: Vec<f64> = spaced(ends[0], ends[1], 12).collect();
        bed.add(&Solid::field(&far, &[-2.9, -1.7, 0.0, 1.7, 2.9], bed_height), DMat4::IDENTITY);
    }
    bed
}

fn bed_height(x: f64, z: f64) -> f64 {
    let stones = noise(dvec3(5.0 * x, 0.0, 5.0 * z), 3, 5);
    let shoulder = ((z.abs() - 1.6) / 1.3).clamp(0.0, 1.0);
    -0.2 - 0.45 * shoulder + 0.035 * stones
}

/// Even ground, rising a little far away.
pub fn meadow() -> Solid {
    // Steps that grow from the track on.
    let grown = |first: f64, last: f64| {
        let mut at = vec![0.0];
        let mut step = first;
        while at[at.len() - 1] < last {
            at.push(at[at.len() - 1] + step);
            step *= 1.3;
        }
        at
    };
    let outwards = |from: f64, sense: f64, first: f64| -> Vec<f64> {
        grown(first, 900.0).into_iter().skip(1).map(|d| from + sense * d).collect()
    };
    let axis = |low: f64, high: f64, n: usize| -> Vec<f64> {
        let step = (high - low) / n as f64;
        let before = outwards(low, -1.0, step).into_iter().rev();
        before.chain(spaced(low, high, n)).chain(outwards(high, 1.0, step)).collect()
    };
    Solid::field(&axis(-22.0, 15.0, 36), &axis(-8.0, 14.0, 24), ground_height)
}

fn ground_height(x: f64, z: f64) -> f64 {
    let away = ((z.abs() - 4.0) / 60.0).clamp(0.0, 1.0);
    let hills = noise(dvec3(0.018 * x, 0.0, 0.018 * z), 3, 1);
    let uneven = noise(dvec3(0.35 * x, 0.0, 0.35 * z), 3, 2);
    -0.62 + 0.12 * uneven + 1.8 * away * hills
}

/// Tufts of grass beside the track, blade by blade.
pub fn grass() -> Solid {
    let mut random = Random::new(12);
    let mut grass = Solid::default();
    let mut n_tufts = 0;
    while n_tufts < 900 {
        // Closer to the eye there are more.
        let x = f64::from(random.within(-14.0, 12.5));
        let z = 2.95 + 8.0 * f64::from(random.unit()).powi(2);
        let thick = noise(dvec3(0.5 * x, 0.0, 0.5 * z), 2, 8) + 0.1;
        if thick < f64::from(random.within(-0.2, 0.5)) {
            continue;
        }
        n_tufts += 1;
        let foot = dvec3(x, ground_height(x, z) - 0.02, z);
        for _ in 0..4 {
            let out = random.direction().as_dvec3().with_y(0.0);
            let height = f64::from(random.within(0.1, 0.32));
            let tip = foot + height * (DVec3::Y + 0.55 * out);
            let across = 0.014 * DVec3::Y.cross(out).normalize_or(DVec3::X);
            grass.triangle([foot + 0.06 * out - across, foot + 0.06 * out + across, tip]);
        }
    }
    grass
}

fn noise(p: DVec3, octaves: u32, seed: u32) -> f64 {
    f64::from(fbm(p.as_vec3(), octaves, seed))
}

fn spaced(low: f64, high: f64, n: usize) -> impl Iterator<Item = f64> {
    (0..=n).map(move |k| low + (high - low) * k as f64 / n as f64)
}
