// A thread: the mean emitted radiance per meter of one cell, over n_sub^3 points of it.

#import "lib/emission.wgsl"

struct EmissionParams {
    heat: Heat,
    dims: vec3u,
    n_sub: u32,
}

@group(0) @binding(0) var<uniform> params: EmissionParams;
@group(1) @binding(0) var flame: texture_3d<f32>;
@group(1) @binding(1) var temperature: texture_3d<f32>;
@group(1) @binding(2) var blackbodies: texture_2d<f32>;
@group(1) @binding(3) var linear_clamp: sampler;
@group(2) @binding(0) var cells: texture_storage_3d<rgba32float, write>;

@compute @workgroup_size(8, 8, 1)
fn emission(@builtin(global_invocation_id) id: vec3u) {
    if any(id >= params.dims) {
        return;
    }
    let n = params.n_sub;
    var sum = vec3f(0.0);
    for (var sub = 0u; sub < n * n * n; sub += 1u) {
        let offset = (vec3f(vec3u(sub % n, (sub / n) % n, sub / (n * n))) + 0.5) / f32(n) - 0.5;
        sum += emitted(params.heat, flame, temperature, blackbodies, linear_clamp, vec3f(id) + offset);
    }
    textureStore(cells, id, vec4f(sum / f32(n * n * n), 0.0));
}
