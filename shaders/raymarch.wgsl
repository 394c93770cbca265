// A thread: one pixel, marched through the medium from the camera (DESIGN 6.5). Extinction along the ray
// is sigma_t* = k sigma_t; light at a sample is single scattering, what the forward peak adds, and the
// residual lobe. Extinction is sampled in every step, light once in two: it varies less, and costs more.
// Layers are kept apart. Everything is in index space; angles are those of the world, since the map between
// them is a rotation and one scale.

#import "lib/spectrum_{channels}.wgsl"
#import "lib/walk.wgsl"
#import "lib/view.wgsl"
#import "lib/block.wgsl"
#import "lib/beam.wgsl"
#import "lib/layered.wgsl"
#import "lib/lobe.wgsl"
#import "lib/emission.wgsl"
#import "raymarch/channels_{channels}.wgsl"
#import "raymarch/residual_{channels}.wgsl"
#import "lib/surface_beam.wgsl"
#import "lib/surface_light.wgsl"
#import "lib/bvh.wgsl"
#import "lib/shadow.wgsl"
#import "lib/radial_depth.wgsl"
#import "raymarch/beams.wgsl"
#import "raymarch/environment.wgsl"
#import "raymarch/surface.wgsl"
#import "raymarch/emission.wgsl"

struct MarchParams {
    shape: Shape,
    eye: vec3f,
    cell_m: f32,
    // The view: lib/view.wgsl.
    forward: vec3f,
    step: f32,
    right: vec3f,
    g: f32,
    up: vec3f,
    g_star: f32,
    k: vec4f,
    albedo: vec4f,
    // sigma_s* / sigma_t.
    scatter: vec4f,
    // Radiance of the constant environment, per channel.
    ambient: vec4f,
    // What the channels are multiplied by in the end: the color of grey light.
    color: vec4f,
    dims: vec3u,
    n_beams: u32,
    packs_per_column: u32,
    width: u32,
    height: u32,
    // First row of this band, rows in it.
    row: u32,
    n_rows: u32,
    // Samples per pixel and axis.
    n_sub: u32,
    // 0: none behind the medium; 1: constant radiance `background`; 2: the map, times `background`.
    backdrop: u32,
    rotate_y: f32,
    background: vec4f,
    // What the residual's channels are multiplied by to be in the march's.
    residual_color: vec4f,
    // Columns of the rotation from index space to the world.
    world_from_index: mat3x3f,
    // 0: none.
    residual_channels: u32,
    // Beams before this one have depths at corners, others grids of their own.
    n_at_corners: u32,
    pad_1: u32,
    pad_2: u32,
    // Numbers of forward scatterings that the levels of the stack are for.
    stack_x: array<vec4f, 4>,
    // For each level angles in radians that light has turned by after half of the scatterings.
    stack_turns: array<vec4f, 16>,
    heat: Heat,
}

struct Pixel {
    // Radiance and coverage.
    beauty: vec4f,
    // Single scattering, and the mean distance of what is seen [m].
    single: vec4f,
    forward: vec4f,
    residual: vec4f,
    surface: vec4f,
    emission: vec4f,
}

@group(0) @binding(0) var<uniform> params: MarchParams;
@group(1) @binding(0) var sigma_t: texture_3d<f32>;
@group(1) @binding(1) var linear_clamp: sampler;
@group(1) @binding(2) var tau: texture_3d<f32>;
@group(1) @binding(3) var<storage, read> beams: array<Beam>;
@group(1) @binding(4) var moments: texture_3d<f32>;
@group(1) @binding(5) var peak: texture_2d<f32>;
@group(1) @binding(6) var environment: texture_2d<f32>;
@group(1) @binding(7) var linear_around: sampler;
@group(1) @binding(8) var blocks: texture_3d<f32>;
@group(1) @binding(9) var stack: texture_3d<f32>;
@group(1) @binding(10) var<storage, read> surface_nodes: array<SurfaceNode>;
@group(1) @binding(11) var<storage, read> surface_triangles: array<SurfaceTriangle>;
@group(1) @binding(12) var flame: texture_3d<f32>;
@group(1) @binding(13) var temperature: texture_3d<f32>;
@group(1) @binding(14) var blackbodies: texture_2d<f32>;
@group(1) @binding(15) var<storage, read> surface_light: array<vec4f>;
@group(1) @binding(16) var<storage, read> surface_corners: array<vec4u>;
@group(1) @binding(17) var star: texture_3d<f32>;
@group(1) @binding(18) var radial: texture_3d<f32>;
@group(1) @binding(19) var<storage, read> radial_lights: array<RadialLight>;
@group(1) @binding(20) var sums: texture_3d<f32>;
@group(1) @binding(21) var ahead: texture_3d<f32>;
@group(1) @binding(22) var backward: texture_2d<f32>;
@group(2) @binding(0) var<storage, read_write> pixels: array<Pixel>;

// Where less than this is left of a ray it ends.
const OPAQUE: f32 = 1e-5;
// No surface within reach [cells].
const FAR: f32 = 1e30;
const STACK_LEVELS: u32 = 16u;
const STACK_TURNS: u32 = 3u;
// Optical depth of two steps that counts as none: its square, and its product with OPAQUE, are numbers still.
const VOID: f32 = 1e-18;
// Optical depth of a ray whose third power is still a number with all its digits.
const HARDLY_ANY: f32 = 1e-6;

// What this picture has. The rest is left out when the shader is compiled: on a device without real branches
// it would cost as much as what is used.
const HAS_VOXELS: bool = {voxels};
const HAS_POINTS: bool = {points};
const HAS_PEAK: bool = {peak};
const HAS_WINDOW: bool = {window};
const HAS_RESIDUAL: bool = {residual};
const HAS_STACK: bool = {stack};
const HAS_SURFACES: bool = {surfaces};
const HAS_GATHERED: bool = {gathered};
const HAS_SHADOWS: bool = {shadows};
const HAS_RADIAL: bool = {radial};
const HAS_WIDENING: bool = {widening};
// Whether light goes to and fro along parallel beams.
const RETURNS: bool = {returns};
const HAS_EMISSION: bool = {emission};
const HAS_BEAMS: bool = {beams};
// Whether the beams were gathered at corners for this view.
const HAS_SUMS: bool = {sums};
// Whether lobes have a direction; where g is 0 they have none.
const HAS_LOBES: bool = {lobes};
// Whether there are empty blocks to pass.
const SKIPS: bool = {skips};

// A number where it is known when the shader is compiled: what is the same along the ray is then computed once.
fn n_beams() -> u32 {
    return {n_beams};
}

struct Layers {
    single: Spectrum,
    forward: Spectrum,
    residual: Spectrum,
    emission: Spectrum,
    // Optical depth of the whole ray, unscaled.
    tau: f32,
    // Sum of distance times what is absorbed there [cells].
    distance: f32,
    // Integrals over the optical depth, of its powers 0, 1 and 2: of these, and of the distance times these.
    depth_moments: vec3f,
    distance_moments: vec3f,
}

// The residual lobe's radiance per unit of sigma_s*, towards the camera.
fn residual_radiance(p: vec3f, view: vec3f, c: u32) -> f32 {
    let m = layered(moments, linear_clamp, params.residual_channels, c, p);
    let lobe = lobe_from_moments(m.x, select(vec3f(0.0), params.g_star * m.yzw, HAS_LOBES));
    let shape = 1.0 - dot(lobe.yzw, view);
    return lobe.x * shape * shape;
}

// A ray from the eye, no further than `until` cells.
fn march(direction: vec3f, until: f32) -> Layers {
    var layers: Layers;
    var span = ray_shape(params.shape, params.eye, direction);
    span.y = min(span.y, until);
    if span.x >= span.y {
        return layers;
    }
    let k = spectrum(params.k);
    let scatter = spectrum(params.scatter);
    let n_pairs = ceil((span.y - span.x) / (2.0 * params.step));
    let dt = (span.y - span.x) / (2.0 * n_pairs);
    let length_m = dt * params.cell_m;
    // What is left of the ray: of light that nothing deflects, and of light that the forward peak may.
    var sharp = 1.0;
    var through = Spectrum(1.0);
    for (var n = 0.0; n < n_pairs; n += 1.0) {
        var t = vec2f(0.0);
        var step_tau = vec2f(params.shape.sigma_t * length_m);
        // On to the next matter, in a loop of its own: a void step then costs nothing of what a lit one does.
        for (; n < n_pairs; n += 1.0) {
            t = span.x + (2.0 * n + vec2f(0.5, 1.5)) * dt;
            if !HAS_VOXELS {
                break;
            }
            let far = params.eye + t.y * direction;
            step_tau.x = length_m * extinction(sigma_t, linear_clamp, params.eye + t.x * direction);
            step_tau.y = length_m * extinction(sigma_t, linear_clamp, far);
            if step_tau.x + step_tau.y > VOID {
                break;
            }
            if HAS_EMISSION {
                layers.emission += through * length_m * (glow(params.eye + t.x * direction) + glow(far));
            }
            if SKIPS {
                n = max(n, floor((empty_until(blocks, params.eye, direction, far) - span.x) / (2.0 * dt) - 0.75));
            }
        }
        if n >= n_pairs {
            break;
        }

        let kept_near = exp(-k * step_tau.x);
        let kept_far = exp(-k * step_tau.y);
        let seen_near = through * per_channel_mean(k * step_tau.x, kept_near);
        let seen_far = through * kept_near * per_channel_mean(k * step_tau.y, kept_far);
        let near = seen_near * step_tau.x;
        let far = seen_far * step_tau.y;
        let half_way = sharp * exp(-step_tau.x);
        let end = half_way * exp(-step_tau.y);
        let seen = vec2f(largest(near), largest(far)) / (largest(near) + largest(far));
        let p = params.eye + dot(seen, t) * direction;
        // Optical depths at the middle of the steps: at their starts the light would be up to 16 % too bright.
        let tau_c = layers.tau + dot(seen, vec2f(0.5 * step_tau.x, step_tau.x + 0.5 * step_tau.y));
        let segment = Segment(sharp - end, near + far, tau_c, 2.0 * dt);
        if HAS_BEAMS {
            var scattered: Scattered;
            if HAS_SUMS {
                scattered = scatter_sums(segment, p);
            } else {
                scattered = scatter_beams(segment, p, direction);
            }
            layers.single += scattered.single;
            layers.forward += scattered.forward;
        }
        if HAS_RESIDUAL {
            layers.residual += segment.reach * scatter * residual_of(p, direction);
        }
        if HAS_EMISSION {
            let lights = seen_near * glow(params.eye + t.x * direction) + seen_far * glow(params.eye + t.y * direction);
            layers.emission += length_m * lights;
        }
        layers.distance += dot(vec2f(sharp - half_way, half_way - end), t);
        if HAS_STACK {
            let at_near = layers.tau + 0.5 * step_tau.x;
            let at_far = layers.tau + step_tau.x + 0.5 * step_tau.y;
            let near_moments = step_tau.x * vec3f(1.0, at_near, at_near * at_near);
            let far_moments = step_tau.y * vec3f(1.0, at_far, at_far * at_far);
            layers.depth_moments += near_moments + far_moments;
            layers.distance_moments += t.x * near_moments + t.y * far_moments;
        }
        layers.tau += step_tau.x + step_tau.y;
        sharp = end;
        through *= kept_near * kept_far;
        if largest(through) < OPAQUE {
            break;
        }
    }
    return layers;
}

// Where a ray bends: about where a quarter of its matter is behind, the mean of the distance with the weight
// (1 - tau/T)^2; in hardly any matter, in the middle of it.
fn elbow_distance(layers: Layers) -> f32 {
    let total = layers.tau;
    let weights = select(vec3f(total * total, -2.0 * total, 1.0), vec3f(1.0, 0.0, 0.0), total < HARDLY_ANY);
    return dot(weights, layers.distance_moments) / dot(weights, layers.depth_moments);
}

@compute @workgroup_size(8, 8, 1)
fn raymarch(@builtin(global_invocation_id) id: vec3u) {
    if id.x >= params.width || id.y >= params.n_rows {
        return;
    }
    var pixel: Pixel;
    let n = params.n_sub;
    for (var sub = 0u; sub < n * n; sub += 1u) {
        let offset = (vec2f(vec2u(sub % n, sub / n)) + 0.5) / f32(n);
        let at = (vec2f(vec2u(id.x, params.row + id.y)) + offset) / vec2f(f32(params.width), f32(params.height));
        let direction = view_ray(params.forward, params.right, params.up, at);
        var surface = SurfaceHit(FAR, NO_SURFACE);
        if HAS_SURFACES {
            surface = nearest_surface(params.eye, direction, FAR);
        }
        let layers = march(direction, surface.t);
        let sharp = exp(-layers.tau);
        let through = exp(-spectrum(params.k) * layers.tau);
        let color = params.color.xyz;
        var single = color * rgb(layers.single);
        var behind = sharp;
        var distance = layers.distance;
        if surface.triangle == NO_SURFACE {
            let turned = params.world_from_index * direction;
            var forward = color * rgb(layers.forward + (through - sharp) * spectrum(params.ambient));
            if HAS_STACK && layers.tau > 0.0 {
                let elbow = params.eye + elbow_distance(layers) * direction;
                forward += environment_forward(direction, layers.tau, elbow);
                // Where ordinates shine more evenly than the medium scatters the stack takes that back, and what
                // is scattered once is the first that gives. Never more than there is.
                single = max(single + min(forward, vec3f(0.0)), vec3f(0.0));
                forward = max(forward, vec3f(0.0));
            }
            pixel.forward += vec4f(forward, 0.0);
            pixel.beauty += vec4f(forward + sharp * environment_radiance(turned), 0.0);
        } else {
            let reflected = rgb(through) * surface_radiance(surface.triangle, params.eye + surface.t * direction, direction);
            let forward = color * rgb(layers.forward);
            pixel.surface += vec4f(reflected, 0.0);
            pixel.forward += vec4f(forward, 0.0);
            pixel.beauty += vec4f(forward + reflected, 0.0);
            distance += sharp * surface.t;
            behind = 0.0;
        }
        let residual = color * rgb(layers.residual);
        let emission = color * rgb(layers.emission);
        pixel.beauty += vec4f(single + residual + emission, 1.0 - behind);
        pixel.single += vec4f(single, distance * params.cell_m);
        pixel.residual += vec4f(residual, 0.0);
        pixel.emission += vec4f(emission, 0.0);
    }
    let share = 1.0 / f32(n * n);
    pixel.beauty *= share;
    pixel.single *= share;
    pixel.forward *= share;
    pixel.residual *= share;
    pixel.surface *= share;
    pixel.emission *= share;
    // Mean distance of what is seen; 0 where nothing is.
    pixel.single.w = select(0.0, pixel.single.w / max(pixel.beauty.w, 1e-30), pixel.beauty.w > 1e-6);
    pixels[id.y * params.width + id.x] = pixel;
}
