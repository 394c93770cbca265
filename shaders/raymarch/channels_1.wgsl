// What a march evaluates for each channel: here for one.

#import "lib/transmittance.wgsl"

// (1 - exp(-x)) / x, where the exponential is known.
fn per_channel_mean(x: Spectrum, exp_x: Spectrum) -> Spectrum {
    return select((1.0 - exp_x) / max(x, 1e-3), thin_transmittance(x), x < 0.1);
}

fn peak_of(x: Spectrum, column: f32) -> Spectrum {
    return forward_peak(x, column);
}

fn exp_of(x: Spectrum) -> Spectrum {
    return exp(x);
}
