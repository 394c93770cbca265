// A thread: for up to four beams at one corner the depth tau of a light that widens, E* = E exp(-k tau).

#import "principal_propagation/aligned.wgsl"
#import "lib/shadow.wgsl"
#import "lib/tau_{pack}.wgsl"

struct WidenGatherParams {
    grids: array<Aligned, 4>,
    // Texel of the atlas where this pack begins.
    origin: vec3u,
    n_beams: u32,
    corners: vec3u,
    k: f32,
}

@group(0) @binding(0) var<uniform> params: WidenGatherParams;
@group(1) @binding(0) var linear_clamp: sampler;
// Of straight beams without shadows.
@group(1) @binding(1) var tau: texture_3d<f32>;
@group(1) @binding(2) var star_0: texture_3d<f32>;
@group(1) @binding(3) var star_1: texture_3d<f32>;
@group(1) @binding(4) var star_2: texture_3d<f32>;
@group(1) @binding(5) var star_3: texture_3d<f32>;
@group(1) @binding(6) var straight_0: texture_3d<f32>;
@group(1) @binding(7) var straight_1: texture_3d<f32>;
@group(1) @binding(8) var straight_2: texture_3d<f32>;
@group(1) @binding(9) var straight_3: texture_3d<f32>;
@group(2) @binding(0) var widened: texture_storage_3d<{format}, write>;

// Light that is less is none.
const LEAST_LIGHT: f32 = 1e-30;

fn depth_of(star: texture_3d<f32>, straight: texture_3d<f32>, grid: Aligned, id: vec3u, tau_n: f32) -> f32 {
    let p = aligned_from_index(grid, vec3f(id) - 0.5);
    // Faces stand half a cell before the centers of cells.
    let at = (p + vec3f(0.5, 0.5, 1.0)) / vec3f(textureDimensions(star));
    let spread = textureSampleLevel(star, linear_clamp, at, 0.0).x;
    let unspread = textureSampleLevel(straight, linear_clamp, at, 0.0).x;
    if spread < LEAST_LIGHT {
        return HIDDEN;
    }
    // What is known of the straight beam is finer than this grid; from here comes how much the widening and
    // the shadows change.
    return select(-log(spread), params.k * tau_n - log(spread / max(unspread, LEAST_LIGHT)), unspread > LEAST_LIGHT) / params.k;
}

@compute @workgroup_size(8, 8, 1)
fn principal_propagation_widen_gather(@builtin(global_invocation_id) id: vec3u) {
    if any(id >= params.corners) {
        return;
    }
    let depths = textureLoad(tau, params.origin + id, 0);
    var found = vec4f(0.0);
    found.x = depth_of(star_0, straight_0, params.grids[0], id, depths.x);
    if params.n_beams > 1u {
        found.y = depth_of(star_1, straight_1, params.grids[1], id, depths.y);
    }
    if params.n_beams > 2u {
        found.z = depth_of(star_2, straight_2, params.grids[2], id, depths.z);
    }
    if params.n_beams > 3u {
        found.w = depth_of(star_3, straight_3, params.grids[3], id, depths.w);
    }
    for (var n = 0u; n < 4u; n += 1u) {
        found[n] = stored_tau(found[n]);
    }
    textureStore(widened, params.origin + id, found);
}
