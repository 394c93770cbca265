// What a view ray sees of glowing gas: at the middle of every step, since flames are thinner than smoke.

// Emitted radiance per meter at a point of index space, in the channels of the march.
fn glow(p: vec3f) -> Spectrum {
    return spectrum(vec4f(emitted(params.heat, flame, temperature, blackbodies, linear_clamp, p), 0.0));
}
