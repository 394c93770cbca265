//! Whether a march looks up every beam at every step, or what all of them send to the eye is gathered at the
//! corners of cells first.
//!
//! Both cost about the same for each place where light is evaluated, so the fewer places win: corners of cells
//! that hold something, or steps of rays there. Gathered light is interpolated between corners, which is as good
//! as the optical depths are, but for the phase function: from a corner to the next the direction to the eye turns
//! by 1/d, d the distance in cells. At its sharpest, straight on, HG bends by 3g/(1 - g)² of itself a radian
//! squared, so that between corners, along both axes across the view, it is off by at most
//! 2 · (1/8) 3g/((1 - g) d)². And where beams mix, the logarithm of their sum bends by the variance of its terms'
//! slopes, for light from everywhere (sigma_t h)²/3 along each of three axes; the mean over a cell of what that
//! makes too bright is a twelfth. A window that takes light off a beam between two angles adds its own bend, at most
//! 6 over their distance squared. Estimates for unkind light, with the mean of what cells hold: a cumulus of up to 1.2
//! optical depths a cell, lit by 32 ordinates of a sky, is 0.06 % brighter for it, and the picture of a camera that
//! passes the distance where the choice changes changes by as much.

use super::number;
use crate::graph::Decision;

/// What a rule knows of the beams and the view.
#[derive(Debug, Clone, Copy)]
pub struct Gathering {
    /// Beams that the march would look up.
    pub n_beams: usize,
    /// Whether all are parallel, with depths at corners that no surface hides, no peak widens and whose
    /// light does not come back.
    pub is_plain: bool,
    /// Whether the medium is a shape in closed form.
    pub is_closed: bool,
    /// The largest |g| a0 of a beam.
    pub g: f64,
    /// The least angle within which a window takes light off a beam, in radians; infinite for none.
    pub window: f64,
    /// From the eye to the nearest matter in cells, at least; 0 inside.
    pub distance: f64,
    /// Optical depth of a cell that holds something, about.
    pub cell_tau: f64,
    /// Whether the device has room for the sums.
    pub fits: bool,
    /// What the march moves, beam by beam.
    pub looked_up_bytes: f64,
    /// What it moves together with the gathering.
    pub gathered_bytes: f64,
}

/// All errors together, relative, about.
pub const GATHERING_ERROR: f64 = 0.02;

/// Whether beams are gathered at corners.
pub fn gathering(facts: Gathering, prune: bool) -> (bool, Decision) {
    const RULE: &str = "gathering";
    let what = "looking up every beam at every step";
    let beams = format!("{} beam{}", facts.n_beams, if facts.n_beams == 1 { "" } else { "s" });
    let Gathering { g, distance, .. } = facts;
    let error =
        turning_error(g, distance) + window_error(facts.window, distance) + mixing_error(facts.cell_tau);
    let found = format!(
        "{beams}; the eye is {} cells away, g = {}, cells of some {} optical depths: error about {}; {} MB looked up, {} MB \
         gathered",
        number(distance),
        number(g),
        number(facts.cell_tau),
        number(error),
        number((facts.looked_up_bytes * 1e-6).round()),
        number((facts.gathered_bytes * 1e-6).round()),
    );
    let data = if prune && facts.is_plain && !facts.is_closed { found } else { beams };
    let kept = |reason: &str| (false, Decision::kept(RULE, what, reason, data.clone()));
    match () {
        () if !prune => kept("everything is modeled"),
        () if !facts.is_plain => kept("lights have places, shadows, peaks that widen, or ways back"),
        () if facts.is_closed => kept("a shape's depths are known at every place"),
        () if !facts.fits => kept("the device has no room for what would be gathered"),
        () if facts.gathered_bytes >= facts.looked_up_bytes => kept("there are more corners than steps"),
        () if error > GATHERING_ERROR => {
            kept("light is not smooth enough from corner to corner, so near or so thick")
        }
        () => {
            let reason =
                "what all send to the eye is gathered at the corners of cells, of which there are fewer";
            (true, Decision::left_out(RULE, what, reason, data))
        }
    }
}

/// Largest relative error between corners of a phase function towards an eye so many cells away.
fn turning_error(g: f64, distance: f64) -> f64 {
    if g > 0.0 { 0.25 * 3.0 * g / ((1.0 - g) * distance).powi(2) } else { 0.0 }
}

/// The same of a smooth step over an angle.
fn window_error(window: f64, distance: f64) -> f64 {
    if window.is_finite() { 0.25 * 6.0 / (window * distance).powi(2) } else { 0.0 }
}

/// Mean relative error where light from everywhere goes through cells of this optical depth.
fn mixing_error(cell_tau: f64) -> f64 {
    cell_tau * cell_tau / 12.0
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::optics::phase::hg;

    const MANY: Gathering = Gathering {
        n_beams: 32,
        is_plain: true,
        is_closed: false,
        g: 0.85,
        window: f64::INFINITY,
        distance: 200.0,
        cell_tau: 0.2,
        fits: true,
        looked_up_bytes: 5e9,
        gathered_bytes: 1e9,
    };

    #[test]
    fn many_beams_are_gathered_where_that_is_cheaper_and_exact_enough() {
        assert!(gathering(MANY, true).0);
        assert!(!gathering(MANY, false).0);
        let kept = |facts: Gathering| {
            let (gathers, decision) = gathering(facts, true);
            assert!(!gathers && decision.kept, "{facts:?}");
            decision.reason.clone()
        };
        assert!(kept(Gathering { is_plain: false, ..MANY }).contains("shadows"));
        assert!(kept(Gathering { is_closed: true, ..MANY }).contains("shape"));
        assert!(kept(Gathering { gathered_bytes: 5e9, ..MANY }).contains("more corners"));
        // Cells of 0.2 are 0.33 % off; g 0.85 bends by 113: from 42 cells on it is 1.6 % off.
        assert!(kept(Gathering { distance: 41.0, ..MANY }).contains("near"));
        assert!(gathering(Gathering { distance: 42.0, ..MANY }, true).0);
        assert!(kept(Gathering { distance: 0.0, ..MANY }).contains("near"));
        assert!(kept(Gathering { cell_tau: 0.5, ..MANY }).contains("thick"));
        // Two steps of a degree over a cell of 0.29 degrees, and of sixty.
        assert!(kept(Gathering { window: 0.0175, ..MANY }).contains("near"));
        assert!(gathering(Gathering { window: 1.05, ..MANY }, true).0);
        assert!(kept(Gathering { fits: false, ..MANY }).contains("room"));
        // Even light has nothing that turns, wherever the eye is.
        for distance in [0.0, 1.0] {
            let even = Gathering { g: 0.0, distance, ..MANY };
            assert!(gathering(even, true).0);
            assert!(!gathering(even, true).1.data.contains("NaN"));
        }
    }

    #[test]
    fn the_error_of_mixed_light_is_that_of_its_logarithm() {
        // Even light from everywhere in one direction of extinction 0.3 a cell: along x, ln of the mean of
        // e^{−0.3 mu x} over mu, trilinear between 0 and 1; the other two axes are alike.
        let cell_tau = 0.3;
        let log = |x: f64| if x == 0.0 { 0.0 } else { ((cell_tau * x).sinh() / (cell_tau * x)).ln() };
        let n = 1000;
        let excess: f64 =
            (0..n).map(|i| (f64::from(i) + 0.5) / f64::from(n)).map(|x| x * log(1.0) - log(x)).sum();
        let found = 3.0 * excess / f64::from(n);
        assert!((found / mixing_error(cell_tau) - 1.0).abs() < 0.02, "{found}");
    }

    #[test]
    fn the_error_is_that_of_the_phase_function() {
        // Midway between the corners of a square of one cell across the view, straight on.
        for (g, distance) in [(0.5, 40.0), (0.85, 60.0), (0.95, 300.0)] {
            let corner = hg((0.5_f64.sqrt() / distance).cos(), g);
            let found = 1.0 - corner / hg(1.0, g);
            let bound = turning_error(g, distance);
            // Terms of the fourth order are some of the square of this.
            assert!((found / bound - 1.0).abs() < 0.05, "{g}: {found} against {bound}");
        }
    }
}
