// A thread: (phi, F) of one cell of the medium and channel, with what an ordinate's grid holds there.

#import "principal_propagation/aligned.wgsl"

struct AddParams {
    grid: Aligned,
    // Of the channels that this grid was solved for, 0 for others.
    power: vec4f,
    // Cells of the medium.
    dims: vec3u,
    n_channels: u32,
}

@group(0) @binding(0) var<uniform> params: AddParams;
@group(1) @binding(0) var linear_clamp: sampler;
@group(1) @binding(1) var hops: texture_3d<f32>;
@group(1) @binding(2) var hops_flux: texture_3d<f32>;
@group(1) @binding(3) var before: texture_3d<f32>;
@group(2) @binding(0) var moments: texture_storage_3d<rgba32float, write>;

@compute @workgroup_size(8, 8, 1)
fn principal_propagation_literal_add(@builtin(global_invocation_id) id: vec3u) {
    if any(id.xy >= params.dims.xy) || id.z >= params.dims.z * params.n_channels {
        return;
    }
    let cell = vec3f(vec3u(id.xy, id.z % params.dims.z));
    let p = (aligned_from_index(params.grid, cell) + 0.5) / vec3f(params.grid.dims);
    let phi = textureSampleLevel(hops, linear_clamp, p, 0.0).w;
    let flux = textureSampleLevel(hops_flux, linear_clamp, p, 0.0).x;
    let added = params.power[id.z / params.dims.z] * vec4f(phi, flux * params.grid.w);
    textureStore(moments, id, textureLoad(before, id, 0) + added);
}
