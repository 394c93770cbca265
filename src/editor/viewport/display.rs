//! From a layer of radiance to what the window shows: tone curve, signal, histogram.
//!
//! On the CPU, because exposure and curve must follow the slider without a new picture: half a million pixels take
//! some 10 ms on two cores. The formulas are [`crate::image::tonemap`]'s; the sRGB signal comes from a table over
//! the root of display light, so that dark tones keep their steps (at most half a step of 8 bits off, tested).
//! A layer of one channel is shown as grey: coverage as it is, everything else as a share of its largest
//! value. The histogram is of luminance (or of the channel) in stops around 1.

use std::sync::LazyLock;

use egui::{Color32, ColorImage};
use rayon::prelude::*;

use crate::image::tonemap::{self, Curve, srgb_encode};
use crate::image::{ALPHA, Image, Layer};
use crate::optics::spectrum;

/// How radiance is shown.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Tone {
    /// One more is twice as bright, in EV.
    pub exposure_ev: f32,
    /// Between radiance and display light.
    pub curve: Curve,
}

const TABLE: usize = 4096;

static SIGNALS: LazyLock<Vec<u8>> = LazyLock::new(|| {
    let signal = |idx: usize| srgb_encode((idx as f32 / (TABLE - 1) as f32).powi(2));
    (0..TABLE).map(|idx| (signal(idx) * 255.0).round() as u8).collect()
});

fn signal(linear: f32) -> u8 {
    SIGNALS[(linear.clamp(0.0, 1.0).sqrt() * (TABLE - 1) as f32).round() as usize]
}

/// A layer for the display; `None` where the image has no such layer.
pub fn develop(image: &Image, layer: &str, tone: Tone) -> Option<ColorImage> {
    let data = image.layers.get(layer)?;
    let mut pixels = vec![Color32::BLACK; image.width * image.height];
    match data.channels {
        3 => pixels.par_iter_mut().zip(data.data.par_chunks_exact(3)).for_each(|(pixel, rgb)| {
            let [r, g, b] =
                tonemap::apply([rgb[0], rgb[1], rgb[2]], tone.exposure_ev, tone.curve).map(signal);
            *pixel = Color32::from_rgb(r, g, b);
        }),
        _ => {
            let largest = data.data.iter().copied().filter(|v| v.is_finite()).fold(0.0, f32::max);
            let scale = if layer == ALPHA || largest <= 0.0 { 1.0 } else { 1.0 / largest };
            pixels.par_iter_mut().zip(data.data.par_iter()).for_each(|(pixel, value)| {
                let grey = if value.is_nan() { 0 } else { signal((value * scale).powi(2)) };
                *pixel = Color32::from_gray(grey);
            });
        }
    }
    Some(ColorImage::new([image.width, image.height], pixels))
}

/// The beauty at most [`SMALL`] pixels wide, by picking: it is seen for its content, not for its grain.
pub fn thumbnail(image: &Image, tone: Tone) -> ColorImage {
    let step = image.width.max(image.height).div_ceil(SMALL).max(1);
    let [width, height] = [image.width.div_ceil(step), image.height.div_ceil(step)];
    let picked = (0..width * height).flat_map(|idx| {
        let [x, y] = [idx % width * step, idx / width * step];
        image.pixels()[x + image.width * y]
    });
    let small = Image::new(width, height, picked.collect());
    develop(&small, crate::image::BEAUTY, tone).expect("every image has a beauty")
}

/// Pixels of a thumbnail's longer side.
const SMALL: usize = 160;

/// Luminance of linear Rec. 709.
pub fn luminance(rgb: [f32; 3]) -> f32 {
    spectrum::luminance(rgb.map(f64::from)) as f32
}

/// Counts of a layer by stops.
#[derive(Debug, Clone, PartialEq)]
pub struct Histogram {
    /// Of each bin, from [`Self::LOWEST`] stops, [`Self::BINS_A_STOP`] a stop.
    pub counts: Vec<u32>,
    /// Values of 0 and below.
    pub n_black: u32,
    /// NaN and infinite values.
    pub n_odd: u32,
}

impl Histogram {
    /// Stops of the first bin.
    pub const LOWEST: f32 = -12.0;
    /// Stops that are counted.
    pub const STOPS: usize = 20;
    /// Bins of a stop.
    pub const BINS_A_STOP: usize = 4;

    /// Of a layer; what is darker or brighter than all bins is counted in the first or last.
    pub fn of(layer: &Layer) -> Self {
        let n_bins = Self::STOPS * Self::BINS_A_STOP;
        let mut found = Self { counts: vec![0; n_bins], n_black: 0, n_odd: 0 };
        for pixel in layer.data.chunks_exact(layer.channels) {
            let value =
                if layer.channels == 3 { luminance([pixel[0], pixel[1], pixel[2]]) } else { pixel[0] };
            if !value.is_finite() {
                found.n_odd += 1;
            } else if value <= 0.0 {
                found.n_black += 1;
            } else {
                let bin = (value.log2() - Self::LOWEST) * Self::BINS_A_STOP as f32;
                found.counts[(bin.max(0.0) as usize).min(n_bins - 1)] += 1;
            }
        }
        found
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    // The table is over the root of light in steps of 1/4095; the signal's slope over the root is at most that of
    // the straight part's end, 12.92·2·√0.0031 = 1.44: half a step is 255·1.44/(2·4095) = 0.045 of a count.
    #[test]
    fn the_table_is_the_signal() {
        for i in 0..=10_000 {
            let x = i as f32 / 10_000.0;
            assert!((f32::from(signal(x)) - srgb_encode(x) * 255.0).abs() <= 0.55, "{x}");
        }
        assert_eq!([signal(-1.0), signal(2.0), signal(f32::NAN.max(0.0))], [0, 255, 0]);
    }

    #[test]
    fn layers_are_shown_as_they_are() {
        let mut image = Image::new(2, 1, vec![0.0, 0.25, 1.0, 4.0, 0.0, 0.0]);
        image.insert("alpha", 1, vec![0.0, 1.0]);
        image.insert("depth", 1, vec![2.0, 8.0]);
        let tone = Tone { exposure_ev: 2.0, curve: Curve::None };
        let beauty = develop(&image, "beauty", tone).unwrap();
        assert_eq!(beauty.pixels, [Color32::from_rgb(0, 255, 255), Color32::from_rgb(255, 0, 0)]);
        let alpha = develop(&image, "alpha", tone).unwrap();
        assert_eq!(alpha.pixels, [Color32::from_gray(0), Color32::from_gray(255)]);
        let depth = develop(&image, "depth", tone).unwrap();
        assert!(depth.pixels[0].r() < depth.pixels[1].r() && depth.pixels[1].r() == 255);
        assert!(develop(&image, "none", tone).is_none());
    }

    #[test]
    fn a_histogram_counts_all() {
        let data = vec![1.0, 1.0, 0.0, f32::NAN, 1e-30, 1e30, f32::INFINITY];
        let found = Histogram::of(&Layer { channels: 1, data });
        assert_eq!((found.n_black, found.n_odd), (1, 2));
        assert_eq!(found.counts[48], 2);
        assert_eq!((found.counts[0], *found.counts.last().unwrap()), (1, 1));
    }
}
