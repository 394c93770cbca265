// A thread: sigma_t of one cell, the mean of the trilinear grid over n_sub^3 points of the cell.

struct MediumParams {
    // Rows of the map from cell index to voxel index.
    voxel_from_cell: array<vec4f, 3>,
    dims: vec3u,
    n_sub: u32,
    // Extinction per unit of the grid [1/m].
    density_scale: f32,
    pad_0: u32,
    pad_1: u32,
    pad_2: u32,
}

@group(0) @binding(0) var<uniform> params: MediumParams;
@group(1) @binding(0) var voxels: texture_3d<f32>;
@group(2) @binding(0) var sigma_t: texture_storage_3d<r32float, write>;

// Trilinear between voxel centers; beyond the voxels the background, 0, takes part.
fn density(p: vec3f) -> f32 {
    let size = vec3i(textureDimensions(voxels));
    let low = floor(p);
    let t = p - low;
    var sum = 0.0;
    for (var n = 0u; n < 8u; n += 1u) {
        let corner = vec3u(n & 1u, (n >> 1u) & 1u, n >> 2u);
        let at = vec3i(low) + vec3i(corner);
        let inside = all(at >= vec3i(0)) && all(at < size);
        let w = select(1.0 - t, t, corner == vec3u(1u));
        if inside {
            sum += w.x * w.y * w.z * textureLoad(voxels, at, 0).x;
        }
    }
    return sum;
}

@compute @workgroup_size(8, 8, 1)
fn medium(@builtin(global_invocation_id) id: vec3u) {
    if any(id >= params.dims) {
        return;
    }
    let n = params.n_sub;
    var sum = 0.0;
    for (var sub = 0u; sub < n * n * n; sub += 1u) {
        let offset = (vec3f(vec3u(sub % n, (sub / n) % n, sub / (n * n))) + 0.5) / f32(n) - 0.5;
        let cell = vec4f(vec3f(id) + offset, 1.0);
        let rows = params.voxel_from_cell;
        sum += density(vec3f(dot(rows[0], cell), dot(rows[1], cell), dot(rows[2], cell)));
    }
    textureStore(sigma_t, id, vec4f(params.density_scale * sum / f32(n * n * n)));
}
