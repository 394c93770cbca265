//! The head of a file, the descriptors of its grids, and the head of each grid.
//!
//! File: magic, version, library version, a flag for grid offsets, UUID, metadata, grid count. Descriptor: unique name,
//! type, parent's name (of an instance), and three offsets: of the grid, of its buffers, of its end. Grid: compression
//! flags, metadata, transform, and then its tree. Source: `openvdb/io/{Archive,GridDescriptor,File,Stream}.cc`.
//! Offsets are checked to lie in the file in order, so that no byte is read for two grids and the walk ends.
//! Tested in `tests.rs`.

use super::GridType;
use super::codec::{Compression, VERSION_NODE_MASK};
use super::cursor::{Cursor, Fault};
use super::metadata::{self, Metadata};
use super::transform::{self, Transform};

const MAGIC: [u8; 8] = *b" BDV\0\0\0\0";
/// File versions that are read.
pub(super) const VERSIONS: std::ops::RangeInclusive<u32> = 218..=225;
const VERSION_COMPRESSION_FLAG: u32 = 220;
/// Stands between the name and the number of grids of one name.
const SUFFIX_SEPARATOR: char = '\u{1e}';
const HALF_SUFFIX: &str = "_HalfFloat";

pub(super) struct Header {
    pub version: u32,
    pub has_offsets: bool,
    /// Of grids that do not say it themselves.
    pub compression: Compression,
    pub metadata: Metadata,
    pub n_grids: u32,
}

impl Header {
    pub fn parse(cursor: &mut Cursor) -> Result<Self, Fault> {
        let offset = cursor.offset();
        if cursor.array()? != MAGIC {
            return Err(Fault::invalid(offset, "no OpenVDB file: it does not start with ` BDV`"));
        }
        let offset = cursor.offset();
        let version = cursor.u32()?;
        if !VERSIONS.contains(&version) {
            let (first, last) = (VERSIONS.start(), VERSIONS.end());
            return Err(Fault::unsupported(
                offset,
                format!("file version {version}, read are {first} to {last}"),
            ));
        }
        cursor.take(8)?;
        let has_offsets = cursor.u8()? != 0;
        let compression = if (VERSION_COMPRESSION_FLAG..VERSION_NODE_MASK).contains(&version) {
            if cursor.u8()? != 0 { Compression::ZIP_ONLY } else { Compression::NONE }
        } else {
            Compression::ZIP_AND_MASK
        };
        // The UUID in hexadecimal.
        cursor.take(36)?;
        let metadata = metadata::parse(cursor)?;
        let offset = cursor.offset();
        let n_grids = cursor.i32()?;
        let n_grids =
            u32::try_from(n_grids).map_err(|_| Fault::invalid(offset, format!("{n_grids} grids")))?;
        // Three lengths and three offsets for each.
        cursor.check(u64::from(n_grids) * 36)?;
        Ok(Self { version, has_offsets, compression, metadata, n_grids })
    }
}

pub(super) struct Descriptor {
    /// With its number, if several grids have the name.
    pub unique_name: String,
    pub kind: GridType,
    pub half: bool,
    /// Unique name of the grid whose tree this one shares.
    pub parent: Option<String>,
    pub grid_offset: u64,
    pub end_offset: u64,
}

impl Descriptor {
    /// Reads a descriptor; with `file_end` its offsets are in use and are checked.
    pub fn parse(cursor: &mut Cursor, file_end: Option<u64>) -> Result<Self, Fault> {
        let unique_name = cursor.string()?;
        let type_name = cursor.string()?;
        let parent = Some(cursor.string()?).filter(|name| !name.is_empty());
        let offset = cursor.offset();
        let [grid, _buffers, end] = [cursor.i64()?, cursor.i64()?, cursor.i64()?];
        let here = cursor.offset();
        let [grid_offset, end_offset] = [grid, end].map(|at| u64::try_from(at).unwrap_or(0));
        if let Some(file_end) = file_end
            && (grid_offset < here || end_offset < grid_offset || end_offset > file_end)
        {
            let name = listed_name(&unique_name);
            let what = if end_offset > file_end {
                format!(
                    "grid `{name}` reaches to byte {end}, but the file ends at {file_end}: it is cut short, copy it again"
                )
            } else {
                format!(
                    "grid `{name}` claims the bytes {grid} to {end}, where {here} to {file_end} is possible: the file is damaged, copy it again"
                )
            };
            return Err(Fault::invalid(offset, what));
        }
        let (tree, half) =
            type_name.strip_suffix(HALF_SUFFIX).map_or((&*type_name, false), |tree| (tree, true));
        Ok(Self { unique_name, kind: GridType::from_tree(tree), half, parent, grid_offset, end_offset })
    }
}

/// `name[1]` for the second grid of a name, as OpenVDB lists it.
pub(super) fn listed_name(unique_name: &str) -> String {
    match unique_name.split_once(SUFFIX_SEPARATOR) {
        Some((name, number)) => format!("{name}[{number}]"),
        None => unique_name.to_owned(),
    }
}

/// The name without its number.
pub(super) fn base_name(unique_name: &str) -> &str {
    unique_name.split_once(SUFFIX_SEPARATOR).map_or(unique_name, |(name, _)| name)
}

/// What stands before a grid's tree.
pub(super) struct GridHead {
    pub compression: Compression,
    pub metadata: Metadata,
    pub transform: Transform,
}

impl GridHead {
    pub fn parse(cursor: &mut Cursor, header: &Header) -> Result<Self, Fault> {
        let compression = if header.version >= VERSION_NODE_MASK {
            Compression::parse(cursor)?
        } else {
            header.compression
        };
        let metadata = metadata::parse(cursor)?;
        let transform = transform::parse(cursor, header.version)?;
        Ok(Self { compression, metadata, transform })
    }
}
