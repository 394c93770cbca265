// A thread: the optical depths from a few corners to a parallel light, each in two parts: samples up to a plane of
// corners whose depths are known, and from there what that plane has, between its corners.

#import "lib/walk.wgsl"

struct ScanParams {
    shape: Shape,
    // The first corner that is looked from, and how many are.
    low: vec3u,
    // Where the depths of this beam begin.
    first: u32,
    extent: vec3u,
    // The axis that the planes stand across: 0, 1, 2.
    along: u32,
    // Of the grid.
    corners: vec3u,
    // The plane that is known.
    known: u32,
    // Unit vector in index space.
    to_light: vec3f,
    cell_m: f32,
    // Where on that axis ways end: at the known plane, or where the medium does.
    until: f32,
    pad_0: u32,
    pad_1: u32,
    pad_2: u32,
}

@group(0) @binding(0) var<uniform> params: ScanParams;
@group(1) @binding(0) var sigma_t: texture_3d<f32>;
@group(1) @binding(1) var linear_clamp: sampler;
@group(2) @binding(0) var<storage, read_write> depths: array<f32>;

// A finite number with room for the sums of an interpolation.
const DEEPEST: f32 = 1e30;

// Weights of four neighbors at a share of the way from the second to the third (Catmull-Rom).
fn cubic(f: f32) -> vec4f {
    return vec4f(f * (f * (1.0 - 0.5 * f) - 0.5), 1.0 + f * f * (1.5 * f - 2.5), f * (0.5 + f * (2.0 - 1.5 * f)), 0.5 * f * f * (f - 1.0));
}

// Where corners of the known plane are kept along one of its axes. Beyond the grid stands its nearest corner: where
// a ray leaves the grid that has 0, because the outermost cells are void.
fn place(at: i32, axis: u32) -> u32 {
    return u32(clamp(at, 0, i32(params.corners[axis]) - 1)) * stride(axis);
}

fn stride(axis: u32) -> u32 {
    return select(select(1u, params.corners.x, axis == 1u), params.corners.x * params.corners.y, axis == 2u);
}

// Depths of a row of the known plane around one place, which its cubic may not leave.
struct Row {
    there: f32,
    least: f32,
    most: f32,
}

fn row(start: u32, columns: vec4u, weights: vec4f) -> Row {
    let four = vec4f(depths[start + columns.x], depths[start + columns.y], depths[start + columns.z], depths[start + columns.w]);
    return Row(dot(weights, four), min(four.y, four.z), max(four.y, four.z));
}

// Whether ways are walked to their end, from every corner that is looked from; no plane is known then.
const IS_WHOLE: bool = {whole};

fn keep(corner: vec3u, tau: f32) {
    depths[params.first + corner.x + params.corners.x * (corner.y + params.corners.y * corner.z)] = min(tau, DEEPEST);
}

// Corners that a thread takes one after the other, across the beam: their ways cross the known plane by rows that
// they share.
const COLUMN: u32 = 8u;

@compute @workgroup_size(8, 8, 1)
fn principal_propagation_scan(@builtin(global_invocation_id) id: vec3u) {
    // Along x neighboring threads are neighbors; a plane's other axis is that of the columns.
    let u = select(0u, 1u, params.along == 0u);
    let v = select(2u, 1u, params.along == 2u);
    var first = id;
    first[v] *= COLUMN;
    if any(first >= params.extent) {
        return;
    }
    let low = params.low + first;
    let n_corners = min(COLUMN, params.extent[v] - first[v]);
    if IS_WHOLE {
        for (var n = 0u; n < n_corners; n += 1u) {
            var corner = low;
            corner[v] += n;
            keep(corner, walk(sigma_t, linear_clamp, params.shape, params.cell_m, vec3f(corner) - 0.5, params.to_light, 1e30));
        }
        return;
    }
    let steps = (params.until - f32(low[params.along])) / params.to_light[params.along];
    let n_samples = ceil(steps);
    let dt = steps / n_samples;
    let crossing = vec3f(low) + steps * params.to_light;
    let at_u = i32(floor(crossing[u]));
    let columns = vec4u(place(at_u - 1, u), place(at_u, u), place(at_u + 1, u), place(at_u + 2, u));
    let weights_u = cubic(fract(crossing[u]));
    let weights_v = cubic(fract(crossing[v]));
    let at_v = i32(floor(crossing[v]));
    let plane = params.first + params.known * stride(params.along);
    var before = row(plane + place(at_v - 1, v), columns, weights_u);
    var near = row(plane + place(at_v, v), columns, weights_u);
    var far = row(plane + place(at_v + 1, v), columns, weights_u);
    for (var n = 0u; n < n_corners; n += 1u) {
        let after = row(plane + place(at_v + i32(n) + 2, v), columns, weights_u);
        let there = dot(weights_v, vec4f(before.there, near.there, far.there, after.there));
        var corner = low;
        corner[v] += n;
        let p = vec3f(corner) - 0.5;
        var sum = 0.0;
        for (var step = 0.5; step < n_samples; step += 1.0) {
            sum += extinction(sigma_t, linear_clamp, p + step * dt * params.to_light);
        }
        keep(corner, sum * dt * params.cell_m + clamp(there, min(near.least, far.least), max(near.most, far.most)));
        before = near;
        near = far;
        far = after;
    }
}
