//! The value types of OpenVDB's trees: how each lies in a file and what it is as a number.
//!
//! Source: `openvdb/io/Compression.h` (`RealToHalf`), `openvdb/math/Math.h` (`negative`),
//! `openvdb/tree/LeafNode{,Bool,Mask}.h`. Tested by the fixtures in `tests.rs`, one grid a type.

use crate::volume::stats::Components;
use half::f16;

/// How a leaf's 512 values are stored.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(super) enum LeafLayout {
    /// Packed values, as in the inner nodes.
    Values,
    /// A second bit mask holds the values.
    Bits,
    /// The active mask is the values.
    Mask,
}

pub(super) trait Value: Components + Copy + PartialEq + Default + Send + Sync {
    /// Bytes of a value as such.
    const N_BYTES: usize;
    /// Bytes of a value in a grid "saved as half".
    const N_BYTES_HALF: usize = Self::N_BYTES;
    const LAYOUT: LeafLayout = LeafLayout::Values;

    /// From exactly `N_BYTES` bytes.
    fn parse(bytes: &[u8]) -> Self;

    /// From exactly `N_BYTES_HALF` bytes.
    fn parse_half(bytes: &[u8]) -> Self {
        Self::parse(bytes)
    }

    /// Inside of a level set; a bool's opposite is its "negative", integers wrap.
    fn negative(self) -> Self;

    /// As a scalar field; a vector's first component.
    fn to_f32(self) -> f32;
}

fn fixed<const N: usize>(bytes: &[u8]) -> [u8; N] {
    let mut out = [0; N];
    out.copy_from_slice(bytes);
    out
}

fn parse_f16(bytes: &[u8]) -> f16 {
    f16::from_le_bytes(fixed(bytes))
}

impl Value for f32 {
    const N_BYTES: usize = 4;
    const N_BYTES_HALF: usize = 2;
    fn parse(bytes: &[u8]) -> Self {
        Self::from_le_bytes(fixed(bytes))
    }
    fn parse_half(bytes: &[u8]) -> Self {
        parse_f16(bytes).to_f32()
    }
    fn negative(self) -> Self {
        -self
    }
    fn to_f32(self) -> f32 {
        self
    }
}

impl Value for f64 {
    const N_BYTES: usize = 8;
    const N_BYTES_HALF: usize = 2;
    fn parse(bytes: &[u8]) -> Self {
        Self::from_le_bytes(fixed(bytes))
    }
    fn parse_half(bytes: &[u8]) -> Self {
        parse_f16(bytes).to_f64()
    }
    fn negative(self) -> Self {
        -self
    }
    fn to_f32(self) -> f32 {
        self as f32
    }
}

impl Value for f16 {
    const N_BYTES: usize = 2;
    fn parse(bytes: &[u8]) -> Self {
        parse_f16(bytes)
    }
    fn negative(self) -> Self {
        -self
    }
    fn to_f32(self) -> f32 {
        f32::from(self)
    }
}

impl Value for i32 {
    const N_BYTES: usize = 4;
    fn parse(bytes: &[u8]) -> Self {
        Self::from_le_bytes(fixed(bytes))
    }
    fn negative(self) -> Self {
        self.wrapping_neg()
    }
    fn to_f32(self) -> f32 {
        self as f32
    }
}

impl Value for i64 {
    const N_BYTES: usize = 8;
    fn parse(bytes: &[u8]) -> Self {
        Self::from_le_bytes(fixed(bytes))
    }
    fn negative(self) -> Self {
        self.wrapping_neg()
    }
    fn to_f32(self) -> f32 {
        self as f32
    }
}

impl Value for bool {
    const N_BYTES: usize = 1;
    const LAYOUT: LeafLayout = LeafLayout::Bits;
    fn parse(bytes: &[u8]) -> Self {
        bytes[0] != 0
    }
    fn negative(self) -> Self {
        !self
    }
    fn to_f32(self) -> f32 {
        f32::from(u8::from(self))
    }
}

/// The value of a mask grid: like a bool, but it is also what says whether it is active.
#[derive(Clone, Copy, PartialEq, Eq, Default)]
pub(super) struct MaskValue(pub bool);

impl Components for MaskValue {
    const IS_VECTOR: bool = false;
    fn components(self) -> [f64; 3] {
        self.0.components()
    }
}

impl Value for MaskValue {
    const N_BYTES: usize = 1;
    const LAYOUT: LeafLayout = LeafLayout::Mask;
    fn parse(bytes: &[u8]) -> Self {
        Self(bool::parse(bytes))
    }
    fn negative(self) -> Self {
        Self(!self.0)
    }
    fn to_f32(self) -> f32 {
        self.0.to_f32()
    }
}

impl<V: Value> Value for [V; 3]
where
    [V; 3]: Components,
{
    const N_BYTES: usize = 3 * V::N_BYTES;
    const N_BYTES_HALF: usize = 3 * V::N_BYTES_HALF;
    fn parse(bytes: &[u8]) -> Self {
        std::array::from_fn(|i| V::parse(&bytes[i * V::N_BYTES..(i + 1) * V::N_BYTES]))
    }
    fn parse_half(bytes: &[u8]) -> Self {
        std::array::from_fn(|i| V::parse_half(&bytes[i * V::N_BYTES_HALF..(i + 1) * V::N_BYTES_HALF]))
    }
    fn negative(self) -> Self {
        self.map(V::negative)
    }
    fn to_f32(self) -> f32 {
        self[0].to_f32()
    }
}
