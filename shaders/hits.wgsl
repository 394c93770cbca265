// A thread: the nearest hit of one ray, and whether there is any. The proof of lib/bvh.wgsl.

#import "lib/bvh.wgsl"

struct HitsParams {
    n_rays: u32,
    pad_0: u32,
    pad_1: u32,
    pad_2: u32,
}

struct HitsRay {
    // In w, how far it goes.
    origin: vec4f,
    direction: vec4f,
}

struct HitsFound {
    t: f32,
    triangle: u32,
    // 1: something is in the way.
    occluded: u32,
    pad: u32,
    // Unit normal towards the ray's origin.
    normal: vec4f,
    reflectance: vec4f,
}

@group(0) @binding(0) var<uniform> params: HitsParams;
@group(1) @binding(0) var<storage, read> surface_nodes: array<SurfaceNode>;
@group(1) @binding(1) var<storage, read> surface_triangles: array<SurfaceTriangle>;
@group(1) @binding(2) var<storage, read> rays: array<HitsRay>;
@group(2) @binding(0) var<storage, read_write> found: array<HitsFound>;

@compute @workgroup_size(64, 1, 1)
fn hits(@builtin(global_invocation_id) id: vec3u) {
    if id.x >= params.n_rays {
        return;
    }
    let ray = rays[id.x];
    let hit = nearest_surface(ray.origin.xyz, ray.direction.xyz, ray.origin.w);
    let occluded = u32(is_occluded(ray.origin.xyz, ray.direction.xyz, ray.origin.w));
    var normal = vec3f(0.0);
    var reflectance = vec3f(0.0);
    if hit.triangle != NO_SURFACE {
        normal = surface_normal(hit.triangle, ray.direction.xyz);
        reflectance = surface_reflectance(hit.triangle);
    }
    found[id.x] = HitsFound(hit.t, hit.triangle, occluded, 0u, vec4f(normal, 0.0), vec4f(reflectance, 0.0));
}
