// A thread: the depths of up to four beams at one corner become a texel of the atlas.

#import "lib/tau_{pack}.wgsl"

struct PackParams {
    corners: vec3u,
    n_beams: u32,
    // Texel of the atlas where this pack begins.
    origin: vec3u,
    pad: u32,
}

@group(0) @binding(0) var<uniform> params: PackParams;
// Beam after beam.
@group(1) @binding(0) var<storage, read> depths: array<f32>;
@group(2) @binding(0) var tau: texture_storage_3d<{format}, write>;

@compute @workgroup_size(8, 8, 1)
fn principal_propagation_pack(@builtin(global_invocation_id) id: vec3u) {
    if any(id >= params.corners) {
        return;
    }
    let n_corners = params.corners.x * params.corners.y * params.corners.z;
    let corner = id.x + params.corners.x * (id.y + params.corners.y * id.z);
    var four = vec4f(0.0);
    for (var n = 0u; n < params.n_beams; n += 1u) {
        four[n] = stored_tau(depths[n * n_corners + corner]);
    }
    textureStore(tau, params.origin + id, four);
}
