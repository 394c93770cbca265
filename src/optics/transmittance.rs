//! Forms of e^{−x} that keep their digits from x = 0 to where e^{−x} underflows.
//!
//! A beam that loses optical depth x hands over 1 − e^{−x}; its mean along the way is (1 −
//! e^{−x})/x; a source that rises linearly along the way adds [`linear_source_weight`]. Written
//! naively all of these cancel where x is small. Arguments: x ≥ 0, finite. Tested against series,
//! and against the naive forms where those are good.

/// 1 − e^{−x}: the share that an optical depth `x` removes.
pub fn one_minus_exp(x: f64) -> f64 {
    -(-x).exp_m1()
}

/// (1 − e^{−x})/x: mean of e^{−t} over t in [0, x]; 1 at x = 0.
pub fn mean_transmittance(x: f64) -> f64 {
    if x == 0.0 { 1.0 } else { one_minus_exp(x) / x }
}

/// 1 − (1 − e^{−x})/x: what [`mean_transmittance`] lacks of 1; x/2 where x is small.
pub fn one_minus_mean_transmittance(x: f64) -> f64 {
    // Σ_{m≥1} (−1)^{m+1} x^m / (m+1)!
    if x < SERIES_BELOW { alternating_series(x, 1, |_| 1.0) } else { 1.0 - one_minus_exp(x) / x }
}

/// (e^{−a} − e^{−b})/(b − a): mean of e^{−t} over t between `a` and `b`, in either order.
pub fn mean_exp(a: f64, b: f64) -> f64 {
    (-a.min(b)).exp() * mean_transmittance((b - a).abs())
}

/// G = 2 − E − 2E/x with E = 1 − e^{−x}: what a source that rises from −1 to 1 along an optical
/// depth `x` sends out at the end; x²/6 where x is small.
pub fn linear_source_weight(x: f64) -> f64 {
    // Σ_{m≥2} (−1)^m (m−1) x^m / (m+1)!
    if x < SERIES_BELOW {
        -alternating_series(x, 2, |m| -(m - 1.0))
    } else {
        let e = one_minus_exp(x);
        2.0 - e - 2.0 * e / x
    }
}

/// Below this optical depth the series stand in: at 1 the closed form of G has lost one digit, and
/// a series of 20 terms none.
const SERIES_BELOW: f64 = 1.0;

/// Σ_{m ≥ first} ∓ coefficient(m) x^m / (m+1)!, the sign of the first term the coefficient's own,
/// twenty terms.
fn alternating_series(x: f64, first: i32, coefficient: impl Fn(f64) -> f64) -> f64 {
    let mut term = (1..=first).fold(1.0, |product, m| product * x / f64::from(m + 1));
    let mut sum = 0.0;
    for m in first..first + 20 {
        sum += coefficient(f64::from(m)) * term;
        term *= -x / f64::from(m + 2);
    }
    sum
}

#[cfg(test)]
mod tests {
    use super::*;

    fn assert_close(found: f64, expected: f64, relative: f64, what: &str) {
        assert!((found - expected).abs() <= relative * expected.abs(), "{what}: {found} against {expected}");
    }

    #[test]
    fn agree_with_the_naive_forms_where_those_are_good() {
        // Naive forms cancel to about epsilon / G(x); G(0.5) = 0.03.
        for x in [0.5f64, 0.999, 1.0, 1.001, 3.0, 30.0, 700.0, 1e4] {
            let e = 1.0 - (-x).exp();
            assert_close(one_minus_exp(x), e, 1e-14, "one_minus_exp");
            assert_close(mean_transmittance(x), e / x, 1e-14, "mean_transmittance");
            assert_close(one_minus_mean_transmittance(x), 1.0 - e / x, 1e-14, "one_minus_mean_transmittance");
            assert_close(linear_source_weight(x), 2.0 - e - 2.0 * e / x, 1e-13, "linear_source_weight");
        }
    }

    #[test]
    fn keep_their_digits_where_x_is_small() {
        // The neglected terms are x/3 and x/2 relative to those written.
        for x in [1e-300, 1e-12, 1e-9] {
            assert_close(one_minus_exp(x), x, x.max(f64::EPSILON), "one_minus_exp");
            assert_close(mean_transmittance(x), 1.0, x.max(f64::EPSILON), "mean_transmittance");
            assert_close(
                one_minus_mean_transmittance(x),
                x / 2.0,
                x.max(4.0 * f64::EPSILON),
                "one_minus_mean_transmittance",
            );
        }
        for x in [1e-150f64, 1e-9] {
            assert_close(
                linear_source_weight(x),
                x * x / 6.0,
                x.max(4.0 * f64::EPSILON),
                "linear_source_weight",
            );
        }
        assert_eq!(mean_transmittance(0.0), 1.0);
        assert_eq!(one_minus_mean_transmittance(0.0), 0.0);
        assert_eq!(linear_source_weight(0.0), 0.0);
    }

    #[test]
    fn mean_between_two_depths() {
        assert_close(mean_exp(1.0, 3.0), ((-1.0f64).exp() - (-3.0f64).exp()) / 2.0, 1e-14, "mean_exp");
        assert_eq!(mean_exp(1.0, 3.0), mean_exp(3.0, 1.0));
        assert_close(mean_exp(2.0, 2.0 + 1e-10), (-2.0f64 - 0.5e-10).exp(), 1e-15, "nearly equal");
        assert_eq!(mean_exp(2.0, 2.0), (-2.0f64).exp());
        assert_eq!(mean_exp(1e4, 2e4), 0.0);
    }
}
