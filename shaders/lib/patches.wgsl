// Surfaces cut into patches of one radiance a side: where a ray's hit finds the light that comes back.
//
// Who imports this declares, beside what lib/bvh.wgsl wants:
//   var<storage, read> patch_grids: array<vec2u>;        (a triangle's first patch, and its cuts n along an edge)
//   var<storage, read> patch_radiances: array<vec4f>;    (two for each patch: the side of the normal, the other)

#import "lib/bvh.wgsl"

// Of n^2 patches that a triangle's grid has, the one at barycentric coordinates u towards b, v towards c.
fn patch_at(n: u32, u: f32, v: f32) -> u32 {
    let i = min(u32(max(u, 0.0) * f32(n)), n - 1u);
    let j = min(u32(max(v, 0.0) * f32(n)), n - 1u - i);
    let part = vec2f(u, v) * f32(n) - vec2f(vec2u(i, j));
    let is_upper = part.x + part.y > 1.0 && i + j < n - 1u;
    return n * n - (n - i) * (n - i) + 2u * j + u32(is_upper);
}

// Radiance towards a ray of this direction from where it meets a triangle, at `p`.
fn patch_radiance(triangle: u32, p: vec3f, direction: vec3f) -> vec3f {
    let corners = surface_triangles[triangle];
    let ab = corners.b.xyz - corners.a.xyz;
    let ac = corners.c.xyz - corners.a.xyz;
    let ap = p - corners.a.xyz;
    let normal = cross(ab, ac);
    let area2 = max(dot(normal, normal), 1e-37);
    let u = dot(cross(ap, ac), normal) / area2;
    let v = dot(cross(ab, ap), normal) / area2;
    let grid = patch_grids[triangle];
    let patch_idx = grid.x + patch_at(grid.y, u, v);
    return patch_radiances[2u * patch_idx + u32(dot(normal, direction) > 0.0)].xyz;
}
