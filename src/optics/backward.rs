//! Backward scattering: light that goes to and fro along its line.
//!
//! For g < 0 the share f = g² of what a beam scatters is counted as turned straight back, the rest as scattered
//! with the mean cosine g* = (g + f)/(1 − f) = g/(1 − g) ≥ −½: delta–Eddington (`delta.rs`) with the delta at
//! mu = −1. The moments 0, 1 and 2 of Henyey–Greenstein are kept, and the lobe can hold g*. Along the line of a
//! beam two streams are left (Schuster 1905), of unit light and per optical depth, with c = albedo f:
//!
//! dE₊/dtau = −E₊ + c E₋, −dE₋/dtau = −E₋ + c E₊, E₊ = 1 where the light enters, E₋ = 0 where it leaves. With tau
//! the depth that it has passed, A the depth ahead, kappa = √(1 − c²) and s(u) = (1 − e^{−2 kappa u})/kappa,
//!
//! E₊ = e^{−kappa tau} (s(A) + 1 + e^{−2 kappa A})/N, E₋ = e^{−kappa tau} c s(A)/N, N = s(tau + A) + 1 +
//! e^{−2 kappa (tau + A)}.
//!
//! What leaves the line is the residual's first source, Q0 = sigma_s (1 − f) (E₊ + E₋) and Q1 = sigma_s (1 − f) g*
//! (E₊ − E₋) d; from there on nothing is scaled. Towards the eye e^{−tau} is scattered once, as ever; what turned
//! at least once, E₋ and E₊ − e^{−tau}, by the functions of [`phases`]. Those are HG(g²) and HG(g³), as
//! HG ∗ HG = HG(g²), less the squared-linear lobes by which the residual carries the same orders, over f and f²:
//!
//! once    f⁻¹ \[HG(g²) − (1−f) q(g* g)\],
//! twice   f⁻² \[HG(g³) − (1−f) q(g* g²) − f (1−f) q(−g* g)\],
//!
//! mu the cosine to the beam, q(a) the lobe of mean cosine a. They have the integral 1 and the mean cosines −g and
//! g, and stand for all odd and even numbers of turns.
//!
//! Units: irradiances over that of the beam, phase functions in 1/sr. Limits: parallel light; what was scattered
//! out of the line is not turned again; light that turns stays on its line, which holds the less the nearer g is
//! to 0. Tested by the equations, the moments and the limits.

use std::f64::consts::PI;

use super::lobe::slope_from_mean_cosine;
use super::phase::hg;

/// Columns of the table, over the angle.
pub const COLUMNS: usize = 256;

/// Light 1 that travels along a line, at one point of it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Streams {
    /// E₊ over e^{−kappa tau}.
    pub on: f64,
    /// E₋ over e^{−kappa tau}.
    pub back: f64,
    /// Decay per optical depth, in 0..=1.
    pub kappa: f64,
}

impl Streams {
    /// At the optical depth `tau` from the light, with the depth `ahead` until the medium's end; for an albedo in
    /// 0..=1 and a mean cosine g in (−1, 0\].
    pub fn new(albedo: f64, g: f64, tau: f64, ahead: f64) -> Self {
        let turned = albedo * g * g;
        // A sum, because 1 − albedo f cancels where both are near 1.
        let rest = (1.0 - albedo) + albedo * (1.0 - g) * (1.0 + g);
        let kappa = (rest * (1.0 + turned)).sqrt();
        let s = |depth: f64| {
            let x = 2.0 * kappa * depth;
            if x > 0.0 { -(-x).exp_m1() / kappa } else { 2.0 * depth }
        };
        let all = |depth: f64| s(depth) + 1.0 + (-2.0 * kappa * depth).exp();
        Self { on: all(ahead) / all(tau + ahead), back: turned * s(ahead) / all(tau + ahead), kappa }
    }
}

/// g* of what leaves the line, in (−½, 0\].
pub fn g_star(g: f64) -> f64 {
    g / (1.0 - g)
}

/// Below this |g| differences of lobes lose their digits, and what they are for is under 1e-4 of the light.
const SMALL: f64 = 0.01;

/// What turned an even and an odd number of times sends towards the eye [1/sr], of the cosine `mu` to the travel of
/// the beam; not cut at 0.
pub fn phases(mu: f64, g: f64) -> [f64; 2] {
    if g > -SMALL {
        return [hg(mu, g), hg(mu, -g)];
    }
    let f = g * g;
    let once = hg(mu, f) - (1.0 - f) * lobe(mu, g_star(g) * g);
    let by_residual = lobe(mu, g_star(g) * f) + f * lobe(mu, -g_star(g) * g);
    let twice = hg(mu, g * f) - (1.0 - f) * by_residual;
    [twice / (f * f), once / f]
}

/// The same as a table of two rows of [`COLUMNS`], each of the cosine to the travel of its own stream, none below 0:
/// column 255 √(sin(θ/2)), θ the angle from straight back, where both are steepest.
pub fn table(g: f64) -> Vec<f32> {
    let value = |n: usize| {
        let root = (n % COLUMNS) as f64 / (COLUMNS - 1) as f64;
        let along = 2.0 * root.powi(4) - 1.0;
        let [even, odd] = [phases(along, g)[0], phases(-along, g)[1]];
        (if n < COLUMNS { even } else { odd }).max(0.0) as f32
    };
    (0..2 * COLUMNS).map(value).collect()
}

/// The squared-linear lobe of mean cosine `a` in −½..=½ and integral 1 [1/sr].
fn lobe(mu: f64, a: f64) -> f64 {
    let b = slope_from_mean_cosine(a.abs()).copysign(a);
    (1.0 + b * mu) * (1.0 + b * mu) / (4.0 * PI * (1.0 + b * b / 3.0))
}

/// A row of the table by linear interpolation, as the shaders look it up.
#[cfg(test)]
pub fn lookup(table: &[f32], row: usize, mu: f64) -> f64 {
    let position = (0.5 * (1.0 + mu)).max(0.0).sqrt().sqrt() * (COLUMNS - 1) as f64;
    let lower = (position as usize).min(COLUMNS - 2);
    let part = position - lower as f64;
    let at = |column: usize| f64::from(table[row * COLUMNS + column]);
    (1.0 - part) * at(lower) + part * at(lower + 1)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn irradiances(albedo: f64, g: f64, tau: f64, ahead: f64) -> [f64; 2] {
        let Streams { on, back, kappa } = Streams::new(albedo, g, tau, ahead);
        [on, back].map(|over| over * (-kappa * tau).exp())
    }

    #[test]
    fn streams_solve_their_equations() {
        for (albedo, g) in [(1.0, -0.999), (0.95, -0.8), (0.5, -0.5), (1.0, -0.01), (0.0, -0.9), (0.9, 0.0)] {
            for total in [0.01, 1.0, 12.0] {
                let c = albedo * g * g;
                assert_eq!(irradiances(albedo, g, 0.0, total)[0], 1.0);
                assert_eq!(irradiances(albedo, g, total, 0.0)[1], 0.0);
                // Central differences: h²/6 of a third derivative up to 1, and roundings over h.
                let (h, tau) = (1e-4 * total, 0.3 * total);
                let at = |tau: f64| irradiances(albedo, g, tau, total - tau);
                let slope = |n: usize| (at(tau + h)[n] - at(tau - h)[n]) / (2.0 * h);
                let [on, back] = at(tau);
                let what = format!("albedo {albedo} g {g} total {total}");
                assert!((slope(0) - (c * back - on)).abs() < 1e-6, "{what}: {}", slope(0));
                assert!((slope(1) - (back - c * on)).abs() < 1e-6, "{what}: {}", slope(1));
                assert!(on >= (-tau).exp() * (1.0 - 1e-12) && on <= 1.0 && back <= 1.0, "{what}");
            }
        }
    }

    #[test]
    fn streams_are_finite_in_white_mirrors() {
        // kappa → 0: both linear, E₊ = (1 + A)/(1 + tau + A), E₋ = A/(1 + tau + A).
        let [on, back] = irradiances(1.0, -1.0, 2.0, 3.0);
        assert!((on - 4.0 / 6.0).abs() < 1e-15 && (back - 3.0 / 6.0).abs() < 1e-15, "{on} {back}");
    }

    /// ∫ phase · weight over the sphere by the midpoint rule, finer at both ends.
    fn moment(phase: impl Fn(f64) -> f64, weight: impl Fn(f64) -> f64) -> f64 {
        let n = 40_000;
        let half = |sign: f64| {
            let dt = (PI / 2.0).sqrt() / n as f64;
            (0..n)
                .map(|step| {
                    let t = (step as f64 + 0.5) * dt;
                    let mu = sign * (t * t).cos();
                    2.0 * PI * (t * t).sin() * phase(mu) * weight(mu) * 2.0 * t * dt
                })
                .sum::<f64>()
        };
        half(1.0) + half(-1.0)
    }

    #[test]
    fn phases_keep_power_and_mean_cosine() {
        // The midpoint rule as in `phase.rs`, and 1/f² of its error.
        for g in [-0.95, -0.8, -0.5, -0.2, -0.005] {
            for (n, cosine) in [(0, g), (1, -g)] {
                let phase = |mu: f64| phases(mu, g)[n];
                let (power, first) = (moment(phase, |_| 1.0), moment(phase, |mu| mu));
                assert!(
                    (power - 1.0).abs() < 1e-4 && (first - cosine).abs() < 1e-4,
                    "g {g}: {power} {first}"
                );
            }
        }
    }

    #[test]
    fn what_leaves_the_line_keeps_the_moments() {
        for g in [-0.99, -0.5, -0.1] {
            let f = g * g;
            assert!(((1.0 - f) * g_star(g) - f - g).abs() < 1e-15 && g_star(g) > -0.5, "g {g}");
        }
    }

    #[test]
    fn table_interpolates_the_phases() {
        // Linear on 255 steps in the root of sin(θ/2), at the narrowest 0.05 wide: 1 % of a peak that is 0.1 % of
        // the light; elsewhere 1e-3.
        for g in [-0.95, -0.5, -0.3] {
            let table = table(g);
            for mu in [-1.0, -0.99, -0.7, -0.2, 0.3, 0.9, 1.0] {
                let expected = [phases(mu, g)[0], phases(-mu, g)[1]];
                for (row, expected) in expected.into_iter().enumerate() {
                    let found = lookup(&table, row, mu);
                    let expected = expected.max(0.0);
                    assert!(
                        (found - expected).abs() < 2e-3 * expected + 1e-3,
                        "g {g} mu {mu}: {found} {expected}"
                    );
                }
            }
        }
        let few = table(-1e-9);
        assert!(few.iter().all(|value| (f64::from(*value) * 4.0 * PI - 1.0).abs() < 1e-6));
    }
}
