// Triangles cut into n^2 equal ones: which of them a point lies in, and where. Rows of them, and of their
// corners, stand along a triangle's edge from a to c; row 0 is that edge.
//
// Who imports this declares what lib/bvh.wgsl wants.

#import "lib/bvh.wgsl"

struct Cut {
    // Row, and column of the lozenge of two.
    i: u32,
    j: u32,
    // Of the two the one that lies away from corner a.
    is_upper: bool,
    // 0: seen from the side of the normal; 1: from the other.
    side: u32,
    // Position in the lozenge, along both edges.
    part: vec2f,
}

// Of a triangle with n cuts along an edge, at its point p, as a ray of this direction sees it.
fn cut_at(triangle: u32, n: u32, p: vec3f, direction: vec3f) -> Cut {
    let corners = surface_triangles[triangle];
    let ab = corners.b.xyz - corners.a.xyz;
    let ac = corners.c.xyz - corners.a.xyz;
    let ap = p - corners.a.xyz;
    let normal = cross(ab, ac);
    let area2 = max(dot(normal, normal), 1e-37);
    let coordinates = vec2f(dot(cross(ap, ac), normal), dot(cross(ab, ap), normal)) / area2;
    let at = clamp(coordinates, vec2f(0.0), vec2f(1.0)) * f32(n);
    let i = min(u32(at.x), n - 1u);
    let j = min(u32(at.y), n - 1u - i);
    let part = min(at - vec2f(vec2u(i, j)), vec2f(1.0));
    let is_upper = part.x + part.y > 1.0 && i + j < n - 1u;
    return Cut(i, j, is_upper, u32(dot(normal, direction) > 0.0), part);
}
