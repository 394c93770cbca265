//! Pencils of light through a cube: how far they have spread where they leave it.
//!
//! A column of cells of a cube of edge 1 is lit; the root of the mean square of the distance from its axis,
//! over all power that leaves the opposite face. The truth is 10⁶ photons, a pencil without width; the cells'
//! own adds h²/6 to the mean square.

use glam::DVec3;

use crate::nodes::isotropic_residual::oracle::{Level, Quality, Sources, solve};
use crate::nodes::oracle_scene::{BeamLight, OracleMedium};
use crate::nodes::principal_propagation::widening::oracle::Widening;
use crate::optics::transmittance::mean_transmittance;
use crate::volume::field::Field;

/// Cells along an axis.
const N: usize = 17;

/// Radii with and without widening.
fn radii(tau: f64, g: f64) -> [f64; 2] {
    let (h, lit) = (1.0 / N as f64, [N / 2, N / 2]);
    let medium = OracleMedium { sigma_t: Field::filled([N; 3], tau), h, albedo: 1.0, g };
    let widening = Widening { h, albedo: 1.0, g };
    let widened = widening.propagate(&medium.sigma_t, |at, face| face > 0 || at == lit);
    let within = mean_transmittance(medium.scaled().k * tau * h);
    let straight =
        Field::from_fn([N, N, N + 1], |at| if at[..2] == lit { widened.straight.at(at) } else { 0.0 });
    let straight_mean = Field::from_fn([N; 3], |cell| within * straight.at(cell));
    let radius = |mean: &Field<f64>, beam: &Field<f64>| {
        let light = BeamLight::Parallel { direction: DVec3::Z, irradiance: 1.0, spread: 1.0 };
        let mut sources = Sources::new([N; 3], 0.0);
        sources.add_beam(&medium, &light, mean);
        let state = solve(Level::new(&medium, sources), Quality::Reference.options()).state;
        let (mut power, mut second) = (0.0, 0.0);
        for y in 0..N {
            for x in 0..N {
                let leaving = beam.at([x, y, N]) + state.at([x, y, N - 1]).w.max(0.0);
                let [x, y] = [x, y].map(|i| (i as f64 - lit[0] as f64) * h);
                power += leaving;
                second += leaving * (x * x + y * y);
            }
        }
        (second / power).sqrt()
    };
    [radius(&widened.mean, &widened.star), radius(&straight_mean, &straight)]
}

#[test]
fn widen_as_photons_do() {
    let truth = 0.190;
    let [widening, straight] = radii(2.0, 0.9);
    assert!((widening / truth - 1.0).abs() < 0.05, "{widening}, straight {straight}");
    assert!((straight / truth - 1.0).abs() > 0.25, "widening {widening}, straight {straight}");
}
