// A point light's own grid: distance from it, times directions by the octahedral map.

#import "lib/octahedral.wgsl"

struct RadialLight {
    // Rows of the rotation from index space to the light's own frame. Then: distance of the first node, of the
    // last one [cells], and 1 where nodes stand ever further apart, 0 where evenly.
    right: vec4f,
    up: vec4f,
    axis: vec4f,
    // The part of the square that is kept: its lowest corner, its extent.
    crop: vec4f,
    // First texel of the grid, and its directions along an edge.
    origin: vec3u,
    n_angular: u32,
    // Nodes of a direction.
    n_radial: u32,
    pad_0: u32,
    pad_1: u32,
    pad_2: u32,
}

// ln of the last distance over that of the second node, where nodes stand ever further apart.
const LOG_RANGE: f32 = 4.605170;

fn radial_frame(light: RadialLight) -> mat3x3f {
    return mat3x3f(light.right.xyz, light.up.xyz, light.axis.xyz);
}

// Distance of a node from the light [cells].
fn radial_distance(light: RadialLight, node: u32) -> f32 {
    let first = light.right.w;
    let last = light.up.w;
    if light.axis.w == 0.0 {
        return first + (last - first) * f32(node) / f32(light.n_radial - 1u);
    }
    let part = f32(max(node, 1u) - 1u) / f32(light.n_radial - 2u);
    return select(last * exp(LOG_RANGE * (part - 1.0)), 0.0, node == 0u);
}

// The node at a distance.
fn radial_node(light: RadialLight, r: f32) -> f32 {
    let first = light.right.w;
    let last = light.up.w;
    let n = f32(light.n_radial - 1u);
    if light.axis.w == 0.0 {
        return clamp(n * (r - first) / max(last - first, 1e-30), 0.0, n);
    }
    let second = last * exp(-LOG_RANGE);
    return clamp(select(1.0 + (n - 1.0) * log(max(r, second) / second) / LOG_RANGE, r / second, r < second), 0.0, n);
}
