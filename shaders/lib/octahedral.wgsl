// The octahedral map of directions to the square -1 .. 1. The twin of src/optics/octahedral.rs.

fn with_sign(size: vec2f, sign_of: vec2f) -> vec2f {
    return select(-size, size, sign_of >= vec2f(0.0));
}

// Where a direction of any length lies; 0 where it has none.
fn octahedral(d: vec3f) -> vec2f {
    let q = d / max(abs(d.x) + abs(d.y) + abs(d.z), 1e-30);
    return select(with_sign(1.0 - abs(q.yx), q.xy), q.xy, q.z >= 0.0);
}

// The unit vector at a place up to 1 beyond the square.
fn octahedral_direction(at: vec2f) -> vec3f {
    var uv = at;
    if abs(uv.x) > 1.0 {
        uv = vec2f(select(-2.0, 2.0, uv.x >= 0.0) - uv.x, -uv.y);
    }
    if abs(uv.y) > 1.0 {
        uv = vec2f(-uv.x, select(-2.0, 2.0, uv.y >= 0.0) - uv.y);
    }
    let z = 1.0 - abs(uv.x) - abs(uv.y);
    let xy = select(with_sign(1.0 - abs(uv.yx), uv), uv, z >= 0.0);
    return normalize(vec3f(xy, z));
}
