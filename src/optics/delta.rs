//! Delta scaling: the forward peak of the phase function is counted as light that was not
//! scattered.
//!
//! For g ≥ 0 the share f = g² goes straight on (delta–Eddington; Joseph, Wiscombe, Weinman 1976):
//! g* = (g − f)/(1 − f) = g/(1 + g), sigma_s* = sigma_s (1 − f), sigma_t* = sigma_a + sigma_s*. The
//! transport cross section sigma_a + sigma_s (1 − g) is unchanged. For g < 0 nothing is scaled: of beams alone a share
//! turns back (`backward.rs`). All
//! members are ratios to sigma_t, so that one set serves a whole medium. Tested by that invariant.

/// What delta scaling makes of a medium, relative to its extinction sigma_t.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DeltaScaled {
    /// Share of the scattered light that is counted as not scattered, in [0, 1).
    pub f: f64,
    /// Mean cosine of what remains, in (−1, ½].
    pub g_star: f64,
    /// sigma_t* / sigma_t = 1 − albedo f, in (0, 1].
    pub k: f64,
    /// sigma_s* / sigma_t = albedo (1 − f).
    pub sigma_s_ratio: f64,
    /// sigma_a / sigma_t = 1 − albedo.
    pub sigma_a_ratio: f64,
}

impl DeltaScaled {
    /// From the single-scattering albedo in [0, 1] and the mean cosine g in (−1, 1).
    pub fn new(albedo: f64, g: f64) -> Self {
        let (f, g_star, one_minus_f) =
            if g > 0.0 { (g * g, g / (1.0 + g), (1.0 - g) * (1.0 + g)) } else { (0.0, g, 1.0) };
        let sigma_s_ratio = albedo * one_minus_f;
        let sigma_a_ratio = 1.0 - albedo;
        // A sum, because 1 − albedo f cancels where both are near 1.
        Self { f, g_star, k: sigma_a_ratio + sigma_s_ratio, sigma_s_ratio, sigma_a_ratio }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn keeps_the_transport_cross_section() {
        // Ten roundings of numbers up to 2.
        let tolerance = 10.0 * f64::EPSILON;
        for g in [-0.99, -0.3, 0.0, 0.1, 0.75, 0.9, 0.999] {
            for albedo in [0.0, 0.5, 0.9, 0.999, 1.0] {
                let scaled = DeltaScaled::new(albedo, g);
                let transport = scaled.sigma_a_ratio + scaled.sigma_s_ratio * (1.0 - scaled.g_star);
                assert!((transport - (1.0 - albedo * g)).abs() < tolerance, "g {g} albedo {albedo}");
                assert!((scaled.k - (1.0 - albedo * scaled.f)).abs() < tolerance, "g {g} albedo {albedo}");
                assert!(scaled.g_star <= 0.5);
            }
        }
    }

    #[test]
    fn removes_the_second_moment_of_the_peak() {
        // HG has the second moment g²; f of it is the delta's, so the moments 0, 1, 2 of f delta +
        // (1 − f) P(g*) are 1, g, g² with P₂ of the rest 0.
        let scaled = DeltaScaled::new(1.0, 0.8);
        assert!((scaled.f - 0.64).abs() < 1e-15);
        assert!((scaled.f + (1.0 - scaled.f) * scaled.g_star - 0.8).abs() < 1e-15);
        let backward = DeltaScaled::new(0.9, -0.8);
        assert_eq!((backward.f, backward.g_star, backward.k), (0.0, -0.8, backward.sigma_a_ratio + 0.9));
    }
}
