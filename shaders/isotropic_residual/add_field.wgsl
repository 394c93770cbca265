// A thread: phi and F of one cell and channel with those of a light field that is known already.

#import "isotropic_residual/realizable.wgsl"

struct FieldParams {
    dims: vec3u,
    // Of the residual.
    n_channels: u32,
    // What the field's one channel is multiplied by; ones where it has three.
    color: vec4f,
    n_field_channels: u32,
    pad_0: u32,
    pad_1: u32,
    pad_2: u32,
}

@group(0) @binding(0) var<uniform> params: FieldParams;
@group(1) @binding(0) var field: texture_3d<f32>;
@group(1) @binding(1) var before: texture_3d<f32>;
@group(2) @binding(0) var moments: texture_storage_3d<rgba32float, write>;

@compute @workgroup_size(8, 8, 1)
fn isotropic_residual_add_field(@builtin(global_invocation_id) id: vec3u) {
    if any(id.xy >= params.dims.xy) || id.z >= params.dims.z * params.n_channels {
        return;
    }
    let c = id.z / params.dims.z;
    let field_c = select(0u, c, params.n_field_channels > 1u);
    let cell = vec3u(id.xy, id.z % params.dims.z + field_c * params.dims.z);
    let added = params.color[c] * textureLoad(field, cell, 0);
    textureStore(moments, id, realizable(textureLoad(before, id, 0) + added));
}
