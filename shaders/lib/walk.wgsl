// Optical depth from a point to a light, by samples at most a cell apart.

#import "lib/block.wgsl"
#import "lib/shape.wgsl"

// Trilinear extinction [1/m] at an index position. The field's outermost cells are void, so that
// clamping to them is the same as a background of 0.
fn extinction(sigma_t: texture_3d<f32>, linear_clamp: sampler, p: vec3f) -> f32 {
    let size = vec3f(textureDimensions(sigma_t));
    return textureSampleLevel(sigma_t, linear_clamp, (p + 0.5) / size, 0.0).x;
}

// A way through the shape: its first point and its samples' distance along the ray, in cells.
struct Way {
    start: f32,
    dt: f32,
    n_steps: f32,
}

// The way from `p` along `to_light`, no further than `reach` cells; a miss has no steps.
fn way_through(shape: Shape, p: vec3f, to_light: vec3f, reach: f32) -> Way {
    let clipped = ray_shape(shape, p, to_light);
    let span = max(min(clipped.y, reach) - clipped.x, 0.0);
    let n_steps = ceil(span);
    return Way(clipped.x, span / max(n_steps, 1.0), n_steps);
}

// tau from `p` along the unit vector `to_light`, no further than `reach` cells; cell_m is a cell's edge.
fn walk(sigma_t: texture_3d<f32>, linear_clamp: sampler, shape: Shape, cell_m: f32, p: vec3f, to_light: vec3f, reach: f32) -> f32 {
    let way = way_through(shape, p, to_light, reach);
    if shape.kind != VOXELS {
        return shape.sigma_t * way.n_steps * way.dt * cell_m;
    }
    var sum = 0.0;
    for (var n = 0.0; n < way.n_steps; n += 1.0) {
        sum += extinction(sigma_t, linear_clamp, p + (way.start + (n + 0.5) * way.dt) * to_light);
    }
    return sum * way.dt * cell_m;
}

// The same past empty blocks of cells, for ways that are mostly void.
fn walk_past(sigma_t: texture_3d<f32>, linear_clamp: sampler, blocks: texture_3d<f32>, shape: Shape, cell_m: f32, p: vec3f, to_light: vec3f, reach: f32) -> f32 {
    let way = way_through(shape, p, to_light, reach);
    if shape.kind != VOXELS {
        return shape.sigma_t * way.n_steps * way.dt * cell_m;
    }
    var sum = 0.0;
    for (var n = 0.0; n < way.n_steps; n += 1.0) {
        let at = p + (way.start + (n + 0.5) * way.dt) * to_light;
        let here = extinction(sigma_t, linear_clamp, at);
        sum += here;
        if here <= 0.0 {
            n = max(n, floor((empty_until(blocks, p, to_light, at) - way.start) / way.dt - 0.5));
        }
    }
    return sum * way.dt * cell_m;
}
