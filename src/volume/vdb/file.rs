//! An open file: its grids, found without being decoded, and the reading of one.
//!
//! [`File::open`] reads windows of the file that grow only while what is in them is cut off, so that a long file costs
//! as little to list as a short one; the bytes of a grid are read when it is asked for. Lookup by name follows
//! `openvdb/io/File.cc` (`findDescriptor`): the listed name first, then the first grid of that name without a number.
//! Limits: a stream without offsets is walked as a whole, and its grids behind one that is not understood are not found.
//! Tested in `tests.rs`.

use super::codec::Format;
use super::cursor::{Cursor, Fault, FaultKind};
use super::header::{self, Descriptor, GridHead, Header};
use super::metadata::Metadata;
use super::summary::Summary;
use super::transform::Transform;
use super::tree::Plan;
use super::value::{MaskValue, Value};
use super::{GridType, VdbError};
use crate::volume::grid::Grid;
use crate::volume::stats::{Figures, Sample};
use glam::DMat4;
use half::f16;
use std::borrow::Cow;
use std::collections::{HashMap, HashSet};
use std::io::{Read, Seek, SeekFrom};
use std::path::{Path, PathBuf};

/// Calls a function for the value type of a tree; the last arm is for trees that are not read.
macro_rules! for_type {
    ($kind:expr, $function:ident($($argument:expr),*), $other:expr) => {
        match $kind {
            GridType::Float => $function::<f32>($($argument),*),
            GridType::Half => $function::<f16>($($argument),*),
            GridType::Double => $function::<f64>($($argument),*),
            GridType::Int32 => $function::<i32>($($argument),*),
            GridType::Int64 => $function::<i64>($($argument),*),
            GridType::Bool => $function::<bool>($($argument),*),
            GridType::Mask => $function::<MaskValue>($($argument),*),
            GridType::Vec3s => $function::<[f32; 3]>($($argument),*),
            GridType::Vec3d => $function::<[f64; 3]>($($argument),*),
            GridType::Vec3i => $function::<[i32; 3]>($($argument),*),
            GridType::Points | GridType::Other(_) => $other,
        }
    };
}

/// An open file: what it says of itself and of its grids.
#[derive(Debug)]
pub struct File {
    /// Where it was opened, or its name in messages if it is in memory.
    pub path: PathBuf,
    /// Of the file format, 218 to 225.
    pub version: u32,
    /// The file's own, apart from that of its grids.
    pub metadata: Metadata,
    /// In the order of the file, those that are refused too.
    pub grids: Vec<Entry>,
    source: Source,
}

/// A grid as the file lists it.
#[derive(Debug, Clone)]
pub struct Entry {
    /// Unique in the file: `density`, or `density[1]` for the second of several.
    pub name: String,
    /// Value type of the tree in memory; what it is saved as also depends on `half`.
    pub kind: GridType,
    /// Saved with 16 bits a component.
    pub half: bool,
    /// In OpenVDB's words, like `blosc + active values`; empty if the grid's head is damaged.
    pub compression: String,
    /// The grid's own, like its class and creator; empty if its head is damaged.
    pub metadata: Metadata,
    /// Takes voxel centers to meters; `None` only if refused.
    pub world_from_index: Option<DMat4>,
    /// Name of the grid whose tree this one shares.
    pub parent: Option<String>,
    /// Why the grid cannot be read.
    pub refused: Option<String>,
    /// Name without a number.
    base_name: String,
    unique_name: String,
    /// Where its tree is; `None` for an instance and for what is refused.
    tree: Option<TreeBytes>,
}

#[derive(Debug, Clone, Copy)]
struct TreeBytes {
    start: u64,
    end: u64,
    format: Format,
}

#[derive(Debug)]
enum Source {
    Disk { n_bytes: u64 },
    Memory(Vec<u8>),
}

impl File {
    /// Opens a file; reads its head, the list of its grids and the head of each, and no voxels (unless it is a stream
    /// without offsets, which has to be walked).
    pub fn open(path: &Path) -> Result<Self, VdbError> {
        let n_bytes =
            std::fs::metadata(path).map_err(|source| VdbError::Io { path: path.into(), source })?.len();
        Self::from_source(path.into(), Source::Disk { n_bytes })
    }

    /// The same for a file in memory; `path` is its name in messages.
    pub fn from_bytes(path: impl Into<PathBuf>, bytes: Vec<u8>) -> Result<Self, VdbError> {
        Self::from_source(path.into(), Source::Memory(bytes))
    }

    fn from_source(path: PathBuf, source: Source) -> Result<Self, VdbError> {
        let mut file = Self { path, version: 0, metadata: Metadata::new(), grids: Vec::new(), source };
        let end = file.n_bytes();
        let (header, at) = file.parse_at(0, end, None, Header::parse)?;
        file.version = header.version;
        if header.has_offsets {
            file.list(&header, at)?;
        } else {
            file.walk_stream(&header, at)?;
        }
        file.metadata = header.metadata;
        file.finish();
        Ok(file)
    }

    /// Reads a scalar grid; of several of one name, `name` alone is the first.
    ///
    /// # Errors
    /// If the name is unknown (the message lists what there is), if the grid is refused or holds vectors, or if its
    /// bytes are damaged.
    pub fn read(&self, name: &str) -> Result<Grid, VdbError> {
        let entry = self.find(name)?;
        let refuse =
            |why: String| VdbError::Refused { path: self.path.clone(), grid: entry.name.clone(), why };
        if let Some(why) = &entry.refused {
            return Err(refuse(why.clone()));
        }
        if entry.kind.is_vector() {
            return Err(refuse(format!("it holds vectors ({}); a scalar grid is needed", entry.kind)));
        }
        let (Some(world_from_index), Some(tree)) = (entry.world_from_index, self.tree_of(entry)) else {
            return Err(refuse("it has no tree".into()));
        };
        let bytes = self.section(tree.start, tree.end)?;
        let mut cursor = Cursor::new(&bytes, tree.start);
        let mut grid = for_type!(entry.kind, scalar_grid(&mut cursor, tree.format), unreadable(&cursor))
            .map_err(|fault| self.error(fault, Some(&entry.name)))?;
        grid.name = entry.name.clone();
        grid.world_from_index = world_from_index;
        Ok(grid)
    }

    /// What `tyndall inspect` prints; grids whose bytes are damaged are refused in it.
    pub fn summary(&self) -> Summary {
        Summary::of(self)
    }

    /// Figures and background of a grid of any type that is read.
    pub(super) fn figures(&self, entry: &Entry) -> Result<(Figures, Sample), VdbError> {
        let Some(tree) = self.tree_of(entry) else {
            return Err(VdbError::Refused {
                path: self.path.clone(),
                grid: entry.name.clone(),
                why: "it has no tree".into(),
            });
        };
        let bytes = self.section(tree.start, tree.end)?;
        let mut cursor = Cursor::new(&bytes, tree.start);
        for_type!(entry.kind, tree_figures(&mut cursor, tree.format), unreadable(&cursor))
            .map_err(|fault| self.error(fault, Some(&entry.name)))
    }

    pub(super) fn find(&self, name: &str) -> Result<&Entry, VdbError> {
        let by_name = self.grids.iter().find(|entry| entry.name == name);
        by_name.or_else(|| self.grids.iter().find(|entry| entry.base_name == name)).ok_or_else(|| {
            let names: Vec<_> = self.grids.iter().map(|entry| format!("`{}`", entry.name)).collect();
            let known =
                if names.is_empty() { "are none".into() } else { format!("are {}", names.join(", ")) };
            VdbError::UnknownGrid { path: self.path.clone(), name: name.into(), known }
        })
    }

    /// Where the entry's tree or that of its parent is.
    fn tree_of(&self, entry: &Entry) -> Option<TreeBytes> {
        let Some(parent) = &entry.parent else {
            return entry.tree;
        };
        self.grids.iter().find(|other| other.name == *parent)?.tree
    }

    fn n_bytes(&self) -> u64 {
        match &self.source {
            Source::Disk { n_bytes } => *n_bytes,
            Source::Memory(bytes) => bytes.len() as u64,
        }
    }

    /// Bytes `start..end`, which lie in the file.
    fn section(&self, start: u64, end: u64) -> Result<Cow<'_, [u8]>, VdbError> {
        if let Source::Memory(bytes) = &self.source {
            return Ok(Cow::Borrowed(&bytes[start as usize..end as usize]));
        }
        let read = || {
            let mut file = std::fs::File::open(&self.path)?;
            file.seek(SeekFrom::Start(start))?;
            let mut bytes = vec![0; (end - start) as usize];
            file.read_exact(&mut bytes)?;
            Ok(bytes)
        };
        read().map(Cow::Owned).map_err(|source| VdbError::Io { path: self.path.clone(), source })
    }

    /// Parses a thing of unknown length between `start` and `end`; returns it and where it ends.
    ///
    /// Reads as little as is needed: a window that grows while the thing does not fit into it.
    fn parse_at<T>(
        &self,
        start: u64,
        end: u64,
        grid: Option<&str>,
        parse: impl Fn(&mut Cursor) -> Result<T, Fault>,
    ) -> Result<(T, u64), VdbError> {
        let mut window = 4096;
        loop {
            let window_end = end.min(start.saturating_add(window));
            let bytes = self.section(start, window_end)?;
            let mut cursor = Cursor::new(&bytes, start);
            match parse(&mut cursor) {
                Ok(thing) => return Ok((thing, cursor.offset())),
                Err(fault) if fault.kind == FaultKind::Short && window_end < end => window *= 8,
                Err(fault) => return Err(self.error(fault, grid)),
            }
        }
    }

    fn list(&mut self, header: &Header, mut at: u64) -> Result<(), VdbError> {
        let end = self.n_bytes();
        for _ in 0..header.n_grids {
            let (descriptor, _) =
                self.parse_at(at, end, None, |cursor| Descriptor::parse(cursor, Some(end)))?;
            at = descriptor.end_offset;
            let head =
                self.parse_at(descriptor.grid_offset, at, None, |cursor| GridHead::parse(cursor, header));
            self.grids.push(match head {
                Ok((head, start)) => Entry::new(descriptor, head, header, start, at),
                Err(err @ VdbError::Io { .. }) => return Err(err),
                Err(err) => Entry::damaged(descriptor, &err),
            });
        }
        Ok(())
    }

    /// Lists the grids of a stream without offsets, where each tree has to be walked to find the next grid.
    fn walk_stream(&mut self, header: &Header, at: u64) -> Result<(), VdbError> {
        let bytes = self.section(at, self.n_bytes())?;
        let mut cursor = Cursor::new(&bytes, at);
        let mut entries = Vec::new();
        for _ in 0..header.n_grids {
            let descriptor = Descriptor::parse(&mut cursor, None).map_err(|fault| self.error(fault, None))?;
            let name = header::listed_name(&descriptor.unique_name);
            let head =
                GridHead::parse(&mut cursor, header).map_err(|fault| self.error(fault, Some(&name)))?;
            let start = cursor.offset();
            let mut entry = Entry::new(descriptor, head, header, start, start);
            if let Some(tree) = &mut entry.tree {
                for_type!(entry.kind, skip_tree(&mut cursor, tree.format), unreadable(&cursor))
                    .map_err(|fault| self.error(fault, Some(&name)))?;
                tree.end = cursor.offset();
            }
            let is_lost = entry.tree.is_none() && entry.parent.is_none();
            entries.push(entry);
            if is_lost {
                // Without offsets there is no way past a tree that is not understood.
                break;
            }
        }
        drop(bytes);
        self.grids = entries;
        Ok(())
    }

    /// Makes names unique and connects instances with their parents.
    fn finish(&mut self) {
        let mut taken = HashSet::new();
        let mut last_number: HashMap<String, usize> = HashMap::new();
        let mut by_unique_name: HashMap<String, usize> = HashMap::new();
        for (i, entry) in self.grids.iter_mut().enumerate() {
            let listed = entry.name.clone();
            while !taken.insert(entry.name.clone()) {
                let number = last_number.entry(listed.clone()).or_default();
                *number += 1;
                entry.name = format!("{listed}[{number}]");
            }
            by_unique_name.entry(entry.unique_name.clone()).or_insert(i);
        }
        for i in 0..self.grids.len() {
            let Some(parent) = self.grids[i].parent.take() else {
                continue;
            };
            let found = by_unique_name.get(&parent).map(|&at| &self.grids[at]);
            let name = header::listed_name(&parent);
            let refused = match found {
                None => Some(format!("instance of grid `{name}`, which is not in the file")),
                Some(found) if found.tree.is_none() => {
                    Some(format!("instance of grid `{name}`, which has no tree"))
                }
                Some(found) if found.kind != self.grids[i].kind => {
                    Some(format!("{} instance of grid `{name}`, which is {}", self.grids[i].kind, found.kind))
                }
                Some(_) => None,
            };
            let listed = found.map(|found| found.name.clone());
            let entry = &mut self.grids[i];
            entry.parent = listed.or(Some(name));
            entry.refused = entry.refused.take().or(refused);
        }
    }

    fn error(&self, fault: Fault, grid: Option<&str>) -> VdbError {
        let (path, grid, offset, what) =
            (self.path.clone(), grid.map(str::to_owned), fault.offset, fault.what);
        match fault.kind {
            FaultKind::Unsupported => VdbError::Unsupported { path, grid, offset, what },
            FaultKind::Invalid => VdbError::Invalid { path, grid, offset, what },
            FaultKind::Short => {
                VdbError::Invalid { path, grid, offset, what: format!("the file is cut off: {what}") }
            }
        }
    }
}

impl Entry {
    fn new(descriptor: Descriptor, head: GridHead, header: &Header, start: u64, end: u64) -> Self {
        let Descriptor { unique_name, kind, half, parent, .. } = descriptor;
        let (world_from_index, refused) = match head.transform {
            Transform::Linear(matrix) => (Some(matrix), None),
            Transform::Refused(why) => (None, Some(why)),
        };
        let format = Format { version: header.version, compression: head.compression, half };
        let tree = TreeBytes { start, end, format };
        let is_known = !matches!(kind, GridType::Points | GridType::Other(_));
        let refused = match &kind {
            GridType::Points => Some("a grid of points, which has no field".into()),
            GridType::Other(name) => Some(format!("a tree of type `{name}`, which is not known")),
            _ => refused,
        };
        Self {
            name: header::listed_name(&unique_name),
            base_name: header::base_name(&unique_name).to_owned(),
            unique_name,
            tree: (is_known && parent.is_none()).then_some(tree),
            kind,
            half,
            compression: head.compression.words(),
            metadata: head.metadata,
            world_from_index,
            parent,
            refused,
        }
    }

    /// A grid whose head is damaged.
    fn damaged(descriptor: Descriptor, err: &VdbError) -> Self {
        Self {
            name: header::listed_name(&descriptor.unique_name),
            base_name: header::base_name(&descriptor.unique_name).to_owned(),
            unique_name: descriptor.unique_name,
            kind: descriptor.kind,
            half: descriptor.half,
            compression: String::new(),
            metadata: Metadata::new(),
            world_from_index: None,
            parent: descriptor.parent,
            refused: Some(err.to_string()),
            tree: None,
        }
    }
}

fn scalar_grid<V: Value>(cursor: &mut Cursor, format: Format) -> Result<Grid, Fault> {
    let tree = Plan::<V>::parse(cursor, format)?.decode(V::to_f32)?;
    Ok(Grid {
        name: String::new(),
        background: tree.background.to_f32(),
        world_from_index: DMat4::IDENTITY,
        leaves: tree.leaves,
        tiles: tree.tiles,
    })
}

fn tree_figures<V: Value>(cursor: &mut Cursor, format: Format) -> Result<(Figures, Sample), Fault> {
    let tree = Plan::<V>::parse(cursor, format)?.decode(|value| value)?;
    Ok((Figures::of_tree(&tree.leaves, &tree.tiles), Sample::of(tree.background)))
}

fn skip_tree<V: Value>(cursor: &mut Cursor, format: Format) -> Result<(), Fault> {
    Plan::<V>::parse(cursor, format).map(|_| ())
}

/// Stands for the types that have no reader; such grids are refused before.
fn unreadable<T>(cursor: &Cursor) -> Result<T, Fault> {
    Err(Fault::unsupported(cursor.offset(), "a tree of this type"))
}
