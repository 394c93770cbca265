//! Writes float grids as fog volumes that OpenVDB reads back: file version 224, with active-mask compression.
//!
//! Only what our samples and tests need: compression none or zip, half or whole floats. The layout is that of
//! `tree.rs`; which inactive values are stored is decided as in `MaskCompress` of `openvdb/io/Compression.h`. The file
//! appears whole or not at all: it is written beside its place and renamed. The same grids give the same bytes; the
//! UUID is a hash of the rest.
//! Limits: origins of leaves and tiles must be multiples of their size, as [`Grid`] has them.
//! Tested by round trips in `tests.rs`, and OpenVDB's own library has read the results.

use super::VdbError;
use super::codec::Compression;
use crate::volume::grid::{Grid, Leaf, Tile};
use glam::{DMat4, DVec3, IVec3};
use half::f16;
use std::collections::BTreeMap;
use std::io::Write;
use std::path::Path;

const VERSION: u32 = 224;
/// OpenVDB's that writes this version.
const LIBRARY_VERSION: [u32; 2] = [10, 0];

/// How values are stored.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum WriteCompression {
    /// As they are; inactive ones are left out where at most two values stand for them all.
    #[default]
    None,
    /// Each node's values as a zlib stream of the usual level 6, where that is shorter than the values.
    Zip,
}

/// How to write a file.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct WriteOptions {
    /// Of the values alone; masks are stored as they are.
    pub compression: WriteCompression,
    /// Round values to 16 bits.
    pub half: bool,
}

/// Writes the grids, in order, to a file that replaces what is there.
pub fn write(path: &Path, grids: &[Grid], options: WriteOptions) -> Result<(), VdbError> {
    let folder = path.parent().filter(|folder| !folder.as_os_str().is_empty()).unwrap_or(Path::new("."));
    let save = || {
        let mut builder = tempfile::Builder::new();
        // The usual rights of a new file, less the umask, and not those of a private one.
        #[cfg(unix)]
        builder.permissions(std::os::unix::fs::PermissionsExt::from_mode(0o666));
        let mut file = builder.tempfile_in(folder)?;
        file.write_all(&to_bytes(grids, options))?;
        file.persist(path).map_err(|err| err.error)?;
        Ok(())
    };
    save().map_err(|source| VdbError::Io { path: path.into(), source })
}

/// The bytes of a file with these grids.
pub fn to_bytes(grids: &[Grid], options: WriteOptions) -> Vec<u8> {
    let mut out = Output { bytes: Vec::new(), options };
    out.bytes.extend(b" BDV\0\0\0\0");
    for number in [VERSION, LIBRARY_VERSION[0], LIBRARY_VERSION[1]] {
        out.u32(number);
    }
    // Grids have offsets.
    out.bytes.push(1);
    let uuid_at = out.bytes.len();
    out.bytes.extend([b'0'; 36]);
    out.u32(0);
    out.u32(grids.len() as u32);
    for (name, grid) in unique_names(grids).iter().zip(grids) {
        out.grid(name, grid);
    }
    let uuid = uuid(&out.bytes);
    out.bytes[uuid_at..uuid_at + uuid.len()].copy_from_slice(uuid.as_bytes());
    out.bytes
}

/// Names with a number after a separator where several grids have one, as OpenVDB has them.
fn unique_names(grids: &[Grid]) -> Vec<String> {
    let mut counts: BTreeMap<&str, (usize, usize)> = BTreeMap::new();
    for grid in grids {
        counts.entry(&grid.name).or_default().0 += 1;
    }
    let mut unique_name = |grid: &Grid| {
        let Some((count, next)) = counts.get_mut(&*grid.name) else {
            return grid.name.clone();
        };
        *next += 1;
        if *count > 1 || grid.name.is_empty() {
            format!("{}\u{1e}{}", grid.name, *next - 1)
        } else {
            grid.name.clone()
        }
    };
    grids.iter().map(&mut unique_name).collect()
}

/// Two FNV-1a hashes in the form of a UUID.
fn uuid(bytes: &[u8]) -> String {
    let fnv = |basis: u64| {
        bytes.iter().fold(basis, |hash, &byte| (hash ^ u64::from(byte)).wrapping_mul(0x100_0000_01b3))
    };
    let [a, b] = [fnv(0xcbf2_9ce4_8422_2325), fnv(0x9e37_79b9_7f4a_7c15)];
    format!(
        "{:08x}-{:04x}-{:04x}-{:04x}-{:012x}",
        a >> 32,
        a >> 16 & 0xffff,
        a & 0xffff,
        b >> 48,
        b & 0xffff_ffff_ffff
    )
}

/// A slot of an inner node or of the root.
enum Slot<'a, C> {
    Tile(&'a Tile),
    Child(C),
}

type Lower<'a> = BTreeMap<usize, Slot<'a, &'a Leaf>>;
type Upper<'a> = BTreeMap<usize, Slot<'a, Lower<'a>>>;
type Root<'a> = BTreeMap<[i32; 3], Slot<'a, Upper<'a>>>;

/// Sorts leaves and tiles into the tree that the file has.
fn root(grid: &Grid) -> Root<'_> {
    let mut root = Root::new();
    for tile in grid.tiles.iter().filter(|tile| tile.size == 4096) {
        root.insert(tile.origin.to_array(), Slot::Tile(tile));
    }
    for tile in grid.tiles.iter().filter(|tile| tile.size == 128) {
        if let Some(upper) = upper(&mut root, tile.origin) {
            upper.insert(slot_of(tile.origin, 5, 7), Slot::Tile(tile));
        }
    }
    for tile in grid.tiles.iter().filter(|tile| tile.size == 8) {
        if let Some(lower) = lower(&mut root, tile.origin) {
            lower.insert(slot_of(tile.origin, 4, 3), Slot::Tile(tile));
        }
    }
    for leaf in &grid.leaves {
        if let Some(lower) = lower(&mut root, leaf.origin) {
            lower.insert(slot_of(leaf.origin, 4, 3), Slot::Child(leaf));
        }
    }
    root
}

fn slot_of(at: IVec3, slots_log2: i32, slot_size_log2: i32) -> usize {
    let [x, y, z] = (at >> slot_size_log2 & IVec3::splat((1 << slots_log2) - 1)).to_array();
    ((x << (2 * slots_log2)) + (y << slots_log2) + z) as usize
}

/// The upper node around a voxel, unless a tile covers it.
fn upper<'a, 'r>(root: &'r mut Root<'a>, at: IVec3) -> Option<&'r mut Upper<'a>> {
    let origin = at & IVec3::splat(!4095);
    match root.entry(origin.to_array()).or_insert_with(|| Slot::Child(Upper::new())) {
        Slot::Child(upper) => Some(upper),
        Slot::Tile(_) => None,
    }
}

/// The lower node around a voxel, unless a tile covers it.
fn lower<'a, 'r>(root: &'r mut Root<'a>, at: IVec3) -> Option<&'r mut Lower<'a>> {
    match upper(root, at)?.entry(slot_of(at, 5, 7)).or_insert_with(|| Slot::Child(Lower::new())) {
        Slot::Child(lower) => Some(lower),
        Slot::Tile(_) => None,
    }
}

struct Output {
    bytes: Vec<u8>,
    options: WriteOptions,
}

impl Output {
    fn u32(&mut self, value: u32) {
        self.bytes.extend(value.to_le_bytes());
    }

    fn string(&mut self, text: &str) {
        self.u32(text.len() as u32);
        self.bytes.extend(text.as_bytes());
    }

    fn grid(&mut self, unique_name: &str, grid: &Grid) {
        self.string(unique_name);
        self.string(if self.options.half { "Tree_float_5_4_3_HalfFloat" } else { "Tree_float_5_4_3" });
        // No parent.
        self.string("");
        let offsets_at = self.bytes.len();
        self.bytes.extend([0; 24]);
        let grid_at = self.bytes.len();
        self.u32(
            match self.options.compression {
                WriteCompression::None => Compression::MASK_ONLY,
                WriteCompression::Zip => Compression::ZIP_AND_MASK,
            }
            .bits(),
        );
        self.metadata(&grid.name);
        self.transform(grid.world_from_index);
        // One buffer.
        self.u32(1);
        let root = root(grid);
        let leaves = self.topology(grid.background, &root);
        let buffers_at = self.bytes.len();
        for leaf in leaves {
            self.mask(&leaf.active);
            self.values(grid.background, &leaf.active, |_| false, &leaf.values[..]);
        }
        for (i, at) in [grid_at, buffers_at, self.bytes.len()].into_iter().enumerate() {
            self.bytes[offsets_at + 8 * i..][..8].copy_from_slice(&(at as u64).to_le_bytes());
        }
    }

    fn metadata(&mut self, name: &str) {
        self.u32(3);
        for (key, text) in [("class", "fog volume"), ("name", name)] {
            self.string(key);
            self.string("string");
            self.string(text);
        }
        self.string("is_saved_as_half_float");
        self.string("bool");
        self.u32(1);
        self.bytes.push(u8::from(self.options.half));
    }

    /// A map of uniform scale if it is one, which more programs read than an affine one.
    fn transform(&mut self, matrix: DMat4) {
        let (scale, translation) = (matrix.x_axis.x, matrix.w_axis.truncate());
        if scale > 0.0
            && matrix == DMat4::from_translation(translation) * DMat4::from_scale(DVec3::splat(scale))
        {
            self.string("UniformScaleTranslateMap");
            self.f64s(&translation.to_array());
            // The scale, and over the voxel size, inverse, squared inverse and half inverse.
            for value in [scale, scale, 1.0 / scale, 1.0 / (scale * scale), 0.5 / scale] {
                self.f64s(&[value; 3]);
            }
        } else {
            self.string("AffineMap");
            self.f64s(&matrix.to_cols_array());
        }
    }

    fn f64s(&mut self, values: &[f64]) {
        self.bytes.extend(values.iter().flat_map(|value| value.to_le_bytes()));
    }

    fn mask(&mut self, words: &[u64]) {
        self.bytes.extend(words.iter().flat_map(|word| word.to_le_bytes()));
    }

    /// What the file holds of a value: with `half`, that is less.
    fn rounded(&self, value: f32) -> f32 {
        if self.options.half { f16::from_f32(value).to_f32() } else { value }
    }

    fn f32(&mut self, value: f32) {
        self.bytes.extend(self.rounded(value).to_le_bytes());
    }

    /// Writes root and inner nodes; returns the leaves in their order.
    fn topology<'a>(&mut self, background: f32, root: &Root<'a>) -> Vec<&'a Leaf> {
        let is_child = |slot: &Slot<Upper>| matches!(slot, Slot::Child(_));
        let n_children = root.values().filter(|&slot| is_child(slot)).count();
        self.f32(background);
        self.u32((root.len() - n_children) as u32);
        self.u32(n_children as u32);
        for (origin, slot) in root {
            if let Slot::Tile(tile) = slot {
                self.coord(*origin);
                self.f32(tile.value);
                self.bytes.push(u8::from(tile.active));
            }
        }
        let mut leaves = Vec::new();
        for (origin, slot) in root {
            let Slot::Child(upper) = slot else { continue };
            self.coord(*origin);
            self.table::<_, 512>(background, upper);
            for slot in upper.values() {
                let Slot::Child(lower) = slot else { continue };
                self.table::<_, 64>(background, lower);
                for slot in lower.values() {
                    let Slot::Child(leaf) = slot else { continue };
                    self.mask(&leaf.active);
                    leaves.push(*leaf);
                }
            }
        }
        leaves
    }

    fn coord(&mut self, at: [i32; 3]) {
        self.bytes.extend(at.iter().flat_map(|value| value.to_le_bytes()));
    }

    /// Masks and tiles of an inner node of 64·WORDS slots.
    fn table<C, const WORDS: usize>(&mut self, background: f32, slots: &BTreeMap<usize, Slot<C>>) {
        let mut children = [0; WORDS];
        let mut active = [0; WORDS];
        let mut values = vec![background; 64 * WORDS];
        for (&i, slot) in slots {
            match slot {
                Slot::Child(_) => children[i / 64] |= 1 << (i % 64),
                Slot::Tile(tile) => {
                    active[i / 64] |= u64::from(tile.active) << (i % 64);
                    values[i] = tile.value;
                }
            }
        }
        self.mask(&children);
        self.mask(&active);
        self.values(background, &active, |i| bit(&children, i), &values);
    }

    /// Values of a node under active-mask compression: a code, what is needed to make the inactive ones, the active
    /// ones.
    fn values(&mut self, background: f32, active: &[u64], is_child: impl Fn(usize) -> bool, values: &[f32]) {
        let is_inactive = |i: usize| !bit(active, i) && !is_child(i);
        let inactive =
            Inactive::of(background, (0..values.len()).filter(|&i| is_inactive(i)).map(|i| values[i]));
        self.bytes.push(inactive.code);
        for value in inactive.stored.into_iter().flatten() {
            self.f32(value);
        }
        if let Some(selected) = inactive.selected {
            let mut select = vec![0; active.len()];
            for i in (0..values.len()).filter(|&i| !bit(active, i) && same(values[i], selected)) {
                select[i / 64] |= 1 << (i % 64);
            }
            self.mask(&select);
        }
        let stored = (0..values.len()).filter(|&i| inactive.all || bit(active, i)).map(|i| values[i]);
        let bytes: Vec<u8> = if self.options.half {
            stored.flat_map(|value| f16::from_f32(value).to_le_bytes()).collect()
        } else {
            stored.flat_map(f32::to_le_bytes).collect()
        };
        self.chunk(&bytes);
    }

    fn chunk(&mut self, bytes: &[u8]) {
        let is_absent = self.options.half && bytes.is_empty();
        if self.options.compression == WriteCompression::None || is_absent {
            self.bytes.extend(bytes);
            return;
        }
        let mut encoder = flate2::write::ZlibEncoder::new(Vec::new(), flate2::Compression::default());
        let zipped = encoder.write_all(bytes).and_then(|()| encoder.finish()).expect("writing to memory");
        if zipped.len() < bytes.len() {
            self.bytes.extend((zipped.len() as i64).to_le_bytes());
            self.bytes.extend(zipped);
        } else {
            self.bytes.extend((-(bytes.len() as i64)).to_le_bytes());
            self.bytes.extend(bytes);
        }
    }
}

fn bit(words: &[u64], i: usize) -> bool {
    words[i / 64] >> (i % 64) & 1 != 0
}

/// By bits, unlike OpenVDB, so that −0 and NaN come back as they were.
fn same(a: f32, b: f32) -> bool {
    a.to_bits() == b.to_bits()
}

/// How the inactive values of a node are made from few.
struct Inactive {
    code: u8,
    stored: [Option<f32>; 2],
    /// What the set bits of the selection mask stand for.
    selected: Option<f32>,
    all: bool,
}

impl Inactive {
    fn of(background: f32, values: impl Iterator<Item = f32>) -> Self {
        let mut found: Vec<f32> = Vec::new();
        for value in values {
            if !found.iter().any(|&other| same(other, value)) {
                found.push(value);
            }
            if found.len() > 2 {
                break;
            }
        }
        let is_background = |value: f32| same(value, background);
        let is_minus = |value: f32| same(value, -background);
        let (code, stored, selected) = match found[..] {
            [] => (0, [None; 2], None),
            [a] if is_background(a) => (0, [None; 2], None),
            [a] if is_minus(a) => (1, [None; 2], None),
            [a] => (2, [Some(a), None], None),
            [a, b] if is_background(a) || is_background(b) => {
                let other = if is_background(a) { b } else { a };
                if is_minus(other) {
                    (3, [None; 2], Some(background))
                } else {
                    (4, [Some(other), None], Some(background))
                }
            }
            [a, b] => (5, [Some(a), Some(b)], Some(b)),
            _ => (6, [None; 2], None),
        };
        Self { code, stored, selected, all: code == 6 }
    }
}
