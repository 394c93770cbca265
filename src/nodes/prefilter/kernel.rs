//! What forward scattering does to an environment that is seen through x scatterings of the peak.
//!
//! B_x(mu) = e^−x Σ_{j≥1} x^j/j! w(mu) peak_j(mu) [1/sr], peak_j = f^−j [HG(g^j) − (1 + 3 g^j mu)/4π] +
//! (1 + 3mu)/4π, w the window (DESIGN 6.5): 0 at the outer angle, its share at the inner, smoothstep in mu between.
//! As a convolution it is a factor for each degree l of spherical harmonics, 2π ∫ B_x P_l dmu. That of
//! w = 1 is known: f^−j g^{jl} sums up to e^−x (e^{x g^{l−2}} − 1), and 1 − e^−x for l = 0 and 1. What a
//! window of share 1 takes off, (1 − w) peak_j, begins at the inner angle, where there is no peak: it is integrated
//! by even samples of θ, in which it is periodic. Where f^j < 1e-10 peak_j is its limit, (1 + 3mu + 5P₂)/4π.
//!
//! Degrees end at the grid's. A peak that still has power there would ring, below zero next to a bright spot: all
//! is smoothed by a Gaussian on the sphere (a factor e^{−s² l(l+1)/2}, positive, short of tail), s so that the
//! first peak has fallen to e^−10 at the last degree: s = 0 for g up to 0.961 on the largest grid, 0.9° for
//! 0.99 and at most 1°. What rings is then under 3e-4/sr. Kernels are negative by
//! themselves, by up to 0.061/sr (60 to 120 degrees), inside the outer angle: there so much is taken off the ordinates.
//! `turns` are three angles of B_{x/2}, for the eye that asks which way light comes when it is half way.
//! Tested by values of the kernel itself, and by folding.

use std::f64::consts::PI;

use rayon::prelude::*;

use crate::light::Window;
use crate::light::environment::{STACK_TURNS, STACK_X};
use crate::optics::phase::hg;

/// Levels of the stack.
pub(super) const N_LEVELS: usize = STACK_X.len();
/// Samples over the angle.
const N_SAMPLES: usize = 4096;
/// Folds of the peak: for x = 48 the Poisson tail above is 1e-9.
const N_FOLDS: usize = 98;
/// Below this share of light a folded peak is replaced by its limit.
const SMALLEST_SHARE: f64 = 1e-10;
/// −ln of what is left of a peak at the last degree.
const FALLEN: f64 = 10.0;

/// The fewest degrees that hold the peak of this g, with what the window needs.
pub(super) fn degrees_needed(g: f64) -> f64 {
    FALLEN / (1.0 - g)
}

/// The factor of each level for each degree below `n_degrees`.
pub(super) fn factors(g: f64, window: Window, n_degrees: usize) -> Vec<[f64; N_LEVELS]> {
    let mut factors = unwindowed(g, n_degrees);
    for (factor, taken) in factors.iter_mut().zip(taken_by_window(g, window, n_degrees)) {
        (0..N_LEVELS).for_each(|level| factor[level] -= taken[level]);
    }
    let variance = smoothing(g, n_degrees);
    for (l, factor) in factors.iter_mut().enumerate() {
        let kept = (-0.5 * variance * (l * (l + 1)) as f64).exp();
        factor.iter_mut().for_each(|factor| *factor *= window.share * kept);
    }
    factors
}

/// s² [rad²] of the Gaussian that kernels on so many degrees are smoothed by.
fn smoothing(g: f64, n_degrees: usize) -> f64 {
    let n = n_degrees as f64;
    2.0 * (FALLEN + n * g.ln()).max(0.0) / (n * n)
}

fn unwindowed(g: f64, n_degrees: usize) -> Vec<[f64; N_LEVELS]> {
    let factor = |l: usize| STACK_X.map(|x| (x * (g.powi(l.max(2) as i32 - 2) - 1.0)).exp() - (-x).exp());
    (0..n_degrees).map(factor).collect()
}

fn taken_by_window(g: f64, window: Window, n_degrees: usize) -> Vec<[f64; N_LEVELS]> {
    let [cos_inner, cos_outer] = window.cosines();
    let samples: Vec<(f64, [f64; N_LEVELS])> = (0..N_SAMPLES)
        .into_par_iter()
        .map(|idx| {
            let theta = PI * (idx as f64 + 0.5) / N_SAMPLES as f64;
            let mu = theta.cos();
            let taken = 1.0 - smoothstep((mu - cos_outer) / (cos_inner - cos_outer));
            let area = 2.0 * PI * theta.sin() * PI / N_SAMPLES as f64;
            let peaks = if taken > 0.0 { peaks(mu, g) } else { [0.0; N_LEVELS] };
            (mu, peaks.map(|peak| taken * area * peak))
        })
        .collect();
    let samples: Vec<_> = samples.into_iter().filter(|(_, taken)| taken[N_LEVELS - 1] != 0.0).collect();
    // P_l of all samples, from degree to degree.
    let mut before = vec![0.0; samples.len()];
    let mut legendre = vec![1.0; samples.len()];
    (0..n_degrees)
        .map(|l| {
            let mut sum = [0.0; N_LEVELS];
            for ((mu, taken), (p, before)) in samples.iter().zip(legendre.iter_mut().zip(&mut before)) {
                (0..N_LEVELS).for_each(|level| sum[level] += taken[level] * *p);
                let next = ((2 * l + 1) as f64 * mu * *p - l as f64 * *before) / (l + 1) as f64;
                *before = std::mem::replace(p, next);
            }
            sum
        })
        .collect()
}

fn smoothstep(t: f64) -> f64 {
    let t = t.clamp(0.0, 1.0);
    t * t * (3.0 - 2.0 * t)
}

/// The angles [rad] at the middles of even parts of what half of the scatterings of each level do, w B_{x/2} where
/// it is positive.
pub(super) fn turns(g: f64, window: Window) -> [[f32; STACK_TURNS]; N_LEVELS] {
    let [cos_inner, cos_outer] = window.cosines();
    // Nothing is scattered at x = 0: the limit, once.
    let halves = STACK_X.map(|x| 0.5 * x.max(1e-3));
    // Finer towards the peak.
    let angle = |idx: usize| PI * (idx as f64 / N_SAMPLES as f64).powi(2);
    let parts: Vec<[f64; N_LEVELS]> = (0..N_SAMPLES)
        .into_par_iter()
        .map(|idx| {
            let (low, high) = (angle(idx), angle(idx + 1));
            let mu = (0.5 * (low + high)).cos();
            let kept = smoothstep((mu - cos_outer) / (cos_inner - cos_outer));
            let area = low.cos() - high.cos();
            if kept > 0.0 {
                folded(mu, g, &halves).map(|b| (kept * area * b).max(0.0))
            } else {
                [0.0; N_LEVELS]
            }
        })
        .collect();
    std::array::from_fn(|level| {
        let total: f64 = parts.iter().map(|part| part[level]).sum();
        if total <= 0.0 {
            // A window that lets nothing through turns nothing.
            return [0.0; STACK_TURNS];
        }
        std::array::from_fn(|turn| {
            let mut rest = (turn as f64 + 0.5) / STACK_TURNS as f64 * total;
            let idx = parts.iter().position(|part| {
                rest -= part[level];
                rest <= 0.0
            });
            idx.map_or(0.0, |idx| angle(idx + 1) + rest / parts[idx][level] * (angle(idx + 1) - angle(idx)))
                as f32
        })
    })
}

/// e^−x Σ_j x^j/j! peak_j for each level.
fn peaks(mu: f64, g: f64) -> [f64; N_LEVELS] {
    folded(mu, g, &STACK_X)
}

/// The same for each of these x.
fn folded(mu: f64, g: f64, xs: &[f64; N_LEVELS]) -> [f64; N_LEVELS] {
    let mut weights = xs.map(|x| (-x).exp());
    let mut sums = [0.0; N_LEVELS];
    for j in 1..=N_FOLDS {
        let peak = peak(j, mu, g);
        for level in 0..N_LEVELS {
            weights[level] *= xs[level] / j as f64;
            sums[level] += weights[level] * peak;
        }
    }
    sums
}

/// peak_j [1/sr].
fn peak(j: usize, mu: f64, g: f64) -> f64 {
    let g_j = g.powi(j as i32);
    let share = g_j * g_j;
    let folded = if share > SMALLEST_SHARE {
        (hg(mu, g_j) - (1.0 + 3.0 * g_j * mu) / (4.0 * PI)) / share
    } else {
        5.0 * (1.5 * mu * mu - 0.5) / (4.0 * PI)
    };
    folded + (1.0 + 3.0 * mu) / (4.0 * PI)
}

#[cfg(test)]
mod tests {
    use super::*;

    const WINDOW: Window = Window { inner_deg: 30.0, outer_deg: 70.0, share: 0.8 };

    /// A kernel from its factors.
    fn kernel(factors: &[[f64; N_LEVELS]], level: usize, mu: f64) -> f64 {
        let (mut before, mut p, mut sum) = (0.0, 1.0, 0.0);
        for (l, factor) in factors.iter().enumerate() {
            sum += (2 * l + 1) as f64 / (4.0 * PI) * factor[level] * p;
            let next = ((2 * l + 1) as f64 * mu * p - l as f64 * before) / (l + 1) as f64;
            (before, p) = (p, next);
        }
        sum
    }

    fn windowed(mu: f64, g: f64) -> [f64; N_LEVELS] {
        let [inner, outer] = WINDOW.cosines();
        peaks(mu, g).map(|peak| 0.8 * peak * smoothstep((mu - outer) / (inner - outer)))
    }

    #[test]
    fn factors_are_the_kernel() {
        // 256 degrees hold these peaks to 256 · 0.85^256 = 2e-16: what is left is the series' end of the window's
        // corners, second derivatives of up to 10 that jump: 10/256²; and twice that at 180°, where all degrees of
        // the samples' error add up.
        for g in [0.05, 0.5, 0.85] {
            let factors = factors(g, WINDOW, 256);
            for degrees in [0.0, 2.0, 8.0, 25.0, 35.0, 50.0, 65.0, 75.0, 120.0, 180.0_f64] {
                let mu = degrees.to_radians().cos();
                for (level, expected) in windowed(mu, g).into_iter().enumerate() {
                    let found = kernel(&factors, level, mu);
                    assert!(
                        (found - expected).abs() < 4e-4 + 1e-5 * expected.abs(),
                        "g {g}, {degrees} deg, level {level}: {found} against {expected}"
                    );
                }
            }
        }
    }

    #[test]
    fn turns_are_the_angles_of_even_parts() {
        // Hardly windowed and x small, the kernel is HG where HG is above its first moments: its share beyond
        // an angle is known, with F(mu) = (1-g²)/2g (1/(1-g) - 1/√(1+g²-2g mu)) of HG and (1-mu)/2 + 3g (1-mu²)/4
        // of the moments taken off, and (1-mu)/2 + 3(1-mu²)/4 times g² put back.
        let (g, wide) = (0.8_f64, Window { inner_deg: 178.0, outer_deg: 179.0, share: 0.5 });
        let f = g * g;
        let below = |mu: f64| {
            let hg = (1.0 - f) / (2.0 * g) * (1.0 / (1.0 - g) - 1.0 / (1.0 + f - 2.0 * g * mu).sqrt());
            let (even, tilted) = (0.5 * (1.0 - mu), 0.75 * (1.0 - mu * mu));
            hg - (even + g * tilted) + f * (even + tilted)
        };
        // Wherever the kernel is positive: it is so ahead, and a little behind.
        let samples: Vec<f64> = (0..=200_000).map(|n| below(1.0 - n as f64 * 1e-5)).collect();
        let total: f64 = samples.windows(2).map(|pair| (pair[1] - pair[0]).max(0.0)).sum();
        let found = turns(g, wide);
        for (turn, share) in found[0].into_iter().zip([1.0 / 6.0, 0.5, 5.0 / 6.0]) {
            let found = below(f64::from(turn).cos()) / total;
            // Midpoints of steps of some 3e-4 of the angle, and 5e-4 of twice scattered.
            assert!((found - share).abs() < 1e-3, "{found} against {share}");
        }
        // More scatterings turn light further; the window ends it.
        for g in [0.3, 0.9, 0.999] {
            let found = turns(g, WINDOW);
            assert!(
                found.iter().all(|turns| turns.is_sorted() && turns[2].to_degrees() <= 70.1),
                "{found:?}"
            );
            assert!(found.windows(2).all(|pair| pair[1][1] >= pair[0][1] - 1e-3), "{found:?}");
        }
    }

    #[test]
    fn one_fold_is_scattering_once_and_many_are_smooth() {
        // x -> 0: peak_1 = (HG(g) - W)/f, whose factors are g^{l-2}.
        for (l, factor) in unwindowed(0.8, 12).into_iter().enumerate() {
            let x = STACK_X[1];
            let first = x * (-x).exp() * if l < 2 { 1.0 } else { 0.8f64.powi(l as i32 - 2) };
            assert!((factor[1] / first - 1.0).abs() < 0.6 * x, "{l}: {} {first}", factor[1]);
            // 48 folds of g = 0.8: nothing is left of degrees above 2 but e^-48(1 - g^{l-2}).
            let rest = if l < 3 { 1.0 } else { (-48.0 * (1.0 - 0.8f64.powi(l as i32 - 2))).exp() };
            assert!((factor[15] - rest).abs() < 1e-12);
            assert_eq!(factor[0], 0.0);
        }
    }

    #[test]
    fn narrow_peaks_are_smoothed_and_do_not_ring() {
        let deviation_deg = |g| smoothing(g, 256).sqrt().to_degrees();
        assert_eq!(deviation_deg(0.961), 0.0);
        assert!((0.8..0.9).contains(&deviation_deg(0.99)) && (0.9..1.0).contains(&deviation_deg(0.9999)));
        let found = factors(0.99, WINDOW, 256);
        let values: Vec<f64> =
            (0..140).map(|half| kernel(&found, 1, (0.5 * f64::from(half)).to_radians().cos())).collect();
        for (half, pair) in values.windows(2).enumerate() {
            // It falls with the angle, as HG does, to what e^-10 of its degrees can add.
            assert!(
                pair[1] < pair[0] + 1e-4 * values[0],
                "{} deg: {} after {}",
                0.5 * half as f64,
                pair[1],
                pair[0]
            );
        }
    }
}
