// Light that a surface sends towards the eye: reflectance / pi times what arrives (DESIGN 6.7).

// Irradiance of one beam at a point of a surface, past others and through the medium; forward light counts as
// undeflected.
fn irradiance_of(beam: Beam, p: vec3f, normal: vec3f) -> Spectrum {
    var to_light = -beam.place.xyz;
    var reach = 1e30;
    var falloff = 1.0;
    if HAS_POINTS && beam.place.w > 0.0 {
        let line = beam.place.xyz - p;
        reach = max(length(line), SURFACE_GAP);
        to_light = line / reach;
        falloff = 1.0 / (reach * reach * params.cell_m * params.cell_m);
    }
    let cosine = dot(normal, to_light);
    if cosine <= 0.0 || is_occluded(p, to_light, reach) {
        return Spectrum(0.0);
    }
    let depth = walk(sigma_t, linear_clamp, params.shape, params.cell_m, p, to_light, reach);
    return cosine * falloff * spectrum(beam.power) * exp(-spectrum(params.k) * depth);
}

// Radiance from where a ray of this direction meets a surface, at `p`.
fn surface_radiance(triangle: u32, p: vec3f, direction: vec3f) -> vec3f {
    let normal = surface_normal(triangle, direction);
    var irradiance = Spectrum(0.0);
    for (var n = 0u; n < n_beams(); n += 1u) {
        // The others' light is in what the residual has gathered.
        if !HAS_GATHERED || is_narrow(beams[n]) {
            irradiance += irradiance_of(beams[n], p, normal);
        }
    }
    var arriving = params.color.xyz * rgb(irradiance);
    if HAS_GATHERED {
        let gathered = surface_irradiance(triangle, p, direction);
        let channels = select(gathered, gathered.xxx, params.residual_channels == 1u);
        arriving += params.color.xyz * params.residual_color.xyz * channels;
    }
    return surface_reflectance(triangle) / PI * arriving;
}
