// A coarser level's field at a cell of a finer one, trilinear between the coarse cells around it.

#import "isotropic_residual/common.wgsl"
#import "lib/layered.wgsl"

fn sample_coarse(level: Level, coarse: texture_3d<f32>, linear_clamp: sampler, id: vec3u) -> vec4f {
    let cell = vec3u(id.xy, id.z % level.dims.z);
    let p = 0.5 * (vec3f(cell) + 0.5) - 0.5;
    return layered(coarse, linear_clamp, level.n_channels, id.z / level.dims.z, p);
}
