// A thread: the irradiance [W/m2] on one side of a point of a surface, from beams (surface_beams.wgsl) and from some
// directions: the medium's own light, surfaces, ambient light.

#import "isotropic_residual/bounce.wgsl"
#import "isotropic_residual/surface_point.wgsl"
#import "lib/block.wgsl"
#import "lib/lobe.wgsl"
#import "lib/surface_light.wgsl"
#import "lib/transmittance.wgsl"

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
@group(1) @binding(9) var<storage, read> lit_by_beams: array<vec4f>;
@group(2) @binding(0) var<storage, read_write> irradiances: array<vec4f>;

const N_DIRECTIONS: u32 = {directions}u;
// Rays to a flame: more, as it is brighter than all around it and has finer structure.
const N_FLAME: u32 = 2u * N_DIRECTIONS;
const N_CHANNELS: u32 = {channels}u;
const FAR: f32 = 1e30;
// Where less than this is left of a ray it ends.
const OPAQUE: f32 = 1e-4;
// Whether beams count whose light the camera adds point by point.
const HAS_NARROW: bool = {narrow};
// Whether the medium emits.
const GLOWS: bool = {glows};
// Whether sides that got no light at all before, like those inside of things, stay dark.
const SKIPS_DARK: bool = {skips_dark};

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
            let empty = empty_until(blocks, p, direction, at);
            // There may be flame without smoke.
            if GLOWS && empty <= 0.0 {
                break;
            }
            n = max(n, floor((empty - span.x) / dt - 0.5));
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

// From this distance on a ball has rays of its own [radii].
const NEAR_FLAME: f32 = 1.1;

// Irradiance from the cone around `aim` whose cosine is `edge`, by rays that are spread evenly over it.
fn from_flame(p: vec3f, normal: vec3f, aim: vec3f, edge: f32) -> vec3f {
    let across = normalize(select(vec3f(0.0, -aim.z, aim.y), vec3f(-aim.y, aim.x, 0.0), abs(aim.z) < 0.7));
    let along = cross(aim, across);
    var sum = vec3f(0.0);
    for (var n = 0u; n < N_FLAME; n += 1u) {
        let z = 1.0 - (1.0 - edge) * (f32(n) + 0.5) / f32(N_FLAME);
        let angle = 2.39996323 * f32(n);
        let direction = sqrt(max(0.0, 1.0 - z * z)) * (cos(angle) * across + sin(angle) * along) + z * aim;
        let cosine = dot(direction, normal);
        if cosine > 0.0 {
            sum += cosine * arriving(p, direction);
        }
    }
    return sum * (2.0 * PI * (1.0 - edge) / f32(N_FLAME));
}

@compute @workgroup_size(64, 1, 1)
fn isotropic_residual_surface_light(@builtin(global_invocation_id) id: vec3u) {
    let thread = id.x + ROW * id.y;
    if thread >= 2u * params.n_points {
        return;
    }
    // First all fronts, then all backs: rays of neighboring threads then go the same way.
    let is_back = u32(thread >= params.n_points);
    let point = thread - is_back * params.n_points;
    let idx = 2u * point + is_back;
    if SKIPS_DARK && all(surface_light[idx].xyz == vec3f(0.0)) {
        irradiances[idx] = vec4f(0.0);
        return;
    }
    let lit = points[point];
    let front = front_normal(lit.triangle);
    let normal = select(front, -front, is_back == 1u);
    var irradiance = lit_by_beams[4u * point + 2u + is_back].xyz;
    if HAS_NARROW {
        irradiance += lit_by_beams[4u * point + is_back].xyz;
    }
    // A flame is small and bright: where it is seen from outside its ball has rays of its own.
    let to_flame = params.flame.xyz - lit.p;
    let distance = length(to_flame);
    let aims = GLOWS && distance > NEAR_FLAME * params.flame.w && params.flame.w > 0.0;
    let aim = to_flame / max(distance, 1e-30);
    let edge = sqrt(max(0.0, 1.0 - params.flame.w * params.flame.w / max(distance * distance, 1e-30)));
    let across = normalize(select(vec3f(0.0, -normal.z, normal.y), vec3f(-normal.y, normal.x, 0.0), abs(normal.z) < 0.7));
    let along = cross(normal, across);
    var sum = vec3f(0.0);
    for (var n = 0u; n < N_DIRECTIONS; n += 1u) {
        // By the cosine: evenly over the disk below the hemisphere, the golden angle apart.
        let share = (f32(n) + 0.5) / f32(N_DIRECTIONS);
        let angle = 2.39996323 * f32(n);
        let flat_part = sqrt(share) * vec2f(cos(angle), sin(angle));
        let direction = flat_part.x * across + flat_part.y * along + sqrt(1.0 - share) * normal;
        if !aims || dot(direction, aim) < edge {
            sum += arriving(lit.p, direction);
        }
    }
    irradiance += sum * (PI / f32(N_DIRECTIONS));
    if aims {
        irradiance += from_flame(lit.p, normal, aim, edge);
    }
    irradiances[idx] = vec4f(irradiance, 0.0);
}
