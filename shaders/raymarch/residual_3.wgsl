// The residual towards the camera, of three channels.

fn residual_of(p: vec3f, view: vec3f) -> Spectrum {
    if params.residual_channels == 1u {
        return params.residual_color.xyz * residual_radiance(p, view, 0u);
    }
    return vec3f(residual_radiance(p, view, 0u), residual_radiance(p, view, 1u), residual_radiance(p, view, 2u));
}
