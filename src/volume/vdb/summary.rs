//! What `tyndall inspect --json` prints of a file.
//!
//! The field names are a contract with scripts. A refused grid has `refused` instead of figures. Grids are decoded one
//! after the other, so that no two are in memory at once; instances take their parent's figures, so that a file of many
//! instances costs no more than its bytes.
//! Tested in `tests.rs`.

use super::metadata::Metadata;
use super::{Entry, File, GridType};
use crate::volume::stats::{Figures, Sample};
use serde::Serialize;
use std::collections::HashMap;

/// A file in figures.
#[derive(Debug, Clone, Serialize)]
pub struct Summary {
    /// The path as it was given; what is no UTF-8 became U+FFFD.
    pub file: String,
    /// Of the file format.
    pub version: u32,
    /// In the order of the file.
    pub grids: Vec<GridSummary>,
}

/// A grid in figures, or why there are none.
#[derive(Debug, Clone, Serialize)]
pub struct GridSummary {
    /// Unique in the file, and what [`File::read`] takes.
    pub name: String,
    /// Value type in lower case, as [`GridType`] prints it; `half` for a float grid that is only saved so, too.
    #[serde(rename = "type")]
    pub kind: String,
    /// Why there are neither figures nor a background.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub refused: Option<String>,
    /// Its fields stand beside the others in the JSON, without a level of their own.
    #[serde(flatten)]
    pub figures: Option<Figures>,
    /// Lengths of a voxel's edges along index x, y and z, in meters.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub voxel_size: Option<[f64; 3]>,
    /// Row after row, of a matrix that takes column vectors to meters.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub world_from_index: Option<[f64; 16]>,
    /// Value where the tree has no node, in the grid's unit.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub background: Option<Sample>,
    /// In OpenVDB's words, as [`Entry::compression`].
    pub compression: String,
    /// As the file has it and unchecked: extents and counts in it may be wrong.
    pub metadata: Metadata,
}

type Decoded = Result<(Figures, Sample), String>;

impl Summary {
    pub(super) fn of(file: &File) -> Self {
        let mut known: HashMap<&str, Decoded> = HashMap::new();
        let mut grids = Vec::new();
        for entry in &file.grids {
            let decoded = match &entry.refused {
                Some(why) => Err(why.clone()),
                None => known
                    .entry(entry.parent.as_deref().unwrap_or(&entry.name))
                    .or_insert_with(|| file.figures(entry).map_err(|err| err.to_string()))
                    .clone(),
            };
            grids.push(GridSummary::new(entry, decoded));
        }
        Self { file: file.path.display().to_string(), version: file.version, grids }
    }
}

impl GridSummary {
    fn new(entry: &Entry, decoded: Decoded) -> Self {
        let (decoded, refused) = match decoded {
            Ok(decoded) => (Some(decoded), None),
            Err(why) => (None, Some(why)),
        };
        let (figures, background) = decoded.unzip();
        let is_half = entry.half && entry.kind == GridType::Float;
        let matrix = entry.world_from_index;
        Self {
            name: entry.name.clone(),
            kind: if is_half { GridType::Half } else { entry.kind.clone() }.to_string(),
            refused,
            figures,
            voxel_size: matrix.map(|m| [m.x_axis, m.y_axis, m.z_axis].map(|axis| axis.truncate().length())),
            world_from_index: matrix.map(|m| m.transpose().to_cols_array()),
            background,
            compression: entry.compression.clone(),
            metadata: entry.metadata.clone(),
        }
    }
}
