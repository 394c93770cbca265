// A thread: phi and F [W/m2] in one cell of what comes straight from surfaces, from 32 directions, all channels,
// less the ambient light from behind them: the solver lets that in everywhere.

#import "isotropic_residual/bounce.wgsl"
#import "lib/block.wgsl"
#import "lib/surface_light.wgsl"

@group(0) @binding(0) var<uniform> params: BounceParams;
@group(1) @binding(0) var sigma_t: texture_3d<f32>;
@group(1) @binding(1) var linear_clamp: sampler;
@group(1) @binding(2) var blocks: texture_3d<f32>;
@group(1) @binding(3) var<storage, read> surface_nodes: array<SurfaceNode>;
@group(1) @binding(4) var<storage, read> surface_triangles: array<SurfaceTriangle>;
@group(1) @binding(5) var<storage, read> surface_corners: array<vec4u>;
@group(1) @binding(6) var<storage, read> surface_light: array<vec4f>;
@group(2) @binding(0) var uncollided: texture_storage_3d<rgba32float, write>;

const N_DIRECTIONS: u32 = 32u;
const WEIGHT: f32 = 0.39269908169872; // 4 pi / 32

// Whether there is matter within `reach` of a point along each axis, or in a block that this meets.
fn is_near_matter(p: vec3f, reach: f32) -> bool {
    let last = vec3i(textureDimensions(blocks)) - 1;
    let low = clamp(vec3i(floor((p + 0.5 - reach) / f32(BLOCK))), vec3i(0), last);
    let high = clamp(vec3i(floor((p + 0.5 + reach) / f32(BLOCK))), vec3i(0), last);
    let n = high - low + 1;
    for (var idx = 0; idx < n.x * n.y * n.z; idx += 1) {
        let block = low + vec3i(idx % n.x, (idx / n.x) % n.y, idx / (n.x * n.y));
        if textureLoad(blocks, block, 0).x > 0.0 {
            return true;
        }
    }
    return false;
}

@compute @workgroup_size(8, 8, 1)
fn isotropic_residual_uncollided(@builtin(global_invocation_id) id: vec3u) {
    let level = params.level;
    let layer = level.dims / params.coarser;
    if any(id >= layer) {
        return;
    }
    let p = (vec3f(id) + 0.5) * f32(params.coarser) - 0.5;
    let has_ambient = level.channels[0].inflow + level.channels[1].inflow + level.channels[2].inflow > 0.0;
    var sums: array<vec4f, 3>;
    // What is not near matter nothing reads: by linear interpolation a cell reaches its neighbors.
    let n_directions = select(0u, N_DIRECTIONS, is_near_matter(p, f32(params.coarser)));
    for (var n = 0u; n < n_directions; n += 1u) {
        // Evenly along z, the golden angle apart.
        let z = 1.0 - (2.0 * f32(n) + 1.0) / f32(N_DIRECTIONS);
        let angle = 2.39996323 * f32(n);
        let towards = vec3f(sqrt(1.0 - z * z) * vec2f(cos(angle), sin(angle)), z);
        let hit = nearest_surface(p, towards, 1e30);
        if hit.triangle != NO_SURFACE {
            let at = p + hit.t * towards;
            let radiance = returned_radiance(hit.triangle, at, towards);
            let tau = walk_past(sigma_t, linear_clamp, blocks, params.shape, level.cell_m, p, towards, hit.t);
            var beyond = 0.0;
            if has_ambient {
                beyond = walk_past(sigma_t, linear_clamp, blocks, params.shape, level.cell_m, at, towards, 1e30);
            }
            for (var c = 0u; c < level.n_channels; c += 1u) {
                let channel = level.channels[c];
                let hidden = channel.inflow * exp(-channel.k * beyond);
                sums[c] += WEIGHT * (radiance[c] - hidden) * exp(-channel.k * tau) * vec4f(1.0, -towards);
            }
        }
    }
    for (var c = 0u; c < level.n_channels; c += 1u) {
        textureStore(uncollided, id + vec3u(0u, 0u, c * layer.z), sums[c]);
    }
}
