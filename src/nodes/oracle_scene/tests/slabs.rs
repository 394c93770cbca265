//! Slabs against adding–doubling.
//!
//! The slab is a wide box. A beam lights its middle alone; summed over all that leaves through the
//! two large faces this gives the slab's reflectance and transmittance, but for what leaves through
//! the four narrow sides. The references are azimuth-averaged adding–doubling with 48 and 64
//! streams, which agree to 1e-6.

use glam::DVec3;

use crate::nodes::isotropic_residual::oracle::{Level, Quality, Sources, solve};
use crate::nodes::oracle_scene::{BeamLight, OracleMedium};
use crate::nodes::principal_propagation::oracle::mean_irradiance;
use crate::volume::field::Field;

/// Cells along the wide axes, and of the lit middle.
const WIDTH: usize = 64;
const LIT: std::ops::Range<usize> = 24..40;

/// Power over that of the beam: reflected, transmitted, through the sides.
fn slab(mu0: f64, albedo: f64, g: f64, tau: f64) -> [f64; 3] {
    let n_layers = match tau {
        0.5 => 4,
        2.0 => 8,
        _ => 16,
    };
    let dims = [WIDTH, WIDTH, n_layers];
    let h = 1.0 / n_layers as f64;
    let medium = OracleMedium { sigma_t: Field::filled(dims, tau), h, albedo, g };
    let k = medium.scaled().k;
    let direction = DVec3::new((1.0 - mu0 * mu0).sqrt(), 0.0, mu0);
    let light = BeamLight::Parallel { direction, irradiance: 1.0, spread: 1.0 };
    let tau_corners = Field::from_fn(dims.map(|n| n + 1), |[_, _, z]| tau * h * z as f64 / mu0);
    let everywhere = mean_irradiance(&tau_corners, k, direction);
    let lit = Field::from_fn(dims, |cell| {
        if LIT.contains(&cell[0]) && LIT.contains(&cell[1]) { everywhere.at(cell) } else { 0.0 }
    });
    let mut sources = Sources::new(dims, 0.0);
    sources.add_beam(&medium, &light, &lit);
    let balance = solve(Level::new(&medium, sources), Quality::Default.options()).balance;
    let [x0, x1, y0, y1, z0, z1] =
        balance.leaving.map(|power| power / (mu0 * (LIT.len() as f64 * h).powi(2)));
    [z0, z1 + (-k * tau / mu0).exp(), x0 + x1 + y0 + y1]
}

#[test]
fn reflect_and_transmit_what_adding_doubling_says() {
    // mu0, albedo, g, tau, R, T.
    let references = [
        (1.0, 1.0, 0.0, 0.5, 0.202506, 0.797494),
        (1.0, 1.0, 0.0, 10.0, 0.853000, 0.146992),
        (1.0, 1.0, 0.5, 2.0, 0.320300, 0.679699),
        (1.0, 1.0, 0.75, 10.0, 0.568972, 0.431021),
        (1.0, 0.95, 0.9, 10.0, 0.124152, 0.334590),
        (1.0, 0.9, 0.0, 10.0, 0.414934, 0.005612),
        (1.0, 0.9, 0.75, 2.0, 0.097395, 0.660958),
        (1.0, 0.9, 0.97, 10.0, 0.016750, 0.300949),
        (1.0, 0.5, 0.0, 2.0, 0.112833, 0.189322),
        (1.0, 0.5, 0.5, 10.0, 0.047541, 0.000453),
        (0.5, 1.0, 0.0, 0.5, 0.334381, 0.665618),
        (0.5, 1.0, 0.5, 2.0, 0.514665, 0.485334),
        (0.5, 0.9, 0.75, 2.0, 0.233569, 0.415890),
        (0.5, 0.95, 0.5, 10.0, 0.524703, 0.039925),
    ];
    for (mu0, albedo, g, tau, reflectance, transmittance) in references {
        let [r, t, sides] = slab(mu0, albedo, g, tau);
        let what = format!("mu0 {mu0} albedo {albedo} g {g} tau {tau}: R {r} T {t} sides {sides}");
        // The requirement is 0.05. Found is at most 0.025 beside what the sides let out, which
        // would have been reflected or transmitted.
        assert!((r - reflectance).abs() < 0.03 + sides, "{what} against R {reflectance}");
        assert!((t - transmittance).abs() < 0.03 + sides, "{what} against T {transmittance}");
        assert!((r - reflectance).abs().max((t - transmittance).abs()) < 0.05, "{what}");
    }
}
