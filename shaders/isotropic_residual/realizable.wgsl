// phi >= 0 and |F| <= phi: what any radiance has.
fn realizable(moments: vec4f) -> vec4f {
    let phi = max(moments.x, 0.0);
    let len = length(moments.yzw);
    return vec4f(phi, moments.yzw * select(1.0, phi / max(len, 1e-37), len > phi));
}
