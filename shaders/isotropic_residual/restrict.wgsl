// A thread: the mean of the eight finer cells of one cell, for any field; layers (channels) stay apart.

struct RestrictParams {
    // Of the coarse level; z counts the layers' cells together.
    dims: vec3u,
    pad: u32,
}

@group(0) @binding(0) var<uniform> params: RestrictParams;
@group(1) @binding(0) var fine: texture_3d<f32>;
@group(2) @binding(0) var coarse: texture_storage_3d<{format}, write>;

@compute @workgroup_size(8, 8, 1)
fn isotropic_residual_restrict(@builtin(global_invocation_id) id: vec3u) {
    if any(id >= params.dims) {
        return;
    }
    var sum = vec4f(0.0);
    for (var n = 0u; n < 8u; n += 1u) {
        sum += textureLoad(fine, 2u * id + vec3u(n & 1u, (n >> 1u) & 1u, n >> 2u), 0);
    }
    textureStore(coarse, id, sum * 0.125);
}
