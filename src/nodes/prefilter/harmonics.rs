//! Convolution of a lat-long map with kernels that depend on the angle alone, through spherical harmonics.
//!
//! Y_lm = P_lm(z) e^{im phi}, orthonormal. a_lm = Σ texels L dω Y_lm*, a level's value at a direction is
//! Σ_l k_l Σ_m a_lm Y_lm. A row is a Fourier transform over phi (`fft.rs`), then for each m a sum over l or
//! rows, by the three-term recurrence of P_lm; rows north and south of the horizon share them, since
//! P_lm(−z) = (−1)^{l+m} P_lm(z). In f64, texels of the output in f32. Cost: n³/2 products per level and
//! channel for n degrees.
//!
//! A map is first spread by area on a grid of n … 4n rows and, a power of two, 2n … 4n columns, so that a
//! texel of light is neither finer than an eighth of the finest wave nor coarser than a half. Kernels are
//! given up to degree n, and must have vanished there. Limits: n up to 1000 (beyond, P_mm leaves f64 where
//! P_lm counts).
//! Tested with the kernel that a single texel gives, by folding, and by what a constant map gives.

use std::f64::consts::PI;

use rayon::prelude::*;

use super::fft::{Complex, Fft};
use super::kernel::N_LEVELS;

/// A picture of all directions: width, height, and radiance of channels row by row.
pub(super) struct Picture<'a> {
    pub width: usize,
    pub height: usize,
    pub texels: &'a (dyn Fn(usize, usize) -> [f64; 3] + Sync),
}

/// Three channels of complex numbers.
type Wave = [Complex; 3];

/// The picture under the kernel of each level: level after level, 2n columns and n rows of n degrees.
pub(super) fn convolve(picture: &Picture, factors: &[[f64; N_LEVELS]]) -> Vec<[f32; 3]> {
    let n = factors.len();
    let legendre = Legendre::new(n);
    let waves = analyze(picture, n, &legendre);
    let rows: Vec<[Vec<[f32; 3]>; 2]> =
        (0..n / 2).into_par_iter().map(|row| synthesize(row, factors, &waves, &legendre)).collect();
    let mut stack = vec![[0.0; 3]; N_LEVELS * n * 2 * n];
    for (pair, [north, south]) in rows.iter().enumerate() {
        for (row, line) in [(pair, north), (n - 1 - pair, south)] {
            for (level, line) in line.chunks_exact(2 * n).enumerate() {
                stack[(level * n + row) * 2 * n..][..2 * n].copy_from_slice(line);
            }
        }
    }
    stack
}

/// Coefficients a_lm for m = 0 …, of each l = m … n − 1.
fn analyze(picture: &Picture, n: usize, legendre: &Legendre) -> Vec<Vec<Wave>> {
    let n_rows = picture.height.clamp(n, 4 * n);
    let n_columns = picture.width.next_power_of_two().clamp(2 * n, 4 * n);
    let grid = spread(picture, n_rows, n_columns);
    let fft = Fft::new(n_columns);
    let rows: Vec<Vec<Wave>> = grid.par_chunks(n_columns).map(|row| row_waves(row, n, &fft)).collect();
    (0..n)
        .into_par_iter()
        .map(|m| {
            let mut waves = vec![Wave::default(); n - m];
            for (row, of_row) in rows.iter().enumerate() {
                let z = (PI * (0.5 - (row as f64 + 0.5) / n_rows as f64)).sin();
                legendre.each(m, z, |l, p| {
                    for (sum, value) in waves[l - m].iter_mut().zip(of_row[m]) {
                        sum.re += p * value.re;
                        sum.im += p * value.im;
                    }
                });
            }
            waves
        })
        .collect()
}

/// Σ_columns L dω e^{−im phi} for m below n.
fn row_waves(row: &[[f64; 3]], n: usize, fft: &Fft) -> Vec<Wave> {
    let n_columns = row.len();
    let mut waves = vec![Wave::default(); n];
    for c in 0..3 {
        let mut line: Vec<Complex> = row.iter().map(|texel| Complex::new(texel[c], 0.0)).collect();
        fft.transform(&mut line);
        for (m, wave) in waves.iter_mut().enumerate() {
            // Texels begin half a texel after phi = 0.
            wave[c] = line[m].times(Complex::turn(-PI * m as f64 / n_columns as f64));
        }
    }
    waves
}

/// Power L dω of the cells of a grid, from texels spread evenly over their areas.
fn spread(picture: &Picture, n_rows: usize, n_columns: usize) -> Vec<[f64; 3]> {
    let columns = overlaps(picture.width, n_columns);
    let rows = overlaps(picture.height, n_rows);
    let column_width = 2.0 * PI / n_columns as f64;
    let mut grid = vec![[0.0; 3]; n_rows * n_columns];
    grid.par_chunks_mut(n_columns).enumerate().for_each(|(row, line)| {
        for &(from_row, low, high) in &rows[row] {
            let edge = |v: f64| (PI * (0.5 - v)).sin();
            let height = edge(low) - edge(high);
            for (cell, from_columns) in line.iter_mut().zip(&columns) {
                for &(from_column, left, right) in from_columns {
                    let area = height * column_width * (right - left) * n_columns as f64;
                    let radiance = (picture.texels)(from_row, from_column);
                    for (sum, l) in cell.iter_mut().zip(radiance) {
                        *sum += area * l;
                    }
                }
            }
        }
    });
    grid
}

/// For each of `n` even parts of 0..1, which of `n_from` even parts it meets, and between which ends.
fn overlaps(n_from: usize, n: usize) -> Vec<Vec<(usize, f64, f64)>> {
    // Ends are compared as whole multiples of 1/(n n_from), so that none is met by rounding alone.
    let overlap = |part: usize| {
        let (low, high) = (part * n_from, (part + 1) * n_from);
        let end = |end: usize| end as f64 / (n * n_from) as f64;
        let met = |from: usize| (from, end(low.max(from * n)), end(high.min((from + 1) * n)));
        (low / n..high.div_ceil(n)).map(met).collect()
    };
    (0..n).map(overlap).collect()
}

/// The rows at the same distance from the horizon, levels one after the other.
fn synthesize(
    row: usize,
    factors: &[[f64; N_LEVELS]],
    waves: &[Vec<Wave>],
    legendre: &Legendre,
) -> [Vec<[f32; 3]>; 2] {
    let n = factors.len();
    let z = (PI * (0.5 - (row as f64 + 0.5) / n as f64)).sin();
    // Of each m, level and channel: what is even and what is odd in z.
    let mut sums = vec![[[[0.0_f64; 6]; N_LEVELS]; 2]; n];
    for (m, (sum, waves)) in sums.iter_mut().zip(waves).enumerate() {
        legendre.each(m, z, |l, p| {
            let [r, g, b] = waves[l - m];
            let wave = [r.re, r.im, g.re, g.im, b.re, b.im];
            for (sum, factor) in sum[(l + m) % 2].iter_mut().zip(&factors[l]) {
                let weight = p * factor;
                for (sum, wave) in sum.iter_mut().zip(wave) {
                    *sum += weight * wave;
                }
            }
        });
    }
    let fft = Fft::new(2 * n);
    [1.0, -1.0].map(|side| {
        let mut line = vec![[0.0; 3]; N_LEVELS * 2 * n];
        for (level, line) in line.chunks_exact_mut(2 * n).enumerate() {
            let spectrum = |c: usize| {
                sums.iter().enumerate().map(move |(m, sum)| {
                    let [even, odd] = [sum[0][level], sum[1][level]];
                    let value = Complex::new(
                        even[2 * c] + side * odd[2 * c],
                        even[2 * c + 1] + side * odd[2 * c + 1],
                    );
                    value.times(Complex::turn(PI * m as f64 / (2 * n) as f64))
                })
            };
            // Real rows by twos: one is the real part, the other the imaginary part.
            for (first, second) in [(0, Some(1)), (2, None)] {
                let mut wave = vec![Complex::default(); 2 * n];
                add_real(&mut wave, spectrum(first), Complex::new(1.0, 0.0));
                if let Some(second) = second {
                    add_real(&mut wave, spectrum(second), Complex::new(0.0, 1.0));
                }
                fft.transform(&mut wave);
                for (texel, value) in line.iter_mut().zip(&wave) {
                    texel[first] = value.re as f32;
                    if let Some(second) = second {
                        texel[second] = value.im as f32;
                    }
                }
            }
        }
        line
    })
}

/// Adds a real signal, times `factor`, as what the transform e^{−i…} makes of it: waves of e^{+im phi} stand
/// at −m.
fn add_real(wave: &mut [Complex], spectrum: impl Iterator<Item = Complex>, factor: Complex) {
    let n = wave.len();
    let mut add = |at: usize, value: Complex| {
        let turned = value.times(factor);
        wave[at].re += turned.re;
        wave[at].im += turned.im;
    };
    for (m, value) in spectrum.enumerate() {
        add((n - m) % n, value);
        if m > 0 {
            add(m, Complex::new(value.re, -value.im));
        }
    }
}

/// Orthonormal associated Legendre functions below a degree.
struct Legendre {
    /// ln of |P_mm| where sin θ = 1.
    ln_diagonal: Vec<f64>,
    /// For each m and l = m + 1 …: P_l = up (z P_{l−1} − down P_{l−2}).
    steps: Vec<Vec<[f64; 2]>>,
}

impl Legendre {
    fn new(n: usize) -> Self {
        let mut ln = -0.5 * (4.0 * PI).ln();
        let ln_diagonal = (0..n)
            .map(|m| {
                if m > 0 {
                    ln += 0.5 * ((2 * m + 1) as f64 / (2 * m) as f64).ln();
                }
                ln
            })
            .collect();
        let root = |l: usize, m: usize| {
            let (l, m) = (l as f64, m as f64);
            ((l * l - m * m) / (4.0 * l * l - 1.0)).sqrt()
        };
        let step = |l: usize, m: usize| [1.0 / root(l, m), root(l - 1, m)];
        let steps = (0..n).map(|m| (m + 1..n).map(|l| step(l, m)).collect()).collect();
        Self { ln_diagonal, steps }
    }

    /// Calls `with(l, P_lm(z))` for every l from m on whose value counts.
    fn each(&self, m: usize, z: f64, mut with: impl FnMut(usize, f64)) {
        let sine = (1.0 - z * z).max(0.0).sqrt();
        // P_mm is sine^m: near the poles it leaves f64's range, and grows no more than to e^{-n/e} of 1 there.
        let ln_first = self.ln_diagonal[m] + if m > 0 { m as f64 * sine.ln() } else { 0.0 };
        if ln_first < LN_SMALLEST {
            return;
        }
        let (mut before, mut p) = (0.0, ln_first.exp());
        with(m, p);
        for (idx, [up, down]) in self.steps[m].iter().enumerate() {
            let next = up * (z * p - down * before);
            (before, p) = (p, next);
            if p.abs() > NEGLIGIBLE {
                with(m + 1 + idx, p);
            }
        }
    }
}

/// ln of a value that is about to leave the range of f64.
const LN_SMALLEST: f64 = -650.0;
/// A value that is lost beside others of up to some ten.
const NEGLIGIBLE: f64 = 1e-16;

#[cfg(test)]
mod tests;
