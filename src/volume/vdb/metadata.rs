//! Metadata of a file or a grid: names with typed values.
//!
//! Each value has its length before it, so that what is not known is stepped over. Source: `openvdb/Metadata.h`,
//! `openvdb/MetaMap.cc`. Types whose name starts with `__` are the writer's own notes (`__delayedload`) and are left
//! out, as OpenVDB does. Metadata is shown and never believed: extents and counts come from the tree.
//! Tested in `tests.rs`.

use super::cursor::{Cursor, Fault};
use half::f16;
use indexmap::IndexMap;
use serde::Serialize;

/// In the order of the file.
pub type Metadata = IndexMap<String, MetaValue>;

/// A value of one of OpenVDB's metadata types; matrices are lists as they lie in the file.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[serde(untagged)]
pub enum MetaValue {
    /// `bool`; every byte but 0 is true.
    Bool(bool),
    /// `int32` and `int64`.
    Int(i64),
    /// `half`, `float` and `double`.
    Float(f64),
    /// `string`; what is no UTF-8 became U+FFFD.
    Text(String),
    /// `vec2i` to `vec4i`: 2 to 4 numbers.
    Ints(Vec<i64>),
    /// Vectors of 2 to 4, quaternions of 4, matrices of 9 or 16 numbers.
    Floats(Vec<f64>),
}

pub(super) fn parse(cursor: &mut Cursor) -> Result<Metadata, Fault> {
    let mut out = Metadata::new();
    let count = cursor.u32()?;
    // A name's, a type's and a value's length.
    cursor.check(u64::from(count) * 12)?;
    for _ in 0..count {
        let name = cursor.string()?;
        let type_name = cursor.string()?;
        let n_bytes = cursor.u32()?;
        let offset = cursor.offset();
        cursor.check(u64::from(n_bytes))?;
        let bytes = cursor.take(n_bytes as usize)?;
        match value(&type_name, bytes) {
            Parsed::Value(value) => {
                out.insert(name, value);
            }
            Parsed::Unknown => {}
            Parsed::WrongSize(right) => {
                let what =
                    format!("metadata `{name}` of type {type_name} has {n_bytes} bytes, right is {right}");
                return Err(Fault::invalid(offset, what));
            }
        }
    }
    Ok(out)
}

enum Parsed {
    Value(MetaValue),
    Unknown,
    WrongSize(usize),
}

fn value(type_name: &str, bytes: &[u8]) -> Parsed {
    let ints =
        |n| numbers(bytes, n, |b: [u8; 4]| i64::from(i32::from_le_bytes(b)), MetaValue::Int, MetaValue::Ints);
    let floats = |n| {
        numbers(bytes, n, |b: [u8; 4]| f64::from(f32::from_le_bytes(b)), MetaValue::Float, MetaValue::Floats)
    };
    let doubles = |n| numbers(bytes, n, f64::from_le_bytes, MetaValue::Float, MetaValue::Floats);
    match type_name {
        "string" => Parsed::Value(MetaValue::Text(String::from_utf8_lossy(bytes).into_owned())),
        "bool" => numbers(bytes, 1, |[b]: [u8; 1]| b != 0, MetaValue::Bool, |_| MetaValue::Bool(false)),
        "half" => numbers(bytes, 1, |b| f16::from_le_bytes(b).to_f64(), MetaValue::Float, MetaValue::Floats),
        "int32" => ints(1),
        "int64" => numbers(bytes, 1, i64::from_le_bytes, MetaValue::Int, MetaValue::Ints),
        "float" => floats(1),
        "double" => doubles(1),
        "vec2i" => ints(2),
        "vec3i" => ints(3),
        "vec4i" => ints(4),
        "vec2s" => floats(2),
        "vec3s" => floats(3),
        "vec4s" | "quats" => floats(4),
        "vec2d" => doubles(2),
        "vec3d" => doubles(3),
        "vec4d" | "quatd" => doubles(4),
        "mat3s" => floats(9),
        "mat3d" => doubles(9),
        "mat4s" => floats(16),
        "mat4d" => doubles(16),
        _ => Parsed::Unknown,
    }
}

fn numbers<T, const N: usize>(
    bytes: &[u8],
    count: usize,
    parse: impl Fn([u8; N]) -> T,
    one: impl Fn(T) -> MetaValue,
    many: impl Fn(Vec<T>) -> MetaValue,
) -> Parsed {
    if bytes.len() != count * N {
        return Parsed::WrongSize(count * N);
    }
    let (words, _) = bytes.as_chunks::<N>();
    let mut values = words.iter().map(|&word| parse(word));
    Parsed::Value(match (count, values.next()) {
        (1, Some(value)) => one(value),
        (_, first) => many(first.into_iter().chain(values).collect()),
    })
}
