//! A graph for a volume: the one that a dropped file is lit by, and any preset made to fit another file.
//!
//! What follows from the volume:
//! - **density**: the grid `density`, else the first of floating point that has something in it;
//! - **density_scale**: such that the way through the middle along the shortest edge of the box, through the mean
//!   density of its active voxels, has an optical depth of [`TAU`]: scale = tau / (mean · edge). A cloud of that depth
//!   is white and still lets its shape be seen; a real one of more is a turn of one parameter away;
//! - **camera**: at the middle of the box, from the front and a little above, so far that the sphere around the box
//!   fills [`FILL`] of the lesser half angle of view: distance = radius / sin(half angle · fill).
//!
//! All of them are ordinary parameters afterwards. [`fit`] is a pure function of document and figures; [`measure`]
//! reads the file. Tested by closed forms and on a file of known values.

use std::path::{Path, PathBuf};

use glam::{DMat4, DVec3, IVec3};
use serde_json::json;

use crate::graph::Document;
use crate::nodes::catalog;
use crate::volume::sequence::{Playback, Sequence};
use crate::volume::stats::{Figures, Sample};
use crate::volume::vdb::{File, GridType};

/// Optical depth along the shortest way through the middle.
pub const TAU: f64 = 8.0;
/// Share of the half angle of view that the box's sphere takes.
pub const FILL: f64 = 0.92;

/// The graph that a dropped volume is lit by: a low sun, a constant blue sky, all that scatters.
const LIT: &str = r#"{
  "tyndall": 1,
  "about": "A volume under a low sun",
  "nodes": {
    "volume": { "type": "load_vdb", "path": "" },
    "medium": { "type": "medium", "albedo": [0.99, 0.99, 0.99], "g": 0.6, "max_cells": 2100000 },
    "sun": { "type": "sun", "direction": [-0.75, -0.5, -0.35], "irradiance": [9.6, 8.6, 7.0], "angular_diameter_deg": 0.53 },
    "sky": { "type": "environment", "radiance": [0.28, 0.42, 0.66] },
    "split": { "type": "light_decomposition" },
    "beams": { "type": "principal_propagation" },
    "residual": { "type": "isotropic_residual" },
    "camera": { "type": "camera", "fov_y_deg": 35, "width": 960, "height": 540 },
    "march": { "type": "raymarch" },
    "tone": { "type": "tone_map", "curve": "aces" }
  },
  "wires": [
    "volume.volume -> medium.volume",
    "sun.light -> split.lights",
    "sky.environment -> split.environment",
    "medium.medium -> beams.medium",
    "split.ordinates -> beams.ordinates",
    "medium.medium -> residual.medium",
    "beams.beams -> residual.beams",
    "medium.medium -> march.medium",
    "beams.beams -> march.beams",
    "residual.residual -> march.residual",
    "camera.camera -> march.camera",
    "sky.environment -> march.environment",
    "march.image -> tone.image"
  ],
  "layout": {
    "volume": [0, 0], "medium": [240, 0], "sun": [0, 160], "sky": [0, 320], "split": [240, 220], "beams": [480, 120],
    "residual": [720, 60], "camera": [720, 320], "march": [960, 160], "tone": [1200, 160]
  }
}"#;

/// What a graph has to know of a volume.
#[derive(Debug, Clone, PartialEq)]
pub struct VolumeFigures {
    /// What load_vdb's `path` becomes: a file, or a pattern with ####.
    pub path: PathBuf,
    /// The grid of densities.
    pub grid: String,
    /// Mean of its active voxels.
    pub mean: f64,
    /// Lowest and highest corner of the active box, in meters.
    pub bounds: [DVec3; 2],
}

/// Why a volume has no graph.
#[derive(Debug, thiserror::Error)]
pub enum TemplateError {
    /// No file, or no sequence.
    #[error(transparent)]
    Sequence(#[from] crate::volume::sequence::SequenceError),
    /// The file cannot be read.
    #[error(transparent)]
    File(#[from] crate::volume::vdb::VdbError),
    /// Nothing in it can be a density.
    #[error("{0}: no grid of numbers with anything above 0 in it; `tyndall inspect` lists what there is")]
    NoDensity(PathBuf),
    /// The preset reads no volume.
    #[error("the preset has no load_vdb whose file could be another")]
    NoLoader,
}

/// Where presets are: in `graphs` of a folder above the program, else where it was built; `None` where they did not
/// come along.
pub fn presets() -> Option<PathBuf> {
    let program = std::env::current_exe().ok();
    let above = program.iter().flat_map(|program| program.ancestors().skip(1).map(Path::to_owned));
    let mut places =
        above.chain([PathBuf::from(env!("CARGO_MANIFEST_DIR"))]).map(|place| place.join("graphs"));
    places.find(|graphs| graphs.join("cumulus.json").is_file())
}

/// The figures of a file, of a folder's or pattern's first frame, or of the numbered sequence that a file is part of
/// (where `as_sequence`).
///
/// # Errors
/// [`TemplateError`] says what was found.
pub fn measure(path: &Path, as_sequence: bool) -> Result<VolumeFigures, TemplateError> {
    let path = std::path::absolute(path).unwrap_or_else(|_| path.to_owned());
    let pattern = if as_sequence { pattern_of(&path) } else { None };
    let sequence = Sequence::find(pattern.as_ref().unwrap_or(&path))?;
    // What is looked at is the frame that was named, or the first.
    let first = if path.is_file() { path.clone() } else { sequence.file(None, Playback::default())? };
    let file = File::open(&first)?;
    let is_number = |kind: &GridType| matches!(kind, GridType::Float | GridType::Half | GridType::Double);
    let mut names: Vec<&str> =
        file.grids.iter().filter(|grid| is_number(&grid.kind)).map(|grid| grid.name.as_str()).collect();
    names.sort_by_key(|name| *name != "density");
    for name in names {
        let Ok(grid) = file.read(name) else { continue };
        let figures = Figures::of(&grid);
        let (Some(Sample::Scalar(mean)), Some(min), Some(max)) =
            (figures.mean, figures.bbox_min, figures.bbox_max)
        else {
            continue;
        };
        if mean.is_finite() && mean > 0.0 {
            let bounds = bounds(IVec3::from_array(min), IVec3::from_array(max), grid.world_from_index);
            let path = match &sequence {
                Sequence::Numbered { pattern, .. } => pattern.clone(),
                Sequence::Single(path) => path.clone(),
            };
            return Ok(VolumeFigures { path, grid: name.to_owned(), mean, bounds });
        }
    }
    Err(TemplateError::NoDensity(first))
}

/// The pattern of the sequence that a numbered file is part of, if there are others.
fn pattern_of(path: &Path) -> Option<PathBuf> {
    let stem = path.file_stem()?.to_str()?;
    let before = stem.trim_end_matches(|c: char| c.is_ascii_digit());
    if before.len() == stem.len() || !path.is_file() {
        return None;
    }
    let ending = path.extension()?.to_str()?;
    let pattern = path.with_file_name(format!("{before}####.{ending}"));
    match Sequence::find(&pattern) {
        Ok(Sequence::Numbered { files, .. }) if files.len() > 1 => Some(pattern),
        _ => None,
    }
}

/// The world's box around the voxels from `min` to `max`, whose values reach half a voxel beyond.
fn bounds(min: IVec3, max: IVec3, world_from_index: DMat4) -> [DVec3; 2] {
    let (low, high) = (min.as_dvec3() - 0.5, max.as_dvec3() + 0.5);
    let corner = |n: usize| {
        let pick = |axis: usize| if n >> axis & 1 == 0 { low[axis] } else { high[axis] };
        world_from_index.transform_point3(DVec3::new(pick(0), pick(1), pick(2)))
    };
    let mut corners = (0..8).map(corner);
    let first = corners.next().unwrap_or_default();
    corners.fold([first; 2], |[low, high], corner| [low.min(corner), high.max(corner)])
}

/// The graph that lights a volume.
pub fn new_graph(volume: &VolumeFigures) -> Document {
    let lit = Document::parse(LIT, Path::new("")).expect("our own graph");
    fit(lit, volume).expect("it has a load_vdb")
}

/// A preset for another volume: its first load_vdb reads it, the media below take its grid and scale, and every
/// camera looks at it.
///
/// # Errors
/// [`TemplateError::NoLoader`].
pub fn fit(mut document: Document, volume: &VolumeFigures) -> Result<Document, TemplateError> {
    let [low, high] = volume.bounds;
    let shortest = (high - low).min_element();
    let density_scale = three_digits(TAU / (volume.mean * shortest));
    let loader =
        document.nodes.iter().find(|(_, node)| node.type_id == "load_vdb").map(|(name, _)| name.clone());
    let loader = loader.ok_or(TemplateError::NoLoader)?;
    let media: Vec<String> = document
        .wires
        .iter()
        .filter(|wire| wire.from.node == loader)
        .map(|wire| wire.to.node.clone())
        .collect();
    for (name, node) in &mut document.nodes {
        let params = &mut node.params;
        if *name == loader {
            params.insert("path".to_owned(), volume.path.to_string_lossy().into());
            params.shift_remove("transform");
        }
        match node.type_id.as_str() {
            "medium" if media.contains(name) => {
                params.insert("density".to_owned(), volume.grid.clone().into());
                params.insert("density_scale".to_owned(), json!(density_scale));
            }
            "camera" => {
                let number =
                    |name: &str, default: f64| params.get(name).and_then(|v| v.as_f64()).unwrap_or(default);
                let aspect = number("width", 512.0) / number("height", 512.0);
                let (position, target) = view(volume.bounds, number("fov_y_deg", 40.0), aspect);
                for (name, place) in [("position", position), ("look_at", target)] {
                    params.insert(name.to_owned(), json!(place.to_array().map(three_digits_of(shortest))));
                }
            }
            _ => {}
        }
    }
    Ok(document)
}

/// The graph with absolute paths, so that it can be written anywhere.
pub fn absolute(mut document: Document) -> Document {
    if let Ok(base) = std::path::absolute(&document.base) {
        document.base = base;
    }
    document.rebase(catalog(), Path::new(""));
    document
}

/// From where the box's sphere fills the picture, and the point to look at.
fn view([low, high]: [DVec3; 2], fov_y_deg: f64, aspect: f64) -> (DVec3, DVec3) {
    let half_y = 0.5 * fov_y_deg.to_radians();
    let half = half_y.min((half_y.tan() * aspect).atan());
    let distance = 0.5 * low.distance(high) / (half * FILL).sin();
    let target = 0.5 * (low + high);
    (target + DVec3::new(0.25, 0.18, 1.0).normalize() * distance, target)
}

/// A number that can be read; the rest of its digits would say nothing.
fn three_digits(x: f64) -> f64 {
    format!("{x:.2e}").parse().unwrap_or(x)
}

/// Places in meters, to a thousandth of the box.
fn three_digits_of(extent: f64) -> impl Fn(f64) -> f64 + Copy {
    let step = 10_f64.powf((extent * 1e-3).log10().floor());
    // By way of text, so that 0.30000000000000004 does not stand in a file.
    move |x| format!("{:.12e}", (x / step).round() * step).parse().unwrap_or(x)
}

#[cfg(test)]
mod tests;
