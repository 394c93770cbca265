//! The squared-linear lobe: a distribution over directions that is never negative and whose first
//! two moments are given.
//!
//! q(w) = Q / (4π (1 + b²/3)) · (1 + b w·n)². Its mean is Q, its mean cosine a = (2b/3)/(1 + b²/3),
//! so b = (1 − √(1 − 3a²))/a, written here without cancellation as 3a/(1 + √(1 − 3a²)). b = 1 at a
//! = ½, the most that the form can hold; g* = g/(1 + g) ≤ ½ of delta scaling never asks for more.
//! It is a polynomial of degree two, so every direction set of [`super::directions`] integrates it
//! exactly and no energy is lost by the quadrature. Units are those of Q: [W/m³] of a source,
//! [W/m²] of a fluence. Tested by its moments.

use glam::DVec3;
use std::f64::consts::PI;

/// The largest mean cosine that the lobe can hold.
pub const MAX_MEAN_COSINE: f64 = 0.5;

/// A lobe A (1 + B·w)².
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct SquaredLinearLobe {
    /// A = Q / (4π (1 + b²/3)), per steradian.
    pub amplitude: f64,
    /// B = b n, |B| ≤ 1.
    pub slope: DVec3,
}

impl SquaredLinearLobe {
    /// The lobe with the integral `q` and the first moment `v`; a first moment above q/2 is cut to
    /// q/2 along its direction, `q` ≤ 0 gives darkness.
    pub fn new(q: f64, v: DVec3) -> Self {
        if q <= 0.0 {
            return Self::default();
        }
        let length = v.length();
        let b = slope_from_mean_cosine(length / q);
        let slope = if length > 0.0 { v * (b / length) } else { DVec3::ZERO };
        Self { amplitude: q / (4.0 * PI * (1.0 + b * b / 3.0)), slope }
    }

    /// Value per steradian in the unit direction `w`.
    pub fn eval(&self, w: DVec3) -> f64 {
        let linear = 1.0 + self.slope.dot(w);
        self.amplitude * linear * linear
    }
}

/// b of the lobe with the mean cosine `a` ≥ 0, cut at [`MAX_MEAN_COSINE`].
pub fn slope_from_mean_cosine(a: f64) -> f64 {
    let a = a.min(MAX_MEAN_COSINE);
    3.0 * a / (1.0 + (1.0 - 3.0 * a * a).sqrt())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::optics::directions::LineSet;

    #[test]
    fn has_exactly_the_moments_it_was_made_from() {
        // A degree-two lobe times w is of degree three, and 14 directions integrate that exactly;
        // some twenty roundings of numbers of order 1.
        for a in [0.0, 1e-9, 1e-4, 0.1, 0.3, 0.499999, 0.5] {
            let v = DVec3::new(2.0, -3.0, 6.0) / 7.0 * (a * 5.0);
            let lobe = SquaredLinearLobe::new(5.0, v);
            let (mut total, mut first) = (0.0, DVec3::ZERO);
            for line in LineSet::Lines14.directions() {
                let value = line.weight * lobe.eval(line.unit());
                assert!(value >= 0.0);
                total += value;
                first += value * line.unit();
            }
            assert!((total - 5.0).abs() < 1e-13, "a {a}: {total}");
            assert!((first - v).length() < 1e-13, "a {a}: {first} against {v}");
        }
    }

    #[test]
    fn slope_solves_the_quadratic() {
        // a b² − 2 b + 3 a = 0, three products of numbers up to 2.
        for a in [1e-12, 1e-5, 0.2, 0.5] {
            let b = slope_from_mean_cosine(a);
            assert!((a * b * b - 2.0 * b + 3.0 * a).abs() < 1e-15, "a {a}");
        }
        assert_eq!(slope_from_mean_cosine(0.9), 1.0);
        assert_eq!(slope_from_mean_cosine(0.0), 0.0);
    }

    #[test]
    fn no_source_is_dark() {
        assert_eq!(SquaredLinearLobe::new(0.0, DVec3::X).eval(DVec3::X), 0.0);
        assert_eq!(SquaredLinearLobe::new(-1.0, DVec3::X).eval(DVec3::X), 0.0);
    }
}
