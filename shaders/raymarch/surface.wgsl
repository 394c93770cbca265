// Light that a surface sends towards the eye: reflectance / pi times what arrives (DESIGN 6.7).

// Radiance from where a ray of this direction meets a surface, at `p`.
fn surface_radiance(triangle: u32, p: vec3f, direction: vec3f) -> vec3f {
    let normal = surface_normal(triangle, direction);
    var irradiance = Spectrum(0.0);
    for (var n = 0u; n < n_beams(); n += 1u) {
        // The others' light is in what the residual has gathered.
        if !HAS_GATHERED || is_narrow(beams[n]) {
            let found = arrival(beams[n], HAS_POINTS, sigma_t, linear_clamp, params.shape, params.cell_m, p, normal);
            // Light that was scattered forward counts as undeflected.
            irradiance += found.share * spectrum(beams[n].power) * exp(-spectrum(params.k) * found.tau);
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
