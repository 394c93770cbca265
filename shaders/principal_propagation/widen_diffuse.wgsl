// A thread: a step of diffusion along one row of columns, backward Euler, dark outside.

#import "principal_propagation/widen_column.wgsl"

struct DiffuseParams {
    n_rows: u32,
    n_columns: u32,
    // From row to row, and from a column of a row to the next.
    row_stride: u32,
    column_stride: u32,
}

@group(0) @binding(0) var<uniform> params: DiffuseParams;
@group(2) @binding(0) var<storage, read_write> columns: array<Column>;

fn at(row: u32, column: u32) -> u32 {
    return row * params.row_stride + column * params.column_stride;
}

@compute @workgroup_size(64, 1, 1)
fn principal_propagation_widen_diffuse(@builtin(global_invocation_id) id: vec3u) {
    if id.x >= params.n_rows {
        return;
    }
    let n = params.n_columns;
    var before = vec3f(0.0);
    var below = 0.0;
    var number_before = columns[at(id.x, 0u)].number;
    var own = number_before;
    for (var i = 0u; i < n; i += 1u) {
        let idx = at(id.x, i);
        let number_after = columns[at(id.x, min(i + 1u, n - 1u))].number;
        let left = 0.5 * (own + number_before);
        let right = 0.5 * (own + number_after);
        let pivot = 1.0 / (1.0 + right + left * (1.0 - below));
        let column = columns[idx];
        before = pivot * (vec3f(column.power, column.covariance, column.variance) + left * before);
        below = right * pivot;
        columns[idx].power = before.x;
        columns[idx].covariance = before.y;
        columns[idx].variance = before.z;
        columns[idx].upper = below;
        number_before = own;
        own = number_after;
    }
    for (var i = n - 1u; i > 0u; i -= 1u) {
        let idx = at(id.x, i - 1u);
        let column = columns[idx];
        before = vec3f(column.power, column.covariance, column.variance) + column.upper * before;
        columns[idx].power = before.x;
        columns[idx].covariance = before.y;
        columns[idx].variance = before.z;
    }
}
