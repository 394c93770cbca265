// A thread: a field of one cell and channel, trilinear between the coarse cells around it, times the
// coarse level's balance.

#import "isotropic_residual/common.wgsl"

@group(0) @binding(0) var<uniform> level: Level;
@group(1) @binding(0) var coarse: texture_3d<f32>;
@group(1) @binding(1) var linear_clamp: sampler;
@group(1) @binding(2) var<storage, read> balance: array<f32>;
@group(2) @binding(0) var fine: texture_storage_3d<rgba32float, write>;

@compute @workgroup_size(8, 8, 1)
fn isotropic_residual_prolong(@builtin(global_invocation_id) id: vec3u) {
    if any(id.xy >= level.dims.xy) || id.z >= level.dims.z * level.n_channels {
        return;
    }
    let c = id.z / level.dims.z;
    let size = vec3f(textureDimensions(coarse));
    let layer = size.z / f32(level.n_channels);
    var p = (vec3f(vec3u(id.xy, id.z % level.dims.z)) + 0.5) * 0.5;
    // Half a texel from the layer's faces, so that channels do not mix.
    p.z = clamp(p.z, 0.5, layer - 0.5) + f32(c) * layer;
    textureStore(fine, id, balance[c] * textureSampleLevel(coarse, linear_clamp, p / size, 0.0));
}
