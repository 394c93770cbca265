// Fields whose channels stand along z, one layer beyond the other.

// Trilinear value of channel c at a position in the field's own cells.
fn layered(field: texture_3d<f32>, linear_clamp: sampler, n_channels: u32, c: u32, p: vec3f) -> vec4f {
    let size = vec3f(textureDimensions(field));
    let layer = size.z / f32(n_channels);
    // Half a texel from the layer's faces, so that channels do not mix.
    let z = clamp(p.z + 0.5, 0.5, layer - 0.5) + f32(c) * layer;
    return textureSampleLevel(field, linear_clamp, vec3f(p.xy + 0.5, z) / size, 0.0);
}
