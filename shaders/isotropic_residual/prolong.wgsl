// A thread: a field of one cell and channel from the next coarser level.

#import "isotropic_residual/coarse.wgsl"

@group(0) @binding(0) var<uniform> level: Level;
@group(1) @binding(0) var coarse: texture_3d<f32>;
@group(1) @binding(1) var linear_clamp: sampler;
@group(2) @binding(0) var fine: texture_storage_3d<rgba32float, write>;

@compute @workgroup_size(8, 8, 1)
fn isotropic_residual_prolong(@builtin(global_invocation_id) id: vec3u) {
    if all(id.xy < level.dims.xy) && id.z < level.dims.z * level.n_channels {
        textureStore(fine, id, sample_coarse(level, coarse, linear_clamp, id));
    }
}
