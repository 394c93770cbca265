// A thread: one corner of one or two beams that had texels of their own, as a texel of four.

#import "lib/tau_4.wgsl"

struct RepackParams {
    corners: vec3u,
    n_beams: u32,
    // First texels of the beams in the source, and of the pack in the target.
    origins: array<vec4u, 2>,
    origin: vec3u,
    pad: u32,
}

@group(0) @binding(0) var<uniform> params: RepackParams;
@group(1) @binding(0) var single: texture_3d<f32>;
@group(2) @binding(0) var packed: texture_storage_3d<rgba16float, write>;

@compute @workgroup_size(8, 8, 1)
fn repack(@builtin(global_invocation_id) id: vec3u) {
    if any(id >= params.corners) {
        return;
    }
    var depths = vec4f(stored_tau(textureLoad(single, params.origins[0].xyz + id, 0).x), 0.0, 0.0, 0.0);
    if params.n_beams > 1u {
        depths.y = stored_tau(textureLoad(single, params.origins[1].xyz + id, 0).x);
    }
    textureStore(packed, params.origin + id, depths);
}
