// What a march evaluates for each channel: here for three.

fn per_channel_mean(x: Spectrum) -> Spectrum {
    return vec3f(mean_transmittance(x.x), mean_transmittance(x.y), mean_transmittance(x.z));
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
