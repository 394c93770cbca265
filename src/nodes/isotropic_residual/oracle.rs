//! f64 oracle of the isotropic residual: all light that has lost its direction, one lobe a cell.
//!
//! Unknown: phi = ∫ L dω and F = ∫ L ω dω [W/m²] at the cells, delta scaled (`optics/delta.rs`).
//! Sources: what the beams give at their first scattering, and emission,
//! Q0 = Σ sigma_s* Em + 4π eps, Q1 = Σ g* sigma_s* Em a0 d [W/m³]. A sweep carries the source's
//! lobes along lines of the lattice (`oracle/sweep.rs`); grids of halved resolution
//! (`oracle/level.rs`) start it and speed it up (`oracle/cascade.rs`).
//!
//! States are fields of `DVec4`: x is phi, yzw is F. Cells are cubes; any box of them. Inflow: a
//! constant radiance from everywhere. Tested in each file: conservation of power per sweep,
//! non-negative states, closed forms, symmetry, linearity.

pub mod cascade;
pub mod level;
pub mod sweep;

use std::f64::consts::PI;

use glam::DVec3;

use crate::nodes::oracle_scene::{BeamLight, OracleMedium};
use crate::optics::backward::{Streams, g_star};
use crate::optics::directions::LineSet;
use crate::volume::field::Field;

pub use cascade::solve;
pub use level::Level;
pub use sweep::Scheme;

/// What the residual starts from.
#[derive(Clone, Debug)]
pub struct Sources {
    /// Power per volume [W/m³].
    pub q0: Field<f64>,
    /// Its first moment over directions [W/m³], |q1| ≤ q0.
    pub q1: Field<DVec3>,
    /// Radiance that comes in from everywhere [W/(m² sr)].
    pub ambient: f64,
}

impl Sources {
    /// Darkness, but for a constant radiance from outside.
    pub fn new(dims: [usize; 3], ambient: f64) -> Self {
        Self { q0: Field::filled(dims, 0.0), q1: Field::filled(dims, DVec3::ZERO), ambient }
    }

    /// Adds the first scattering of a beam; `mean` is the cells' mean irradiance for a unit of
    /// light, with the delta-scaled extinction.
    pub fn add_beam(&mut self, medium: &OracleMedium, light: &BeamLight, mean: &Field<f64>) {
        let scaled = medium.scaled();
        for (idx, sigma_t) in medium.sigma_t.data.iter().enumerate() {
            let scattered = sigma_t * scaled.sigma_s_ratio * light.power() * mean.data[idx];
            let cell = DVec3::from_array(mean.index_of(idx).map(|i| i as f64));
            self.q0.data[idx] += scattered;
            self.q1.data[idx] += scaled.g_star * scattered * light.spread() * light.direction_at(cell);
        }
    }

    /// The same where light goes to and fro along the beam: `tau` and `ahead` are the depths behind and before it
    /// at the cells, `mean` that of e^{−kappa tau}.
    pub fn add_returning_beam(
        &mut self,
        medium: &OracleMedium,
        light: &BeamLight,
        mean: &Field<f64>,
        [tau, ahead]: [&Field<f64>; 2],
    ) {
        let g = medium.g;
        for (idx, sigma_t) in medium.sigma_t.data.iter().enumerate() {
            let Streams { on, back, .. } = Streams::new(medium.albedo, g, tau.data[idx], ahead.data[idx]);
            let leaving = sigma_t * medium.albedo * (1.0 - g * g) * light.power() * mean.data[idx];
            let cell = DVec3::from_array(mean.index_of(idx).map(|i| i as f64));
            self.q0.data[idx] += leaving * (on + back);
            self.q1.data[idx] +=
                g_star(g) * leaving * (on - back) * light.spread() * light.direction_at(cell);
        }
    }

    /// Adds emission: radiance per meter [W/(m³ sr)], at the cells or on a grid that is finer by a
    /// whole number, whose values are averaged.
    pub fn add_emission(&mut self, emission: &Field<f64>) {
        let fine = emission.dims[0] / self.q0.dims[0];
        assert_eq!(emission.dims, self.q0.dims.map(|n| n * fine), "emission grid");
        let share = 4.0 * PI / (fine * fine * fine) as f64;
        for (idx, value) in emission.data.iter().enumerate() {
            let cell = emission.index_of(idx).map(|i| i / fine);
            let cell_idx = self.q0.idx(cell);
            self.q0.data[cell_idx] += share * value;
        }
    }
}

/// How much work goes into the residual.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Quality {
    /// Cascade of 1 sweep, 4 on coarser grids, 8 lines.
    Draft,
    /// Cascade of 1 and 8 sweeps.
    Fast,
    /// Cascade of 4 and 16 sweeps.
    Default,
    /// Nested V-cycles, for media that are optically thick and scatter nearly all.
    Thick,
    /// Until phi changes by less than 1e-5.
    Reference,
}

/// Everything that decides how the residual is solved.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Options {
    /// Number of sweeps.
    pub quality: Quality,
    /// Directions.
    pub lines: LineSet,
    /// Transport through a cell.
    pub scheme: Scheme,
}

impl Quality {
    /// The quality with its usual directions, and order 2.
    pub fn options(self) -> Options {
        let lines = if self == Self::Draft { LineSet::Lines8 } else { LineSet::Lines14 };
        Options { quality: self, lines, scheme: Scheme::Diamond }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn beams_deposit_what_they_lose_but_what_is_absorbed() {
        let medium = OracleMedium {
            sigma_t: Field::from_fn([2, 2, 2], |[x, _, z]| (x + 2 * z) as f64),
            h: 0.5,
            albedo: 0.8,
            g: 0.5,
        };
        let direction = DVec3::new(0.6, 0.0, 0.8);
        let light = BeamLight::Parallel { direction, irradiance: 3.0, spread: 0.9 };
        let mut sources = Sources::new([2, 2, 2], 0.0);
        sources.add_beam(&medium, &light, &Field::filled([2, 2, 2], 0.25));
        // sigma_s* = sigma_t 0.8 (1 − 0.25), g* = 1/3; five roundings.
        let expected = 3.0 * 0.8 * 0.75 * 3.0 * 0.25;
        assert!((sources.q0.at([1, 0, 1]) - expected).abs() < 1e-14);
        let q1 = sources.q1.at([1, 0, 1]);
        assert!((q1 - direction * (expected * 0.9 / 3.0)).length() < 1e-14);
        assert_eq!(sources.q0.at([0, 1, 0]), 0.0);
    }

    #[test]
    fn emission_is_averaged_over_the_points_of_a_cell() {
        let mut sources = Sources::new([2, 1, 1], 0.0);
        sources.add_emission(&Field::from_fn([6, 3, 3], |[x, _, _]| x as f64));
        for (x, mean) in [(0, 1.0), (1, 4.0)] {
            assert!((sources.q0.at([x, 0, 0]) / (4.0 * PI * mean) - 1.0).abs() < 1e-14);
        }
    }
}
