//! The parameter `transform`, which several nodes have: 16 numbers, row-major, on column vectors.

use glam::DMat4;

use crate::graph::{NodeError, ParamSpec, Params};

/// Identity by default.
pub(super) const PARAM: ParamSpec = ParamSpec::vector(
    "transform",
    &[1.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 1.0],
)
.doc(
    "Moves, turns and scales it: 16 numbers, row-major, applied to column vectors, after the file's own map.",
);

/// The matrix.
///
/// # Errors
/// Where it is no invertible affine map.
pub(super) fn read(params: &Params) -> Result<DMat4, NodeError> {
    let rows: [f64; 16] = params.vec("transform");
    if rows[12..] != [0.0, 0.0, 0.0, 1.0] {
        return Err(NodeError::new(
            "transform's last row is not [0, 0, 0, 1]: write an affine map, row by row",
        ));
    }
    let matrix = DMat4::from_cols_array(&rows).transpose();
    let determinant = matrix.determinant();
    if determinant == 0.0 || !determinant.is_finite() {
        return Err(NodeError::new(
            "transform cannot be inverted: its first three columns must be independent",
        ));
    }
    Ok(matrix)
}
