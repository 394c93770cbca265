// Rays and triangles: the nearest hit, and whether there is one. Space and lengths are those of the tree.
//
// Who imports this declares what it walks, empty or not:
//   @group(1) @binding(..) var<storage, read> surface_nodes: array<SurfaceNode>;
//   @group(1) @binding(..) var<storage, read> surface_triangles: array<SurfaceTriangle>;

#import "lib/ray_box.wgsl"

// A box of the tree, in depth-first order.
struct SurfaceNode {
    low: vec3f,
    // Triangles of a leaf: the first one's index; else, the node after all below this one.
    first_or_skip: u32,
    high: vec3f,
    // 0: no leaf.
    n_triangles: u32,
}

// Corners in xyz; red, green and blue reflectance in the w of a, b and c.
struct SurfaceTriangle {
    a: vec4f,
    b: vec4f,
    c: vec4f,
}

struct SurfaceHit {
    // In lengths of the ray's direction.
    t: f32,
    // NO_SURFACE: none.
    triangle: u32,
}

const NO_SURFACE: u32 = 0xffffffffu;
// Rays start and end so far from where they are meant to, in their own lengths: coordinates of some
// hundred cells have an ulp of 3e-5.
const SURFACE_GAP: f32 = 1e-3;
// Two products of f32 and their difference err by less than this share of the products.
const EDGE_ROUNDING: f32 = 2.4e-7;
// Four ulps: distances to a box are a difference and a product.
const BOX_ROUNDING: f32 = 5e-7;

// A ray's own frame (Woop, Benthin, Wald 2013, "Watertight Ray/Triangle Intersection"): z along its longest
// component, sheared so that the ray stands in the origin. Two triangles see a shared edge by the same
// numbers, so that no ray is lost between them.
struct RayFrame {
    origin: vec3f,
    axis: u32,
    shear: vec3f,
}

fn turned(v: vec3f, axis: u32) -> vec3f {
    if axis == 0u {
        return v.yzx;
    }
    return select(v, v.zxy, axis == 1u);
}

fn ray_frame(origin: vec3f, direction: vec3f) -> RayFrame {
    let d = abs(direction);
    var axis = 2u;
    if d.x >= d.y && d.x >= d.z {
        axis = 0u;
    } else if d.y >= d.z {
        axis = 1u;
    }
    let t = turned(direction, axis);
    return RayFrame(origin, axis, vec3f(t.xy, 1.0) / t.z);
}

// Twice the area that p and q span with the origin; 0 within what rounding can make of it.
fn edge_area(p: vec2f, q: vec2f) -> f32 {
    let one = p.x * q.y;
    let other = p.y * q.x;
    let area = one - other;
    return select(area, 0.0, abs(area) <= EDGE_ROUNDING * (abs(one) + abs(other)));
}

// Where the ray meets a triangle's plane, if within the triangle; else a negative number.
fn meet_triangle(frame: RayFrame, triangle: SurfaceTriangle) -> f32 {
    let a = turned(triangle.a.xyz - frame.origin, frame.axis);
    let b = turned(triangle.b.xyz - frame.origin, frame.axis);
    let c = turned(triangle.c.xyz - frame.origin, frame.axis);
    let pa = a.xy - frame.shear.xy * a.z;
    let pb = b.xy - frame.shear.xy * b.z;
    let pc = c.xy - frame.shear.xy * c.z;
    let areas = vec3f(edge_area(pc, pb), edge_area(pa, pc), edge_area(pb, pa));
    let all_areas = areas.x + areas.y + areas.z;
    if (any(areas < vec3f(0.0)) && any(areas > vec3f(0.0))) || all_areas == 0.0 {
        return -1.0;
    }
    return frame.shear.z * dot(areas / all_areas, vec3f(a.z, b.z, c.z));
}

// Whether the box is met before t.
fn meets_box(node: SurfaceNode, origin: vec3f, direction: vec3f, t: f32) -> bool {
    let span = ray_box(origin, direction, node.low, node.high);
    return span.x <= min(span.y, t) * (1.0 + BOX_ROUNDING);
}

// The first surface from `origin` on, beyond SURFACE_GAP and before `t_max`.
fn nearest_surface(origin: vec3f, direction: vec3f, t_max: f32) -> SurfaceHit {
    let frame = ray_frame(origin, direction);
    var hit = SurfaceHit(t_max, NO_SURFACE);
    let n_nodes = arrayLength(&surface_nodes);
    for (var idx = 0u; idx < n_nodes;) {
        let node = surface_nodes[idx];
        let is_met = meets_box(node, origin, direction, hit.t);
        if is_met {
            for (var n = 0u; n < node.n_triangles; n += 1u) {
                let t = meet_triangle(frame, surface_triangles[node.first_or_skip + n]);
                if t > SURFACE_GAP && t < hit.t {
                    hit = SurfaceHit(t, node.first_or_skip + n);
                }
            }
        }
        idx = select(node.first_or_skip, idx + 1u, is_met || node.n_triangles > 0u);
    }
    return hit;
}

// Whether any surface stands between `origin` and t_max, both less SURFACE_GAP.
fn is_occluded(origin: vec3f, direction: vec3f, t_max: f32) -> bool {
    let frame = ray_frame(origin, direction);
    let n_nodes = arrayLength(&surface_nodes);
    for (var idx = 0u; idx < n_nodes;) {
        let node = surface_nodes[idx];
        let is_met = meets_box(node, origin, direction, t_max);
        if is_met {
            for (var n = 0u; n < node.n_triangles; n += 1u) {
                let t = meet_triangle(frame, surface_triangles[node.first_or_skip + n]);
                if t > SURFACE_GAP && t < t_max - SURFACE_GAP {
                    return true;
                }
            }
        }
        idx = select(node.first_or_skip, idx + 1u, is_met || node.n_triangles > 0u);
    }
    return false;
}

// Unit normal of a triangle, on its front side.
fn front_normal(triangle: u32) -> vec3f {
    let corners = surface_triangles[triangle];
    let ab = corners.b.xyz - corners.a.xyz;
    let ac = corners.c.xyz - corners.a.xyz;
    // Edges of length 1 first, so that areas of small triangles do not vanish.
    return normalize(cross(ab / length(ab), ac / length(ac)));
}

// The normal on the side that a ray of this direction comes from.
fn surface_normal(triangle: u32, direction: vec3f) -> vec3f {
    let normal = front_normal(triangle);
    return select(normal, -normal, dot(normal, direction) > 0.0);
}

// Reflectance of a triangle, linear Rec. 709.
fn surface_reflectance(triangle: u32) -> vec3f {
    let corners = surface_triangles[triangle];
    return vec3f(corners.a.w, corners.b.w, corners.c.w);
}
