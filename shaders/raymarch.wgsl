// A thread: one pixel, marched through the medium from the camera (DESIGN 6.5). Extinction along the ray
// is sigma_t* = k sigma_t; light at a sample is single scattering, what the forward peak adds (table K),
// and the residual lobe. Layers are kept apart. Everything is in index space; angles are those of the
// world, since the map between them is a rotation and one scale.

#import "lib/spectrum_{channels}.wgsl"
#import "lib/walk.wgsl"
#import "lib/block.wgsl"
#import "lib/beam.wgsl"
#import "lib/lobe.wgsl"
#import "lib/transmittance.wgsl"
#import "raymarch/channels_{channels}.wgsl"

struct MarchParams {
    shape: Shape,
    eye: vec3f,
    cell_m: f32,
    // The view vector of a pixel: forward + x right + y up, x and y in -1..=1.
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
    pad_0: u32,
    pad_1: u32,
    pad_2: u32,
}

struct Pixel {
    // Radiance and coverage.
    beauty: vec4f,
    // Single scattering, and the mean distance of what is seen [m].
    single: vec4f,
    forward: vec4f,
    residual: vec4f,
}

@group(0) @binding(0) var<uniform> params: MarchParams;
@group(1) @binding(0) var sigma_t: texture_3d<f32>;
@group(1) @binding(1) var linear_clamp: sampler;
@group(1) @binding(2) var tau: texture_3d<f32>;
@group(1) @binding(3) var<storage, read> beams: array<Beam>;
@group(1) @binding(4) var moments: texture_3d<f32>;
@group(1) @binding(5) var peak: texture_3d<f32>;
@group(1) @binding(6) var environment: texture_2d<f32>;
@group(1) @binding(7) var linear_around: sampler;
@group(1) @binding(8) var blocks: texture_3d<f32>;
@group(2) @binding(0) var<storage, read_write> pixels: array<Pixel>;

// Where less than this is left of a ray it ends.
const OPAQUE: f32 = 1e-5;
// The table of K: columns 255 sqrt(sin(theta/2)), rows 63 sqrt(x/60).
const PEAK_SIZE: vec2f = vec2f(256.0, 64.0);
const PEAK_X_MAX: f32 = 60.0;
// Radius of the ball that has the volume of a cube, over the cube's edge.
const BALL_PER_EDGE: f32 = 0.62;

struct Layers {
    single: Spectrum,
    forward: Spectrum,
    residual: Spectrum,
    // Optical depth of the whole ray, unscaled.
    tau: f32,
    // Sum of distance times what is absorbed there [cells].
    distance: f32,
}

// The environment's map towards a direction of the world.
fn environment_radiance(direction: vec3f) -> vec3f {
    let longitude = atan2(direction.x, direction.z) - params.rotate_y;
    let u = 0.5 - longitude / (2.0 * PI);
    let v = acos(clamp(direction.y, -1.0, 1.0)) / PI;
    return textureSampleLevel(environment, linear_around, vec2f(u, v), 0.0).xyz;
}

// K of one channel at x = albedo (tau_n + tau_c) and this column.
fn forward_peak(x: f32, column: f32) -> f32 {
    let row = sqrt(clamp(x, 0.0, PEAK_X_MAX) / PEAK_X_MAX) * (PEAK_SIZE.y - 1.0);
    let at = (vec2f(column, row) + 0.5) / PEAK_SIZE;
    return textureSampleLevel(peak, linear_clamp, vec3f(at, 0.5), 0.0).x;
}

// The residual lobe's radiance per unit of sigma_s*, towards the camera.
fn residual_radiance(p: vec3f, view: vec3f, c: u32) -> f32 {
    let size = vec3f(textureDimensions(moments));
    let layer = f32(params.dims.z);
    var at = p + 0.5;
    at.z = clamp(at.z, 0.5, layer - 0.5) + f32(c) * layer;
    let m = textureSampleLevel(moments, linear_clamp, at / size, 0.0);
    let lobe = lobe_from_moments(m.x, params.g_star * m.yzw);
    let shape = 1.0 - dot(lobe.yzw, view);
    return lobe.x * shape * shape;
}

fn march(direction: vec3f) -> Layers {
    var layers: Layers;
    let span = ray_shape(params.shape, params.eye, direction);
    if span.x >= span.y {
        return layers;
    }
    let k = spectrum(params.k);
    let albedo = spectrum(params.albedo);
    let scatter = spectrum(params.scatter);
    let n_steps = ceil((span.y - span.x) / params.step);
    let dt = (span.y - span.x) / n_steps;
    let length_m = dt * params.cell_m;
    let near2 = BALL_PER_EDGE * BALL_PER_EDGE * dt * dt;
    let tau_size = vec3f(textureDimensions(tau));
    let corners = params.dims + 1u;
    // What is left of the ray: of light that nothing deflects, and of light that the forward peak may.
    var sharp = 1.0;
    var through = Spectrum(1.0);
    for (var n = 0.0; n < n_steps; n += 1.0) {
        let t = span.x + (n + 0.5) * dt;
        let p = params.eye + t * direction;
        var s = params.shape.sigma_t;
        if params.shape.kind == VOXELS {
            s = extinction(sigma_t, linear_clamp, p);
        }
        if s <= 0.0 {
            let ahead = floor((empty_until(blocks, params.eye, direction, p) - span.x) / dt - 0.5);
            n = max(n, ahead);
            continue;
        }
        let step_tau = s * length_m;
        // The middle of the step: its start would be up to 16 % too bright.
        let tau_c = layers.tau + 0.5 * step_tau;
        let kept = exp(-k * step_tau);
        let reach_s = through * per_channel_mean(k * step_tau, kept) * step_tau;
        let seen = sharp * exp(-step_tau);
        layers.distance += (sharp - seen) * t;
        sharp = seen;
        through *= kept;
        layers.tau += step_tau;

        var single = Spectrum(0.0);
        var forward = Spectrum(0.0);
        for (var first = 0u; first < params.n_beams; first += PACK) {
            let origin = vec3f(pack_origin(first / PACK, corners, params.packs_per_column));
            let inside = clamp(p + 1.0, vec3f(0.5), vec3f(corners) - 0.5);
            let depths = textureSampleLevel(tau, linear_clamp, (origin + inside) / tau_size, 0.0);
            for (var m = 0u; m < min(PACK, params.n_beams - first); m += 1u) {
                let beam = beams[first + m];
                var travel = beam.place.xyz;
                var power = spectrum(beam.power);
                var reach = 1e30;
                if beam.place.w > 0.0 {
                    let line = p - beam.place.xyz;
                    let r2 = dot(line, line);
                    travel = line * inverseSqrt(max(r2, 1e-12));
                    reach = sqrt(r2);
                    // Within the ball that has the volume of a cube of a step the ball's mean, 3 / radius^2.
                    let falloff = select(1.0 / max(r2, near2), 3.0 / near2, r2 < near2);
                    power = power * (falloff / (params.cell_m * params.cell_m));
                }
                var tau_n = depths[m];
                if params.shape.kind != VOXELS {
                    let way = ray_shape(params.shape, p, -travel);
                    tau_n = s * max(0.0, min(way.y, reach) - way.x) * params.cell_m;
                }
                let mu = clamp(-dot(travel, direction), -1.0, 1.0);
                let reduced = exp(-k * tau_n);
                let unscattered = min(exp(k * tau_c - (tau_n + tau_c)), reduced);
                single += power * unscattered * henyey_greenstein(mu, params.g * beam.power.w);
                if params.g > 0.0 {
                    let column = (PEAK_SIZE.x - 1.0) * sqrt(sqrt(0.5 - 0.5 * mu));
                    forward += power * (reduced - unscattered) * peak_of(albedo * (tau_n + tau_c), column);
                }
            }
        }
        layers.single += reach_s * albedo * single;
        layers.forward += reach_s * albedo * forward;
        if params.residual_channels > 0u {
            layers.residual += reach_s * scatter * residual_of(p, direction);
        }
        if largest(through) < OPAQUE {
            break;
        }
    }
    return layers;
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
        let direction = normalize(params.forward + (2.0 * at.x - 1.0) * params.right + (1.0 - 2.0 * at.y) * params.up);
        let layers = march(direction);
        let sharp = exp(-layers.tau);
        let through = exp(-spectrum(params.k) * layers.tau);
        let lit = layers.single + layers.forward + layers.residual + (through - sharp) * spectrum(params.ambient);
        var behind = vec3f(0.0);
        if params.backdrop == 1u {
            behind = params.background.xyz;
        } else if params.backdrop == 2u {
            behind = params.background.xyz * environment_radiance(params.world_from_index * direction);
        }
        let color = params.color.xyz;
        pixel.beauty += vec4f(color * rgb(lit) + sharp * behind, 1.0 - sharp);
        pixel.single += vec4f(color * rgb(layers.single), layers.distance * params.cell_m);
        pixel.forward += vec4f(color * rgb(layers.forward + (through - sharp) * spectrum(params.ambient)), 0.0);
        pixel.residual += vec4f(color * rgb(layers.residual), 0.0);
    }
    let share = 1.0 / f32(n * n);
    pixel.beauty *= share;
    pixel.single *= share;
    pixel.forward *= share;
    pixel.residual *= share;
    // Mean distance of what is seen; 0 where nothing is.
    pixel.single.w = select(0.0, pixel.single.w / max(pixel.beauty.w, 1e-30), pixel.beauty.w > 1e-6);
    pixels[id.y * params.width + id.x] = pixel;
}
