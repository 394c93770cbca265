// A thread: the irradiance that one look at a surface finds. The proof of lib/surface_light.wgsl.

#import "lib/surface_light.wgsl"

struct LookupParams {
    n_looks: u32,
    pad_0: u32,
    pad_1: u32,
    pad_2: u32,
}

struct Look {
    p: vec3f,
    triangle: u32,
    direction: vec4f,
}

@group(0) @binding(0) var<uniform> params: LookupParams;
@group(1) @binding(0) var<storage, read> surface_triangles: array<SurfaceTriangle>;
@group(1) @binding(1) var<storage, read> surface_light: array<vec4f>;
@group(1) @binding(2) var<storage, read> surface_corners: array<vec4u>;
@group(1) @binding(3) var<storage, read> looks: array<Look>;
// No ray is sent through the tree: the layout of the stage leaves it out.
@group(1) @binding(4) var<storage, read> surface_nodes: array<SurfaceNode>;
@group(2) @binding(0) var<storage, read_write> found: array<vec4f>;

@compute @workgroup_size(64, 1, 1)
fn lookup(@builtin(global_invocation_id) id: vec3u) {
    if id.x >= params.n_looks {
        return;
    }
    let look = looks[id.x];
    found[id.x] = vec4f(surface_irradiance(look.triangle, look.p, look.direction.xyz), 0.0);
}
