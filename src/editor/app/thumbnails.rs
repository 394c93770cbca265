//! Small pictures of what nodes give, for the canvas.

use egui::{ColorImage, Context, TextureHandle, TextureOptions};

use crate::editor::viewport::display::{Tone, develop};
use crate::image::{BEAUTY, Image, Layer};

/// Pixels across, at most.
const WIDTH: usize = 160;

/// A texture of an image's radiance: the mean of each pixel's block, so that noise and lines do not flicker.
pub fn texture(context: &Context, name: &str, image: &Image) -> Option<TextureHandle> {
    let small = shrink(image)?;
    let pixels: ColorImage = develop(&small, BEAUTY, Tone::default())?;
    Some(context.load_texture(format!("thumbnail {name}"), pixels, TextureOptions::LINEAR))
}

fn shrink(image: &Image) -> Option<Image> {
    let Layer { channels: 3, data } = image.layers.get(BEAUTY)? else { return None };
    let block = image.width.div_ceil(WIDTH).max(1);
    let (width, height) = (image.width / block, image.height / block);
    if width == 0 || height == 0 {
        return None;
    }
    let mean = |idx: usize| {
        let (x, y) = (idx % width * block, idx / width * block);
        let mut sum = [0.0; 3];
        for pixel in (0..block * block).map(|at| (y + at / block) * image.width + x + at % block) {
            for (sum, value) in sum.iter_mut().zip(&data[3 * pixel..3 * pixel + 3]) {
                *sum += value;
            }
        }
        sum.map(|sum| sum / (block * block) as f32)
    };
    Some(Image::new(width, height, (0..width * height).flat_map(mean).collect()))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn blocks_become_their_mean() {
        let (width, height) = (321, 7);
        let rgb =
            (0..width * height).flat_map(|idx| [(idx % width) as f32, (idx / width) as f32, 1.0]).collect();
        let small = shrink(&Image::new(width, height, rgb)).unwrap();
        assert_eq!((small.width, small.height), (107, 2));
        let data = &small.layers[BEAUTY].data;
        assert_eq!(data[..3], [1.0, 1.0, 1.0]);
        assert_eq!(data[3 * 108..3 * 109], [4.0, 4.0, 1.0]);
    }

    #[test]
    fn an_image_of_one_pixel_stays_one() {
        let small = shrink(&Image::new(1, 1, vec![0.5; 3])).unwrap();
        assert_eq!((small.width, small.height, small.layers[BEAUTY].data[0]), (1, 1, 0.5));
    }
}
