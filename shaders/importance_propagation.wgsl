// A thread: the optical depth of one camera ray through the whole medium, rays on an even grid over the
// picture.

#import "lib/view.wgsl"
#import "lib/walk.wgsl"

struct ViewParams {
    shape: Shape,
    eye: vec3f,
    cell_m: f32,
    // The view, in index space: lib/view.wgsl.
    forward: vec3f,
    // Rays across and down.
    n_rays: u32,
    right: vec3f,
    pad_0: u32,
    up: vec3f,
    pad_1: u32,
}

@group(0) @binding(0) var<uniform> params: ViewParams;
@group(1) @binding(0) var sigma_t: texture_3d<f32>;
@group(1) @binding(1) var linear_clamp: sampler;
@group(2) @binding(0) var<storage, read_write> depths: array<f32>;

@compute @workgroup_size(8, 8, 1)
fn importance_propagation(@builtin(global_invocation_id) id: vec3u) {
    let n = params.n_rays;
    if id.x >= n || id.y >= n {
        return;
    }
    let at = (vec2f(id.xy) + 0.5) / f32(n);
    let direction = view_ray(params.forward, params.right, params.up, at);
    depths[id.y * n + id.x] = walk(sigma_t, linear_clamp, params.shape, params.cell_m, params.eye, direction, 1e30);
}
