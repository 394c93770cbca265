//! What an engine pulls: a tender with its coal, coaches. Units: meters.

use std::f64::consts::{FRAC_PI_2, PI};

use glam::{DMat4, DVec2, dvec2, dvec3};

use super::locomotive::{Paints, at, sideways, upright};
use super::running_gear::wheel;
use super::solid::Solid;

pub fn tender(paints: &mut Paints) {
    let same = DMat4::IDENTITY;
    paints.black.add(&Solid::block([-14.6, 1.05, -1.3], [-7.95, 1.35, 1.3], 0.02), same);
    paints.green.add(&Solid::block([-14.5, 1.35, -1.42], [-8.3, 2.95, 1.42], 0.06), same);
    for side in [1.0, -1.0] {
        // The sides lean out above.
        let flare: Vec<DVec2> = (0..=6)
            .map(|n| f64::from(n) / 6.0)
            .map(|t| dvec2(-side * (1.36 + 0.16 * t * t), 2.9 + 0.42 * t))
            .collect();
        let places = [-14.5, -8.3].map(|x| at(x, 0.0, 0.0) * DMat4::from_rotation_y(-FRAC_PI_2));
        let outer: Vec<DVec2> = flare.iter().map(|p| dvec2(-p.x, p.y)).collect();
        paints.green.add(&Solid::swept(&outer, &places), same);
        paints.brass.add(
            &Solid::pipe(&[dvec3(-14.5, 3.33, side * 1.52), dvec3(-8.3, 3.33, side * 1.52)], 0.025, 8),
            same,
        );
        let there = DMat4::from_scale(dvec3(1.0, 1.0, side));
        paints.red.add(&Solid::block([-14.3, 0.55, 0.98], [-8.2, 1.1, 1.03], 0.01), there);
        for x in [-9.1, -11.2, -13.3] {
            paints.red.add(&wheel(0.6, 10, 30), there * at(x, 0.6, 0.76));
            paints.black.add(&Solid::block([x - 0.14, 0.42, 1.03], [x + 0.14, 0.78, 1.18], 0.03), there);
            for n in 0..4 {
                let y = 0.86 + 0.045 * f64::from(n);
                let half = 0.55 - 0.1 * f64::from(n);
                paints
                    .black
                    .add(&Solid::block([x - half, y, 1.06], [x + half, y + 0.035, 1.14], 0.008), there);
            }
        }
    }
    paints.green.add(&Solid::block([-8.34, 2.9, -1.42], [-8.28, 3.2, 1.42], 0.01), same);
}

/// A coach whose front end is at this place.
pub fn coach(paints: &mut Paints, front: f64) {
    let same = DMat4::IDENTITY;
    let (back, middle) = (front - 18.6, front - 9.3);
    paints.black.add(&Solid::block([back + 0.3, 0.75, -1.25], [front - 0.3, 1.15, 1.25], 0.02), same);
    paints.maroon.add(&Solid::block([back, 1.1, -1.42], [front, 2.35, 1.42], 0.05), same);
    paints.cream.add(&Solid::block([back + 0.02, 2.33, -1.4], [front - 0.02, 3.42, 1.4], 0.05), same);
    for side in [1.0, -1.0] {
        for n in 0..11 {
            let x = front - 1.6 - 1.54 * f64::from(n);
            let z = side * 1.4;
            paints
                .black
                .add(&Solid::block([x - 0.42, 2.45, z - 0.02], [x + 0.42, 3.25, z + 0.02], 0.005), same);
            // Doors stand out a little.
            if n % 3 == 0 {
                paints.maroon.add(
                    &Solid::block(
                        [x - 0.6, 1.15, side * 1.42 - 0.03],
                        [x + 0.6, 2.4, side * 1.42 + 0.03],
                        0.015,
                    ),
                    same,
                );
                paints.brass.add(
                    &Solid::block(
                        [x + 0.4, 1.9, side * 1.46 - 0.02],
                        [x + 0.5, 1.96, side * 1.46 + 0.02],
                        0.006,
                    ),
                    same,
                );
            }
        }
        paints.brass.add(
            &Solid::block([back, 2.32, side * 1.43 - 0.015], [front, 2.38, side * 1.43 + 0.015], 0.005),
            same,
        );
        for x in [front - 2.5, front - 5.0, back + 5.0, back + 2.5] {
            let disk = [
                [-0.07, 0.53],
                [-0.04, 0.53],
                [-0.03, 0.5],
                [0.07, 0.49],
                [0.07, 0.42],
                [0.03, 0.4],
                [0.08, 0.12],
                [0.08, 0.0],
            ];
            paints.black.add(&Solid::turned(&disk, 20), at(x, 0.5, side * 0.76) * sideways(side));
        }
        for x in [front - 3.75, back + 3.75] {
            paints.black.add(
                &Solid::block([x - 1.8, 0.45, side * 0.98 - 0.04], [x + 1.8, 0.75, side * 0.98 + 0.04], 0.02),
                same,
            );
        }
    }
    // The roof, its ends rounded down.
    let arc: Vec<DVec2> = (0..=16)
        .map(|n| -1.0 + 2.0 * f64::from(n) / 16.0)
        .map(|t| dvec2(1.5 * t, 0.5 * (1.0 - t * t).sqrt()))
        .collect();
    let places =
        [(-9.45, 0.2), (-9.2, 0.8), (-8.6, 1.0), (8.6, 1.0), (9.2, 0.8), (9.45, 0.2)].map(|(x, high)| {
            at(middle + x, 3.38, 0.0)
                * DMat4::from_rotation_y(FRAC_PI_2)
                * DMat4::from_scale(dvec3(1.0, high, 1.0))
        });
    paints.black.add(&Solid::swept(&arc, &places), same);
    for n in 0..4 {
        let vent = [[0.0, 0.16], [0.1, 0.16], [0.14, 0.1], [0.2, 0.1], [0.22, 0.0]];
        paints
            .black
            .add(&Solid::turned(&vent, 12), at(middle - 6.0 + 4.0 * f64::from(n), 3.84, 0.0) * upright());
    }
    for side in [1.0, -1.0] {
        paints.black.add(
            &Solid::turned(&[[0.0, 0.1], [0.55, 0.08], [0.57, 0.22], [0.6, 0.0]], 20),
            at(front, 1.1, side * 0.85),
        );
    }
}

/// A heap of coal on the tender.
pub fn coal() -> Solid {
    let steps = |low: f64, high: f64, n: usize| -> Vec<f64> {
        (0..=n).map(|k| low + (high - low) * k as f64 / n as f64).collect()
    };
    let lump = |x: f64, z: f64| {
        let hash = |a: f64, b: f64| ((a * 127.1 + b * 311.7).sin() * 43758.5453).fract().abs();
        hash((x * 9.0).floor(), (z * 9.0).floor())
    };
    Solid::field(&steps(-13.2, -8.35, 44), &steps(-1.38, 1.38, 26), |x, z| {
        let along = ((x + 13.2) / 4.85).clamp(0.0, 1.0);
        let heap = 0.75 * (1.0 - (z / 1.5).powi(2)).max(0.0) * (along * PI).sin().max(0.0).sqrt();
        2.85 + heap + 0.14 * lump(x, z)
    })
}
