// What a march evaluates for each channel: here for one.

fn per_channel_mean(x: Spectrum) -> Spectrum {
    return mean_transmittance(x);
}

fn peak_of(x: Spectrum, column: f32) -> Spectrum {
    return forward_peak(x, column);
}

fn residual_of(p: vec3f, view: vec3f) -> Spectrum {
    return params.residual_color.x * residual_radiance(p, view, 0u);
}
