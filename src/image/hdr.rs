//! Radiance pictures (.hdr, RGBE): the usual format of environment maps, read only.
//!
//! Four bytes a pixel: three mantissas and a shared exponent, value = m · 2^(e−136), and
//! black for e = 0 (Ward, "Real Pixels", Graphics Gems II, 1991). That is the reading of
//! nearly all programs; Radiance itself takes m + 1/2, about 0.3 % more, and maps are made to
//! be looked at in the others. Rows are flat, run-length coded as by Radiance 1.x, or coded by
//! channel as since 1991. EXPOSURE lines are divided out, so that values are radiance.
//! The primaries are taken to be Rec. 709.
//!
//! Ours, since the `image` crate drops EXPOSURE and the orientation of rows. Limits: rows
//! along y only (`±Y h ±X w`), no XYZE. Every length is checked against what is left of the
//! file. Tested on hand-made files of each coding, truncation, and real maps.

use std::path::Path;

use super::{Image, ImageError, check_size};

/// Whether the bytes start as a Radiance picture does.
pub(super) fn has_signature(bytes: &[u8]) -> bool {
    bytes.starts_with(b"#?")
}

/// Reads a Radiance picture.
///
/// # Errors
/// If it cannot be read, is damaged, or uses what is not supported.
pub fn read(path: &Path) -> Result<Image, ImageError> {
    decode(path, &super::read_bytes(path)?)
}

struct Header {
    width: usize,
    height: usize,
    flip_x: bool,
    flip_y: bool,
    exposure: f32,
}

pub(super) fn decode(path: &Path, bytes: &[u8]) -> Result<Image, ImageError> {
    let mut rest = bytes;
    let header = read_header(path, &mut rest)?;
    let (width, height) = (header.width, header.height);
    check_size(path, width, height, 3)?;
    // The memory grows with what is decoded: an absurd size in a short file costs nothing.
    let mut rgbe: Vec<[u8; 4]> = Vec::new();
    for row in 0..height {
        read_row(&mut rest, width, &mut rgbe).ok_or_else(|| {
            let at = bytes.len() - rest.len();
            ImageError::invalid(path, format!("row {row} of {height} ends badly at byte {at}"))
        })?;
    }
    let mut rgb = Vec::with_capacity(rgbe.len() * 3);
    for y in 0..height {
        let y = if header.flip_y { height - 1 - y } else { y };
        for x in 0..width {
            let x = if header.flip_x { width - 1 - x } else { x };
            rgb.extend(to_radiance(rgbe[y * width + x], header.exposure));
        }
    }
    Ok(Image::new(width, height, rgb))
}

fn to_radiance([r, g, b, e]: [u8; 4], exposure: f32) -> [f32; 3] {
    let scale = if e == 0 { 0.0 } else { 2f32.powi(i32::from(e) - 136) / exposure };
    [r, g, b].map(|m| f32::from(m) * scale)
}

fn read_header(path: &Path, rest: &mut &[u8]) -> Result<Header, ImageError> {
    const REMEDY: &str = "convert it to RGBE with rows from top to bottom, or to EXR";
    let mut exposure = 1.0f32;
    loop {
        let line = read_line(rest).ok_or_else(|| ImageError::invalid(path, "the header does not end"))?;
        if line.is_empty() {
            break;
        }
        if let Some(format) = line.strip_prefix("FORMAT=") {
            if format.trim() != "32-bit_rle_rgbe" {
                let found = format!("pixel format {}", format.trim());
                return Err(ImageError::not_supported(path, found, REMEDY));
            }
        } else if let Some(value) = line.strip_prefix("EXPOSURE=") {
            let value: f32 = value.trim().parse().unwrap_or(0.0);
            exposure *= value;
            if !exposure.is_normal() || exposure < 0.0 {
                return Err(ImageError::invalid(path, format!("header line {line:?}")));
            }
        }
    }
    let line =
        read_line(rest).ok_or_else(|| ImageError::invalid(path, "the line with the size is missing"))?;
    let words: Vec<&str> = line.split_ascii_whitespace().collect();
    let size = |word: &str| word.parse::<usize>().ok();
    let parsed = match words[..] {
        [y @ ("-Y" | "+Y"), height, x @ ("-X" | "+X"), width] => size(height)
            .zip(size(width))
            .map(|(height, width)| Header { width, height, flip_x: x == "-X", flip_y: y == "+Y", exposure }),
        ["-X" | "+X", _, "-Y" | "+Y", _] => {
            let found = format!("columns before rows ({line})");
            return Err(ImageError::not_supported(path, found, REMEDY));
        }
        _ => None,
    };
    parsed.ok_or_else(|| ImageError::invalid(path, format!("size line {line:?}")))
}

/// The next line without its end; at most 4096 bytes, so that garbage is not searched through.
fn read_line(rest: &mut &[u8]) -> Option<String> {
    let end = rest.iter().take(4096).position(|b| *b == b'\n')?;
    let line = String::from_utf8_lossy(&rest[..end]).trim_end().to_owned();
    *rest = &rest[end + 1..];
    Some(line)
}

fn read_row(rest: &mut &[u8], width: usize, pixels: &mut Vec<[u8; 4]>) -> Option<()> {
    let start = *rest.first_chunk::<4>()?;
    let coded = usize::from(start[2]) << 8 | usize::from(start[3]);
    if (8..=0x7fff).contains(&width) && start[..2] == [2, 2] && coded == width {
        *rest = &rest[4..];
        read_coded_row(rest, width, pixels)
    } else {
        read_plain_row(rest, width, pixels)
    }
}

/// The coding since 1991: each channel for itself, runs of up to 127 bytes.
fn read_coded_row(rest: &mut &[u8], width: usize, pixels: &mut Vec<[u8; 4]>) -> Option<()> {
    let mut row = vec![[0u8; 4]; width];
    for channel in 0..4 {
        let mut x = 0;
        while x < width {
            let count = usize::from(take(rest)?);
            let is_run = count > 128;
            let count = if is_run { count - 128 } else { count };
            if count == 0 || x + count > width {
                return None;
            }
            let run = if is_run { Some(take(rest)?) } else { None };
            for pixel in &mut row[x..x + count] {
                pixel[channel] = match run {
                    Some(value) => value,
                    None => take(rest)?,
                };
            }
            x += count;
        }
    }
    pixels.append(&mut row);
    Some(())
}

/// Flat pixels, where 1 1 1 n repeats the one before n times; of several in a row each next
/// one counts 256 times as much.
fn read_plain_row(rest: &mut &[u8], width: usize, pixels: &mut Vec<[u8; 4]>) -> Option<()> {
    let row_start = pixels.len();
    let mut shift = 0;
    while pixels.len() < row_start + width {
        let pixel = *rest.first_chunk::<4>()?;
        *rest = &rest[4..];
        if pixel[..3] == [1, 1, 1] {
            let last = *pixels.last().filter(|_| pixels.len() > row_start)?;
            let count = usize::from(pixel[3]).checked_shl(shift)?;
            if pixels.len() + count > row_start + width {
                return None;
            }
            pixels.resize(pixels.len() + count, last);
            shift = (shift + 8).min(24);
        } else {
            pixels.push(pixel);
            shift = 0;
        }
    }
    Some(())
}

fn take(rest: &mut &[u8]) -> Option<u8> {
    let (first, tail) = rest.split_first()?;
    *rest = tail;
    Some(*first)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn file(head: &str, pixels: &[u8]) -> Vec<u8> {
        [head.as_bytes(), pixels].concat()
    }

    fn decode_ok(bytes: &[u8]) -> Image {
        decode(Path::new("map.hdr"), bytes).unwrap()
    }

    const HEAD: &str = "#?RADIANCE\n# made by hand\nFORMAT=32-bit_rle_rgbe\n\n";

    // 128 · 2^(129−136) = 1, exactly; every value below is a small multiple of a power of two,
    // so that equality is exact.
    #[test]
    fn flat_pixels_and_black() {
        let size = "-Y 1 +X 2\n";
        let bytes = file(&(HEAD.to_owned() + size), &[128, 64, 32, 129, 200, 200, 200, 0]);
        assert_eq!(decode_ok(&bytes).beauty(), [1.0, 0.5, 0.25, 0.0, 0.0, 0.0]);
    }

    #[test]
    fn exposure_is_divided_out_and_rows_are_turned() {
        let head = "#?RGBE\nEXPOSURE=2\nEXPOSURE= 4\n\n+Y 2 -X 1\n";
        let bytes = file(head, &[128, 128, 128, 129, 128, 128, 128, 130]);
        assert_eq!(decode_ok(&bytes).beauty(), [0.25, 0.25, 0.25, 0.125, 0.125, 0.125]);
        let head = "#?RGBE\n\n-Y 1 -X 2\n";
        let bytes = file(head, &[128, 128, 128, 129, 128, 128, 128, 130]);
        assert_eq!(decode_ok(&bytes).beauty()[0], 2.0);
    }

    #[test]
    fn both_run_length_codings() {
        let head = HEAD.to_owned() + "-Y 1 +X 9\n";
        // New: R is a run of 9, G a list of 9, B a run of 4 and a list of 5, E a run.
        let mut new = vec![2, 2, 0, 9, 128 + 9, 128, 9];
        new.extend([0, 16, 32, 48, 64, 80, 96, 112, 128]);
        new.extend([128 + 4, 64, 5, 1, 2, 3, 4, 5, 128 + 9, 129]);
        let image = decode_ok(&file(&head, &new));
        assert_eq!(image.pixels()[0], [1.0, 0.0, 0.5]);
        assert_eq!(image.pixels()[8], [1.0, 1.0, 5.0 / 128.0]);
        // Old: one pixel, repeated 8 times.
        let old = [128, 64, 0, 129, 1, 1, 1, 8];
        let image = decode_ok(&file(&head, &old));
        assert!(image.pixels().iter().all(|p| *p == [1.0, 0.5, 0.0]));
    }

    #[test]
    fn every_truncation_is_an_error() {
        let mut bytes = file(&(HEAD.to_owned() + "-Y 2 +X 9\n"), &[]);
        for _ in 0..2 {
            bytes.extend([2, 2, 0, 9, 137, 128, 137, 64, 137, 32, 137, 129]);
        }
        decode_ok(&bytes);
        for end in 0..bytes.len() {
            assert!(decode(Path::new("map.hdr"), &bytes[..end]).is_err(), "{end}");
        }
    }

    #[test]
    fn what_is_not_supported_says_what_to_do() {
        let cases = [
            ("#?RADIANCE\nFORMAT=32-bit_rle_xyze\n\n-Y 1 +X 1\n", "32-bit_rle_xyze"),
            ("#?RADIANCE\n\n+X 1 -Y 1\n", "columns before rows"),
            ("#?RADIANCE\n\n-Y 99999 +X 99999\n", "at most"),
            ("#?RADIANCE\n\n-Y 0 +X 1\n", "size 1x0"),
            ("#?RADIANCE\n\n-Y 1\n", "size line"),
            ("#?RADIANCE\nEXPOSURE=0\n\n-Y 1 +X 1\n", "EXPOSURE=0"),
        ];
        for (head, expected) in cases {
            let error = decode(Path::new("map.hdr"), &file(head, &[1, 2, 3, 4])).unwrap_err();
            let text = error.to_string();
            assert!(text.contains(expected) && text.contains("map.hdr"), "{text}");
        }
    }
}
