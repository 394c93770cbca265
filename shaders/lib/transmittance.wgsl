// Forms of exp that keep their digits in f32. All take and give finite numbers.

// (1 - exp(-x)) / x, for x >= 0; 1 at 0.
fn mean_transmittance(x: f32) -> f32 {
    let series = 1.0 - x * (0.5 - x * (1.0 / 6.0 - x * (1.0 / 24.0 - x / 120.0)));
    return select((1.0 - exp(-x)) / max(x, 1e-3), series, x < 0.1);
}

// Mean of exp(-t) for t from a to b: (e^-a - e^-b) / (b - a), symmetric, by series where b - a is small.
fn mean_exp(a: f32, b: f32) -> f32 {
    return exp(-min(a, b)) * mean_transmittance(abs(b - a));
}
