// A thread: the lobe of one cell and channel, from what was swept last, rebalanced, and the sources.

#import "isotropic_residual/common.wgsl"
#import "lib/lobe.wgsl"

@group(0) @binding(0) var<uniform> level: Level;
@group(1) @binding(0) var sigma_t: texture_3d<f32>;
@group(1) @binding(1) var sources: texture_3d<f32>;
@group(1) @binding(2) var moments: texture_3d<f32>;
@group(1) @binding(3) var<storage, read> balance: array<f32>;
@group(2) @binding(0) var lobes: texture_storage_3d<rgba32uint, write>;

@compute @workgroup_size(8, 8, 1)
fn isotropic_residual_lobe(@builtin(global_invocation_id) id: vec3u) {
    if any(id.xy >= level.dims.xy) || id.z >= level.dims.z * level.n_channels {
        return;
    }
    let c = id.z / level.dims.z;
    let channel = level.channels[c];
    let extinction = textureLoad(sigma_t, vec3u(id.xy, id.z % level.dims.z), 0).x;
    let source = textureLoad(sources, id, 0);
    let scatter = extinction * channel.scatter * balance[c];
    let swept = scatter * textureLoad(moments, id, 0) * vec4f(1.0, vec3f(level.g_star));
    let total = swept + source;
    textureStore(lobes, id, pack_lobe(lobe_from_moments(total.x, total.yzw), extinction * channel.k));
}
