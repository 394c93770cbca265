// The squared-linear lobe of a cell: q(w) = A (1 + B.w)^2, A = Q / (4 pi (1 + |B|^2 / 3)).

#import "lib/phase.wgsl"

// |B| of the lobe whose mean cosine is a, 0 <= a <= 1/2.
fn lobe_slope(a: f32) -> f32 {
    let exact = (1.0 - sqrt(max(0.0, 1.0 - 3.0 * a * a))) / max(a, 1e-3);
    // The series of the same form: below 0.02 its next term, 7e-10, is under half an ulp of 0.03.
    let series = a * (1.5 + a * a * 1.125);
    return select(exact, series, a < 0.02);
}

// A in x and B in yzw, from the power Q and its first moment V.
fn lobe_from_moments(q: f32, v: vec3f) -> vec4f {
    if q <= 0.0 {
        return vec4f(0.0);
    }
    // Scaled by the largest component, so that squares neither overflow nor vanish.
    let big = max(abs(v.x), max(abs(v.y), abs(v.z)));
    if big <= 0.0 {
        return vec4f(q / FOUR_PI, 0.0, 0.0, 0.0);
    }
    let scaled = v / big;
    let len = length(scaled);
    let b = lobe_slope(min(0.5, big / q * len));
    return vec4f(q / (FOUR_PI * (1.0 + b * b / 3.0)), b / len * scaled);
}

// A lobe and the cell's scaled extinction in one texel: A, B in 3 x 21 bits (steps of 1e-6), sigma_t*.
fn pack_lobe(lobe: vec4f, sigma_t_star: f32) -> vec4u {
    let b = bitcast<vec3u>(vec3i(round(lobe.yzw * 1048575.0)));
    let y = (b.x & 0x1fffffu) | (b.y << 21u);
    let z = ((b.y >> 11u) & 0x3ffu) | (b.z << 10u);
    return vec4u(bitcast<u32>(lobe.x), y, z, bitcast<u32>(sigma_t_star));
}

fn unpack_slope(texel: vec4u) -> vec3f {
    let x = i32(texel.y << 11u) >> 11u;
    let y = i32((texel.y >> 21u) << 11u | (texel.z << 22u)) >> 11u;
    let z = i32(texel.z << 1u) >> 11u;
    return vec3f(vec3i(x, y, z)) * (1.0 / 1048575.0);
}
