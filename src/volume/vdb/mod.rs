//! OpenVDB files (`.vdb`): what is in one, any of its scalar grids, and a small writer.
//!
//! The reader is total: every input gives data or an error that names byte offset and grid. Nothing is allocated from
//! a count that the file cannot back with bytes, bounding boxes in metadata are never believed, and reading is linear
//! in the bytes. [`File::open`] reads the head of the file and of each grid; [`File::read`] reads and decodes one
//! grid's bytes, its leaves in parallel.
//! Read: file versions 218 to 225; float, half, double, int32, int64, bool, mask (as scalar fields), vec3s, vec3d,
//! vec3i (figures only); compression none, zip, blosc, active mask, half; tiles on all levels; instances; several grids
//! of one name; streams without offsets; all linear transforms. Listed and refused: points, frustum transforms, other
//! trees.
//! Values keep the file's unit; index space has a voxel's value at its integer coordinates; world space is meters.
//! Source of the format: OpenVDB's own C++ (`openvdb/io`, `tree`, `math`), named in each module.
//! Tested against OpenVDB's readings of real files, by fixtures that OpenVDB wrote, by round trips, and by damage: each
//! truncation and each changed byte of a small file.

mod blosc;
mod codec;
mod cursor;
mod file;
mod header;
mod metadata;
mod summary;
#[cfg(test)]
mod tests;
mod transform;
mod tree;
mod value;
mod write;

pub use file::{Entry, File};
pub use metadata::{MetaValue, Metadata};
pub use summary::{GridSummary, Summary};
pub use write::{WriteCompression, WriteOptions, to_bytes, write};

use std::fmt;
use std::path::PathBuf;

/// Why a file or a grid cannot be read or written.
#[derive(Debug, thiserror::Error)]
pub enum VdbError {
    #[error("{}: {source}", path.display())]
    Io { path: PathBuf, source: std::io::Error },
    #[error("{}: {}at byte {offset}: {what}", path.display(), of_grid(grid))]
    Invalid { path: PathBuf, grid: Option<String>, offset: u64, what: String },
    #[error("{}: {}at byte {offset}: not supported: {what}", path.display(), of_grid(grid))]
    Unsupported { path: PathBuf, grid: Option<String>, offset: u64, what: String },
    #[error("{}: grid `{grid}`: {why}", path.display())]
    Refused { path: PathBuf, grid: String, why: String },
    #[error("{}: no grid `{name}`; there {known}", path.display())]
    UnknownGrid { path: PathBuf, name: String, known: String },
}

fn of_grid(grid: &Option<String>) -> String {
    grid.as_ref().map_or_else(String::new, |grid| format!("grid `{grid}` "))
}

/// What a grid holds.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum GridType {
    Float,
    /// 16-bit floats in memory too; a float grid that is only saved so is `Float` with [`Entry::half`].
    Half,
    Double,
    Int32,
    Int64,
    Bool,
    Mask,
    Vec3s,
    Vec3d,
    Vec3i,
    Points,
    /// A tree that is not known, by OpenVDB's name for it.
    Other(String),
}

impl GridType {
    fn from_tree(name: &str) -> Self {
        match name.strip_prefix("Tree_").and_then(|name| name.strip_suffix("_5_4_3")) {
            Some("float") => Self::Float,
            Some("half") => Self::Half,
            Some("double") => Self::Double,
            Some("int32") => Self::Int32,
            Some("int64") => Self::Int64,
            Some("bool") => Self::Bool,
            Some("mask") => Self::Mask,
            Some("vec3s") => Self::Vec3s,
            Some("vec3d") => Self::Vec3d,
            Some("vec3i") => Self::Vec3i,
            Some("ptdataidx32" | "ptdataidx64" | "ptidx32" | "ptidx64") => Self::Points,
            _ => Self::Other(name.to_owned()),
        }
    }

    fn is_vector(&self) -> bool {
        matches!(self, Self::Vec3s | Self::Vec3d | Self::Vec3i)
    }
}

impl fmt::Display for GridType {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        f.write_str(match self {
            Self::Float => "float",
            Self::Half => "half",
            Self::Double => "double",
            Self::Int32 => "int32",
            Self::Int64 => "int64",
            Self::Bool => "bool",
            Self::Mask => "mask",
            Self::Vec3s => "vec3s",
            Self::Vec3d => "vec3d",
            Self::Vec3i => "vec3i",
            Self::Points => "points",
            Self::Other(name) => name,
        })
    }
}
