// A thread: what beams and emission give to one cell, Q0 and Q1 [W/m3] of each channel (DESIGN 6.3).

#import "isotropic_residual/common.wgsl"
#import "isotropic_residual/cell_mean.wgsl"
#import "lib/beam.wgsl"
#import "lib/streams.wgsl"
#import "lib/phase.wgsl"

struct SourceParams {
    level: Level,
    n_beams: u32,
    packs_per_column: u32,
    // Layer of cells where the threads begin.
    first: u32,
    pad: u32,
}

@group(0) @binding(0) var<uniform> params: SourceParams;
@group(1) @binding(0) var sigma_t: texture_3d<f32>;
@group(1) @binding(1) var tau: texture_3d<f32>;
@group(1) @binding(2) var<storage, read> beams: array<Beam>;
@group(1) @binding(3) var emission: texture_3d<f32>;
@group(1) @binding(4) var ahead: texture_3d<f32>;
@group(2) @binding(0) var sources: texture_storage_3d<rgba32float, write>;

// Whether light goes to and fro along parallel beams (optics/backward.rs); nothing is scaled then, so that g* of the
// level is g and sigma_s* / sigma_t the albedo.
const RETURNS: bool = {returns};
const HAS_EMISSION: bool = {emission};
// Whether k is the same in all channels.
const IS_GREY: bool = {grey};

// Mean of 1 / r^2 [1/m2] over the cell at `cell`, for a light at `position`, in index space.
fn mean_inverse_square(cell: vec3f, position: vec3f, cell_m: f32) -> f32 {
    let line = cell - position;
    if dot(line, line) >= 1.0 {
        return 1.0 / (dot(line, line) * cell_m * cell_m);
    }
    // 8^3 points; within e = 0.62 of a sub-cell the mean over that ball, 3 / e^2.
    let near = 0.62 / 8.0;
    var sum = 0.0;
    for (var n = 0u; n < 512u; n += 1u) {
        let offset = (vec3f(vec3u(n & 7u, (n >> 3u) & 7u, n >> 6u)) + 0.5) / 8.0 - 0.5;
        let r = line + offset;
        let r2 = dot(r, r);
        sum += select(1.0 / max(r2, near * near), 3.0 / (near * near), r2 < near * near);
    }
    return sum / (512.0 * cell_m * cell_m);
}

// Mean of the depths at the corners that light reaches.
fn mean_depth(depths: array<f32, 8>) -> f32 {
    var sum = vec2f(0.0);
    for (var n = 0u; n < 8u; n += 1u) {
        sum += select(vec2f(depths[n], 1.0), vec2f(0.0), is_hidden(depths[n]));
    }
    return sum.x / max(sum.y, 1.0);
}

@compute @workgroup_size(8, 8, 1)
fn isotropic_residual_sources(@builtin(global_invocation_id) thread: vec3u) {
    let level = params.level;
    let id = thread + vec3u(0u, 0u, params.first);
    if any(id >= level.dims) {
        return;
    }
    let extinction = textureLoad(sigma_t, id, 0).x;
    var totals: array<vec4f, 3>;
    if extinction > 0.0 {
        let corners = level.dims + 1u;
        for (var first = 0u; first < params.n_beams; first += PACK) {
            let origin = pack_origin(first / PACK, corners, params.packs_per_column) + id;
            var depths: array<vec4f, 8>;
            var depths_ahead: array<vec4f, 8>;
            for (var n = 0u; n < 8u; n += 1u) {
                let corner = origin + vec3u(n & 1u, (n >> 1u) & 1u, n >> 2u);
                depths[n] = textureLoad(tau, corner, 0);
                if RETURNS {
                    depths_ahead[n] = textureLoad(ahead, corner, 0);
                }
            }
            for (var n = 0u; n < min(PACK, params.n_beams - first); n += 1u) {
                let beam = beams[first + n];
                var one: array<f32, 8>;
                for (var m = 0u; m < 8u; m += 1u) {
                    one[m] = depths[m][n];
                }
                var direction = beam.place.xyz;
                var axis = largest_axis(direction);
                if RETURNS && beam.place.w <= 0.0 {
                    var one_ahead: array<f32, 8>;
                    for (var m = 0u; m < 8u; m += 1u) {
                        one_ahead[m] = depths_ahead[m][n];
                    }
                    let g = level.g_star;
                    let passed = mean_depth(one);
                    let before = mean_depth(one_ahead);
                    for (var c = 0u; c < level.n_channels; c += 1u) {
                        let both = streams(g, level.channels[c].scatter, passed, before);
                        let leaves = (1.0 - g) * (1.0 + g) * cell_mean(one, both.kappa, axis);
                        let along = g / (1.0 - g) * beam.power.w * (both.on - both.back) * direction;
                        totals[c] += beam.power[c] * leaves * vec4f(both.on + both.back, along);
                    }
                    continue;
                }
                var spreading = 1.0;
                if beam.place.w > 0.0 {
                    let line = vec3f(id) - beam.place.xyz;
                    direction = line / max(length(line), 1e-6);
                    axis = largest_axis(0.5 * vec3f(level.dims) - 0.5 - beam.place.xyz);
                    spreading = emission_along(beam, direction) * mean_inverse_square(vec3f(id), beam.place.xyz, level.cell_m);
                }
                let travel = vec4f(1.0, level.g_star * beam.power.w * direction);
                let first_mean = cell_mean(one, level.channels[0].k, axis);
                for (var c = 0u; c < level.n_channels; c += 1u) {
                    var mean = first_mean;
                    if !IS_GREY {
                        mean = cell_mean(one, level.channels[c].k, axis);
                    }
                    totals[c] += beam.power[c] * spreading * mean * travel;
                }
            }
        }
    }
    var eps = vec4f(0.0);
    if HAS_EMISSION {
        eps = textureLoad(emission, id, 0);
    }
    for (var c = 0u; c < level.n_channels; c += 1u) {
        var total = extinction * level.channels[c].scatter * totals[c];
        // Into all directions alike, in void too.
        total.x += FOUR_PI * eps[c];
        textureStore(sources, vec3u(id.xy, id.z + c * level.dims.z), total);
    }
}
