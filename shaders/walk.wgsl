// A thread: the optical depth from one corner of a cell to each light of a pack, walked exactly.
// Serves parallel beams and point lights alike.

#import "lib/walk.wgsl"
#import "lib/beam.wgsl"
#import "lib/tau_{pack}.wgsl"

struct WalkParams {
    shape: Shape,
    // Texel of the atlas where this pack begins.
    origin: vec3u,
    n_beams: u32,
    corners: vec3u,
    cell_m: f32,
    // Layer of corners where the threads begin.
    first: u32,
    pad_0: u32,
    pad_1: u32,
    pad_2: u32,
    beams: array<Beam, 4>,
}

@group(0) @binding(0) var<uniform> params: WalkParams;
@group(1) @binding(0) var sigma_t: texture_3d<f32>;
@group(1) @binding(1) var linear_clamp: sampler;
@group(2) @binding(0) var tau: texture_storage_3d<{format}, write>;

@compute @workgroup_size(8, 8, 1)
fn walk_corners(@builtin(global_invocation_id) thread: vec3u) {
    let id = thread + vec3u(0u, 0u, params.first);
    if any(id >= params.corners) {
        return;
    }
    let p = vec3f(id) - 0.5;
    var depths = vec4f(0.0);
    for (var n = 0u; n < params.n_beams; n += 1u) {
        let place = params.beams[n].place;
        var to_light = -place.xyz;
        var reach = 1e30;
        if place.w > 0.0 {
            let line = place.xyz - p;
            reach = length(line);
            to_light = line / max(reach, 1e-6);
        }
        depths[n] = stored_tau(walk(sigma_t, linear_clamp, params.shape, params.cell_m, p, to_light, reach));
    }
    textureStore(tau, params.origin + id, depths);
}
