//! How much light from each direction matters to a picture.
//!
//! What a camera sees by forward scattering comes from behind what it looks at: a Henyey–Greenstein lobe
//! about the view, the wider the more scattering there is, over a floor for all other light (DESIGN 6.6).
//! Its mean over all directions is 1. Directions point towards where the light comes from, in the world.
//! Tested by its mean and by a closed form on the axis.

use std::f64::consts::PI;

use glam::DVec3;

use crate::optics::phase::hg;

/// Importance of directions.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Importance {
    /// Unit vector towards the light that matters most.
    pub axis: DVec3,
    /// Mean cosine of the lobe about it, in (−1, 1).
    pub g: f64,
    /// Share of the lobe, in 0..=1.
    pub strength: f64,
}

impl Importance {
    /// Of light that comes from `direction`, a unit vector.
    pub fn at(&self, direction: DVec3) -> f64 {
        // Rounding takes the cosine of a vector with itself beyond 1.
        let mu = self.axis.dot(direction).clamp(-1.0, 1.0);
        self.strength * 4.0 * PI * hg(mu, self.g) + 1.0 - self.strength
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_mean_is_one() {
        let axis = DVec3::new(0.36, 0.48, 0.8);
        let importance = Importance { axis, g: 0.6, strength: 0.75 };
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
        assert!((importance.at(axis) - (0.25 + 0.75 * 1.6 / 0.16)).abs() < 1e-13);
        assert!((importance.at(-axis) - (0.25 + 0.75 * 0.4 / 2.56)).abs() < 1e-13);
    }
}
