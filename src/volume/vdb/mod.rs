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

/// How the names of files end.
pub const ENDINGS: &[&str] = &["vdb"];

/// Why a file or a grid cannot be read or written.
#[derive(Debug, thiserror::Error)]
pub enum VdbError {
    #[error("{}: {source}", path.display())]
    /// The system refused to open, read, write or replace the file.
    Io {
        /// The file.
        path: PathBuf,
        /// The system's reason.
        source: std::io::Error,
    },
    #[error("{}: {}at byte {offset}: {what}", path.display(), of_grid(grid))]
    /// Bytes that no OpenVDB file has: it is damaged, cut off, or another kind of file.
    Invalid {
        /// The file, or what [`File::from_bytes`] was told to call it.
        path: PathBuf,
        /// Its listed name; `None` while only the file's head and list of grids are read.
        grid: Option<String>,
        /// Byte in the file where what is at fault starts.
        offset: u64,
        /// What was found, and what is allowed.
        what: String,
    },
    #[error("{}: {}at byte {offset}: not supported: {what}", path.display(), of_grid(grid))]
    /// Well formed as far as it was read, but of a version, compression or map that has no reader here.
    Unsupported {
        /// The file, or what [`File::from_bytes`] was told to call it.
        path: PathBuf,
        /// Its listed name; `None` while only the file's head and list of grids are read.
        grid: Option<String>,
        /// Byte in the file where what is at fault starts.
        offset: u64,
        /// What was found, and what is read.
        what: String,
    },
    #[error("{}: grid `{grid}`: {why}", path.display())]
    /// A grid that is listed and that [`File::read`] gives no field for.
    Refused {
        /// The file, or what [`File::from_bytes`] was told to call it.
        path: PathBuf,
        /// Its listed name.
        grid: String,
        /// What stands in the way: its kind of tree or transform, vectors, a damaged head, a missing parent.
        why: String,
    },
    #[error("{}: no grid `{name}`; there {known}", path.display())]
    /// A name that no grid of the file has, with or without a number.
    UnknownGrid {
        /// The file, or what [`File::from_bytes`] was told to call it.
        path: PathBuf,
        /// The name asked for.
        name: String,
        /// The listed names as a part of the sentence: `are none`, or `are` and each in backquotes.
        known: String,
    },
}

fn of_grid(grid: &Option<String>) -> String {
    grid.as_ref().map_or_else(String::new, |grid| format!("grid `{grid}` "))
}

/// What a grid holds.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum GridType {
    /// One f32 a voxel.
    Float,
    /// 16-bit floats in memory too; a float grid that is only saved so is `Float` with [`Entry::half`].
    Half,
    /// One f64 a voxel; a field of it is rounded to f32.
    Double,
    /// One i32 a voxel; beyond 2^24 a field of it is rounded.
    Int32,
    /// One i64 a voxel; beyond 2^24 a field of it is rounded.
    Int64,
    /// A bit a voxel beside the active mask; a field of it is 0 or 1.
    Bool,
    /// Nothing but the active mask; a field of it is 1 where active, 0 elsewhere.
    Mask,
    /// Three f32 a voxel; figures only.
    Vec3s,
    /// Three f64 a voxel; figures only.
    Vec3d,
    /// Three i32 a voxel; figures only.
    Vec3i,
    /// Particles, or their indices, sorted into voxels; always refused.
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
