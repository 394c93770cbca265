//! `tyndall compare`: how wrong a picture is against a reference (`tyndall::image::metrics`).

use std::fmt::Write;
use std::path::PathBuf;
use std::process::ExitCode;

use tyndall::image;
use tyndall::image::metrics::{Metrics, compare, error_map};

use super::output::{TITLE, WRONG, columns, print, print_json};

const TOO_DIFFERENT: u8 = 1;

/// Compare a picture with a reference.
///
/// Exit code 0: done, 1: block_relative is above the tolerance, 2: wrong usage or input, such as
/// pictures of unequal sizes.
#[derive(clap::Args)]
pub struct Args {
    /// An .exr, .hdr or .png file.
    picture: PathBuf,
    /// What it should be.
    reference: PathBuf,
    /// An optical depth a pixel: blocks count where its mean is above 0.01.
    #[arg(long, value_name = "TAU.exr")]
    mask: Option<PathBuf>,
    /// Write the relative error of each pixel in colors: black 0.1 %, red about 10 %, yellow 100 %.
    #[arg(long, value_name = "OUT.png")]
    map: Option<PathBuf>,
    /// The largest block_relative that is accepted, such as 0.02.
    #[arg(long, value_name = "X", value_parser = parse_tolerance)]
    tolerance: Option<f64>,
    /// Print JSON.
    #[arg(long)]
    json: bool,
}

fn parse_tolerance(text: &str) -> Result<f64, String> {
    let tolerance = text.parse().ok().filter(|x: &f64| x.is_finite() && *x >= 0.0);
    tolerance.ok_or_else(|| "write a number of at least 0, such as 0.02 for 2 %".to_owned())
}

/// Compares.
///
/// # Errors
/// When a file cannot be read or written, or sizes differ.
pub fn run(args: &Args) -> anyhow::Result<ExitCode> {
    if let Some(path) = &args.map {
        if image::Format::of(path)? != image::Format::Png {
            anyhow::bail!("--map {}: the map is a .png; change the ending", path.display());
        }
        image::atomic::check(path)?;
    }
    let picture = image::read(&args.picture)?;
    let reference = image::read(&args.reference)?;
    let mask = args.mask.as_deref().map(image::read).transpose()?;
    let metrics = compare(&picture, &reference, mask.as_ref())?;
    if let Some(path) = &args.map {
        image::write(path, &error_map(&picture, &reference)?)?;
    }
    if args.json {
        print_json(&metrics)?;
    } else {
        print(&describe(&metrics, args.tolerance))?;
    }
    let too_different = args.tolerance.is_some_and(|tolerance| metrics.block_relative > tolerance);
    Ok(if too_different { ExitCode::from(TOO_DIFFERENT) } else { ExitCode::SUCCESS })
}

fn describe(metrics: &Metrics, tolerance: Option<f64>) -> String {
    let percent = |x: f64| format!("{:.3} %", 100.0 * x);
    let row = |name: &str, all: String, channel: &dyn Fn(usize) -> String| {
        vec![name.to_owned(), all, channel(0), channel(1), channel(2)]
    };
    let of = &metrics.per_channel;
    let none = |_: usize| String::new();
    let rows = [
        row("", "all".to_owned(), &|channel| ["R", "G", "B"][channel].to_owned()),
        row("mean_relative", percent(metrics.mean_relative), &|c| percent(of[c].mean_relative)),
        row("block_relative", percent(metrics.block_relative), &|c| percent(of[c].block_relative)),
        row("bias", percent(metrics.bias), &|c| percent(of[c].bias)),
        row("rel_mse", format!("{:.4e}", metrics.rel_mse), &none),
        row("flip", format!("{:.4}", metrics.flip), &none),
        row("ssim", format!("{:.4}", metrics.ssim), &none),
    ];
    let mut text = columns(&rows);
    if metrics.non_finite > 0 {
        let _ =
            writeln!(text, "  {WRONG}non_finite      {} pixels, left out above{WRONG:#}", metrics.non_finite);
    }
    if let Some(tolerance) = tolerance {
        let place = if metrics.block_relative > tolerance { "above" } else { "within" };
        let _ = writeln!(
            text,
            "{TITLE}block_relative is {place} the tolerance of {}{TITLE:#}",
            percent(tolerance)
        );
    }
    text
}
