// A thread: the irradiance [W/m2] on one side of a point of a surface, from beams through the medium and past
// surfaces, and from some directions: the medium's own light, surfaces, ambient light.

#import "isotropic_residual/bounce.wgsl"
#import "lib/beam.wgsl"
#import "lib/block.wgsl"
#import "lib/lobe.wgsl"
#import "lib/surface_beam.wgsl"
#import "lib/surface_light.wgsl"
#import "lib/transmittance.wgsl"

struct SurfacePoint {
    // In index space.
    p: vec3f,
    triangle: u32,
}

@group(0) @binding(0) var<uniform> params: BounceParams;
@group(1) @binding(0) var sigma_t: texture_3d<f32>;
@group(1) @binding(1) var linear_clamp: sampler;
@group(1) @binding(2) var blocks: texture_3d<f32>;
@group(1) @binding(3) var scattered: texture_3d<f32>;
@group(1) @binding(4) var<storage, read> surface_nodes: array<SurfaceNode>;
@group(1) @binding(5) var<storage, read> surface_triangles: array<SurfaceTriangle>;
@group(1) @binding(6) var<storage, read> points: array<SurfacePoint>;
@group(1) @binding(7) var<storage, read> surface_corners: array<vec4u>;
@group(1) @binding(8) var<storage, read> surface_light: array<vec4f>;
@group(1) @binding(9) var<storage, read> beams: array<Beam>;
@group(2) @binding(0) var<storage, read_write> irradiances: array<vec4f>;

const N_DIRECTIONS: u32 = {directions}u;
const N_CHANNELS: u32 = {channels}u;
const FAR: f32 = 1e30;
// Where less than this is left of a ray it ends.
const OPAQUE: f32 = 1e-4;
// Whether beams count whose light the camera adds point by point.
const HAS_NARROW: bool = {narrow};
// Threads along x of one dispatch.
const ROW: u32 = 4194240u;

// Irradiance of one beam on a side, per channel.
fn from_beam(beam: Beam, p: vec3f, normal: vec3f) -> vec3f {
    let level = params.level;
    let found = arrival(beam, true, sigma_t, linear_clamp, params.shape, level.cell_m, p, normal);
    var k = vec3f(0.0);
    for (var c = 0u; c < N_CHANNELS; c += 1u) {
        k[c] = level.channels[c].k;
    }
    return found.share * beam.power.xyz * exp(-k * found.tau);
}

// Radiance that arrives from `direction`, per channel.
fn arriving(p: vec3f, direction: vec3f) -> vec3f {
    let level = params.level;
    let hit = nearest_surface(p, direction, FAR);
    let span = ray_box(p, direction, vec3f(0.0), vec3f(level.dims) - 1.0);
    let way = max(0.0, min(span.y, hit.t) - span.x);
    let n_steps = ceil(way);
    let dt = way / max(n_steps, 1.0);
    let length_m = dt * level.cell_m;
    var radiance = vec3f(0.0);
    var through = vec3f(1.0);
    for (var n = 0.0; n < n_steps; n += 1.0) {
        var at = p;
        var extinction_here = 0.0;
        // On to the next matter, in a loop of its own: a void step then costs little.
        for (; n < n_steps; n += 1.0) {
            at = p + (span.x + (n + 0.5) * dt) * direction;
            extinction_here = extinction(sigma_t, linear_clamp, at);
            if extinction_here > 0.0 {
                break;
            }
            n = max(n, floor((empty_until(blocks, p, direction, at) - span.x) / dt - 0.5));
        }
        if n >= n_steps {
            break;
        }
        for (var c = 0u; c < N_CHANNELS; c += 1u) {
            let depth = level.channels[c].k * extinction_here * length_m;
            let source = layered(scattered, linear_clamp, N_CHANNELS, c, at);
            let lobe = lobe_from_moments(source.x, source.yzw);
            let shape = 1.0 - dot(lobe.yzw, direction);
            radiance[c] += through[c] * mean_transmittance(depth) * length_m * lobe.x * shape * shape;
            through[c] *= exp(-depth);
        }
        // Channels that are not solved have no say.
        through = select(through.xxx, through, N_CHANNELS == 3u);
        if max(through.x, max(through.y, through.z)) < OPAQUE {
            break;
        }
    }
    var beyond = vec3f(level.channels[0].inflow, level.channels[1].inflow, level.channels[2].inflow);
    if hit.triangle != NO_SURFACE {
        beyond = returned_radiance(hit.triangle, p + hit.t * direction, direction);
    }
    return radiance + through * beyond;
}

@compute @workgroup_size(64, 1, 1)
fn isotropic_residual_surface_light(@builtin(global_invocation_id) id: vec3u) {
    // Beyond 65,535 groups along x, threads stand along y.
    let idx = id.x + ROW * id.y;
    if idx >= 2u * params.n_points {
        return;
    }
    let lit = points[idx / 2u];
    let front = front_normal(lit.triangle);
    let normal = select(front, -front, idx % 2u == 1u);
    var irradiance = vec3f(0.0);
    for (var n = 0u; n < params.n_beams; n += 1u) {
        if HAS_NARROW || !is_narrow(beams[n]) {
            irradiance += from_beam(beams[n], lit.p, normal);
        }
    }
    let across = normalize(select(vec3f(0.0, -normal.z, normal.y), vec3f(-normal.y, normal.x, 0.0), abs(normal.z) < 0.7));
    let along = cross(normal, across);
    var sum = vec3f(0.0);
    for (var n = 0u; n < N_DIRECTIONS; n += 1u) {
        // By the cosine: evenly over the disk below the hemisphere, the golden angle apart.
        let share = (f32(n) + 0.5) / f32(N_DIRECTIONS);
        let angle = 2.39996323 * f32(n);
        let flat_part = sqrt(share) * vec2f(cos(angle), sin(angle));
        sum += arriving(lit.p, flat_part.x * across + flat_part.y * along + sqrt(1.0 - share) * normal);
    }
    irradiances[idx] = vec4f(irradiance + sum * (PI / f32(N_DIRECTIONS)), 0.0);
}
