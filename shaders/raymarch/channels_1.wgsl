// What a march evaluates for each channel: here for one.

#import "lib/transmittance.wgsl"
#import "lib/streams.wgsl"

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

// Of light 1 that goes to and fro along its line: what goes on, and what comes back.
struct BothWays {
    on: Spectrum,
    back: Spectrum,
}

fn both_ways(tau: f32, ahead: f32) -> BothWays {
    let both = streams(params.g, params.albedo.x, tau, ahead);
    let decayed = exp(-both.kappa * tau);
    return BothWays(decayed * both.on, decayed * both.back);
}
