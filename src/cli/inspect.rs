//! `tyndall inspect`: what is in a volume, a picture, or a folder of frames.

use std::fmt::Write;
use std::path::{Path, PathBuf};
use std::process::ExitCode;

use serde::Serialize;
use tyndall::image::{self, Image, Layer};
use tyndall::volume::sequence::Sequence;
use tyndall::volume::stats::Sample;
use tyndall::volume::vdb::{File, GridSummary, Summary};

use super::frames::is_pattern;
use super::output::{NAME, TITLE, WRONG, columns, print, print_json, size};

/// Show what is in a .vdb file, a picture, or a sequence (a folder or a pattern such as smoke_####.vdb).
#[derive(clap::Args)]
pub struct Args {
    /// A .vdb, .exr, .hdr or .png file, a folder, or a pattern.
    path: PathBuf,
    /// Print JSON.
    #[arg(long)]
    json: bool,
}

/// Prints.
///
/// # Errors
/// When the file cannot be read.
pub fn run(args: &Args) -> anyhow::Result<ExitCode> {
    let path = &args.path;
    let ending = path.extension().map(|ending| ending.to_string_lossy().to_lowercase());
    match ending.as_deref() {
        _ if path.is_dir() || is_pattern(path) && !path.exists() => {
            show(args, &FramesJson::find(path)?, describe_frames)?;
        }
        _ if !path.exists() => anyhow::bail!("{}: there is no such file or folder", path.display()),
        Some("vdb") => show(args, &File::open(path)?.summary(), describe_volume)?,
        Some("exr" | "hdr" | "png") => {
            show(args, &PictureJson::of(path, &image::read(path)?), describe_picture)?
        }
        _ => anyhow::bail!(
            "{}: cannot look into this; name a .vdb, .exr, .hdr or .png file, a folder, or a pattern such as smoke_####.vdb",
            path.display()
        ),
    }
    Ok(ExitCode::SUCCESS)
}

fn show<T: Serialize>(args: &Args, found: &T, describe: fn(&T) -> String) -> anyhow::Result<()> {
    if args.json { print_json(found) } else { print(&describe(found)) }
}

/// A sequence for scripts; the field names are a contract.
#[derive(Serialize)]
struct FramesJson {
    path: String,
    first: i64,
    last: i64,
    /// How many there are.
    count: usize,
    /// Numbers between the first and the last that are not there.
    missing: Vec<i64>,
    frames: Vec<FrameJson>,
}

#[derive(Serialize)]
struct FrameJson {
    frame: i64,
    file: String,
    bytes: u64,
}

/// More numbers are not listed: the names hold a date, or one file too many.
const MOST_MISSING: i64 = 1_000_000;

impl FramesJson {
    fn find(path: &Path) -> anyhow::Result<Self> {
        let Sequence::Numbered { files, .. } = Sequence::find(path)? else {
            anyhow::bail!("{}: this is no sequence; name a folder or a pattern", path.display());
        };
        let (Some((first, _)), Some((last, _))) = (files.first_key_value(), files.last_key_value()) else {
            anyhow::bail!("{}: there are no frames", path.display());
        };
        let (first, last) = (*first, *last);
        if last - first > MOST_MISSING + files.len() as i64 {
            anyhow::bail!(
                "{}: the numbers go from {first} to {last}; take out what does not belong",
                path.display()
            );
        }
        let missing = (first..=last).filter(|frame| !files.contains_key(frame)).collect();
        let frames: Vec<FrameJson> = files
            .iter()
            .map(|(frame, file)| FrameJson {
                frame: *frame,
                file: file.display().to_string(),
                bytes: std::fs::metadata(file).map_or(0, |found| found.len()),
            })
            .collect();
        Ok(Self { path: path.display().to_string(), first, last, count: frames.len(), missing, frames })
    }
}

fn describe_frames(found: &FramesJson) -> String {
    let bytes: u64 = found.frames.iter().map(|frame| frame.bytes).sum();
    let FramesJson { path, count, first, last, .. } = found;
    let mut text = format!("{TITLE}{path}{TITLE:#}: {count} frames, {first} to {last}, {}\n", size(bytes));
    if !found.missing.is_empty() {
        let _ = writeln!(text, "  {WRONG}missing:{WRONG:#} {}", ranges(&found.missing));
    }
    if let (Some(first), Some(last)) = (found.frames.first(), found.frames.last()) {
        let _ = writeln!(text, "  first  {}\n  last   {}", first.file, last.file);
    }
    text
}

/// `3, 5-9` of numbers in order.
fn ranges(numbers: &[i64]) -> String {
    let runs = numbers.chunk_by(|a, b| a + 1 == *b);
    let texts = runs.map(|run| match run {
        [first, .., last] => format!("{first}-{last}"),
        [one] => one.to_string(),
        [] => String::new(),
    });
    texts.collect::<Vec<_>>().join(", ")
}

fn describe_volume(found: &Summary) -> String {
    let mut text = format!("{TITLE}{}{TITLE:#}: OpenVDB, file version {}\n", found.file, found.version);
    if found.grids.is_empty() {
        text += "  no grids\n";
    }
    for grid in &found.grids {
        let _ = writeln!(text, "{NAME}{}{NAME:#} ({})", grid.name, grid.kind);
        text += &columns(&grid_rows(grid));
        if let Some(why) = &grid.refused {
            let _ = writeln!(text, "  {WRONG}refused:{WRONG:#} {why}");
        }
    }
    text
}

fn grid_rows(grid: &GridSummary) -> Vec<Vec<String>> {
    let mut rows = Vec::new();
    let mut row = |name: &str, value: String| rows.push(vec![name.to_owned(), value]);
    if let Some(figures) = &grid.figures {
        row("active voxels", figures.active_voxels.to_string());
        for (name, sample) in [("min", figures.min), ("max", figures.max), ("mean", figures.mean)] {
            if let Some(sample) = sample {
                row(name, sample_text(sample));
            }
        }
        if let (Some(min), Some(max)) = (figures.bbox_min, figures.bbox_max) {
            let [nx, ny, nz] = [0, 1, 2].map(|axis| u64::from(max[axis].abs_diff(min[axis])) + 1);
            row("extent", format!("{nx} x {ny} x {nz} voxels, {min:?} to {max:?}"));
            let bytes = nx.saturating_mul(ny).saturating_mul(nz).saturating_mul(4);
            row("memory", format!("{} as a dense field of 32 bits", size(bytes)));
        }
    }
    if let Some(voxel) = grid.voxel_size {
        row("voxel size", voxel.map(number).join(" x "));
    }
    if let Some(matrix) = &grid.world_from_index {
        for (idx, numbers) in matrix.chunks(4).enumerate() {
            row(
                if idx == 0 { "world from index" } else { "" },
                numbers.iter().copied().map(number).collect::<Vec<_>>().join(" "),
            );
        }
    }
    if let Some(background) = grid.background {
        row("background", sample_text(background));
    }
    row("compression", grid.compression.clone());
    for (name, value) in &grid.metadata {
        row(name, serde_json::to_string(value).unwrap_or_default());
    }
    rows
}

fn sample_text(sample: Sample) -> String {
    match sample {
        Sample::Scalar(x) => number(x),
        Sample::Vector(v) => v.map(number).join(" "),
    }
}

/// A picture for scripts; the field names are a contract.
#[derive(Serialize)]
struct PictureJson {
    file: String,
    width: usize,
    height: usize,
    layers: Vec<LayerJson>,
}

#[derive(Serialize)]
struct LayerJson {
    name: String,
    channels: usize,
    /// One number a channel, of the finite values; null where there are none.
    min: Vec<Option<f32>>,
    max: Vec<Option<f32>>,
    mean: Vec<Option<f64>>,
    /// Pixels of which a channel is not finite.
    non_finite: usize,
}

impl PictureJson {
    fn of(path: &Path, image: &Image) -> Self {
        let layers = image.layers.iter().map(|(name, layer)| LayerJson::of(name, layer));
        Self {
            file: path.display().to_string(),
            width: image.width,
            height: image.height,
            layers: layers.collect(),
        }
    }
}

impl LayerJson {
    fn of(name: &str, layer: &Layer) -> Self {
        let channels = layer.channels;
        let finite = |channel: usize| {
            layer.data.iter().skip(channel).step_by(channels).copied().filter(|value| value.is_finite())
        };
        let mean = |channel: usize| {
            let (count, sum) =
                finite(channel).fold((0_u64, 0.0), |(count, sum), value| (count + 1, sum + f64::from(value)));
            (count > 0).then(|| sum / count as f64)
        };
        let broken = layer.data.chunks(channels).filter(|pixel| pixel.iter().any(|value| !value.is_finite()));
        Self {
            name: name.to_owned(),
            channels,
            min: (0..channels).map(|channel| finite(channel).reduce(f32::min)).collect(),
            max: (0..channels).map(|channel| finite(channel).reduce(f32::max)).collect(),
            mean: (0..channels).map(mean).collect(),
            non_finite: broken.count(),
        }
    }
}

fn describe_picture(found: &PictureJson) -> String {
    let PictureJson { file, width, height, layers } = found;
    let mut text = format!("{TITLE}{file}{TITLE:#}: {width}x{height} pixels\n");
    let mut rows = vec![["layer", "min", "mean", "max", ""].map(str::to_owned).to_vec()];
    for layer in layers {
        let broken = match layer.non_finite {
            0 => String::new(),
            count => format!("{count} pixels are not finite"),
        };
        let (min, max) = (figures(&layer.min), figures(&layer.max));
        rows.push(vec![layer.name.clone(), min, figures(&layer.mean), max, broken]);
    }
    text += &columns(&rows);
    text
}

fn figures<T: Copy + Into<f64>>(values: &[Option<T>]) -> String {
    let texts = values.iter().map(|value| value.map_or("-".to_owned(), |value| number(value.into())));
    texts.collect::<Vec<_>>().join(" ")
}

/// With six digits: `0.0333333`, `60`, `1.5e-7`.
fn number(x: f64) -> String {
    let rounded: f64 = format!("{x:.5e}").parse().unwrap_or(x);
    let is_plain = rounded == 0.0 || !rounded.is_finite() || (1e-4..1e9).contains(&rounded.abs());
    if is_plain { rounded.to_string() } else { format!("{rounded:e}") }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_have_six_digits() {
        let texts = [1.0 / 30.0, 60.0, -1.5e-7, 0.0, f64::NAN, 1e12 / 3.0, 123_456.78].map(number);
        assert_eq!(texts, ["0.0333333", "60", "-1.5e-7", "0", "NaN", "3.33333e11", "123457"]);
    }

    #[test]
    fn runs_of_numbers() {
        assert_eq!(ranges(&[3, 5, 6, 7, 9, 10]), "3, 5-7, 9-10");
        assert_eq!(ranges(&[]), "");
    }

    #[test]
    fn layers_count_what_is_not_finite() {
        let data = vec![1.0, -2.0, 3.0, f32::NAN, 4.0, f32::INFINITY];
        let layer = LayerJson::of("beauty", &Layer { channels: 3, data });
        assert_eq!(layer.non_finite, 1);
        assert_eq!(layer.min, [Some(1.0), Some(-2.0), Some(3.0)]);
        assert_eq!(layer.mean, [Some(1.0), Some(1.0), Some(3.0)]);
        let empty = LayerJson::of("a", &Layer { channels: 1, data: vec![f32::NAN] });
        assert_eq!((empty.min[0], empty.mean[0], empty.non_finite), (None, None, 1));
    }
}
