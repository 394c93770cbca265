//! Pictures: their type, their files, their display and their comparison.
//!
//! An [`Image`] is a stack of layers of one size. Radiance is linear with Rec. 709 primaries
//! (W m⁻² sr⁻¹), row 0 on top, channels interleaved. The layer `beauty` always exists, comes
//! first and has three channels, so that no reader has to ask for it.
//!
//! Files: [`exr`] (all layers), [`hdr`] (Radiance RGBE, read only), [`png`] (display-referred).
//! [`read`] tells them apart by their first bytes, never by their name. Every file is written
//! by [`atomic::write`]: whole or not at all. [`tonemap`] maps radiance to the display;
//! [`metrics`], [`flip`] and [`ssim`] compare pictures: one implementation for tests, command
//! line and editor.
//!
//! Limits: 2²⁸ pixels (16384²) and 2³⁰ samples a file, checked before memory is taken.
//!
//! Tested by round trips, damaged files, and real environment maps where they are present.

pub mod atomic;
pub mod colormap;
pub mod exr;
pub mod flip;
pub mod hdr;
pub mod metrics;
pub mod png;
pub mod ssim;
pub mod table;
pub mod tonemap;

use std::io;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use indexmap::IndexMap;

/// The most pixels that a file may announce.
pub const MAX_PIXELS: usize = 1 << 28;
/// The most samples (pixels times channels) that a file may announce.
pub const MAX_SAMPLES: usize = 1 << 30;

/// Name of the layer that every image has: three channels of radiance.
pub const BEAUTY: &str = "beauty";
/// Name of the coverage layer: one channel, 0..=1.
pub const ALPHA: &str = "alpha";
/// Name of the depth layer: one channel, metres.
pub const DEPTH: &str = "depth";

/// A stack of layers of one size; `beauty` is the first.
#[derive(Debug, Clone, PartialEq)]
pub struct Image {
    /// Pixels along a row.
    pub width: usize,
    /// Rows; row 0 is the top.
    pub height: usize,
    /// By name, in the order of their making; pictures that differ in some share the others.
    pub layers: IndexMap<String, Arc<Layer>>,
}

/// One layer: `width * height * channels` values, row 0 on top, channels interleaved.
#[derive(Debug, Clone, PartialEq)]
pub struct Layer {
    /// 1 or 3.
    pub channels: usize,
    /// The values.
    pub data: Vec<f32>,
}

impl Image {
    /// An image with nothing but `beauty`: `rgb` holds `width * height * 3` values.
    ///
    /// # Panics
    /// If the length does not fit the size.
    pub fn new(width: usize, height: usize, rgb: Vec<f32>) -> Self {
        let mut image = Self { width, height, layers: IndexMap::new() };
        image.insert(BEAUTY, 3, rgb);
        image
    }

    /// Bytes of all layers.
    pub fn bytes(&self) -> u64 {
        self.layers.values().map(|layer| size_of_val(layer.data.as_slice()) as u64).sum()
    }

    /// Adds a layer, or replaces the one of that name.
    ///
    /// # Panics
    /// If `channels` is neither 1 nor 3, if `beauty` does not have 3, or if the length does
    /// not fit the size.
    pub fn insert(&mut self, name: &str, channels: usize, data: Vec<f32>) {
        assert!(channels == 3 || (channels == 1 && name != BEAUTY));
        assert_eq!(data.len(), self.width * self.height * channels, "{name}");
        let layer = Layer { channels, data };
        self.layers.insert(name.to_owned(), Arc::new(layer));
    }

    /// The radiance, `width * height * 3` values.
    ///
    /// # Panics
    /// If `beauty` was taken out of `layers`.
    pub fn beauty(&self) -> &[f32] {
        &self.layers[BEAUTY].data
    }

    /// The pixels of `beauty`, row by row.
    pub fn pixels(&self) -> &[[f32; 3]] {
        self.beauty().as_chunks().0
    }
}

/// What can go wrong with an image file.
#[derive(Debug, thiserror::Error)]
pub enum ImageError {
    /// The file could not be read at all.
    #[error("cannot read {path}: {source}; check the path and its permissions")]
    Read {
        /// The file.
        path: PathBuf,
        /// What the system said.
        source: io::Error,
    },
    /// The file is well formed, as far as one can tell, and uses what is not supported.
    #[error("{path} is not supported: {found}; {remedy}")]
    NotSupported {
        /// The file.
        path: PathBuf,
        /// What was found.
        found: String,
        /// What to do.
        remedy: &'static str,
    },
    /// The file contradicts its format.
    #[error("{path} is damaged: {found}; copy or export it again")]
    Invalid {
        /// The file.
        path: PathBuf,
        /// What was found.
        found: String,
    },
    /// An environment map holds a value that is no radiance.
    #[error(
        "{path}: texel ({x}, {y}) has {channel} = {value}; radiance must be finite and not negative, repair the map"
    )]
    Texel {
        /// The file.
        path: PathBuf,
        /// Column, from the left.
        x: usize,
        /// Row, from the top.
        y: usize,
        /// R, G or B.
        channel: char,
        /// What was found there.
        value: f32,
    },
    /// A picture for the display holds a value that has no color.
    #[error(
        "cannot write {path}: pixel ({x}, {y}) is not finite; a PNG cannot hold it, write an EXR to look at it"
    )]
    NonFinite {
        /// The file.
        path: PathBuf,
        /// Column, from the left.
        x: usize,
        /// Row, from the top.
        y: usize,
    },
    /// The ending says no format that is written.
    #[error("cannot write {path}: pictures are written as .exr or .png; change the ending")]
    Ending {
        /// The file.
        path: PathBuf,
    },
    /// A layer's name cannot be a channel's name.
    #[error(
        "cannot write {path}: layer name {name:?}; 1 to 200 letters, digits, '_', '-' or '.' are allowed, rename the layer"
    )]
    LayerName {
        /// The file.
        path: PathBuf,
        /// The name.
        name: String,
    },
    /// The file could not be written.
    #[error(transparent)]
    Write(#[from] atomic::WriteError),
}

impl ImageError {
    fn invalid(path: &Path, found: impl Into<String>) -> Self {
        Self::Invalid { path: path.to_owned(), found: found.into() }
    }

    fn not_supported(path: &Path, found: impl Into<String>, remedy: &'static str) -> Self {
        Self::NotSupported { path: path.to_owned(), found: found.into(), remedy }
    }
}

pub use colormap::Colormap;
pub use table::Table;

/// How the names of pictures end that are written, as [`Format::of`] has it.
pub const ENDINGS: &[&str] = &["exr", "png"];
/// How the names of environment maps usually end; [`read_environment`] goes by content.
pub const ENVIRONMENT_ENDINGS: &[&str] = &["exr", "hdr"];

/// What a picture is written as.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Format {
    /// OpenEXR with all layers.
    Exr,
    /// 8-bit sRGB of the beauty.
    Png,
}

impl Format {
    /// By the ending of the name, case ignored.
    ///
    /// # Errors
    /// [`ImageError::Ending`] for any other ending and for none.
    pub fn of(path: &Path) -> Result<Self, ImageError> {
        match path.extension().and_then(|ending| ending.to_str()).map(str::to_lowercase).as_deref() {
            Some("exr") => Ok(Self::Exr),
            Some("png") => Ok(Self::Png),
            _ => Err(ImageError::Ending { path: path.to_owned() }),
        }
    }
}

/// Writes an image in the format that its name's ending says; see [`exr::write`] and [`png::write`].
///
/// # Errors
/// As [`Format::of`] and the writers.
pub fn write(path: &Path, image: &Image) -> Result<(), ImageError> {
    match Format::of(path)? {
        Format::Exr => exr::write(path, image),
        Format::Png => png::write(path, image),
    }
}

/// Reads an EXR, Radiance HDR or PNG file, whichever its first bytes say it is.
///
/// # Errors
/// If the file cannot be read, is none of the three, or is refused by its reader.
pub fn read(path: &Path) -> Result<Image, ImageError> {
    let bytes = read_bytes(path)?;
    if png::has_signature(&bytes) { png::decode(path, &bytes) } else { read_radiance(path, &bytes) }
}

/// Reads an environment map, EXR or Radiance HDR by content; keeps `beauty` alone.
///
/// # Errors
/// As [`read`]; also for a PNG, and if a texel is negative or not finite, which names it.
pub fn read_environment(path: &Path) -> Result<Image, ImageError> {
    let bytes = read_bytes(path)?;
    let mut image = read_radiance(path, &bytes)?;
    image.layers.retain(|name, _| name == BEAUTY);
    let bad = |v: &f32| !(v.is_finite() && *v >= 0.0);
    if let Some(at) = image.beauty().iter().position(bad) {
        return Err(ImageError::Texel {
            path: path.to_owned(),
            x: at / 3 % image.width,
            y: at / 3 / image.width,
            channel: ['R', 'G', 'B'][at % 3],
            value: image.beauty()[at],
        });
    }
    Ok(image)
}

fn read_radiance(path: &Path, bytes: &[u8]) -> Result<Image, ImageError> {
    if exr::has_signature(bytes) {
        exr::decode(path, bytes)
    } else if hdr::has_signature(bytes) {
        hdr::decode(path, bytes)
    } else {
        let start: String = bytes.iter().take(4).map(|b| format!(" {b:02x}")).collect();
        Err(ImageError::not_supported(
            path,
            format!("no known signature (the file starts with{start})"),
            "give a linear .exr or Radiance .hdr file",
        ))
    }
}

fn read_bytes(path: &Path) -> Result<Vec<u8>, ImageError> {
    std::fs::read(path).map_err(|source| ImageError::Read { path: path.to_owned(), source })
}

/// Refuses a size that is empty or beyond the limits, before memory is taken for it.
fn check_size(path: &Path, width: usize, height: usize, channels: usize) -> Result<(), ImageError> {
    if width == 0 || height == 0 {
        return Err(ImageError::invalid(path, format!("size {width}x{height}")));
    }
    let pixels = width.saturating_mul(height);
    if pixels > MAX_PIXELS || pixels.saturating_mul(channels) > MAX_SAMPLES {
        return Err(ImageError::not_supported(
            path,
            format!(
                "{width}x{height} pixels of {channels} channels, at most {MAX_PIXELS} pixels and {MAX_SAMPLES} samples are read"
            ),
            "scale it down or drop channels",
        ));
    }
    Ok(())
}

#[cfg(test)]
mod tests;
