// Corners of cells that a surface hides from a light: they hold a depth that no walk gives.

#import "lib/half.wgsl"

// Where depths that are stored end too: either way no light is left.
const HIDDEN: f32 = LARGEST_HALF;

fn is_hidden(tau: f32) -> bool {
    // Half floats of this size are 32 apart.
    return tau > HIDDEN - 32.0;
}

// Beams of a texel, between the corners of cells.
struct Lit {
    // Of the corners, weighted, that the light reaches: E is share exp(-k tau). Between a lit and a hidden
    // corner light ends halfway, on average, as it does where shadows end anywhere.
    share: vec4f,
    // Mean depth of those corners; 0 where there are none.
    tau: vec4f,
}

// The beams of the pack whose first texel is `origin`, at `p` in corner coordinates (cell centers at 1/2).
fn lit_between(depths: texture_3d<f32>, origin: vec3u, corners: vec3u, p: vec3f) -> Lit {
    let low = clamp(floor(p), vec3f(0.0), vec3f(corners) - 2.0);
    let part = clamp(p - low, vec3f(0.0), vec3f(1.0));
    var lit = Lit(vec4f(0.0), vec4f(0.0));
    for (var n = 0u; n < 8u; n += 1u) {
        let step = vec3u(n & 1u, (n >> 1u) & 1u, n >> 2u);
        let side = select(1.0 - part, part, step == vec3u(1u));
        let texel = textureLoad(depths, origin + vec3u(low) + step, 0);
        let weight = side.x * side.y * side.z * vec4f(texel <= vec4f(HIDDEN - 32.0));
        lit.share += weight;
        lit.tau += weight * texel;
    }
    lit.tau /= max(lit.share, vec4f(1e-6));
    return lit;
}
