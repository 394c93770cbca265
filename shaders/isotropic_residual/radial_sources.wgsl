// A thread: what point lights with grids of their own give to one cell, Q0 and Q1 [W/m3] in all channels
// (DESIGN 6.7): of lights outside by the corners of the cell, of those inside by 2^3 samples of it, 16^3 near them.

#import "isotropic_residual/common.wgsl"
#import "isotropic_residual/cell_mean.wgsl"
#import "lib/beam.wgsl"
#import "lib/radial_depth.wgsl"

struct RadialSourceParams {
    level: Level,
    shape: Shape,
    // The first of the beams that have grids, and their number.
    first: u32,
    n_lights: u32,
    // 1: lights inside of the medium alone, 0: the others.
    inside: u32,
    pad: u32,
}

@group(0) @binding(0) var<uniform> params: RadialSourceParams;
@group(1) @binding(0) var sigma_t: texture_3d<f32>;
@group(1) @binding(1) var linear_clamp: sampler;
@group(1) @binding(2) var radial: texture_3d<f32>;
@group(1) @binding(3) var<storage, read> radial_lights: array<RadialLight>;
@group(1) @binding(4) var<storage, read> beams: array<Beam>;
@group(2) @binding(0) var sources: texture_storage_3d<rgba32float, write>;

const HAS_SHADOWS: bool = {shadows};
// So near to a light [cells] a cell has 16^3 samples, further away 2^3.
const NEAR: f32 = 2.0;
// Radius of the ball that has the volume of a cube, over the cube's edge.
const BALL_PER_EDGE: f32 = 0.62;

struct Sums {
    of_channel: array<vec4f, 3>,
}

// Mean of E and of its first moment over a cell, by samples, per channel.
fn sampled(beam: Beam, light: RadialLight, cell: vec3f, extinction: f32) -> Sums {
    let level = params.level;
    let position = beam.place.xyz;
    let to_cell = cell - position;
    let n = select(2u, 16u, dot(to_cell, to_cell) < NEAR * NEAR);
    let near = BALL_PER_EDGE / f32(n);
    let weight = 1.0 / (f32(n * n * n) * level.cell_m * level.cell_m);
    var sums: Sums;
    for (var idx = 0u; idx < n * n * n; idx += 1u) {
        let offset = (vec3f(vec3u(idx % n, idx / n % n, idx / (n * n))) + 0.5) / f32(n) - 0.5;
        let line = to_cell + offset;
        let r = length(line);
        let travel = line / max(r, 1e-6);
        let found = radial_depth(light, linear_clamp, params.shape, level.cell_m, HAS_SHADOWS, position, line, r);
        // Within the ball that has the volume of the sample's part its mean: of r^-2 exp(-k tau), tau = sigma_t r.
        let is_near = r < near;
        let falloff = select(1.0 / max(r * r, near * near), 3.0 / (near * near), is_near);
        // Around the light itself half of the ball is before a surface, by the mean of the cosine.
        let along = select(emission_along(beam, travel), 1.0, is_near);
        for (var c = 0u; c < level.n_channels; c += 1u) {
            let k = level.channels[c].k;
            let through = select(exp(-k * found.tau), mean_transmittance(k * extinction * near * level.cell_m), is_near);
            let e = weight * falloff * along * found.share * through;
            sums.of_channel[c] += e * vec4f(1.0, select(travel, vec3f(0.0), is_near));
        }
    }
    return sums;
}

// The same from the corners of the cell: means along edges are what the beam loses, however thick the cell is.
fn from_corners(beam: Beam, light: RadialLight, cell: vec3f) -> Sums {
    let level = params.level;
    let position = beam.place.xyz;
    let axis = largest_axis(0.5 * vec3f(level.dims) - 0.5 - position);
    var tau: array<f32, 8>;
    for (var n = 0u; n < 8u; n += 1u) {
        let line = cell + vec3f(vec3u(n & 1u, (n >> 1u) & 1u, n >> 2u)) - 0.5 - position;
        let found = radial_depth(light, linear_clamp, params.shape, level.cell_m, HAS_SHADOWS, position, line, length(line));
        tau[n] = select(HIDDEN, found.tau, found.share >= 0.5);
    }
    let line = cell - position;
    let r2 = max(dot(line, line), 1e-6);
    let travel = line * inverseSqrt(r2);
    let spreading = emission_along(beam, travel) / (r2 * level.cell_m * level.cell_m);
    var sums: Sums;
    for (var c = 0u; c < level.n_channels; c += 1u) {
        sums.of_channel[c] = spreading * cell_mean(tau, level.channels[c].k, axis) * vec4f(1.0, travel);
    }
    return sums;
}

@compute @workgroup_size(8, 8, 1)
fn isotropic_residual_radial_sources(@builtin(global_invocation_id) id: vec3u) {
    let level = params.level;
    if any(id >= level.dims) {
        return;
    }
    let extinction = textureLoad(sigma_t, id, 0).x;
    var total: Sums;
    for (var n = 0u; extinction > 0.0 && n < params.n_lights; n += 1u) {
        let light = radial_lights[n];
        let beam = beams[params.first + n];
        if (light.axis.w == 1.0) != (params.inside == 1u) {
            continue;
        }
        var mean: Sums;
        if params.inside == 1u {
            mean = sampled(beam, light, vec3f(id), extinction);
        } else {
            mean = from_corners(beam, light, vec3f(id));
        }
        for (var c = 0u; c < level.n_channels; c += 1u) {
            total.of_channel[c] += beam.power[c] * mean.of_channel[c];
        }
    }
    for (var c = 0u; c < level.n_channels; c += 1u) {
        let scattered = extinction * level.channels[c].scatter * total.of_channel[c];
        textureStore(sources, id + vec3u(0u, 0u, c * level.dims.z), vec4f(scattered.x, level.g_star * scattered.yzw));
    }
}
