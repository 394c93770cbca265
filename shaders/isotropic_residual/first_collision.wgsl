// A thread: the sources of one cell and channel with what scatters of the light straight from surfaces.

#import "isotropic_residual/bounce.wgsl"

@group(0) @binding(0) var<uniform> params: BounceParams;
@group(1) @binding(0) var sigma_t: texture_3d<f32>;
@group(1) @binding(1) var linear_clamp: sampler;
@group(1) @binding(2) var uncollided: texture_3d<f32>;
@group(1) @binding(3) var of_beams: texture_3d<f32>;
@group(2) @binding(0) var sources: texture_storage_3d<rgba32float, write>;

@compute @workgroup_size(8, 8, 1)
fn isotropic_residual_first_collision(@builtin(global_invocation_id) id: vec3u) {
    let level = params.level;
    if any(id.xy >= level.dims.xy) || id.z >= level.dims.z * level.n_channels {
        return;
    }
    let c = id.z / level.dims.z;
    let cell = vec3u(id.xy, id.z % level.dims.z);
    let at = (vec3f(cell) + 0.5) / f32(params.coarser) - 0.5;
    let state = layered(uncollided, linear_clamp, level.n_channels, c, at) * vec4f(1.0, vec3f(level.g_star));
    let scatter = textureLoad(sigma_t, cell, 0).x * level.channels[c].scatter;
    textureStore(sources, id, textureLoad(of_beams, id, 0) + scatter * state);
}
