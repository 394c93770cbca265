// A coarser level's field at a cell of a finer one, trilinear between the coarse cells around it.

#import "isotropic_residual/common.wgsl"

fn sample_coarse(level: Level, coarse: texture_3d<f32>, linear_clamp: sampler, id: vec3u) -> vec4f {
    let c = id.z / level.dims.z;
    let size = vec3f(textureDimensions(coarse));
    let layer = size.z / f32(level.n_channels);
    var p = (vec3f(vec3u(id.xy, id.z % level.dims.z)) + 0.5) * 0.5;
    // Half a texel from the layer's faces, so that channels do not mix.
    p.z = clamp(p.z, 0.5, layer - 0.5) + f32(c) * layer;
    return textureSampleLevel(coarse, linear_clamp, p / size, 0.0);
}
