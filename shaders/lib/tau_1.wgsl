// How an atlas of one beam a texel (32-bit floats) stores an optical depth.

// As it is, but finite with room for the sums of an interpolation.
fn stored_tau(tau: f32) -> f32 {
    return min(tau, 1e30);
}
