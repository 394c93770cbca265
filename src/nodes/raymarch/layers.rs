//! From the shader's pixels to a picture with layers.

use crate::image::{ALPHA, DEPTH, Image};
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
    /// Whether all of its layers are.
    pub(super) fn is_finite(&self) -> bool {
        [self.beauty, self.single, self.forward, self.residual, self.surface, self.emission]
            .as_flattened()
            .iter()
            .all(|value| value.is_finite())
    }
}

/// The picture of these pixels, row by row.
pub(super) fn image(width: usize, height: usize, pixels: &[Pixel]) -> Image {
    let three = |of: fn(&Pixel) -> [f32; 4]| {
        pixels.iter().map(of).flat_map(|[red, green, blue, _]| [red, green, blue]).collect()
    };
    let one = |of: fn(&Pixel) -> f32| pixels.iter().map(of).collect();
    let mut image = Image::new(width, height, three(|p| p.beauty));
    image.insert(ALPHA, 1, one(|p| p.beauty[3]));
    image.insert(DEPTH, 1, one(|p| p.single[3]));
    image.insert("single", 3, three(|p| p.single));
    image.insert("forward", 3, three(|p| p.forward));
    image.insert("residual", 3, three(|p| p.residual));
    image.insert("surface", 3, three(|p| p.surface));
    image.insert("emission", 3, three(|p| p.emission));
    image
}
