//! From the shader's pixels to a picture with layers.

use std::ops::Range;

use rayon::prelude::*;
use rayon::slice::ChunksMut;

use crate::image::{ALPHA, BEAUTY, DEPTH, Image};
use crate::mirror;

mirror! {
    /// `Pixel` of `shaders/raymarch.wgsl`.
    pub(super) struct Pixel {
        beauty: [f32; 4],
        single: [f32; 4],
        forward: [f32; 4],
        residual: [f32; 4],
        surface: [f32; 4],
        emission: [f32; 4],
    }
}

impl Pixel {
    fn layers(&self) -> [[f32; 4]; 6] {
        [self.beauty, self.single, self.forward, self.residual, self.surface, self.emission]
    }

    fn is_finite(&self) -> bool {
        self.layers().as_flattened().iter().all(|value| value.is_finite())
    }
}

/// Layers with three channels, in the order of [`Pixel::layers`].
const NAMES: [&str; 6] = [BEAUTY, "single", "forward", "residual", "surface", "emission"];

/// What a picture keeps of a pixel [bytes].
pub(super) const BYTES_OF_A_PIXEL: usize = 4 * (3 * NAMES.len() + 2);

/// A picture that is filled by whole rows, from above.
pub(super) struct Filling {
    width: usize,
    height: usize,
    /// Pixels that are there.
    n_pixels: usize,
    colors: [Vec<f32>; 6],
    alpha: Vec<f32>,
    depth: Vec<f32>,
}

impl Filling {
    pub(super) fn new(width: usize, height: usize) -> Self {
        let n = width * height;
        let colors = NAMES.map(|_| vec![0.0; 3 * n]);
        Self { width, height, n_pixels: 0, colors, alpha: vec![0.0; n], depth: vec![0.0; n] }
    }

    /// Adds pixels below; an error tells where one is not finite, x and y.
    pub(super) fn add(&mut self, pixels: &[Pixel]) -> Result<(), (usize, usize)> {
        if let Some(idx) = pixels.par_iter().position_first(|pixel| !pixel.is_finite()) {
            let idx = self.n_pixels + idx;
            return Err((idx % self.width, idx / self.width));
        }
        let width = self.width;
        let new = self.n_pixels..self.n_pixels + pixels.len();
        let [beauty, single, forward, residual, surface, emission] =
            self.colors.each_mut().map(|color| rows(color, 3, &new, width));
        let (alpha, depth) = (rows(&mut self.alpha, 1, &new, width), rows(&mut self.depth, 1, &new, width));
        // A large picture is new memory, which all cores together take faster than one.
        (pixels.par_chunks(width), beauty, single, forward, residual, surface, emission, alpha, depth)
            .into_par_iter()
            .for_each(|(pixels, beauty, single, forward, residual, surface, emission, alpha, depth)| {
                let mut colors = [beauty, single, forward, residual, surface, emission];
                for (n, pixel) in pixels.iter().enumerate() {
                    for (color, value) in colors.iter_mut().zip(pixel.layers()) {
                        color[3 * n..][..3].copy_from_slice(&value[..3]);
                    }
                    (alpha[n], depth[n]) = (pixel.beauty[3], pixel.single[3]);
                }
            });
        self.n_pixels = new.end;
        Ok(())
    }

    /// The picture, once all rows are there.
    pub(super) fn finish(self) -> Image {
        assert_eq!(self.n_pixels, self.width * self.height, "rows are missing");
        let mut colors = NAMES.into_iter().zip(self.colors);
        let beauty = colors.next().map(|(_, data)| data).unwrap_or_default();
        let mut image = Image::new(self.width, self.height, beauty);
        image.insert(ALPHA, 1, self.alpha);
        image.insert(DEPTH, 1, self.depth);
        for (name, data) in colors {
            image.insert(name, 3, data);
        }
        image
    }
}

/// The rows of these pixels in a layer.
fn rows<'a>(
    layer: &'a mut [f32],
    channels: usize,
    pixels: &Range<usize>,
    width: usize,
) -> ChunksMut<'a, f32> {
    layer[channels * pixels.start..channels * pixels.end].par_chunks_mut(channels * width)
}
