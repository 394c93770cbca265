// How an atlas of four beams a texel (16-bit floats) stores an optical depth.

#import "lib/half.wgsl"

// Beyond the largest half float stands infinity. exp(-k tau) is 0 in f32 long before, for every |g| <= 0.999.
fn stored_tau(tau: f32) -> f32 {
    return min(tau, LARGEST_HALF);
}
