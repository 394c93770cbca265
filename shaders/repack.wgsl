// A thread: one corner of a pack of beams, on its way to another atlas: of one or two beams that had texels of their
// own and get one of four, or of a pack as it is.

#import "lib/tau_{pack}.wgsl"

struct RepackParams {
    corners: vec3u,
    n_beams: u32,
    // First texels of the beams in the source, and of the pack in the target.
    origins: array<vec4u, 2>,
    origin: vec3u,
    pad: u32,
}

@group(0) @binding(0) var<uniform> params: RepackParams;
@group(1) @binding(0) var source: texture_3d<f32>;
@group(2) @binding(0) var packed: texture_storage_3d<{format}, write>;

const FROM_SINGLES: bool = {singles};

@compute @workgroup_size(8, 8, 1)
fn repack(@builtin(global_invocation_id) id: vec3u) {
    if any(id >= params.corners) {
        return;
    }
    var depths = textureLoad(source, params.origins[0].xyz + id, 0);
    if FROM_SINGLES {
        let second = textureLoad(source, params.origins[1].xyz + id, 0).x;
        depths = vec4f(stored_tau(depths.x), select(0.0, stored_tau(second), params.n_beams > 1u), 0.0, 0.0);
    }
    textureStore(packed, params.origin + id, depths);
}
