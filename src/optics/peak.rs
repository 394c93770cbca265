//! K: what light adds that was scattered forward several times by small angles.
//!
//! Delta scaling counts the share f = g² of the scattered light as not scattered. That light is in
//! the beam E* − E0, but it is spread out a little: folded (k+1) times with itself, HG(g) is
//! HG(g^{k+1}), and k of the peak's events on an optical depth are Poisson distributed. With x the
//! scattering optical depth albedo (tau_light + tau_camera),
//!
//! K = max(0, \[(1−f) + 3(g−f) mu\]/4π + Σ_{k≥1} p_k/(k+1) f^{−k} \[HG(g^{k+1}; mu) − ((1−f^{k+1})
//! + 3(g^{k+1}−f^{k+1}) mu)/4π\]), p_k = Poisson(k; x f)/(1 − e^{−x f}).
//!
//! The residual lobe already carries the first two moments, so they are taken off; 1/(k+1) because
//! gathering along the way counts a (k+1)-fold path k+1 times. Where f^{k+1} < 1e-10 a term is its
//! limit f (1 + 3mu + 5P₂(mu))/4π/(k+1). Units [1/sr], mu the cosine of the scattering angle.
//!
//! The table has [`ROWS`] rows over x and [`COLUMNS`] columns over mu, finer towards x = 0 and
//! towards the peak: row 63 √(x/60), column 255 √(sin(θ/2)); x is clamped to [`X_MAX`] and the
//! first row is x = 1e-6. Made in f64, stored in f32. For g ≤ 0 there is no peak and K is 0. Tested
//! against the series summed another way, by the limits in x and g, and by the error of the
//! interpolation.

use super::phase::hg;
use std::f64::consts::PI;

/// Columns of the table, over the scattering angle.
pub const COLUMNS: usize = 256;
/// Rows of the table, over x.
pub const ROWS: usize = 64;
/// The largest scattering optical depth x of the table.
pub const X_MAX: f64 = 60.0;
/// Terms of the series: for x f ≤ 60 the Poisson tail above 119 is below 1e-10.
const N_TERMS: usize = 119;
/// Below this share of light a folded peak is replaced by its limit.
const SMALLEST_SHARE: f64 = 1e-10;

/// The table of K for mean cosine `g` in (−1, 1): [`ROWS`] × [`COLUMNS`] values [1/sr], columns
/// fastest; all 0 for g ≤ 0.
pub fn peak_table(g: f64) -> Vec<f32> {
    let mut table = vec![0.0; ROWS * COLUMNS];
    if g <= 0.0 {
        return table;
    }
    let weights: Vec<_> = (0..ROWS).map(|row| poisson_weights(x_of_row(row) * g * g)).collect();
    for column in 0..COLUMNS {
        let mu = mu_of_column(column);
        let (smooth, folds) = (smooth_part(mu, g), folded_peaks(mu, g));
        for (row, weights) in weights.iter().enumerate() {
            let peaks: f64 = weights.iter().zip(&folds).map(|(weight, fold)| weight * fold).sum();
            table[row * COLUMNS + column] = (smooth + peaks).max(0.0) as f32;
        }
    }
    table
}

/// K by bilinear interpolation in a table of [`peak_table`], for x ≥ 0 and the cosine `mu`.
pub fn lookup(table: &[f32], x: f64, mu: f64) -> f64 {
    let (column, across) = split((0.5 * (1.0 - mu)).max(0.0).sqrt().sqrt() * (COLUMNS - 1) as f64, COLUMNS);
    let (row, along) = split((x.clamp(0.0, X_MAX) / X_MAX).sqrt() * (ROWS - 1) as f64, ROWS);
    let in_row = |row: usize| {
        let start = row * COLUMNS + column;
        (1.0 - across) * f64::from(table[start]) + across * f64::from(table[start + 1])
    };
    (1.0 - along) * in_row(row) + along * in_row(row + 1)
}

/// \[(1−f) + 3(g−f) mu\]/4π: the part of K that has not been folded.
fn smooth_part(mu: f64, g: f64) -> f64 {
    let f = g * g;
    ((1.0 - f) + 3.0 * (g - f) * mu) / (4.0 * PI)
}

/// The terms k = 1 … of the series without p_k.
fn folded_peaks(mu: f64, g: f64) -> [f64; N_TERMS] {
    let f = g * g;
    let p2 = 1.5 * mu * mu - 0.5;
    let mut g_power = g;
    let mut share_before = 1.0;
    std::array::from_fn(|index| {
        let n_fold = (index + 2) as f64;
        g_power *= g;
        share_before *= f;
        let share = share_before * f;
        let fold = if share > SMALLEST_SHARE {
            (hg(mu, g_power) - ((1.0 - share) + 3.0 * (g_power - share) * mu) / (4.0 * PI)) / share_before
        } else {
            f * (1.0 + 3.0 * mu + 5.0 * p2) / (4.0 * PI)
        };
        fold / n_fold
    })
}

/// p_k = Poisson(k; mean)/(1 − e^{−mean}), k = 1 …
fn poisson_weights(mean: f64) -> [f64; N_TERMS] {
    let mut weight = if mean > 0.0 { mean / mean.exp_m1() } else { 1.0 };
    std::array::from_fn(|index| {
        let here = weight;
        weight *= mean / (index + 2) as f64;
        here
    })
}

/// Cosine of a column.
fn mu_of_column(column: usize) -> f64 {
    let root = column as f64 / (COLUMNS - 1) as f64;
    1.0 - 2.0 * root.powi(4)
}

/// Scattering optical depth of a row.
fn x_of_row(row: usize) -> f64 {
    let root = row as f64 / (ROWS - 1) as f64;
    (root * root * X_MAX).max(1e-6)
}

/// Position in a line of `n` samples as the lower sample and the weight of the upper one.
fn split(position: f64, n: usize) -> (usize, f64) {
    let lower = (position as usize).min(n - 2);
    (lower, position - lower as f64)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The series by logarithms, Legendre-free, 400 terms: written apart from the code under test.
    fn direct_series(x: f64, mu: f64, g: f64) -> f64 {
        let f = g * g;
        let mean = x * f;
        let mut sum = ((1.0 - f) + 3.0 * (g - f) * mu) / (4.0 * PI);
        let mut ln_factorial = 0.0;
        for k in 1..400 {
            ln_factorial += f64::from(k).ln();
            let p = (f64::from(k) * mean.ln() - mean - ln_factorial).exp() / (1.0 - (-mean).exp());
            let (gn, fn_) = (g.powi(k + 1), f.powi(k + 1));
            let denominator = (1.0 + gn * gn - 2.0 * gn * mu).powf(1.5);
            let term = if fn_ > 1e-10 {
                f.powi(-k) * ((1.0 - gn * gn) / denominator - (1.0 - fn_) - 3.0 * (gn - fn_) * mu)
            } else {
                f * (1.0 + 3.0 * mu + 2.5 * (3.0 * mu * mu - 1.0))
            };
            sum += p * term / (4.0 * PI * f64::from(k + 1));
        }
        sum.max(0.0)
    }

    #[test]
    fn table_is_the_series() {
        for g in [0.1, 0.5, 0.85, 0.95, 0.999] {
            let table = peak_table(g);
            for row in [1, 5, 20, 40, 63] {
                for column in [0, 1, 30, 128, 200, 255] {
                    let expected = direct_series(x_of_row(row), mu_of_column(column), g);
                    let found = f64::from(table[row * COLUMNS + column]);
                    // f32 holds 6e-8 of the value; f^−k up to 1e10·f times a difference of order
                    // 1/4π loses 1e-16 · 1e10 absolutely at most, and the naive denominator of the
                    // check loses 2e-16/(1−g)² of the peak.
                    let tolerance = expected * (1e-7 + 1e-15 / ((1.0 - g) * (1.0 - g))) + 2e-6;
                    assert!(
                        (found - expected).abs() < tolerance,
                        "g {g} row {row} column {column}: {found} against {expected}"
                    );
                }
            }
        }
    }

    #[test]
    fn at_small_depth_one_fold_remains() {
        // x → 0: p_1 = 1, so K = smooth + f⁻¹/2 [HG(g²) − moments].
        let (g, mu) = (0.6, 0.9);
        let f = g * g;
        let fold = hg(mu, f) - ((1.0 - f * f) + 3.0 * (f - f * f) * mu) / (4.0 * PI);
        let expected = smooth_part(mu, g) + fold / (2.0 * f);
        // One row of the table apart from x = 0: p_2 = x f / 2 at 1e-6; the column's interpolation
        // errs by 1e-4 of K.
        assert!((lookup(&peak_table(g), 0.0, mu) - expected).abs() < 1e-3 * expected);
    }

    #[test]
    fn lookup_interpolates_the_series() {
        // Bilinear on a grid of 63 × 255 steps in the square roots: the worst found here is 0.09 % of
        // the value, and half as much again is allowed.
        for g in [0.3, 0.75, 0.9] {
            let table = peak_table(g);
            for x in [0.05, 0.7, 3.0, 11.0, 47.0] {
                for mu in [-0.9, 0.1, 0.8, 0.99, 1.0] {
                    let expected = direct_series(x, mu, g);
                    let found = lookup(&table, x, mu);
                    assert!(
                        (found - expected).abs() < 1.3e-3 * expected + 1e-6,
                        "g {g} x {x} mu {mu}: {found} against {expected}"
                    );
                }
            }
            assert_eq!(lookup(&table, 60.0, 0.3), lookup(&table, 1e9, 0.3));
        }
    }

    #[test]
    fn no_peak_without_forward_scattering() {
        assert!(peak_table(0.0).iter().chain(&peak_table(-0.9)).all(|value| *value == 0.0));
        assert!(
            peak_table(1e-200)
                .iter()
                .chain(&peak_table(0.999))
                .all(|value| value.is_finite() && *value >= 0.0)
        );
    }
}
