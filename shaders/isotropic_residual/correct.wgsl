// A thread: a cell and channel after a V-cycle's coarse correction, trilinear between the coarse cells;
// phi stays within a factor 4 of what was swept.

#import "isotropic_residual/common.wgsl"
#import "isotropic_residual/realizable.wgsl"
#import "isotropic_residual/coarse.wgsl"

@group(0) @binding(0) var<uniform> level: Level;
@group(1) @binding(0) var swept: texture_3d<f32>;
@group(1) @binding(1) var correction: texture_3d<f32>;
@group(1) @binding(2) var linear_clamp: sampler;
@group(2) @binding(0) var corrected: texture_storage_3d<rgba32float, write>;

@compute @workgroup_size(8, 8, 1)
fn isotropic_residual_correct(@builtin(global_invocation_id) id: vec3u) {
    if any(id.xy >= level.dims.xy) || id.z >= level.dims.z * level.n_channels {
        return;
    }
    let before = textureLoad(swept, id, 0);
    var after = before + sample_coarse(level, correction, linear_clamp, id);
    after.x = clamp(after.x, 0.25 * before.x, 4.0 * before.x);
    textureStore(corrected, id, realizable(after));
}
