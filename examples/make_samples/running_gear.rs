//! What moves below an engine: spoked wheels, cylinders, rods, valve gear. Units: meters.

use std::f64::consts::{FRAC_PI_2, TAU};

use glam::{DMat4, DVec2, DVec3, dvec2, dvec3};

use super::locomotive::{DRIVER_RADIUS, DRIVER_X, Paints, at, sideways};
use super::solid::Solid;

const CRANK: f64 = 0.34;
/// Angle of the cranks from +x, on the side of +z; those of the other side follow by a quarter.
const CRANK_ANGLE: f64 = -0.55;

/// A spoked wheel in the xy plane, its outer side at +z.
pub fn wheel(radius: f64, n_spokes: usize, n_faces: usize) -> Solid {
    let mut wheel = Solid::default();
    let r = radius;
    let rim = [
        [-0.07, r - 0.08],
        [-0.07, r + 0.03],
        [-0.04, r + 0.03],
        [-0.03, r],
        [0.06, r - 0.006],
        [0.07, r - 0.02],
        [0.07, r - 0.08],
        [0.045, r - 0.105],
        [-0.045, r - 0.105],
        [-0.07, r - 0.08],
    ];
    wheel.add(&Solid::turned(&rim, n_faces), sideways(1.0));
    let hub =
        [[-0.08, 0.0], [-0.08, 0.17], [0.08, 0.17], [0.1, 0.14], [0.1, 0.08], [0.13, 0.07], [0.13, 0.0]];
    wheel.add(&Solid::turned(&hub, 14), sideways(1.0));
    let spoke = [dvec2(0.12, -0.06), dvec2(r - 0.09, -0.034), dvec2(r - 0.09, 0.034), dvec2(0.12, 0.06)];
    let spoke = Solid::plate(&spoke, 0.075, 0.018);
    for n in 0..n_spokes {
        wheel.add(&spoke, DMat4::from_rotation_z(TAU * (n as f64 + 0.5) / n_spokes as f64));
    }
    wheel
}

/// Wheels, cylinder and rods of one side.
pub fn one_side(paints: &mut Paints, side: f64) {
    let angle = CRANK_ANGLE + if side > 0.0 { 0.0 } else { FRAC_PI_2 };
    // What is made for +z stands mirrored on the other side.
    let there = DMat4::from_scale(dvec3(1.0, 1.0, side));
    let pin = CRANK * dvec3(angle.cos(), angle.sin(), 0.0);
    let driver = wheel(DRIVER_RADIUS, 17, 44);
    // Across the axle from the pin hangs the counterweight.
    let weight: Vec<DVec2> = (0..=12)
        .map(|n| 0.62 * (f64::from(n) / 6.0 - 1.0))
        .map(|t| (DRIVER_RADIUS - 0.1) * dvec2(-t.cos(), t.sin()))
        .collect();
    let weight = Solid::plate(&weight, 0.12, 0.015);
    for x in DRIVER_X {
        let axle = there * at(x, DRIVER_RADIUS, 0.76);
        paints.red.add(&driver, axle);
        paints.red.add(&weight, axle * DMat4::from_rotation_z(angle));
        let boss = [[0.0, 0.15], [0.1, 0.14], [0.12, 0.07], [0.3, 0.07], [0.31, 0.0]];
        paints.steel.add(&Solid::turned(&boss, 20), axle * DMat4::from_translation(pin) * sideways(1.0));
    }
    let small = wheel(0.48, 10, 28);
    for x in [2.15, 3.95] {
        paints.red.add(&small, there * at(x, 0.48, 0.76));
    }
    paints.black.add(&Solid::block([2.2, 0.6, 0.9], [3.9, 0.78, 1.0], 0.02), there);
    // Coupling rods from pin to pin, a boss at each.
    let eye = [[-0.045, 0.0], [-0.045, 0.09], [-0.03, 0.115], [0.03, 0.115], [0.045, 0.09], [0.045, 0.0]];
    let on_pin = |x: f64, z: f64| dvec3(x, DRIVER_RADIUS, z) + pin;
    for pair in DRIVER_X.windows(2) {
        let bar = Solid::bar(on_pin(pair[0], 0.94), on_pin(pair[1], 0.94), DVec3::Y, [0.13, 0.06], 0.014);
        paints.steel.add(&bar, there);
    }
    for x in DRIVER_X {
        paints
            .steel
            .add(&Solid::turned(&eye, 24), there * DMat4::from_translation(on_pin(x, 0.94)) * sideways(1.0));
    }
    // The connecting rod drives the middle axle; its crosshead slides on the cylinder's axis.
    let (big_end, rod) = (on_pin(DRIVER_X[1], 1.07), 3.1);
    let axis_y = 0.98;
    let crosshead = dvec3(big_end.x + (rod * rod - (big_end.y - axis_y).powi(2)).sqrt(), axis_y, 1.07);
    paints.steel.add(&Solid::bar(big_end, crosshead, DVec3::Y, [0.15, 0.06], 0.015), there);
    for p in [big_end, crosshead] {
        paints.steel.add(&Solid::turned(&eye, 24), there * DMat4::from_translation(p) * sideways(1.0));
    }
    paints.steel.add(
        &Solid::block([-0.16, -0.2, -0.09], [0.22, 0.2, 0.09], 0.03),
        there * DMat4::from_translation(crosshead),
    );
    paints.steel.add(&Solid::pipe(&[crosshead, dvec3(2.5, axis_y, 1.07)], 0.05, 16), there);
    for y in [axis_y - 0.25, axis_y + 0.25] {
        paints.steel.add(&Solid::block([0.9, y - 0.045, 1.0], [2.5, y + 0.045, 1.14], 0.012), there);
    }
    paints.black.add(&Solid::block([0.82, 0.65, 0.6], [0.9, 1.8, 1.2], 0.015), there);
    // The cylinder with its steam chest, and the covers of both.
    let cylinder = [
        [2.45, 0.0],
        [2.45, 0.3],
        [2.5, 0.38],
        [2.5, 0.41],
        [2.56, 0.41],
        [2.56, 0.39],
        [3.44, 0.39],
        [3.44, 0.41],
        [3.5, 0.41],
        [3.5, 0.38],
        [3.56, 0.28],
        [3.56, 0.1],
        [3.62, 0.09],
        [3.62, 0.0],
    ];
    paints.black.add(&Solid::turned(&cylinder, 40), there * at(0.0, axis_y, 1.07));
    let band = [[2.75, 0.385], [2.76, 0.4], [2.8, 0.4], [2.81, 0.385]];
    paints.brass.add(&Solid::turned(&band, 40), there * at(0.0, axis_y, 1.07));
    let chest = [[2.4, 0.0], [2.4, 0.17], [2.46, 0.2], [3.54, 0.2], [3.6, 0.17], [3.6, 0.0]];
    paints.black.add(&Solid::turned(&chest, 32), there * at(0.0, axis_y + 0.52, 1.1));
    // The valve gear: return crank, eccentric rod, expansion link, radius rod.
    let crank = big_end + dvec3(0.0, 0.0, 0.1) - 0.75 * pin + 0.12 * dvec3(-pin.y, pin.x, 0.0);
    let link = dvec3(0.55, 1.35, 1.17);
    paints
        .steel
        .add(&Solid::bar(big_end + dvec3(0.0, 0.0, 0.1), crank, DVec3::Y, [0.09, 0.05], 0.012), there);
    paints.steel.add(&Solid::bar(crank, link - dvec3(0.0, 0.35, 0.0), DVec3::Y, [0.08, 0.04], 0.01), there);
    paints.steel.add(
        &Solid::bar(
            link - dvec3(0.06, 0.4, 0.0),
            link + dvec3(0.06, 0.35, 0.0),
            DVec3::X,
            [0.13, 0.07],
            0.015,
        ),
        there,
    );
    paints.steel.add(
        &Solid::bar(link + dvec3(0.0, 0.1, 0.0), dvec3(2.4, 1.5, 1.17), DVec3::Y, [0.07, 0.04], 0.01),
        there,
    );
    paints.steel.add(
        &Solid::bar(dvec3(2.2, 1.55, 1.2), crosshead - dvec3(0.0, 0.3, -0.13), DVec3::X, [0.08, 0.04], 0.01),
        there,
    );
}
