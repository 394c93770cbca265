//! How wrong a picture is, as numbers and as a map.
//!
//! Of picture X against reference R, linear radiance, all pixels and channels together:
//! * `mean_relative` = Σ|X−R|/ΣR;
//! * `block_relative`: the same on the means of 4×4 pixels, for noisy references; with a mask
//!   over the blocks alone whose mean of the mask is above 0.01. Partial blocks at the border
//!   are means over their own pixels, and every block weighs as many pixels as it has;
//! * `rel_mse` = mean((X−R)²/(R² + 0.01 mean(R)²));
//! * `bias` = ΣX/ΣR − 1;
//! * `flip` ([`super::flip`]) and `ssim` ([`super::ssim`], of the luma of the sRGB signal), both
//!   on pictures mapped by [`Curve::Aces`] at exposure 0, the curve that HDR-FLIP takes: what
//!   is above some 10 W m⁻² sr⁻¹ is white in both and does not count there.
//!
//! A pixel with a value that is not finite, in either picture, is counted in `non_finite`,
//! left out of all sums, and black in both pictures for `flip` and `ssim`.
//!
//! Where the reference is zero, a quotient is 0 if its numerator is 0 too, else the largest
//! double with the numerator's sign: it fails every tolerance, and JSON, which has no
//! infinity, can hold it.
//!
//! Sums are in f64 and in a fixed order. Tested by hand-computed pictures, by the noise that
//! the reference pictures state, and that each metric sees 1 %.

use serde::Serialize;

use super::Image;
use super::tonemap::{self, Curve};
use super::{flip, ssim};

/// Side of a block in pixels.
pub const BLOCK: usize = 4;
/// A block counts where the mean of the mask, an optical depth, is above this.
pub const MASK_THRESHOLD: f64 = 0.01;

/// The errors of a picture; see the module for the definitions.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Metrics {
    /// Σ|X−R|/ΣR over pixels.
    pub mean_relative: f64,
    /// Σ|X−R|/ΣR over block means.
    pub block_relative: f64,
    /// Mean squared error, each term relative.
    pub rel_mse: f64,
    /// ΣX/ΣR − 1.
    pub bias: f64,
    /// Mean ꟻLIP, 0 (equal) to 1.
    pub flip: f64,
    /// Mean structural similarity, 1 when equal.
    pub ssim: f64,
    /// Pixels that are not finite in either picture.
    pub non_finite: usize,
    /// R, G and B for themselves.
    pub per_channel: [ChannelMetrics; 3],
}

/// The errors of one channel.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct ChannelMetrics {
    /// Σ|X−R|/ΣR over pixels.
    pub mean_relative: f64,
    /// Σ|X−R|/ΣR over block means.
    pub block_relative: f64,
    /// ΣX/ΣR − 1.
    pub bias: f64,
}

/// Why pictures cannot be compared.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub enum CompareError {
    /// The sizes differ.
    #[error(
        "the {what} is {found}, the reference {expected} pixels; sizes must be equal, render it again at {expected}"
    )]
    Size {
        /// Picture, mask or variance.
        what: &'static str,
        /// Its size.
        found: Size,
        /// The reference's size.
        expected: Size,
    },
    /// No pixel is finite in both pictures.
    #[error("no pixel is finite in both pictures; look at the picture's values before comparing")]
    NothingFinite,
    /// No block is inside the mask.
    #[error("no block of the mask has a mean above {MASK_THRESHOLD}; compare without a mask")]
    EmptyMask,
}

/// Width and height in pixels.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Size(pub usize, pub usize);

impl std::fmt::Display for Size {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "{}x{}", self.0, self.1)
    }
}

/// Compares the `beauty` of a picture with that of a reference.
///
/// # Errors
/// If sizes differ, no pixel is finite in both, or the mask selects nothing.
pub fn compare(picture: &Image, reference: &Image, mask: Option<&Image>) -> Result<Metrics, CompareError> {
    same_size("picture", picture, reference)?;
    let (x, r) = (picture.pixels(), reference.pixels());
    let good = finite_in_both(x, r);
    let n_good = good.iter().filter(|g| **g).count();
    if n_good == 0 {
        return Err(CompareError::NothingFinite);
    }

    let mut pixels = [Sums::default(); 3];
    let pairs = || x.iter().zip(r).zip(&good).filter(|(_, good)| **good);
    for ((x, r), _) in pairs() {
        for c in 0..3 {
            pixels[c].add(f64::from(x[c]), f64::from(r[c]), 1.0);
        }
    }
    let mut blocks = [Sums::default(); 3];
    for block in blocks_in(reference, &good, mask)? {
        let [mean_x, mean_r] = [x, r].map(|image| block.mean(image));
        for c in 0..3 {
            blocks[c].add(mean_x[c], mean_r[c], block.pixels.len() as f64);
        }
    }

    let all = Sums::total(&pixels);
    let mean_r = all.reference / (3 * n_good) as f64;
    let floor = 0.01 * mean_r * mean_r;
    let squares: f64 = pairs()
        .flat_map(|((x, r), _)| x.iter().zip(r))
        .map(|(x, r)| {
            let (x, r) = (f64::from(*x), f64::from(*r));
            quotient((x - r) * (x - r), r * r + floor)
        })
        .sum();
    let [shown_x, shown_r] = [x, r].map(|image| displayed(image, &good));
    let (width, height) = (reference.width, reference.height);
    let flip = flip::flip(width, height, &shown_x, &shown_r);
    let [luma_x, luma_r] = [shown_x, shown_r].map(|shown| luma(&shown));
    Ok(Metrics {
        mean_relative: all.relative(),
        block_relative: Sums::total(&blocks).relative(),
        rel_mse: squares.min(f64::MAX) / (3 * n_good) as f64,
        bias: all.bias(),
        flip: flip.iter().sum::<f64>() / flip.len() as f64,
        ssim: ssim::mean_ssim(width, height, &luma_x, &luma_r),
        non_finite: good.len() - n_good,
        per_channel: [0, 1, 2].map(|c| ChannelMetrics {
            mean_relative: pixels[c].relative(),
            block_relative: blocks[c].relative(),
            bias: pixels[c].bias(),
        }),
    })
}

/// The `block_relative` that a perfect picture is expected to have against this reference,
/// because the reference itself is noisy: 0.8 Σ√(v/n)/ΣR over blocks of n pixels, where v is
/// the block's mean of `variance`, the variance of the reference's pixels (0.8 is about
/// √(2/π), the mean magnitude of a normal deviate).
///
/// # Errors
/// As [`compare`].
pub fn block_noise(reference: &Image, variance: &Image, mask: Option<&Image>) -> Result<f64, CompareError> {
    same_size("variance", variance, reference)?;
    let (r, v) = (reference.pixels(), variance.pixels());
    let good = finite_in_both(r, v);
    if !good.contains(&true) {
        return Err(CompareError::NothingFinite);
    }
    let (mut noise, mut total) = (0.0, 0.0);
    for block in blocks_in(reference, &good, mask)? {
        let n = block.pixels.len() as f64;
        let deviations = block.mean(v).map(|v| (v.max(0.0) / n).sqrt());
        noise += 0.8 * n * deviations.iter().sum::<f64>();
        total += n * block.mean(r).iter().sum::<f64>();
    }
    Ok(quotient(noise, total))
}

/// The relative error of each pixel in colors, display-referred and linear, for a PNG.
///
/// The error is mean|X−R|/√(mean(R)² + 0.01 M²), means over the pixel's channels, M over the
/// whole reference. Black is 0.1 % and less, the palest yellow 100 % and more, a third of the
/// way a factor of 10. Pixels that are not finite are pure green, which the scale lacks.
///
/// # Errors
/// If sizes differ or no pixel is finite in both.
pub fn error_map(picture: &Image, reference: &Image) -> Result<Image, CompareError> {
    same_size("picture", picture, reference)?;
    let (x, r) = (picture.pixels(), reference.pixels());
    let good = finite_in_both(x, r);
    let n_good = good.iter().filter(|g| **g).count();
    if n_good == 0 {
        return Err(CompareError::NothingFinite);
    }
    let mean = |v: &[f32; 3]| v.iter().map(|v| f64::from(*v)).sum::<f64>() / 3.0;
    let selected = r.iter().zip(&good).filter(|(_, good)| **good);
    let mean_r = selected.map(|(r, _)| mean(r)).sum::<f64>() / n_good as f64;
    let color = |((x, r), good): ((&[f32; 3], &[f32; 3]), &bool)| {
        if !good {
            return [0.0, 1.0, 0.0];
        }
        let difference = (0..3).map(|c| (f64::from(x[c]) - f64::from(r[c])).abs());
        let error = quotient(difference.sum::<f64>() / 3.0, mean(r).hypot(0.1 * mean_r));
        let decades = error.max(1e-3).log10();
        inferno((1.0 + decades / 3.0).clamp(0.0, 1.0)).map(|v| tonemap::srgb_decode(v as f32))
    };
    let rgb = x.iter().zip(r).zip(&good).flat_map(color).collect();
    Ok(Image::new(reference.width, reference.height, rgb))
}

/// sRGB signal of the color map "inferno" (van der Walt, Smith 2015) at 0..=1, by the
/// polynomial of M. Zucker (shadertoy WlfXRN, CC0), within 2 % of the table.
fn inferno(t: f64) -> [f64; 3] {
    const POWERS: [[f64; 3]; 7] = [
        [0.000_218_940_4, 0.001_651_004_6, -0.019_480_898_4],
        [0.106_513_419_5, 0.563_956_436_8, 3.932_712_388_9],
        [11.602_493_082_5, -3.972_853_965_7, -15.942_394_106_3],
        [-41.703_996_131_4, 17.436_398_882_1, 44.354_145_198_7],
        [77.162_935_699_4, -33.402_358_942_1, -81.807_309_257_4],
        [-71.319_428_245_0, 32.626_064_264_0, 73.209_519_858_0],
        [25.131_126_224_8, -12.242_668_952_4, -23.070_325_002_9],
    ];
    [0, 1, 2].map(|c| {
        let value = POWERS.iter().rev().fold(0.0, |sum, p| sum * t + p[c]);
        value.clamp(0.0, 1.0)
    })
}

/// Weighted sums of one channel.
#[derive(Debug, Clone, Copy, Default)]
struct Sums {
    difference: f64,
    picture: f64,
    reference: f64,
}

impl Sums {
    fn add(&mut self, x: f64, r: f64, weight: f64) {
        self.difference += weight * (x - r).abs();
        self.picture += weight * x;
        self.reference += weight * r;
    }

    fn total(channels: &[Sums; 3]) -> Sums {
        let sum = |field: fn(&Sums) -> f64| channels.iter().map(field).sum();
        Sums {
            difference: sum(|s| s.difference),
            picture: sum(|s| s.picture),
            reference: sum(|s| s.reference),
        }
    }

    fn relative(&self) -> f64 {
        quotient(self.difference, self.reference)
    }

    fn bias(&self) -> f64 {
        quotient(self.picture - self.reference, self.reference)
    }
}

/// a/b, always finite: 0/0 is 0, and what would be infinite is the largest double.
fn quotient(a: f64, b: f64) -> f64 {
    if a == 0.0 { 0.0 } else { (a / b).clamp(f64::MIN, f64::MAX) }
}

struct Block {
    /// The finite pixels.
    pixels: Vec<usize>,
}

impl Block {
    fn mean(&self, image: &[[f32; 3]]) -> [f64; 3] {
        let n = self.pixels.len() as f64;
        let sum = |c: usize| self.pixels.iter().map(|p| f64::from(image[*p][c])).sum::<f64>();
        [0, 1, 2].map(|c| sum(c) / n)
    }
}

/// The blocks that have a good pixel and lie inside the mask; never none.
fn blocks_in(reference: &Image, good: &[bool], mask: Option<&Image>) -> Result<Vec<Block>, CompareError> {
    let (width, height) = (reference.width, reference.height);
    if let Some(mask) = mask {
        same_size("mask", mask, reference)?;
    }
    let mut blocks = Vec::new();
    for y0 in (0..height).step_by(BLOCK) {
        for x0 in (0..width).step_by(BLOCK) {
            let rows = y0..(y0 + BLOCK).min(height);
            let columns = x0..(x0 + BLOCK).min(width);
            let all = rows.flat_map(|y| columns.clone().map(move |x| y * width + x));
            let mut block = Block { pixels: all.collect() };
            // The mask is judged on the whole block: which pixels failed must not move it.
            let depth = mask.map(|mask| block.mean(mask.pixels()).iter().sum::<f64>() / 3.0);
            block.pixels.retain(|p| good[*p]);
            if !block.pixels.is_empty() && depth.is_none_or(|depth| depth > MASK_THRESHOLD) {
                blocks.push(block);
            }
        }
    }
    if blocks.is_empty() { Err(CompareError::EmptyMask) } else { Ok(blocks) }
}

fn same_size(what: &'static str, image: &Image, reference: &Image) -> Result<(), CompareError> {
    let [found, expected] = [image, reference].map(|i| Size(i.width, i.height));
    if found == expected { Ok(()) } else { Err(CompareError::Size { what, found, expected }) }
}

fn finite_in_both(a: &[[f32; 3]], b: &[[f32; 3]]) -> Vec<bool> {
    let finite = |p: &[f32; 3]| p.iter().all(|v| v.is_finite());
    a.iter().zip(b).map(|(a, b)| finite(a) && finite(b)).collect()
}

/// Linear display light in 0..=1.
fn displayed(pixels: &[[f32; 3]], good: &[bool]) -> Vec<[f64; 3]> {
    let show = |(p, good): (&[f32; 3], &bool)| {
        let rgb = if *good { *p } else { [0.0; 3] };
        tonemap::apply(rgb, 0.0, Curve::Aces).map(f64::from)
    };
    pixels.iter().zip(good).map(show).collect()
}

/// Luma (Rec. 709) of the sRGB signal.
fn luma(shown: &[[f64; 3]]) -> Vec<f64> {
    let luma = |rgb: &[f64; 3]| {
        let [r, g, b] = rgb.map(|v| f64::from(tonemap::srgb_encode(v as f32)));
        0.2126 * r + 0.7152 * g + 0.0722 * b
    };
    shown.iter().map(luma).collect()
}

#[cfg(test)]
#[path = "metrics_tests.rs"]
mod tests;
