// What a march evaluates for each channel: here for three.

// (1 - exp(-x)) / x, where the exponential is known.
fn per_channel_mean(x: Spectrum, exp_x: Spectrum) -> Spectrum {
    let thin = vec3f(thin_transmittance(x.x), thin_transmittance(x.y), thin_transmittance(x.z));
    return select((1.0 - exp_x) / max(x, vec3f(1e-3)), thin, x < vec3f(0.1));
}

fn peak_of(x: Spectrum, column: f32) -> Spectrum {
    return vec3f(forward_peak(x.x, column), forward_peak(x.y, column), forward_peak(x.z, column));
}

fn residual_of(p: vec3f, view: vec3f) -> Spectrum {
    if params.residual_channels == 1u {
        return params.residual_color.xyz * residual_radiance(p, view, 0u);
    }
    return vec3f(residual_radiance(p, view, 0u), residual_radiance(p, view, 1u), residual_radiance(p, view, 2u));
}
