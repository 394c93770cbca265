//! `histogram`: how often which values stand in a grid.
//!
//! Bins of equal width from the lower to the upper end, the last one with its upper end; what lies beyond a given range
//! is counted apart. Voxels that hold exactly what stands outside of them (the void around a cloud) are left out unless
//! asked for, because they would dwarf all else. Tested by numbers whose bins are known.

use super::scalar::{BEAM, GRID, INPUTS, Scalar, range};
use super::{NodeKind, Rules, Run, no_files};
use crate::graph::{Category, NodeError, NodeSpec, ParamSpec, PortSpec, PortType, Value};
use crate::image::{Image, Table};

pub(super) const KIND: NodeKind = NodeKind { spec: &SPEC, files: no_files, run, rules: Rules::None };

static SPEC: NodeSpec = NodeSpec {
    id: "histogram",
    version: 1,
    category: Category::Image,
    purpose: "Counts how often which values stand in a volume or medium.",
    doc: "The table has a row for each bin: low, high, count. The summary has one row: voxels, minimum, maximum and mean of all that \
          was counted, and how many lie below and above the range. `tyndall render GRAPH --node NAME -o h.csv` writes the table.",
    inputs: INPUTS,
    outputs: &[
        PortSpec::new("table", PortType::Table, "low, high, count of each bin"),
        PortSpec::new("image", PortType::Image, "the counts as bars"),
        PortSpec::new("summary", PortType::Table, "voxels, minimum, maximum, mean, below, above"),
    ],
    params: &[
        GRID,
        BEAM,
        ParamSpec::int("bins", 64).between(1.0, 65536.0).soft(8.0, 256.0).doc("How many bins."),
        ParamSpec::vector("range", &[0.0, 1.0])
            .or_null()
            .doc("First and last end of the bins; null is the least and the largest value that is counted."),
        ParamSpec::bool("background", false)
            .doc("Counts voxels too that hold exactly what stands outside of the voxels."),
        ParamSpec::bool("log", true).doc("Bars are as high as the logarithm of 1 + count."),
        ParamSpec::int("width", 512).unit("px").between(1.0, 8192.0).soft(64.0, 2048.0).doc("Pixels across."),
        ParamSpec::int("height", 256).unit("px").between(1.0, 8192.0).soft(64.0, 2048.0).doc("Pixels down."),
    ],
};

fn run(run: &Run) -> Result<Vec<Value>, NodeError> {
    let scalar = Scalar::read(run)?;
    let counts_all = run.params.bool("background");
    let values = scalar.dense.values.iter().map(|value| f64::from(*value));
    let values: Vec<f64> = values.filter(|value| counts_all || *value != scalar.outside).collect();
    let least = values.iter().copied().fold(f64::INFINITY, f64::min);
    let largest = values.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    // Without a voxel there is no value; the bins of nothing are as good as any.
    let of_data = if values.is_empty() { [0.0, 1.0] } else { [least, largest] };
    let [low, high] = widened(range(run, of_data)?);
    let n_bins = run.params.i64("bins") as usize;
    let mut counts = vec![0_u64; n_bins];
    let (mut below, mut above) = (0_u64, 0_u64);
    for value in &values {
        match () {
            () if *value < low => below += 1,
            () if *value > high => above += 1,
            () => counts[bin(*value, [low, high], n_bins)] += 1,
        }
    }
    run.cancel.check()?;
    let edge = |n: usize| low + (high - low) * n as f64 / counts.len() as f64;
    let rows = counts.iter().enumerate().map(|(n, count)| vec![edge(n), edge(n + 1), *count as f64]);
    let table = Table::new(&["low", "high", "count"], rows.collect());
    let n = values.len() as f64;
    let of_all = match values.is_empty() {
        true => [0.0; 3],
        false => [least, largest, values.iter().sum::<f64>() / n],
    };
    let [minimum, maximum, mean] = of_all;
    let summary = Table::new(
        &["voxels", "minimum", "maximum", "mean", "below", "above"],
        vec![vec![n, minimum, maximum, mean, below as f64, above as f64]],
    );
    let image = bars(
        &counts,
        [run.params.i64("width"), run.params.i64("height")].map(|n| n as usize),
        run.params.bool("log"),
    );
    Ok(vec![
        Value::new(PortType::Table, table.bytes(), table),
        Value::new(PortType::Image, image.bytes(), image),
        Value::new(PortType::Table, summary.bytes(), summary),
    ])
}

/// Bins of a field of one value reach half of it, or half, to both sides.
fn widened([low, high]: [f64; 2]) -> [f64; 2] {
    let half = 0.5 * low.abs().max(1.0);
    if high > low { [low, high] } else { [low - half, low + half] }
}

fn bin(value: f64, [low, high]: [f64; 2], n_bins: usize) -> usize {
    // The upper end belongs to the last bin.
    (((value - low) / (high - low) * n_bins as f64) as usize).min(n_bins - 1)
}

/// Linear light of the bars and of what is behind them: light grey on nearly black.
const BAR: f32 = 0.6;
const PAPER: f32 = 0.01;

fn bars(counts: &[u64], [width, height]: [usize; 2], log: bool) -> Image {
    let tall = |count: u64| if log { (count as f64).ln_1p() } else { count as f64 };
    let tallest = counts.iter().copied().max().map_or(0.0, tall).max(f64::MIN_POSITIVE);
    // A column of pixels shows the largest of the bins that it covers.
    let columns = (0..width).map(|x| {
        let first = x * counts.len() / width;
        let end = ((x + 1) * counts.len()).div_ceil(width).max(first + 1);
        let count = counts[first..end].iter().copied().max().unwrap_or(0);
        (tall(count) / tallest * height as f64).round() as usize
    });
    let columns: Vec<usize> = columns.collect();
    let pixels = (0..height).flat_map(|y| {
        columns.iter().flat_map(move |tall| [if height - y <= *tall { BAR } else { PAPER }; 3])
    });
    Image::new(width, height, pixels.collect())
}

#[cfg(test)]
mod tests;
