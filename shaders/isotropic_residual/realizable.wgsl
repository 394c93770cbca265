// phi >= 0 and |F| <= phi: what any radiance has.
fn realizable(moments: vec4f) -> vec4f {
    let phi = max(moments.x, 0.0);
    // Scaled by the largest component, so that squares neither overflow nor vanish.
    let f = abs(moments.yzw);
    let big = max(max(f.x, max(f.y, f.z)), 1e-37);
    let len = big * length(moments.yzw / big);
    return vec4f(phi, moments.yzw * select(1.0, phi / max(len, 1e-37), len > phi));
}
