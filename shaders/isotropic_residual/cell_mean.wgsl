// Means of a beam's light over a cell.

#import "lib/shadow.wgsl"
#import "lib/transmittance.wgsl"

// -ln of the mean of exp(-t) for t from a to b.
fn depth_between(a: f32, b: f32) -> f32 {
    return min(a, b) - log(mean_transmittance(abs(b - a)));
}

// Mean of exp(-k tau) over a cell from its corners, numbered x + 2y + 4z: along `axis` first, then along
// the other two. Exact where tau is linear, so what a beam gives to cells is what it loses. Where the
// edge of a shadow crosses the cell, the mean over the corners, of which the hidden ones have no light.
fn cell_mean(t: array<f32, 8>, k: f32, axis: u32) -> f32 {
    var corners = t;
    var n_lit = 0u;
    for (var n = 0u; n < 8u; n += 1u) {
        n_lit += select(1u, 0u, is_hidden(corners[n]));
    }
    if n_lit < 8u {
        var lit = 0.0;
        for (var n = 0u; n < 8u; n += 1u) {
            lit += select(exp(-k * corners[n]), 0.0, is_hidden(corners[n]));
        }
        return lit / 8.0;
    }
    let first = 1u << axis;
    let second = 1u << ((axis + 1u) % 3u);
    let third = 1u << ((axis + 2u) % 3u);
    var faces: array<f32, 2>;
    for (var n = 0u; n < 2u; n += 1u) {
        let at = n * third;
        let near = depth_between(k * corners[at], k * corners[at | first]);
        let far = depth_between(k * corners[at | second], k * corners[at | second | first]);
        faces[n] = depth_between(near, far);
    }
    return exp(-depth_between(faces[0], faces[1]));
}

fn largest_axis(v: vec3f) -> u32 {
    let a = abs(v);
    if a.x >= a.y && a.x >= a.z {
        return 0u;
    }
    return select(2u, 1u, a.y >= a.z);
}
