//! From the shader's pixels to a picture with layers.

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

/// A picture that grows by whole rows.
pub(super) struct Growing {
    width: usize,
    height: usize,
    colors: [Vec<f32>; 6],
    alpha: Vec<f32>,
    depth: Vec<f32>,
}

impl Growing {
    pub(super) fn new(width: usize, height: usize) -> Self {
        let n = width * height;
        let colors = NAMES.map(|_| Vec::with_capacity(3 * n));
        Self { width, height, colors, alpha: Vec::with_capacity(n), depth: Vec::with_capacity(n) }
    }

    /// Adds pixels below; an error tells where one is not finite, x and y.
    pub(super) fn add(&mut self, pixels: &[Pixel]) -> Result<(), (usize, usize)> {
        if let Some(idx) = pixels.iter().position(|pixel| !pixel.is_finite()) {
            let idx = self.alpha.len() + idx;
            return Err((idx % self.width, idx / self.width));
        }
        for pixel in pixels {
            for (color, [red, green, blue, _]) in self.colors.iter_mut().zip(pixel.layers()) {
                color.extend_from_slice(&[red, green, blue]);
            }
            self.alpha.push(pixel.beauty[3]);
            self.depth.push(pixel.single[3]);
        }
        Ok(())
    }

    /// The picture, once all rows are there.
    pub(super) fn finish(self) -> Image {
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
