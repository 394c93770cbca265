// A thread: the moments of one cell and channel, rebalanced once more, as the field that is handed on.

#import "isotropic_residual/common.wgsl"

@group(0) @binding(0) var<uniform> level: Level;
@group(1) @binding(0) var moments: texture_3d<f32>;
@group(1) @binding(1) var<storage, read> balance: array<f32>;
@group(2) @binding(0) var result: texture_storage_3d<rgba32float, write>;

@compute @workgroup_size(8, 8, 1)
fn isotropic_residual_finish(@builtin(global_invocation_id) id: vec3u) {
    if any(id.xy >= level.dims.xy) || id.z >= level.dims.z * level.n_channels {
        return;
    }
    textureStore(result, id, balance[id.z / level.dims.z] * textureLoad(moments, id, 0));
}
