// What a march evaluates for each channel: here for three.

#import "lib/transmittance.wgsl"
#import "lib/streams.wgsl"

// (1 - exp(-x)) / x, where the exponential is known.
fn per_channel_mean(x: Spectrum, exp_x: Spectrum) -> Spectrum {
    let thin = vec3f(thin_transmittance(x.x), thin_transmittance(x.y), thin_transmittance(x.z));
    return select((1.0 - exp_x) / max(x, vec3f(1e-3)), thin, x < vec3f(0.1));
}

// Whether matter is the same in all channels.
const IS_GREY: bool = {grey};

fn peak_of(x: Spectrum, column: f32) -> Spectrum {
    if IS_GREY {
        return Spectrum(forward_peak(x.x, column));
    }
    return vec3f(forward_peak(x.x, column), forward_peak(x.y, column), forward_peak(x.z, column));
}

// Of what is as grey as matter.
fn exp_of(x: Spectrum) -> Spectrum {
    if IS_GREY {
        return Spectrum(exp(x.x));
    }
    return exp(x);
}

// Of light 1 that goes to and fro along its line: what goes on, and what comes back.
struct BothWays {
    on: Spectrum,
    back: Spectrum,
}

fn both_ways(tau: f32, ahead: f32) -> BothWays {
    var ways: BothWays;
    for (var c = 0u; c < 3u; c += 1u) {
        let both = streams(params.g, params.albedo[c], tau, ahead);
        let decayed = exp(-both.kappa * tau);
        ways.on[c] = decayed * both.on;
        ways.back[c] = decayed * both.back;
    }
    return ways;
}
