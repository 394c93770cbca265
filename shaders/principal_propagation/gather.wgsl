// A thread: the optical depths of up to four beams at one corner, each between the four lines around it.

#import "principal_propagation/shear.wgsl"
#import "lib/tau_{pack}.wgsl"

struct GatherParams {
    shears: array<Shear, 4>,
    // Texel of the atlas where this pack begins.
    origin: vec3u,
    pad: u32,
    corners: vec3u,
    n_beams: u32,
}

@group(0) @binding(0) var<uniform> params: GatherParams;
@group(1) @binding(0) var lines_0: texture_3d<f32>;
@group(1) @binding(1) var lines_1: texture_3d<f32>;
@group(1) @binding(2) var lines_2: texture_3d<f32>;
@group(1) @binding(3) var lines_3: texture_3d<f32>;
@group(1) @binding(4) var linear_clamp: sampler;
@group(2) @binding(0) var tau: texture_storage_3d<{format}, write>;

fn between_lines(lines: texture_3d<f32>, shear: Shear, id: vec3u) -> f32 {
    let p = vec3f(id);
    var uvw = p;
    if shear.along == 0u {
        uvw = p.yzx;
    } else if shear.along == 1u {
        uvw = p.xzy;
    }
    let j = select(f32(shear.corners.z) - 1.0 - uvw.z, uvw.z, shear.sense > 0.0);
    let line = 2.0 * (uvw.xy - line_offset(shear, j));
    let at = (vec3f(line, j) + 0.5) / vec3f(textureDimensions(lines));
    return stored_tau(textureSampleLevel(lines, linear_clamp, at, 0.0).x);
}

@compute @workgroup_size(8, 8, 1)
fn principal_propagation_gather(@builtin(global_invocation_id) id: vec3u) {
    if any(id >= params.corners) {
        return;
    }
    var depths = vec4f(between_lines(lines_0, params.shears[0], id), 0.0, 0.0, 0.0);
    if params.n_beams > 1u {
        depths.y = between_lines(lines_1, params.shears[1], id);
    }
    if params.n_beams > 2u {
        depths.z = between_lines(lines_2, params.shears[2], id);
    }
    if params.n_beams > 3u {
        depths.w = between_lines(lines_3, params.shears[3], id);
    }
    textureStore(tau, params.origin + id, depths);
}
