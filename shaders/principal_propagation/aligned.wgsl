// A grid of cubic cells, as large as the medium's, whose third axis runs along a beam.

struct Aligned {
    dims: vec3u,
    // Edge of a cell [m].
    cell_m: f32,
    // Unit axes in index space, w the direction of travel.
    u: vec3f,
    pad_0: u32,
    v: vec3f,
    pad_1: u32,
    w: vec3f,
    pad_2: u32,
    // Index position of the center of cell (0, 0, 0).
    origin: vec3f,
    pad_3: u32,
}

// The index position of a place in the grid, in its cells.
fn index_from_aligned(grid: Aligned, p: vec3f) -> vec3f {
    return grid.origin + p.x * grid.u + p.y * grid.v + p.z * grid.w;
}

fn aligned_from_index(grid: Aligned, p: vec3f) -> vec3f {
    let from_origin = p - grid.origin;
    return vec3f(dot(from_origin, grid.u), dot(from_origin, grid.v), dot(from_origin, grid.w));
}
