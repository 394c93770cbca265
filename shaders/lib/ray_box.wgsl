// Entry and exit of rays. `t.x > t.y` is a miss.

// Range of t in which origin + t direction lies in the box; t >= 0.
fn ray_box(origin: vec3f, direction: vec3f, low: vec3f, high: vec3f) -> vec2f {
    // A component under 1e-12 counts as that: the slab is then entered at no finite t or at once.
    let tiny = select(vec3f(-1e-12), vec3f(1e-12), direction >= vec3f(0.0));
    let inverse = 1.0 / select(tiny, direction, abs(direction) > vec3f(1e-12));
    let a = (low - origin) * inverse;
    let b = (high - origin) * inverse;
    let near = min(a, b);
    let far = max(a, b);
    return vec2f(max(max(near.x, near.y), max(near.z, 0.0)), min(far.x, min(far.y, far.z)));
}

// The same for the ellipsoid with this center and these half axes along x, y, z.
fn ray_ellipsoid(origin: vec3f, direction: vec3f, center: vec3f, half_axes: vec3f) -> vec2f {
    let o = (origin - center) / half_axes;
    let d = direction / half_axes;
    let a = dot(d, d);
    let b = dot(o, d) / a;
    // Distance of the center from the ray instead of b^2 - c, which cancels for far origins.
    let foot = o - b * d;
    let discriminant = (1.0 - dot(foot, foot)) / a;
    if discriminant <= 0.0 {
        return vec2f(1.0, 0.0);
    }
    let root = sqrt(discriminant);
    return vec2f(max(-b - root, 0.0), -b + root);
}
