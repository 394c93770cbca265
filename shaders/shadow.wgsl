// A thread: the depths of a pack of beams at one corner of a cell, with those marked that a surface hides.

#import "lib/beam.wgsl"
#import "lib/bvh.wgsl"
#import "lib/shadow.wgsl"

struct ShadowParams {
    // Texel of the atlas where this pack begins.
    origin: vec3u,
    n_beams: u32,
    corners: vec3u,
    pad: u32,
    beams: array<Beam, 4>,
}

@group(0) @binding(0) var<uniform> params: ShadowParams;
@group(1) @binding(0) var unshadowed: texture_3d<f32>;
@group(1) @binding(1) var<storage, read> surface_nodes: array<SurfaceNode>;
@group(1) @binding(2) var<storage, read> surface_triangles: array<SurfaceTriangle>;
@group(2) @binding(0) var tau: texture_storage_3d<{format}, write>;

@compute @workgroup_size(8, 8, 1)
fn shadow(@builtin(global_invocation_id) id: vec3u) {
    if any(id >= params.corners) {
        return;
    }
    let p = vec3f(id) - 0.5;
    var depths = textureLoad(unshadowed, id, 0);
    for (var n = 0u; n < params.n_beams; n += 1u) {
        let place = params.beams[n].place;
        var to_light = -place.xyz;
        var reach = 1e30;
        if place.w > 0.0 {
            let line = place.xyz - p;
            reach = length(line);
            to_light = line / max(reach, 1e-6);
        }
        if reach > SURFACE_GAP && is_occluded(p, to_light, reach) {
            depths[n] = HIDDEN;
        }
    }
    textureStore(tau, params.origin + id, depths);
}
