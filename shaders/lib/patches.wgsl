// Surfaces cut into patches of one irradiance a side: where a ray's hit finds the light that comes back.
//
// Who imports this declares, beside what lib/bvh.wgsl wants:
//   var<storage, read> patch_grids: array<vec2u>;          (a triangle's first patch, and its cuts n along an edge)
//   var<storage, read> patch_irradiances: array<vec4f>;    (two for each patch: the side of the normal, the other)

#import "lib/cuts.wgsl"
#import "lib/phase.wgsl"

// Radiance towards a ray of this direction from where it meets a triangle, at `p`.
fn patch_radiance(triangle: u32, p: vec3f, direction: vec3f) -> vec3f {
    let grid = patch_grids[triangle];
    let n = grid.y;
    let cut = cut_at(triangle, n, p, direction);
    let patch_idx = grid.x + n * n - (n - cut.i) * (n - cut.i) + 2u * cut.j + u32(cut.is_upper);
    // One channel is grey, whatever component is taken.
    return surface_reflectance(triangle) / PI * patch_irradiances[2u * patch_idx + cut.side].xyz;
}
