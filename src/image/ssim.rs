//! Structural similarity of two pictures.
//!
//! Wang, Bovik, Sheikh, Simoncelli, "Image quality assessment: from error visibility to
//! structural similarity", IEEE TIP 13(4), 2004, eq. 13: local means, variances and covariance
//! in an 11×11 Gaussian window, σ = 1.5 pixels, K1 = 0.01, K2 = 0.03, for signals in 0..=1.
//! As in the authors' program, the mean is over the pixels whose whole window lies inside.
//! Along an axis shorter than 11 pixels all count, with the part of the window that is inside.
//!
//! Ours: the kept crates need the `image` crate. Moments are in f64, since variances are
//! differences. Tested: identity, a closed form, and the value that scikit-image 0.26 gives.

use rayon::prelude::*;

const RADIUS: usize = 5;
const SIGMA: f64 = 1.5;
const C1: f64 = 0.01 * 0.01;
const C2: f64 = 0.03 * 0.03;

/// Mean similarity of two signals in 0..=1, `width * height` values each; 1 for equal ones.
///
/// # Panics
/// If a length does not fit the size.
pub fn mean_ssim(width: usize, height: usize, a: &[f64], b: &[f64]) -> f64 {
    assert_eq!([a.len(), b.len()], [width * height; 2]);
    let moments: Vec<[f64; 5]> = a.iter().zip(b).map(|(a, b)| [*a, *b, a * a, b * b, a * b]).collect();
    let moments = blur(width, height, &moments);
    let (columns, rows) = (inside(width), inside(height));
    let count = columns.len() * rows.len();
    let row_sum = |y: usize| {
        let row = &moments[y * width..][columns.clone()];
        row.iter().map(similarity).sum::<f64>()
    };
    // Sums by row are added in order: the result does not depend on the threads.
    let sums: Vec<f64> = rows.into_par_iter().map(row_sum).collect();
    sums.iter().sum::<f64>() / count as f64
}

fn inside(size: usize) -> std::ops::Range<usize> {
    if size > 2 * RADIUS { RADIUS..size - RADIUS } else { 0..size }
}

fn similarity(&[ma, mb, aa, bb, ab]: &[f64; 5]) -> f64 {
    let (va, vb, covariance) = (aa - ma * ma, bb - mb * mb, ab - ma * mb);
    (2.0 * ma * mb + C1) * (2.0 * covariance + C2) / ((ma * ma + mb * mb + C1) * (va + vb + C2))
}

/// Gaussian means, with the window cut at the border and its weights scaled to sum 1.
fn blur(width: usize, height: usize, values: &[[f64; 5]]) -> Vec<[f64; 5]> {
    let along = |at: usize, size: usize, value: &dyn Fn(usize) -> [f64; 5]| {
        let (mut sum, mut weights) = ([0.0; 5], 0.0);
        for i in at.saturating_sub(RADIUS)..(at + RADIUS + 1).min(size) {
            let weight = (-0.5 * (i as f64 - at as f64).powi(2) / (SIGMA * SIGMA)).exp();
            weights += weight;
            for (sum, v) in sum.iter_mut().zip(value(i)) {
                *sum += weight * v;
            }
        }
        sum.map(|v| v / weights)
    };
    let pixels = 0..width * height;
    let row_wise: Vec<[f64; 5]> = pixels
        .clone()
        .into_par_iter()
        .map(|p| along(p % width, width, &|x| values[p / width * width + x]))
        .collect();
    pixels.into_par_iter().map(|p| along(p / width, height, &|y| row_wise[y * width + p % width])).collect()
}

#[cfg(test)]
mod tests {
    use super::super::flip::tests::{HEIGHT, WIDTH, pattern};
    use super::*;

    fn luma(rgb: &[[f64; 3]]) -> Vec<f64> {
        let luma = |[r, g, b]: &[f64; 3]| 0.2126 * r + 0.7152 * g + 0.0722 * b;
        rgb.iter().map(luma).collect()
    }

    // skimage.metrics.structural_similarity(data_range=1, gaussian_weights=True, sigma=1.5,
    // use_sample_covariance=False), in f64 throughout: 1e-9 is far above its rounding.
    #[test]
    fn agrees_with_scikit_image() {
        let (a, b) = pattern();
        let value = mean_ssim(WIDTH, HEIGHT, &luma(&a), &luma(&b));
        assert!((value - 0.978_219_060_111_274_7).abs() < 1e-9, "{value}");
    }

    // Constant signals have no variance: (2ab + C1)/(a² + b² + C1), C2 cancels. Variances come
    // out within 1e-16 of 0 against C2 = 9e-4: 1e-12.
    #[test]
    fn constants_have_a_closed_form_at_every_size() {
        let (a, b) = (0.5, 0.6);
        let expected = (2.0 * a * b + C1) / (a * a + b * b + C1);
        for (width, height) in [(1, 1), (3, 20), (20, 3), (11, 11), (13, 12)] {
            let n = width * height;
            let value = mean_ssim(width, height, &vec![a; n], &vec![b; n]);
            assert!((value - expected).abs() < 1e-12, "{width}x{height} {value}");
        }
    }

    #[test]
    fn equal_signals_are_1_and_noise_is_less() {
        let a = luma(&pattern().0);
        assert!((mean_ssim(WIDTH, HEIGHT, &a, &a) - 1.0).abs() < 1e-12);
        let b: Vec<f64> = a.iter().rev().copied().collect();
        assert!(mean_ssim(WIDTH, HEIGHT, &a, &b) < 0.5);
    }
}
