// The residual towards the camera, of one channel.

fn residual_of(p: vec3f, view: vec3f) -> Spectrum {
    return params.residual_color.x * residual_radiance(p, view, 0u);
}
