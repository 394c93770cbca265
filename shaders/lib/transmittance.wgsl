// Forms of exp that keep their digits in f32. All take and give finite numbers.

// (1 - exp(-x)) / x, for x >= 0; 1 at 0.
fn mean_transmittance(x: f32) -> f32 {
    return select((1.0 - exp(-x)) / max(x, 1e-3), thin_transmittance(x), x < 0.1);
}

// Its series, for x < 0.1.
fn thin_transmittance(x: f32) -> f32 {
    return 1.0 - x * (0.5 - x * (1.0 / 6.0 - x * (1.0 / 24.0 - x / 120.0)));
}
