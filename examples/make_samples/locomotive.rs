//! A steam engine of no real class, with its train: two axles ahead, three driven ones.
//!
//! It stands on rails along x whose tops lie at y = 0, heads for +x, and its chimney is above x = 3.35.
//! One mesh for each paint. Units: meters.

use std::f64::consts::{FRAC_PI_2, PI};

use glam::{DMat4, DVec2, DVec3, dvec2, dvec3};

use super::solid::Solid;
use super::{rolling_stock, running_gear};

/// The parts of each paint.
#[derive(Default)]
pub struct Paints {
    pub green: Solid,
    pub maroon: Solid,
    pub cream: Solid,
    pub black: Solid,
    pub red: Solid,
    pub brass: Solid,
    pub steel: Solid,
}

/// Where the steam comes out.
pub const CHIMNEY_TOP: DVec3 = dvec3(3.35, 4.42, 0.0);

const BOILER_Y: f64 = 2.72;
pub const DRIVER_RADIUS: f64 = 0.92;
pub const DRIVER_X: [f64; 3] = [0.55, -1.5, -3.55];
/// Faces around the boiler.
const ROUND: usize = 72;

pub fn engine() -> Paints {
    let mut paints = Paints::default();
    boiler(&mut paints);
    mountings(&mut paints);
    frame(&mut paints);
    cab(&mut paints);
    for side in [1.0, -1.0] {
        running_gear::one_side(&mut paints, side);
    }
    rolling_stock::tender(&mut paints);
    for x in [-15.4, -34.6] {
        rolling_stock::coach(&mut paints, x);
    }
    paints
}

pub fn at(x: f64, y: f64, z: f64) -> DMat4 {
    DMat4::from_translation(dvec3(x, y, z))
}

/// Turns the x axis upwards.
pub fn upright() -> DMat4 {
    DMat4::from_rotation_z(FRAC_PI_2)
}

/// Turns the x axis to +z, or to −z.
pub fn sideways(side: f64) -> DMat4 {
    DMat4::from_rotation_y(-side * FRAC_PI_2)
}

fn boiler(paints: &mut Paints) {
    let axis = at(0.0, BOILER_Y, 0.0);
    let barrel = [[-4.4, 0.88], [-1.2, 0.86], [2.35, 0.82]];
    paints.green.add(&Solid::turned(&barrel, ROUND), axis);
    let radius = |x: f64| 0.865 - (x + 1.2) * if x < -1.2 { 0.00625 } else { 0.0127 };
    for x in [-3.9, -2.7, -1.2, 0.1, 1.3] {
        let r = radius(x);
        let band = [[x - 0.05, r - 0.01], [x - 0.04, r + 0.014], [x + 0.04, r + 0.014], [x + 0.05, r - 0.01]];
        paints.brass.add(&Solid::turned(&band, ROUND), axis);
    }
    let smokebox = [
        [2.33, 0.8],
        [2.35, 0.885],
        [2.38, 0.895],
        [4.03, 0.895],
        [4.08, 0.88],
        [4.1, 0.85],
        [4.1, 0.72],
        [4.13, 0.7],
        [4.2, 0.6],
        [4.255, 0.42],
        [4.28, 0.2],
        [4.285, 0.0],
    ];
    paints.black.add(&Solid::turned(&smokebox, ROUND), axis);
    paints.brass.add(&Solid::ring(0.71, [0.05, 0.05], ROUND), axis * at(4.12, 0.0, 0.0));
    // Hinges, the bar that locks the door, its handwheel.
    for y in [0.28, -0.28] {
        let strap = [dvec3(4.15, y, 0.72), dvec3(4.265, y, 0.3), dvec3(4.275, y, -0.1)];
        paints.steel.add(&Solid::pipe(&strap, 0.025, 6), axis);
    }
    paints.steel.add(&Solid::turned(&[[4.27, 0.0], [4.27, 0.07], [4.34, 0.05], [4.34, 0.0]], 16), axis);
    paints.steel.add(&Solid::ring(0.15, [0.03, 0.03], 24), axis * at(4.36, 0.0, 0.0));
    let spoke = |angle: f64| dvec3(4.36, 0.15 * angle.sin(), 0.15 * angle.cos());
    for angle in [0.4, 0.4 + FRAC_PI_2] {
        paints.steel.add(&Solid::pipe(&[spoke(angle), spoke(angle + PI)], 0.014, 6), axis);
    }
    // The firebox: a barrel's upper half on straight walls.
    let arch: Vec<DVec2> =
        (0..=28).map(|n| PI * f64::from(n) / 28.0).map(|t| dvec2(0.93 * t.cos(), 0.93 * t.sin())).collect();
    let outline = [vec![dvec2(-0.93, -1.15), dvec2(0.93, -1.15)], arch].concat();
    let shell = Solid::plate(&outline, 1.95, 0.04);
    paints.green.add(&shell, at(-5.2, BOILER_Y, 0.0) * DMat4::from_rotation_y(FRAC_PI_2));
    for x in [-4.32, -5.2] {
        let band: Vec<DVec2> = outline.iter().map(|p| *p * 1.012).collect();
        let band = Solid::plate(&band, 0.08, 0.01);
        paints.brass.add(&band, at(x, BOILER_Y, 0.0) * DMat4::from_rotation_y(FRAC_PI_2));
    }
    // Below the smokebox its saddle, and the pipes that bring the steam.
    paints.black.add(&Solid::block([2.6, 1.0, -0.62], [3.9, 2.2, 0.62], 0.06), DMat4::IDENTITY);
    for side in [1.0, -1.0] {
        let pipe: Vec<DVec3> = (0..=8)
            .map(|n| FRAC_PI_2 * f64::from(n) / 8.0)
            .map(|t| {
                dvec3(3.0, 2.6 - 0.75 * (1.0 - t.cos()) - 0.15 * t.sin(), side * (0.75 + 0.42 * t.sin()))
            })
            .chain([dvec3(3.0, 1.35, side * 1.17)])
            .collect();
        paints.black.add(&Solid::pipe(&pipe, 0.13, 16), DMat4::IDENTITY);
    }
}

/// What stands on the boiler.
fn mountings(paints: &mut Paints) {
    let on_top = |x: f64, y: f64| at(x, y, 0.0) * upright();
    let chimney = [
        [-0.12, 0.62],
        [-0.02, 0.45],
        [0.1, 0.335],
        [0.22, 0.3],
        [0.62, 0.325],
        [0.68, 0.33],
        [0.7, 0.395],
        [0.78, 0.405],
        [0.83, 0.385],
        [0.84, 0.33],
        [0.84, 0.29],
        [0.3, 0.25],
        [0.3, 0.0],
    ];
    paints.black.add(&Solid::turned(&chimney, 48), on_top(CHIMNEY_TOP.x, CHIMNEY_TOP.y - 0.84));
    paints.brass.add(&Solid::ring(0.405, [0.09, 0.06], 48), on_top(CHIMNEY_TOP.x, CHIMNEY_TOP.y - 0.1));
    let dome = |height: f64, radius: f64| -> Vec<[f64; 2]> {
        let foot = [[-0.1, 1.7 * radius], [0.0, 1.25 * radius], [0.08, 1.04 * radius], [0.16, radius]];
        let cap = (0..=8).map(|n| FRAC_PI_2 * f64::from(n) / 8.0);
        let cap = cap.map(|t| [height - radius * 0.85 * (1.0 - t.sin()), radius * t.cos()]);
        foot.into_iter().chain(cap).collect()
    };
    paints.brass.add(&Solid::turned(&dome(0.85, 0.42), 48), on_top(0.5, 3.5));
    paints.green.add(&Solid::turned(&dome(0.62, 0.4), 48), on_top(-2.0, 3.52));
    for z in [0.2, -0.2] {
        let valve =
            [[0.0, 0.12], [0.1, 0.1], [0.12, 0.07], [0.4, 0.06], [0.42, 0.1], [0.5, 0.09], [0.52, 0.0]];
        paints.brass.add(&Solid::turned(&valve, 20), at(-4.75, 3.6, z) * upright());
    }
    let whistle = [[0.0, 0.03], [0.22, 0.03], [0.23, 0.06], [0.48, 0.06], [0.5, 0.0]];
    paints.brass.add(&Solid::turned(&whistle, 16), at(-5.3, 3.62, 0.35) * upright());
    for side in [1.0, -1.0] {
        // Hand rails along the boiler and on their posts.
        let rail: Vec<DVec3> =
            [-5.3, -2.0, 1.5, 3.9].map(|x| dvec3(x, BOILER_Y + 0.42, side * 0.98)).to_vec();
        paints.steel.add(&Solid::pipe(&rail, 0.02, 8), DMat4::IDENTITY);
        for x in [-5.0, -3.3, -1.6, 0.1, 1.8, 3.5] {
            let post = [dvec3(x, BOILER_Y + 0.36, side * 0.76), dvec3(x, BOILER_Y + 0.42, side * 0.99)];
            paints.steel.add(&Solid::pipe(&post, 0.016, 6), DMat4::IDENTITY);
        }
        // Sand from its dome to the wheels.
        for x in [-1.75, -2.25] {
            let pipe: Vec<DVec3> = (0..=10)
                .map(|n| 0.25 + 1.65 * f64::from(n) / 10.0)
                .map(|t| dvec3(x, BOILER_Y + 0.9 * t.cos(), side * 0.9 * t.sin()))
                .collect();
            paints.black.add(&Solid::pipe(&pipe, 0.025, 6), DMat4::IDENTITY);
        }
        lamp(paints, dvec3(4.36, 1.62, side * 0.85));
    }
    lamp(paints, dvec3(4.0, 3.72, 0.0));
}

/// A lamp that looks ahead.
fn lamp(paints: &mut Paints, foot: DVec3) {
    let body =
        [[-0.16, 0.0], [-0.16, 0.1], [-0.12, 0.13], [0.1, 0.15], [0.14, 0.17], [0.16, 0.17], [0.16, 0.14]];
    let middle = foot + dvec3(0.0, 0.2, 0.0);
    paints.black.add(&Solid::turned(&body, 24), DMat4::from_translation(middle));
    paints
        .brass
        .add(&Solid::ring(0.155, [0.04, 0.04], 24), DMat4::from_translation(middle + 0.16 * DVec3::X));
    paints
        .steel
        .add(&Solid::turned(&[[0.11, 0.15], [0.09, 0.07], [0.08, 0.0]], 24), DMat4::from_translation(middle));
    let chimney = [[0.12, 0.06], [0.22, 0.05], [0.22, 0.075], [0.25, 0.0]];
    paints.black.add(&Solid::turned(&chimney, 16), DMat4::from_translation(middle) * upright());
    paints.black.add(&Solid::pipe(&[foot - 0.1 * DVec3::Y, middle], 0.035, 8), DMat4::IDENTITY);
}

fn frame(paints: &mut Paints) {
    let same = DMat4::IDENTITY;
    for z in [0.6, -0.6] {
        paints.red.add(&Solid::block([-7.3, 0.75, z - 0.02], [4.3, 1.35, z + 0.02], 0.008), same);
    }
    for side in [1.0, -1.0] {
        // The running board steps down to the front.
        let [low, high]: [f64; 2] = if side > 0.0 { [0.75, 1.42] } else { [-1.42, -0.75] };
        paints.black.add(&Solid::block([-5.7, 1.6, low], [2.1, 1.645, high], 0.01), same);
        paints.red.add(
            &Solid::block([-5.7, 1.5, side * 1.4 - 0.015], [2.1, 1.645, side * 1.4 + 0.015], 0.006),
            same,
        );
        let slope = Solid::bar(
            dvec3(2.07, 1.625, side * 1.085),
            dvec3(2.75, 1.485, side * 1.085),
            DVec3::Z,
            [0.67, 0.04],
            0.01,
        );
        paints.black.add(&slope, same);
        paints.black.add(&Solid::block([2.7, 1.46, low], [4.5, 1.505, high], 0.01), same);
        // Splashers over the wheels.
        for x in DRIVER_X {
            let r = DRIVER_RADIUS + 0.1;
            let from = (1.62 - DRIVER_RADIUS) / r;
            let (start, end) = (from.asin(), PI - from.asin());
            let outline: Vec<DVec2> = (0..=20)
                .map(|n| start + (end - start) * f64::from(n) / 20.0)
                .map(|t| r * dvec2(t.cos(), t.sin()))
                .collect();
            let splasher = Solid::plate(&outline, 0.3, 0.02);
            paints.green.add(&splasher, at(x, DRIVER_RADIUS, side * 0.88));
        }
        // Steps up to the cab and to the front.
        for (x, y) in [(-6.6, 0.45), (-6.6, 0.85), (3.6, 0.75)] {
            paints.black.add(
                &Solid::block(
                    [x - 0.2, y, side * 1.22 - 0.16],
                    [x + 0.2, y + 0.04, side * 1.22 + 0.16],
                    0.01,
                ),
                same,
            );
        }
        paints.black.add(
            &Solid::block([-6.8, 0.45, side * 1.08 - 0.01], [-6.4, 1.95, side * 1.08 + 0.01], 0.004),
            same,
        );
    }
    // Buffer beam, buffers, hook and hose.
    paints.red.add(&Solid::block([4.32, 0.78, -1.42], [4.5, 1.5, 1.42], 0.02), same);
    for side in [1.0, -1.0] {
        let buffer = [
            [4.48, 0.0],
            [4.48, 0.21],
            [4.53, 0.2],
            [4.55, 0.14],
            [4.82, 0.125],
            [4.84, 0.09],
            [5.02, 0.08],
            [5.03, 0.24],
            [5.06, 0.25],
            [5.09, 0.2],
            [5.1, 0.0],
        ];
        paints.black.add(&Solid::turned(&buffer, 32), at(0.0, 1.12, side * 0.9));
        let guard =
            [dvec3(4.2, 0.9, side * 0.72), dvec3(4.45, 0.5, side * 0.72), dvec3(4.5, 0.14, side * 0.72)];
        paints.black.add(&Solid::pipe(&guard, 0.05, 8), same);
    }
    paints
        .steel
        .add(&Solid::bar(dvec3(4.5, 1.12, 0.0), dvec3(4.85, 1.12, 0.0), DVec3::Y, [0.14, 0.06], 0.015), same);
    let chain: Vec<DVec3> = (0..=8)
        .map(|n| PI * f64::from(n) / 8.0)
        .map(|t| dvec3(4.7 + 0.05 * t.cos(), 1.1 - 0.42 * t.sin(), 0.14 * t.cos()))
        .collect();
    paints.steel.add(&Solid::pipe(&chain, 0.025, 8), same);
    let hose: Vec<DVec3> = (0..=10)
        .map(|n| PI * f64::from(n) / 10.0)
        .map(|t| dvec3(4.62 + 0.06 * t.sin(), 1.15 - 0.5 * t.sin(), 0.32 + 0.12 * (1.0 - t.cos())))
        .collect();
    paints.black.add(&Solid::pipe(&hose, 0.04, 8), same);
}

fn cab(paints: &mut Paints) {
    let same = DMat4::IDENTITY;
    for side in [1.0, -1.0] {
        let z = side * 1.4;
        let mut wall = |low: [f64; 2], high: [f64; 2]| {
            let low = [low[0], low[1], z - 0.025];
            paints.green.add(&Solid::block(low, [high[0], high[1], z + 0.025], 0.01), same);
        };
        // Around a window, and a door open to the back.
        wall([-7.35, 1.5], [-5.55, 2.65]);
        wall([-5.95, 2.65], [-5.55, 3.62]);
        wall([-7.0, 2.65], [-6.85, 3.62]);
        wall([-6.85, 3.4], [-5.95, 3.62]);
        for (from, to) in [
            ([-5.95, 2.65], [-5.95, 3.4]),
            ([-6.85, 2.65], [-6.85, 3.4]),
            ([-6.85, 2.65], [-5.95, 2.65]),
            ([-6.85, 3.4], [-5.95, 3.4]),
        ] {
            let p = |at: [f64; 2]| dvec3(at[0], at[1], side * 1.43);
            paints.brass.add(&Solid::pipe(&[p(from), p(to)], 0.02, 6), same);
        }
        let pole = [dvec3(-7.3, 1.9, side * 1.46), dvec3(-7.3, 3.0, side * 1.46)];
        paints.steel.add(&Solid::pipe(&pole, 0.02, 8), same);
        // The front wall beside the firebox, with a window.
        let low = |z: f64, width: f64| [z - 0.5 * width, z + 0.5 * width];
        for ([z0, z1], y) in [
            (low(side * 1.16, 0.5), [1.5, 2.9]),
            (low(side * 1.0, 0.16), [2.9, 3.5]),
            (low(side * 1.36, 0.1), [2.9, 3.5]),
        ] {
            paints.green.add(&Solid::block([-5.6, y[0], z0], [-5.55, y[1], z1], 0.01), same);
        }
    }
    // A roof that is a part of a cylinder.
    let arc = |r: f64| {
        (0..=24)
            .map(move |n| -0.72 + 1.44 * f64::from(n) / 24.0)
            .map(move |t| dvec2(r * t.sin(), r * t.cos()))
    };
    let outline: Vec<DVec2> = arc(2.3).chain(arc(2.24).collect::<Vec<_>>().into_iter().rev()).collect();
    let places = [-7.75, -5.35].map(|x| at(x, 1.83, 0.0) * DMat4::from_rotation_y(FRAC_PI_2));
    let closed = [outline.clone(), vec![outline[0]]].concat();
    paints.black.add(&Solid::swept(&closed, &places), same);
    let front: Vec<DVec2> = arc(2.24).chain([dvec2(1.4, 1.7), dvec2(-1.4, 1.7)]).collect();
    paints
        .green
        .add(&Solid::plate(&front, 0.04, 0.005), at(-5.58, 1.83, 0.0) * DMat4::from_rotation_y(FRAC_PI_2));
    paints.black.add(&Solid::block([-7.7, 1.42, -1.38], [-5.6, 1.5, 1.38], 0.01), same);
}
