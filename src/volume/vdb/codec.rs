//! Packed values: how OpenVDB stores the values of a leaf or of an inner node's table.
//!
//! From version 222 on a code of one byte says which values are stored at all ("active-mask compression": the inactive
//! ones are often all ±background); then come at most two inactive values, a mask that selects between them, and the
//! stored values, as they are, or as a zlib stream or a blosc chunk with its length before it. In a grid "saved as
//! half" the stored values, and only they, are 16 bits a component. Source: `openvdb/io/Compression.{h,cc}`.
//! Parsing ([`Packed::parse`]) is apart from decoding ([`Packed::unpack`]), so that leaves are found one after the
//! other and decoded in parallel. Tested through `tree.rs`; all seven codes in `tests.rs`.

use super::blosc;
use super::cursor::{Cursor, Fault};
use super::value::Value;
use std::borrow::Cow;

/// A grid's compression flags.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Compression(u32);

impl Compression {
    const ZIP: u32 = 1;
    const ACTIVE_MASK: u32 = 2;
    const BLOSC: u32 = 4;

    pub const NONE: Self = Self(0);
    pub const ZIP_ONLY: Self = Self(Self::ZIP);
    pub const ZIP_AND_MASK: Self = Self(Self::ZIP | Self::ACTIVE_MASK);
    pub const MASK_ONLY: Self = Self(Self::ACTIVE_MASK);

    pub fn parse(cursor: &mut Cursor) -> Result<Self, Fault> {
        let offset = cursor.offset();
        let flags = cursor.u32()?;
        if flags > 7 {
            return Err(Fault::unsupported(
                offset,
                format!("compression flags {flags:#x}, known are 1 zip, 2 mask, 4 blosc"),
            ));
        }
        Ok(Self(flags))
    }

    pub fn bits(self) -> u32 {
        self.0
    }

    pub fn has_mask(self) -> bool {
        self.0 & Self::ACTIVE_MASK != 0
    }

    pub fn has_zip(self) -> bool {
        self.0 & Self::ZIP != 0
    }

    /// In OpenVDB's words.
    pub fn words(self) -> String {
        let names = [(Self::BLOSC, "blosc"), (Self::ZIP, "zip"), (Self::ACTIVE_MASK, "active values")];
        let words: Vec<_> =
            names.iter().filter(|(bit, _)| self.0 & bit != 0).map(|&(_, name)| name).collect();
        if words.is_empty() { "none".into() } else { words.join(" + ") }
    }
}

/// A bit mask as it lies in the file: bit i is bit i % 8 of byte i / 8.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(super) struct Mask<'a>(&'a [u8]);

impl<'a> Mask<'a> {
    pub fn parse(cursor: &mut Cursor<'a>, n_bits: usize) -> Result<Self, Fault> {
        Ok(Self(cursor.take(n_bits / 8)?))
    }

    pub fn get(self, i: usize) -> bool {
        self.0[i / 8] >> (i % 8) & 1 != 0
    }

    pub fn count(self) -> usize {
        self.0.iter().map(|byte| byte.count_ones() as usize).sum()
    }

    /// The first 512 bits.
    pub fn leaf_words(self) -> [u64; 8] {
        std::array::from_fn(|i| {
            self.0[i * 8..i * 8 + 8].iter().rev().fold(0, |word, &byte| word << 8 | u64::from(byte))
        })
    }
}

/// What holds for all nodes of a grid.
#[derive(Debug, Clone, Copy)]
pub(super) struct Format {
    /// Of the file.
    pub version: u32,
    pub compression: Compression,
    pub half: bool,
}

/// Version since which inner nodes store 1 code and a slot for each child, and leaves no origin.
pub(super) const VERSION_NODE_MASK: u32 = 222;

/// What is before the stored values: which inactive values the mask selects between.
mod code {
    pub const INACTIVE_BACKGROUND: u8 = 0;
    pub const ONE_INACTIVE: u8 = 2;
    pub const MASK_PLUS_MINUS: u8 = 3;
    pub const MASK_ONE: u8 = 4;
    pub const MASK_TWO: u8 = 5;
    pub const ALL: u8 = 6;
}

/// Values of a node, found but not decoded.
pub(super) struct Packed<'a, V> {
    /// For inactive slots, by the bit of `select`.
    inactive: [V; 2],
    select: Option<Mask<'a>>,
    chunk: Chunk<'a>,
    n_stored: usize,
    half: bool,
}

impl<'a, V: Value> Packed<'a, V> {
    /// Finds `count` values of a node with this active mask and steps over them.
    pub fn parse(
        cursor: &mut Cursor<'a>,
        format: Format,
        background: V,
        count: usize,
        active: Mask<'a>,
    ) -> Result<Self, Fault> {
        let offset = cursor.offset();
        let code = if format.version >= VERSION_NODE_MASK { cursor.u8()? } else { code::ALL };
        if code > code::ALL {
            return Err(Fault::invalid(offset, format!("mask code {code}, known are 0 to 6")));
        }
        let mut inactive =
            [if code == code::INACTIVE_BACKGROUND { background } else { background.negative() }, background];
        if matches!(code, code::ONE_INACTIVE | code::MASK_ONE | code::MASK_TWO) {
            inactive[0] = V::parse(cursor.take(V::N_BYTES)?);
        }
        if code == code::MASK_TWO {
            inactive[1] = V::parse(cursor.take(V::N_BYTES)?);
        }
        let has_select = matches!(code, code::MASK_PLUS_MINUS | code::MASK_ONE | code::MASK_TWO);
        let select = if has_select { Some(Mask::parse(cursor, count)?) } else { None };
        let n_stored =
            if format.compression.has_mask() && code != code::ALL { active.count() } else { count };
        let n_bytes = n_stored * if format.half { V::N_BYTES_HALF } else { V::N_BYTES };
        // OpenVDB's reader and writer of half values leave out an empty chunk altogether, those of whole ones do not.
        let halved = format.half && V::N_BYTES_HALF != V::N_BYTES;
        let chunk = if halved && n_stored == 0 {
            Chunk { bytes: &[], coding: Coding::Plain, offset: cursor.offset() }
        } else {
            Chunk::parse(cursor, format.compression, n_bytes)?
        };
        Ok(Self { inactive, select, chunk, n_stored, half: format.half })
    }

    /// The one value that all slots have, if that is known without decoding.
    pub fn uniform(&self) -> Option<V> {
        let [a, b] = self.inactive;
        (self.n_stored == 0 && (self.select.is_none() || a == b)).then_some(a)
    }

    /// The values of all slots, given to `put` in order; `active` as for [`Packed::parse`].
    pub fn unpack(&self, count: usize, active: Mask, mut put: impl FnMut(usize, V)) -> Result<(), Fault> {
        let (n_bytes, parse): (_, fn(&[u8]) -> V) =
            if self.half { (V::N_BYTES_HALF, V::parse_half) } else { (V::N_BYTES, V::parse) };
        let bytes = self.chunk.decode(self.n_stored * n_bytes)?;
        let mut stored = bytes.chunks_exact(n_bytes).map(parse);
        let all = self.n_stored == count;
        for i in 0..count {
            let value = if all || active.get(i) { stored.next() } else { None };
            put(
                i,
                value.unwrap_or_else(|| {
                    self.inactive[usize::from(self.select.is_some_and(|select| select.get(i)))]
                }),
            );
        }
        Ok(())
    }
}

#[derive(Clone, Copy)]
enum Coding {
    Plain,
    Zip,
    Blosc,
}

/// Bytes, maybe compressed.
struct Chunk<'a> {
    bytes: &'a [u8],
    coding: Coding,
    offset: u64,
}

impl<'a> Chunk<'a> {
    fn parse(cursor: &mut Cursor<'a>, compression: Compression, n_bytes: usize) -> Result<Self, Fault> {
        let plain = |cursor: &mut Cursor<'a>| {
            Ok(Self { offset: cursor.offset(), bytes: cursor.take(n_bytes)?, coding: Coding::Plain })
        };
        if compression.0 & (Compression::BLOSC | Compression::ZIP) == 0 {
            return plain(cursor);
        }
        let offset = cursor.offset();
        let announced = cursor.i64()?;
        if announced <= 0 {
            // Not compressed, which is said by the negative size.
            if announced.unsigned_abs() != n_bytes as u64 {
                let found = announced.unsigned_abs();
                return Err(Fault::invalid(offset, format!("chunk of {found} bytes where {n_bytes} belong")));
            }
            return plain(cursor);
        }
        cursor.check(announced.unsigned_abs())?;
        let coding = if compression.0 & Compression::BLOSC != 0 { Coding::Blosc } else { Coding::Zip };
        Ok(Self { offset: cursor.offset(), bytes: cursor.take(announced as usize)?, coding })
    }

    /// Steps over a chunk of `n_bytes` bytes.
    pub fn decode(&self, n_bytes: usize) -> Result<Cow<'a, [u8]>, Fault> {
        let mut out = vec![];
        match self.coding {
            Coding::Plain => return Ok(Cow::Borrowed(self.bytes)),
            Coding::Zip => {
                out.resize(n_bytes, 0);
                blosc::zlib(self.bytes, &mut out).map_err(|what| Fault::invalid(self.offset, what))?;
            }
            Coding::Blosc => {
                out.resize(n_bytes, 0);
                blosc::decompress(self.bytes, self.offset, &mut out)?;
            }
        }
        Ok(Cow::Owned(out))
    }
}

/// Steps over one of the further buffers that leaves had before version 222.
pub(super) fn skip_buffer<V: Value>(cursor: &mut Cursor, format: Format) -> Result<(), Fault> {
    let zip = if format.compression.has_zip() { Compression::ZIP_ONLY } else { Compression::NONE };
    let n_bytes = if format.half { V::N_BYTES_HALF } else { V::N_BYTES };
    Chunk::parse(cursor, zip, 512 * n_bytes).map(|_| ())
}
