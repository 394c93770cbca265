//! OpenEXR files: every layer of an [`Image`], 32-bit float, ZIP.
//!
//! Written: `beauty` as R G B, `alpha` as A, `depth` as Z (metres), any other layer of three
//! channels as `layer.R` `layer.G` `layer.B` and of one channel as `layer.Y`, scan lines, ZIP
//! in blocks of 16 rows (no loss), chromaticities Rec. 709. The same image gives the same bytes.
//!
//! Read: half, float and unsigned integer samples in any compression that the `exr` crate
//! knows; tiles and mip maps (their largest level); several parts, where all but the first have
//! their part's name before their channels' names. A Y channel, or the only color channel of
//! the file, is grey and fills R, G and B. A channel that is none of the above becomes a layer
//! of its own name and one channel.
//!
//! Windows: the picture is the display window, as OpenEXR defines it. Pixels outside the data
//! window are 0, pixels outside the display window (overscan) are cut off.
//!
//! Limits: deep data, subsampled and luminance–chroma channels are refused by name; other
//! primaries than Rec. 709 are not converted. Source: OpenEXR, "Technical Introduction".
//! Tested by round trips, windows, odd channel sets, truncation and flipped bytes.

use std::io::Cursor;
use std::path::Path;
use std::sync::Arc;

use ::exr::block::samples::Sample;
use ::exr::image::write::WritableImage;
use ::exr::image::{AnyChannel, AnyChannels, Encoding, FlatImage, FlatSamples};
use ::exr::math::Vec2;
use ::exr::meta::attribute::{Chromaticities, IntegerBounds, Text};
use ::exr::meta::{MetaData, header};
use ::exr::prelude::{Compression, ReadChannels, ReadLayers};
use indexmap::IndexMap;

use super::{ALPHA, BEAUTY, DEPTH, Image, ImageError, Layer, atomic, check_size};

/// What the crate returns for a file that it cannot read.
type ExrError = ::exr::error::Error;

const REMEDY: &str = "export it as a flat, full resolution RGB file";

/// No compression of OpenEXR packs more into a byte (deflate: 1032 bytes), so that a damaged
/// header does not take gigabytes.
const MOST_SAMPLES_PER_BYTE: usize = 4096;
/// A small crop in a large display window is honest up to this many samples (256 MiB).
const MOST_UNQUESTIONED: usize = 1 << 26;

/// Whether the bytes start as an OpenEXR file does.
pub(super) fn has_signature(bytes: &[u8]) -> bool {
    bytes.starts_with(&[0x76, 0x2f, 0x31, 0x01])
}

/// Reads an OpenEXR file.
///
/// # Errors
/// If it cannot be read, is damaged, holds no color, or uses what is not supported.
pub fn read(path: &Path) -> Result<Image, ImageError> {
    decode(path, &super::read_bytes(path)?)
}

/// Writes an image; see the module for the channels' names.
///
/// # Errors
/// If a layer's name cannot be a channel's name, or the file cannot be written.
///
/// # Panics
/// If a layer's length does not fit the image's size.
pub fn write(path: &Path, image: &Image) -> Result<(), ImageError> {
    let mut list = Vec::new();
    for (name, layer) in &image.layers {
        let samples = image.width * image.height * layer.channels;
        assert_eq!(layer.data.len(), samples, "layer {name}");
        let legal = |c: char| c.is_ascii_alphanumeric() || "_-.".contains(c);
        if name.is_empty() || name.len() > 200 || !name.chars().all(legal) {
            return Err(ImageError::LayerName { path: path.to_owned(), name: name.clone() });
        }
        for (c, channel) in channel_names(name, layer.channels).iter().enumerate() {
            let values = layer.data.iter().skip(c).step_by(layer.channels).copied();
            let samples = FlatSamples::F32(values.collect());
            list.push(AnyChannel::new(channel.as_str(), samples));
        }
    }
    let encoding = Encoding { compression: Compression::ZIP16, ..Encoding::SMALL_LOSSLESS };
    let mut file = ::exr::image::Image::from_encoded_channels(
        (image.width, image.height),
        encoding,
        AnyChannels::sort(list.into()),
    );
    file.attributes.chromaticities = Some(Chromaticities {
        red: Vec2(0.64, 0.33),
        green: Vec2(0.3, 0.6),
        blue: Vec2(0.15, 0.06),
        white: Vec2(0.3127, 0.329),
    });
    let mut bytes = Cursor::new(Vec::new());
    file.write()
        .to_buffered(&mut bytes)
        .map_err(|e| atomic::WriteError::File { path: path.to_owned(), source: std::io::Error::other(e) })?;
    Ok(atomic::write(path, bytes.get_ref())?)
}

fn channel_names(layer: &str, channels: usize) -> Vec<String> {
    match (layer, channels) {
        (BEAUTY, 3) => ["R", "G", "B"].map(String::from).to_vec(),
        (ALPHA, 1) => vec!["A".into()],
        (DEPTH, 1) => vec!["Z".into()],
        (_, 3) => ["R", "G", "B"].map(|c| format!("{layer}.{c}")).to_vec(),
        _ => vec![format!("{layer}.Y")],
    }
}

pub(super) fn decode(path: &Path, bytes: &[u8]) -> Result<Image, ImageError> {
    let explain = |error| match error {
        ExrError::NotSupported(found) => ImageError::not_supported(path, found, REMEDY),
        other => ImageError::invalid(path, other.to_string()),
    };
    let meta = MetaData::read_from_buffered(Cursor::new(bytes), false).map_err(explain)?;
    let channels = meta.headers.iter().map(|h| h.channels.list.len()).sum();
    for header in &meta.headers {
        check_header(path, header, channels)?;
        let display = header.shared_attributes.display_window.size;
        let samples = header.layer_size.area().max(display.area()) * channels;
        if samples > MOST_UNQUESTIONED.max(bytes.len() * MOST_SAMPLES_PER_BYTE) {
            let found = format!("{samples} samples announced in {} bytes", bytes.len());
            return Err(ImageError::invalid(path, found));
        }
    }
    let file: FlatImage = ::exr::image::read::read()
        .no_deep_data()
        .largest_resolution_level()
        .all_channels()
        .all_layers()
        .all_attributes()
        .from_buffered(Cursor::new(bytes))
        .map_err(explain)?;
    let window = file.attributes.display_window;
    let planes = planes(path, &file)?;
    let layers = assemble(path, planes)?;
    Ok(Image {
        width: window.size.width(),
        height: window.size.height(),
        layers: layers.into_iter().map(|(name, layer)| (name, Arc::new(layer))).collect(),
    })
}

/// Refuses, by the header alone, what would take too much memory or cannot be shown.
fn check_header(path: &Path, header: &header::Header, channels: usize) -> Result<(), ImageError> {
    let display = header.shared_attributes.display_window;
    for size in [header.layer_size, display.size] {
        check_size(path, size.width(), size.height(), channels)?;
    }
    if header.deep {
        return Err(ImageError::not_supported(path, "deep data", REMEDY));
    }
    for channel in &header.channels.list {
        let name = &channel.name;
        if channel.sampling != Vec2(1, 1) {
            let found = format!("channel {name} is subsampled");
            return Err(ImageError::not_supported(path, found, REMEDY));
        }
    }
    let data = IntegerBounds::new(header.own_attributes.layer_position, header.layer_size);
    if overlap(data, display).is_none() {
        return Err(ImageError::not_supported(
            path,
            "the data window lies outside the display window",
            "export it with a display window that holds the picture",
        ));
    }
    Ok(())
}

/// First and one past the last common coordinate along x and y.
fn overlap(a: IntegerBounds, b: IntegerBounds) -> Option<[std::ops::Range<i64>; 2]> {
    let axis = |a0: i32, an: usize, b0: i32, bn: usize| {
        let (a0, b0) = (i64::from(a0), i64::from(b0));
        a0.max(b0)..(a0 + an as i64).min(b0 + bn as i64)
    };
    let x = axis(a.position.0, a.size.0, b.position.0, b.size.0);
    let y = axis(a.position.1, a.size.1, b.position.1, b.size.1);
    (!x.is_empty() && !y.is_empty()).then_some([x, y])
}

/// Every channel of every part on the display window, by full name.
fn planes(path: &Path, file: &FlatImage) -> Result<IndexMap<String, Vec<f32>>, ImageError> {
    let display = file.attributes.display_window;
    let mut planes = IndexMap::new();
    for (index, part) in file.layer_data.iter().enumerate() {
        let data = part.absolute_bounds();
        let [columns, rows] = overlap(data, display).expect("checked by check_header");
        let shift = |at: i64, origin: i32| (at - i64::from(origin)) as usize;
        let part_name = part.attributes.layer_name.as_ref().map(Text::to_string);
        for channel in &part.channel_data.list {
            let mut plane = vec![0.0; display.size.area()];
            for row in rows.clone() {
                let n = columns.clone().count();
                let from =
                    shift(row, data.position.1) * data.size.width() + shift(columns.start, data.position.0);
                let to = shift(row, display.position.1) * display.size.width()
                    + shift(columns.start, display.position.0);
                copy_row(&channel.sample_data, from, &mut plane[to..to + n]);
            }
            let name = match &part_name {
                Some(part) if index > 0 && !channel.name.to_string().starts_with(part) => {
                    format!("{part}.{}", channel.name)
                }
                _ => channel.name.to_string(),
            };
            if planes.insert(name.clone(), plane).is_some() {
                let found = format!("channel {name} is there twice");
                return Err(ImageError::invalid(path, found));
            }
        }
    }
    Ok(planes)
}

fn copy_row(samples: &FlatSamples, from: usize, row: &mut [f32]) {
    for (i, value) in row.iter_mut().enumerate() {
        *value = match samples {
            FlatSamples::F32(v) => v[from + i],
            FlatSamples::F16(v) => v[from + i].to_f32(),
            FlatSamples::U32(v) => Sample::U32(v[from + i]).to_f32(),
        };
    }
}

/// Channels become layers; `beauty` comes first.
fn assemble(
    path: &Path,
    mut planes: IndexMap<String, Vec<f32>>,
) -> Result<IndexMap<String, Layer>, ImageError> {
    if planes.contains_key("RY") || planes.contains_key("BY") {
        let found = "luminance–chroma channels (Y RY BY)";
        return Err(ImageError::not_supported(path, found, REMEDY));
    }
    let found: Vec<String> = planes.keys().cloned().collect();
    let mut layers = IndexMap::new();
    layers.insert(BEAUTY.to_owned(), take_beauty(path, &mut planes, &found)?);
    for name in &found {
        if !planes.contains_key(name) {
            continue;
        }
        let (group, channel) = name.rsplit_once('.').unwrap_or(("", name));
        let triple = ["R", "G", "B"].map(|c| format!("{group}.{c}"));
        let is_triple = triple.contains(name) && triple.iter().all(|c| planes.contains_key(c));
        let (layer_name, layer) = if is_triple {
            (group, take_rgb(&mut planes, &triple))
        } else {
            let data = planes.shift_remove(name).expect("present");
            let layer_name = match (group, channel) {
                ("", "A") => ALPHA,
                ("", "Z") => DEPTH,
                (group, "Y") if !group.is_empty() => group,
                _ => name,
            };
            (layer_name, Layer { channels: 1, data })
        };
        if layers.contains_key(layer_name) {
            let found = format!("layer {layer_name} is there twice");
            return Err(ImageError::invalid(path, found));
        }
        layers.insert(layer_name.to_owned(), layer);
    }
    Ok(layers)
}

fn take_beauty(
    path: &Path,
    planes: &mut IndexMap<String, Vec<f32>>,
    found: &[String],
) -> Result<Layer, ImageError> {
    let rgb = ["R", "G", "B"].map(String::from);
    if rgb.iter().all(|c| planes.contains_key(c)) {
        return Ok(take_rgb(planes, &rgb));
    }
    let grey = match found {
        _ if planes.contains_key("Y") => "Y",
        [only] if only != "A" && only != "Z" => only,
        _ => {
            return Err(ImageError::not_supported(
                path,
                format!("no color, only the channels {}", found.join(" ")),
                "give a file with R, G and B, or with Y",
            ));
        }
    };
    let plane = planes.shift_remove(grey).expect("present");
    Ok(Layer { channels: 3, data: plane.iter().flat_map(|v| [*v; 3]).collect() })
}

fn take_rgb(planes: &mut IndexMap<String, Vec<f32>>, names: &[String; 3]) -> Layer {
    let [r, g, b] = names.each_ref().map(|name| planes.shift_remove(name).expect("present"));
    let data = r.iter().zip(&g).zip(&b);
    Layer { channels: 3, data: data.flat_map(|((r, g), b)| [*r, *g, *b]).collect() }
}

#[cfg(test)]
#[path = "exr_tests.rs"]
mod tests;
