//! PNG files: 8-bit sRGB out, 8 or 16 bits in.
//!
//! Written is what the display shows: linear values 0..=1 that [`tonemap`] made, encoded by
//! the sRGB curve, rounded to 8 bits, with an sRGB chunk. Values beyond 0..=1 are cut at the
//! ends, as every display does; a value that is not finite is an error that names the pixel.
//!
//! Read are all color types; values are taken as sRGB (gAMA and ICC chunks are not looked at)
//! and become linear. Alpha becomes the layer `alpha`, and `beauty` is multiplied by it, as
//! elsewhere in Tyndall. Tested by round trips of all 256 codes and by damaged files.

use std::io::Cursor;
use std::path::Path;

use ::png::{BitDepth, ColorType, Compression, Decoder, Encoder, SrgbRenderingIntent, Transformations};
use rayon::prelude::*;

use super::{ALPHA, Image, ImageError, atomic, check_size, tonemap};

/// Whether the bytes start as a PNG file does.
pub(super) fn has_signature(bytes: &[u8]) -> bool {
    bytes.starts_with(b"\x89PNG\r\n\x1a\n")
}

/// Writes `beauty`, display-referred and linear (0..=1), as 8-bit sRGB.
///
/// # Errors
/// If a value is not finite, or the file cannot be written.
pub fn write(path: &Path, image: &Image) -> Result<(), ImageError> {
    if let Some(at) = image.beauty().iter().position(|v| !v.is_finite()) {
        return Err(ImageError::NonFinite {
            path: path.to_owned(),
            x: at / 3 % image.width,
            y: at / 3 / image.width,
        });
    }
    let codes: Vec<u8> = image.beauty().par_iter().map(|v| to_code(*v)).collect();
    let bytes = encode(image, &codes)
        .map_err(|e| atomic::WriteError::File { path: path.to_owned(), source: e.into() })?;
    Ok(atomic::write(path, &bytes)?)
}

fn to_code(linear: f32) -> u8 {
    (tonemap::srgb_encode(linear.clamp(0.0, 1.0)) * 255.0).round() as u8
}

fn encode(image: &Image, codes: &[u8]) -> Result<Vec<u8>, ::png::EncodingError> {
    let mut bytes = Vec::new();
    // PNG refuses sizes of 2^31 and more itself; what does not fit u32 is made one of those.
    let size = |n: usize| u32::try_from(n).unwrap_or(u32::MAX);
    let mut encoder = Encoder::new(&mut bytes, size(image.width), size(image.height));
    encoder.set_color(ColorType::Rgb);
    encoder.set_depth(BitDepth::Eight);
    encoder.set_source_srgb(SrgbRenderingIntent::RelativeColorimetric);
    // A picture of 512² takes 7 ms instead of 30, and a tenth more room.
    encoder.set_compression(Compression::Fast);
    let mut writer = encoder.write_header()?;
    writer.write_image_data(codes)?;
    writer.finish()?;
    Ok(bytes)
}

/// Reads a PNG file as linear values.
///
/// # Errors
/// If it cannot be read or is damaged.
pub fn read(path: &Path) -> Result<Image, ImageError> {
    decode(path, &super::read_bytes(path)?)
}

pub(super) fn decode(path: &Path, bytes: &[u8]) -> Result<Image, ImageError> {
    let damaged = |e: ::png::DecodingError| ImageError::invalid(path, e.to_string());
    let mut decoder = Decoder::new(Cursor::new(bytes));
    // Palettes, 1, 2 and 4 bits become 8-bit channels, a transparent color becomes alpha.
    decoder.set_transformations(Transformations::EXPAND);
    let mut reader = decoder.read_info().map_err(damaged)?;
    let (width, height) = reader.info().size();
    let (width, height) = (width as usize, height as usize);
    check_size(path, width, height, 4)?;
    let (color, depth) = reader.output_color_type();
    let length = width * height * color.samples() * 2;
    let mut buffer = vec![0; reader.output_buffer_size().unwrap_or(length)];
    reader.next_frame(&mut buffer).map_err(damaged)?;
    let values: Vec<f32> = match depth {
        BitDepth::Sixteen => {
            let pairs = buffer.as_chunks::<2>().0;
            let value = |b: &[u8; 2]| f32::from(u16::from_be_bytes(*b)) / 65535.0;
            pairs.iter().map(value).collect()
        }
        _ => buffer.iter().map(|b| f32::from(*b) / 255.0).collect(),
    };
    let samples = color.samples();
    let has_alpha = samples % 2 == 0;
    let (mut rgb, mut alpha) = (Vec::new(), Vec::new());
    for pixel in values.chunks_exact(samples) {
        let coverage = if has_alpha { pixel[samples - 1] } else { 1.0 };
        let color = if samples < 3 { [pixel[0]; 3] } else { [pixel[0], pixel[1], pixel[2]] };
        rgb.extend(color.map(|v| tonemap::srgb_decode(v) * coverage));
        alpha.push(coverage);
    }
    let mut image = Image::new(width, height, rgb);
    if has_alpha {
        image.insert(ALPHA, 1, alpha);
    }
    Ok(image)
}

#[cfg(test)]
mod tests {
    use super::*;

    // Each code is at least 3e-4 from its neighbors in linear light (1/255/12.92), f32 keeps
    // 1e-7 of it: nothing but the same code may come back.
    #[test]
    fn all_codes_come_back() {
        let dir = tempfile::tempdir().unwrap();
        let path = dir.path().join("codes.png");
        let code = |i: usize| tonemap::srgb_decode((i % 256) as f32 / 255.0);
        let image = Image::new(16, 16, (0..768).map(|i| code(i * 7)).collect());
        write(&path, &image).unwrap();
        let back = read(&path).unwrap();
        let codes = |i: &Image| i.beauty().iter().map(|v| to_code(*v)).collect::<Vec<_>>();
        assert_eq!(codes(&back), codes(&image));
        assert_eq!(codes(&back)[1], 7);
        let bytes = std::fs::read(&path).unwrap();
        assert!(bytes.windows(4).any(|w| w == b"sRGB"));
        assert_eq!(super::super::read(&path).unwrap(), back);
    }

    #[test]
    fn values_beyond_the_range_are_cut_and_nan_is_named() {
        assert_eq!([-1.0, 0.0, 1.0, 9.0].map(to_code), [0, 0, 255, 255]);
        // Middle grey: 0.2140 linear is 50 % of the codes, 127.5.
        assert_eq!([0.213, 0.216].map(to_code), [127, 128]);
        let mut rgb = vec![0.5; 18];
        rgb[13] = f32::NAN;
        let dir = tempfile::tempdir().unwrap();
        let path = dir.path().join("nan.png");
        let error = write(&path, &Image::new(3, 2, rgb)).unwrap_err();
        assert!(error.to_string().contains("pixel (1, 1)"), "{error}");
        assert!(!path.exists());
    }

    fn made(color: ColorType, depth: BitDepth, data: &[u8]) -> Vec<u8> {
        let mut bytes = Vec::new();
        let mut encoder = Encoder::new(&mut bytes, 1, 1);
        encoder.set_color(color);
        encoder.set_depth(depth);
        let mut writer = encoder.write_header().unwrap();
        writer.write_image_data(data).unwrap();
        writer.finish().unwrap();
        bytes
    }

    // 1e-6: a handful of f32 roundings (6e-8 each) through one power function.
    #[test]
    fn depths_and_color_types() {
        let near = |a: f32, b: f32| assert!((a - b).abs() < 1e-6, "{a} {b}");
        let path = Path::new("x.png");
        let grey = decode(path, &made(ColorType::Grayscale, BitDepth::Sixteen, &[0x80, 0x00]));
        let grey = grey.unwrap();
        // ((0.5000076 + 0.055) / 1.055)^2.4, by hand.
        near(grey.beauty()[0], 0.214_048_3);
        assert_eq!(grey.beauty()[0], grey.beauty()[2]);
        assert_eq!(grey.layers.len(), 1);
        let rgba = made(ColorType::Rgba, BitDepth::Eight, &[255, 0, 255, 51]);
        let rgba = decode(path, &rgba).unwrap();
        near(rgba.beauty()[0], 0.2);
        near(rgba.beauty()[1], 0.0);
        near(rgba.layers[ALPHA].data[0], 0.2);
    }

    #[test]
    fn every_truncation_is_an_error() {
        let bytes = made(ColorType::Rgb, BitDepth::Eight, &[1, 2, 3]);
        // The last 12 bytes are the IEND chunk; the picture is whole without it.
        for end in 0..bytes.len() - 12 {
            assert!(decode(Path::new("x.png"), &bytes[..end]).is_err(), "{end}");
        }
    }
}
