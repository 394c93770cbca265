// A thread: Q and V [W/m3] of one cell and channel, of all that it scatters and emits: what rays that look for
// light see of the medium.

#import "isotropic_residual/bounce.wgsl"

@group(0) @binding(0) var<uniform> params: BounceParams;
@group(1) @binding(0) var sigma_t: texture_3d<f32>;
@group(1) @binding(1) var sources: texture_3d<f32>;
@group(1) @binding(2) var moments: texture_3d<f32>;
@group(2) @binding(0) var scattered: texture_storage_3d<rgba32float, write>;

@compute @workgroup_size(8, 8, 1)
fn isotropic_residual_scattered(@builtin(global_invocation_id) id: vec3u) {
    let level = params.level;
    if any(id.xy >= level.dims.xy) || id.z >= level.dims.z * level.n_channels {
        return;
    }
    let cell = vec3u(id.xy, id.z % level.dims.z);
    let scatter = textureLoad(sigma_t, cell, 0).x * level.channels[id.z / level.dims.z].scatter;
    let state = textureLoad(moments, id, 0) * vec4f(1.0, vec3f(level.g_star));
    textureStore(scattered, id, textureLoad(sources, id, 0) + scatter * state);
}
