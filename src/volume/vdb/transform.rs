//! Maps from index space to world space.
//!
//! OpenVDB writes points as rows, so its matrices are the transposes of ours: the 16 numbers of a file, row after row,
//! are the columns of `world_from_index`. Scale maps store derived numbers beside scale and translation, which are not
//! needed. Source: `openvdb/math/Maps.h` and, for files before version 219, `Transform.cc` of OpenVDB 10.
//! Limits: the frustum map is not linear and is refused by name, and so is a map that has no inverse.
//! Tested in `tests.rs`.

use super::cursor::{Cursor, Fault};
use glam::{DMat4, DVec3};

/// Version since which transforms are maps.
const VERSION_MAPS: u32 = 219;
/// Version since which a frustum's box is of doubles.
const VERSION_FLOAT_FRUSTUM: u32 = 221;

pub(super) enum Transform {
    Linear(DMat4),
    /// Read, but of no use, for this reason.
    Refused(String),
}

pub(super) fn parse(cursor: &mut Cursor, version: u32) -> Result<Transform, Fault> {
    let offset = cursor.offset();
    let kind = cursor.string()?;
    let matrix = match kind.as_str() {
        "LinearTransform" if version < VERSION_MAPS => {
            cursor.take(24)?;
            let [world_from_local, _, local_from_voxel, _] =
                [matrix(cursor)?, matrix(cursor)?, matrix(cursor)?, matrix(cursor)?];
            world_from_local * local_from_voxel
        }
        "NonlinearFrustumMap" => {
            cursor.take(if version < VERSION_FLOAT_FRUSTUM { 24 } else { 48 })?;
            cursor.take(16)?;
            let inner = cursor.string()?;
            linear(cursor, &inner, offset)?;
            return Ok(Transform::Refused(
                "frustum transform, which is not supported; resample the grid to a linear one".into(),
            ));
        }
        _ => linear(cursor, &kind, offset)?,
    };
    if !matrix.is_finite() || !matrix.inverse().is_finite() || matrix.determinant() == 0.0 {
        return Ok(Transform::Refused(format!("transform {kind} without an inverse: {matrix}")));
    }
    if matrix.row(3).to_array() != [0.0, 0.0, 0.0, 1.0] {
        return Ok(Transform::Refused(format!("transform {kind} is not affine: {matrix}")));
    }
    Ok(Transform::Linear(matrix))
}

fn linear(cursor: &mut Cursor, kind: &str, offset: u64) -> Result<DMat4, Fault> {
    Ok(match kind {
        "AffineMap" | "UnitaryMap" => matrix(cursor)?,
        "TranslationMap" => DMat4::from_translation(vector(cursor)?),
        "ScaleMap" | "UniformScaleMap" => DMat4::from_scale(scale(cursor)?),
        "ScaleTranslateMap" | "UniformScaleTranslateMap" => {
            let translation = vector(cursor)?;
            DMat4::from_translation(translation) * DMat4::from_scale(scale(cursor)?)
        }
        _ => {
            return Err(Fault::unsupported(offset, format!("transform of type `{kind}`")));
        }
    })
}

fn matrix(cursor: &mut Cursor) -> Result<DMat4, Fault> {
    Ok(DMat4::from_cols_array(&cursor.f64s()?))
}

fn vector(cursor: &mut Cursor) -> Result<DVec3, Fault> {
    Ok(DVec3::from_array(cursor.f64s()?))
}

/// The scale, and over the voxel size, inverse, squared inverse and half inverse.
fn scale(cursor: &mut Cursor) -> Result<DVec3, Fault> {
    let scale = vector(cursor)?;
    cursor.take(4 * 24)?;
    Ok(scale)
}
