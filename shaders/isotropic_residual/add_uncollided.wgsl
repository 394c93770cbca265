// A thread: phi and F of one cell and channel with the light straight from surfaces.

#import "isotropic_residual/bounce.wgsl"
#import "isotropic_residual/realizable.wgsl"

@group(0) @binding(0) var<uniform> params: BounceParams;
@group(1) @binding(0) var linear_clamp: sampler;
@group(1) @binding(1) var uncollided: texture_3d<f32>;
@group(1) @binding(2) var scattered: texture_3d<f32>;
@group(2) @binding(0) var moments: texture_storage_3d<rgba32float, write>;

@compute @workgroup_size(8, 8, 1)
fn isotropic_residual_add_uncollided(@builtin(global_invocation_id) id: vec3u) {
    let level = params.level;
    if any(id.xy >= level.dims.xy) || id.z >= level.dims.z * level.n_channels {
        return;
    }
    let c = id.z / level.dims.z;
    let at = (vec3f(vec3u(id.xy, id.z % level.dims.z)) + 0.5) / f32(params.coarser) - 0.5;
    let straight = layered(uncollided, linear_clamp, level.n_channels, c, at);
    textureStore(moments, id, realizable(textureLoad(scattered, id, 0) + straight));
}
