// A thread: one pixel of a field's colors and opacities, by emission and absorption along its ray.

#import "lib/ray_box.wgsl"

struct TransferParams {
    // The eye and the view's axes in index space; the axes' lengths are in voxels a meter.
    eye: vec3f,
    // Longest step in voxels.
    step: f32,
    forward: vec3f,
    // Extinction of opacity 1 [1/m].
    extinction: f32,
    right: vec3f,
    n_points: u32,
    up: vec3f,
    width: u32,
    // Half extents of the view at distance 1.
    tan: vec2f,
    height: u32,
    row: u32,
    dims: vec3u,
    n_rows: u32,
    background: vec3f,
    pad: u32,
}

// A control point; values rise.
struct Point {
    color: vec3f,
    value: f32,
    opacity: f32,
    pad_0: f32,
    pad_1: f32,
    pad_2: f32,
}

@group(0) @binding(0) var<uniform> params: TransferParams;
// With a border of one voxel of what stands outside.
@group(1) @binding(0) var voxels: texture_3d<f32>;
@group(1) @binding(1) var linear_clamp: sampler;
@group(1) @binding(2) var<storage, read> points: array<Point>;
@group(2) @binding(0) var<storage, read_write> pixels: array<vec4f>;

// Color and opacity of a value, linear between points, beyond the ends those of the end.
fn look_up(value: f32) -> vec4f {
    var low = 0u;
    var high = params.n_points;
    // The first point above the value.
    while low < high {
        let middle = (low + high) / 2u;
        if points[middle].value <= value {
            low = middle + 1u;
        } else {
            high = middle;
        }
    }
    let above = points[min(low, params.n_points - 1u)];
    let below = points[max(low, 1u) - 1u];
    let span = above.value - below.value;
    let share = select(0.0, clamp((value - below.value) / max(span, 1e-37), 0.0, 1.0), span > 0.0);
    return mix(vec4f(below.color, below.opacity), vec4f(above.color, above.opacity), share);
}

@compute @workgroup_size(8, 8, 1)
fn transfer_function(@builtin(global_invocation_id) id: vec3u) {
    let row = params.row + id.y;
    if id.x >= params.width || id.y >= params.n_rows || row >= params.height {
        return;
    }
    let at = 2.0 * (vec2f(f32(id.x), f32(row)) + 0.5) / vec2f(f32(params.width), f32(params.height)) - 1.0;
    let x = at.x;
    let y = -at.y;
    // Voxels a meter along the ray: t is in meters.
    let direction = (params.forward + x * params.right + y * params.up) / length(vec3f(1.0, x * params.tan.x, y * params.tan.y));
    let t = ray_box(params.eye, direction, vec3f(-1.0), vec3f(params.dims));
    var light = vec3f(0.0);
    var depth = 0.0;
    if t.x < t.y {
        let n = max(ceil((t.y - t.x) * length(direction) / params.step - 1e-3), 1.0);
        let h = (t.y - t.x) / n;
        let size = vec3f(params.dims) + 2.0;
        for (var k = 0.0; k < n; k += 1.0) {
            let p = params.eye + (t.x + (k + 0.5) * h) * direction;
            let value = textureSampleLevel(voxels, linear_clamp, (p + 1.5) / size, 0.0).x;
            let found = look_up(value);
            let tau = params.extinction * found.w * h;
            light += exp(-depth) * (1.0 - exp(-tau)) * found.xyz;
            depth += tau;
            // What is behind weighs less than the rounding of what is in front.
            if depth > 20.0 {
                break;
            }
        }
    }
    pixels[id.y * params.width + id.x] = vec4f(light + exp(-depth) * params.background, 1.0 - exp(-depth));
}
