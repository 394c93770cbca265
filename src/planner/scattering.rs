//! Whether light that was scattered more than once has to be solved for.
//!
//! Three scenes need no solution. Without albedo nothing scatters. Where a constant environment of radiance
//! L is the only light and albedo is 1, I = L solves the equation of transfer everywhere, so phi = 4 pi L and
//! F = 0. And where a medium is so thin that its residual is provably under [`ERROR_TARGET`] of the light
//! that was scattered once, in each pixel:
//!
//! Let T bound the optical depth of every straight way, f, g\*, k be those of delta scaling, and E the sum of
//! the beams' irradiances. A lobe of mean cosine up to a = |g\*| is at most Λ = (1 + b)²/(1 + b²/3) times
//! its mean, b its slope. Then phi = ∫∫ q ds dw ≤ Λ p (phi + E) with p = sigma_s\*/sigma_t\* (1 − e^{−kT}), so
//! phi ≤ E Λp/(1 − Λp). Along a view ray the residual sends at most ∫ Λ sigma_s\* phi/4π e^{−tau\*}, light that
//! was scattered once at least ∫ sigma_s E e^{−2T} min HG e^{−tau\*}, min HG = (1 − |g|)/(1 + |g|)²/4π, and their
//! ratio is at most (1 − f) Λ · Λp/(1 − Λp) · e^{2T} (1 + |g|)²/(1 − |g|). That holds for parallel light that
//! nothing hides: a shadow has no light that was scattered once. (The phase that `prefilter` leaves to
//! ordinates is nowhere below min HG. Of g < 0 what turns straight back is no residual: f is 0 here, and the first
//! source, (1 − g²)(E₊ + E₋) ≤ (1 − g⁴) E, less than E.)

use crate::graph::Decision;
use crate::light::chromaticity;
use crate::optics::delta::DeltaScaled;
use crate::optics::lobe::slope_from_mean_cosine;

use super::number;

/// What may be left out without asking: the error of a default picture is some 2 %.
pub const ERROR_TARGET: f64 = 0.01;

/// What lights the medium, and what it is.
#[derive(Debug, Clone, Copy)]
pub struct Lit {
    /// Of three channels.
    pub albedo: [f64; 3],
    /// Mean cosine of the phase function.
    pub g: f64,
    /// Bound of the optical depth of any straight way.
    pub tau_max: f64,
    /// Beams with any light.
    pub n_beams: usize,
    /// Whether all of them are parallel and nothing hides them.
    pub is_parallel: bool,
    /// Radiance from everywhere [W/(m² sr)].
    pub ambient: [f64; 3],
    /// Whether it emits.
    pub glows: bool,
    /// Whether surfaces send light back.
    pub has_surfaces: bool,
    /// Whether there is light that the residual only hands on.
    pub has_fields: bool,
}

/// How multiple scattering is found.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Scattering {
    /// There is none, or so little that nobody sees it.
    None,
    /// The same fluence phi everywhere [W/m²].
    Even([f64; 3]),
    /// By sweeps.
    Solved,
}

/// How multiple scattering is found in this light.
pub fn scattering(lit: &Lit, prune: bool) -> (Scattering, Decision) {
    const RULE: &str = "scattering";
    const WHAT: &str = "multiple scattering";
    let has_ambient = chromaticity(lit.ambient).is_some();
    let bound =
        lit.albedo.into_iter().map(|albedo| residual_bound(albedo, lit.g, lit.tau_max)).fold(0.0, f64::max);
    let lights = [
        (lit.n_beams > 0, "beams"),
        (has_ambient, "ambient"),
        (lit.glows, "emission"),
        (lit.has_surfaces, "surfaces"),
        (lit.has_fields, "fields"),
    ];
    let lights: Vec<&str> = lights.iter().filter(|(is_there, _)| *is_there).map(|(_, name)| *name).collect();
    let data = format!(
        "albedo up to {}, optical depth up to {}; light: {}; share of multiple scattering {}",
        number(lit.albedo.into_iter().fold(0.0, f64::max)),
        number(lit.tau_max),
        if lights.is_empty() { "none".to_owned() } else { lights.join(", ") },
        if bound.is_finite() { format!("at most {}", number(bound)) } else { "not bounded".to_owned() }
    );
    let none = |reason: &str| (Scattering::None, Decision::left_out(RULE, WHAT, reason, data.clone()));
    let solved = |reason: &str| (Scattering::Solved, Decision::kept(RULE, WHAT, reason, data.clone()));
    if lit.has_fields {
        return solved("light of another scheme is handed on");
    }
    if !prune {
        return solved("everything is modeled");
    }
    if lit.has_surfaces {
        return solved("surfaces and medium light each other");
    }
    if lights.is_empty() {
        return none("there is no light");
    }
    if lit.albedo == [0.0; 3] {
        return none("nothing scatters");
    }
    if lights == ["ambient"] && lit.albedo == [1.0; 3] {
        let phi = lit.ambient.map(|radiance| 4.0 * std::f64::consts::PI * radiance);
        let decision = Decision::left_out(
            RULE,
            "sweeps",
            "the same light from everywhere and nothing absorbed: it is the same everywhere",
            data,
        );
        return (Scattering::Even(phi), decision);
    }
    if lights == ["beams"] && lit.is_parallel && bound <= ERROR_TARGET {
        return none("thin: it is under 1 % of what is scattered once");
    }
    solved("light is scattered more than once")
}

/// The most that light scattered more than once can be of light scattered once; infinite where this says
/// nothing.
fn residual_bound(albedo: f64, g: f64, tau_max: f64) -> f64 {
    let scaled = DeltaScaled::new(albedo, g);
    let b = slope_from_mean_cosine(scaled.g_star.abs());
    let lobe = (1.0 + b).powi(2) / (1.0 + b * b / 3.0);
    let p = scaled.sigma_s_ratio / scaled.k * -(-scaled.k * tau_max).exp_m1();
    if lobe * p >= 1.0 {
        return f64::INFINITY;
    }
    let phi = lobe * p / (1.0 - lobe * p);
    (1.0 - scaled.f) * lobe * phi * (2.0 * tau_max).exp() * (1.0 + g.abs()).powi(2) / (1.0 - g.abs())
}

#[cfg(test)]
mod tests {
    use super::*;

    const THIN: Lit = Lit {
        albedo: [0.9; 3],
        g: 0.0,
        tau_max: 5e-3,
        n_beams: 2,
        is_parallel: true,
        ambient: [0.0; 3],
        glows: false,
        has_surfaces: false,
        has_fields: false,
    };

    #[test]
    fn the_bound_is_that_of_isotropic_scattering() {
        // Λ = 1, f = 0, k = 1: p/(1 − p) e^{2T}.
        for tau in [1e-4, 0.01, 0.3] {
            let p = 0.9 * (1.0 - f64::exp(-tau));
            let expected = p / (1.0 - p) * f64::exp(2.0 * tau);
            assert!((residual_bound(0.9, 0.0, tau) / expected - 1.0).abs() < 1e-12, "{tau}");
        }
        assert!(residual_bound(0.9, 0.0, 0.01) < residual_bound(0.9, 0.5, 0.01));
        assert_eq!(residual_bound(1.0, 0.0, f64::INFINITY), f64::INFINITY);
    }

    #[test]
    fn only_what_is_proven_is_left_out() {
        let is_left_out = |lit: Lit| scattering(&lit, true).0 == Scattering::None;
        assert!(is_left_out(THIN));
        assert!(!is_left_out(Lit { tau_max: 0.02, ..THIN }));
        assert!(!is_left_out(Lit { g: 0.8, ..THIN }));
        // Where light has no direction, or not everywhere, light that was scattered once is no measure.
        assert!(!is_left_out(Lit { ambient: [0.0, 0.1, 0.0], ..THIN }));
        assert!(!is_left_out(Lit { glows: true, ..THIN }));
        assert!(!is_left_out(Lit { is_parallel: false, ..THIN }));
        assert!(!is_left_out(Lit { has_surfaces: true, ..THIN }));
        assert!(!is_left_out(Lit { has_fields: true, ..THIN }));
        // Without albedo or light there is nothing, however thick; but surfaces light each other.
        let thick = Lit { tau_max: 50.0, ..THIN };
        assert!(is_left_out(Lit { albedo: [0.0; 3], glows: true, ambient: [1.0; 3], ..thick }));
        assert!(!is_left_out(Lit { albedo: [0.0, 0.0, 0.1], ..thick }));
        assert!(!is_left_out(Lit { albedo: [0.0; 3], has_surfaces: true, ..thick }));
        assert!(is_left_out(Lit { n_beams: 0, ..thick }));
        assert!(scattering(&THIN, false).0 == Scattering::Solved);
    }

    #[test]
    fn even_light_is_known() {
        let even = Lit { albedo: [1.0; 3], n_beams: 0, ambient: [1.0, 0.5, 0.0], tau_max: 50.0, ..THIN };
        let (found, decision) = scattering(&even, true);
        let phi = 4.0 * std::f64::consts::PI;
        assert_eq!(found, Scattering::Even([phi, 0.5 * phi, 0.0]));
        assert_eq!((decision.kept, decision.what.as_str()), (false, "sweeps"));
        for other in [
            Lit { albedo: [1.0, 1.0, 0.999], ..even },
            Lit { n_beams: 1, ..even },
            Lit { glows: true, ..even },
            Lit { has_surfaces: true, ..even },
        ] {
            assert_eq!(scattering(&other, true).0, Scattering::Solved, "{other:?}");
        }
    }
}
