// What arrives on surfaces, between the corners of their cuts.
//
// Who imports this declares, beside what lib/bvh.wgsl wants:
//   var<storage, read> surface_grids: array<vec2u>;    (a triangle's first corner, and its cuts n along an edge)
//   var<storage, read> surface_light: array<vec4f>;    (two for each corner: the side of the normal, the other)

#import "lib/cuts.wgsl"

// Index of corner (i, j) of a triangle with n cuts: rows of n + 1, n, .. 1.
fn cut_corner(n: u32, i: u32, j: u32) -> u32 {
    return i * (2u * n + 3u - i) / 2u + j;
}

// Irradiance [W/m2] at point p of a triangle, on the side that a ray of this direction comes from, in the
// channels of the residual.
fn surface_irradiance(triangle: u32, p: vec3f, direction: vec3f) -> vec3f {
    let grid = surface_grids[triangle];
    let n = grid.y;
    let cut = cut_at(triangle, n, p, direction);
    let shift = u32(cut.is_upper);
    let side = 2u * grid.x + cut.side;
    let own = surface_light[side + 2u * cut_corner(n, cut.i + shift, cut.j + shift)].xyz;
    let along_b = surface_light[side + 2u * cut_corner(n, cut.i + 1u, cut.j)].xyz;
    let along_c = surface_light[side + 2u * cut_corner(n, cut.i, cut.j + 1u)].xyz;
    let weights = select(cut.part, 1.0 - cut.part.yx, cut.is_upper);
    // Rounding alone makes it negative.
    let rest = max(0.0, 1.0 - weights.x - weights.y);
    return rest * own + weights.x * along_b + weights.y * along_c;
}
