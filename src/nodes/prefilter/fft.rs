//! The discrete Fourier transform of a row, radix 2 (Cooley, Tukey 1965).
//!
//! X_m = Σ_n x_n e^{−2πi mn/N}, in place, N a power of two; f64. Tested against the sum itself.

use std::f64::consts::PI;

/// A complex number.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub(super) struct Complex {
    pub re: f64,
    pub im: f64,
}

impl Complex {
    pub(super) fn new(re: f64, im: f64) -> Self {
        Self { re, im }
    }

    /// e^{i angle}.
    pub(super) fn turn(angle: f64) -> Self {
        Self { re: angle.cos(), im: angle.sin() }
    }

    pub(super) fn times(self, other: Self) -> Self {
        Self::new(self.re * other.re - self.im * other.im, self.re * other.im + self.im * other.re)
    }
}

/// A transform of one length.
pub(super) struct Fft {
    /// e^{−2πi k/N}, k up to N/2.
    roots: Vec<Complex>,
}

impl Fft {
    /// Of `n` numbers, a power of two.
    pub(super) fn new(n: usize) -> Self {
        assert!(n.is_power_of_two(), "a transform of {n} numbers");
        Self { roots: (0..n / 2).map(|k| Complex::turn(-2.0 * PI * k as f64 / n as f64)).collect() }
    }

    /// Replaces a row by its transform.
    pub(super) fn transform(&self, row: &mut [Complex]) {
        let n = row.len();
        let bits = n.trailing_zeros();
        for idx in 0..n {
            let reversed = if bits == 0 { 0 } else { idx.reverse_bits() >> (usize::BITS - bits) };
            if idx < reversed {
                row.swap(idx, reversed);
            }
        }
        let mut half = 1;
        while half < n {
            let stride = n / (2 * half);
            for block in row.chunks_exact_mut(2 * half) {
                let (low, high) = block.split_at_mut(half);
                for (k, (a, b)) in low.iter_mut().zip(high).enumerate() {
                    let turned = b.times(self.roots[k * stride]);
                    *b = Complex::new(a.re - turned.re, a.im - turned.im);
                    *a = Complex::new(a.re + turned.re, a.im + turned.im);
                }
            }
            half *= 2;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::nodes::testing::Random;

    #[test]
    fn transforms_are_their_sums() {
        let mut random = Random(5);
        for n in [1, 2, 4, 64] {
            let row: Vec<_> = (0..n).map(|_| Complex::new(random.unit(), random.unit())).collect();
            let mut found = row.clone();
            Fft::new(n).transform(&mut found);
            for (m, found) in found.iter().enumerate() {
                let (mut re, mut im) = (0.0, 0.0);
                for (k, x) in row.iter().enumerate() {
                    let turned = x.times(Complex::turn(-2.0 * PI * (m * k) as f64 / n as f64));
                    re += turned.re;
                    im += turned.im;
                }
                // 64 terms of f64.
                assert!((re - found.re).abs() < 1e-12 && (im - found.im).abs() < 1e-12, "{n} {m}");
            }
        }
    }
}
