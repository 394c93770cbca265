// A thread: the difference of two fields in one cell and channel.

#import "isotropic_residual/common.wgsl"

@group(0) @binding(0) var<uniform> level: Level;
@group(1) @binding(0) var minuend: texture_3d<f32>;
@group(1) @binding(1) var subtrahend: texture_3d<f32>;
@group(2) @binding(0) var difference: texture_storage_3d<rgba32float, write>;

@compute @workgroup_size(8, 8, 1)
fn isotropic_residual_difference(@builtin(global_invocation_id) id: vec3u) {
    if all(id.xy < level.dims.xy) && id.z < level.dims.z * level.n_channels {
        textureStore(difference, id, textureLoad(minuend, id, 0) - textureLoad(subtrahend, id, 0));
    }
}
