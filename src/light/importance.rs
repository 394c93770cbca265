//! How much light from each direction matters to a picture.
//!
//! A floor and a mixture of Henyey–Greenstein lobes: the part of the light that a camera sees through
//! forward scattering comes from behind what it looks at, so each lobe is about a direction in which the
//! camera looks, the wider the more scattering there is (DESIGN 6.6). Of unit mean over all directions
//! where floor and weights add up to 1. Directions point towards where the light comes from, in the world.
//! Tested by its mean and by a closed form on the axis.

use std::f64::consts::PI;

use glam::DVec3;

use crate::optics::phase::hg;

/// Importance of directions.
#[derive(Debug, Clone, PartialEq)]
pub struct Importance {
    /// What every direction has at least, ≥ 0.
    pub floor: f64,
    /// What is added to it.
    pub lobes: Vec<Lobe>,
}

/// A part of importance around a direction.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Lobe {
    /// Unit vector towards the light that matters most.
    pub axis: DVec3,
    /// Mean cosine, in (−1, 1).
    pub g: f64,
    /// Its mean over all directions, ≥ 0.
    pub weight: f64,
}

impl Importance {
    /// Of light that comes from `direction`, a unit vector.
    pub fn at(&self, direction: DVec3) -> f64 {
        let lobe = |lobe: &Lobe| {
            // Rounding takes the cosine of a vector with itself beyond 1.
            let mu = lobe.axis.dot(direction).clamp(-1.0, 1.0);
            lobe.weight * 4.0 * PI * hg(mu, lobe.g)
        };
        self.floor + self.lobes.iter().map(lobe).sum::<f64>()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_mean_is_floor_and_weights() {
        let axis = DVec3::new(0.36, 0.48, 0.8);
        let lobes = vec![Lobe { axis, g: 0.6, weight: 0.5 }, Lobe { axis: -axis, g: 0.3, weight: 0.25 }];
        let importance = Importance { floor: 0.25, lobes };
        let n = 200;
        let mean: f64 = (0..n * n)
            .map(|idx| {
                let z = 2.0 * ((idx / n) as f64 + 0.5) / n as f64 - 1.0;
                let (sin, cos) = (2.0 * PI * (idx % n) as f64 / n as f64).sin_cos();
                let r = (1.0 - z * z).sqrt();
                importance.at(DVec3::new(r * cos, r * sin, z))
            })
            .sum::<f64>()
            / (n * n) as f64;
        // The midpoint rule in z errs by dz²/24 f' = 1e-4/24 times slopes of HG up to 30.
        assert!((mean - 1.0).abs() < 2e-4, "{mean}");
        // On its axis 4 pi HG is (1 + g)/(1 - g)², behind it (1 - g)/(1 + g)².
        let exact = 0.25 + 0.5 * 1.6 / 0.16 + 0.25 * 0.7 / 1.69;
        assert!((importance.at(axis) - exact).abs() < 1e-13);
    }
}
