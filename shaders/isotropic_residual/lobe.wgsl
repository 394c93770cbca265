// A thread: the lobe of one cell and channel, from its moments and sources.

#import "isotropic_residual/batch.wgsl"
#import "isotropic_residual/source_lobe.wgsl"

@group(1) @binding(0) var sigma_t: texture_3d<f32>;
@group(1) @binding(1) var sources: texture_3d<f32>;
@group(1) @binding(2) var moments: texture_3d<f32>;
@group(2) @binding(0) var<storage, read_write> lobes: array<vec4u>;

@compute @workgroup_size(8, 8, 1)
fn isotropic_residual_lobe(@builtin(global_invocation_id) thread: vec3u) {
    let id = cell_of(thread);
    let level = batch.level;
    if !has_cell(id) {
        return;
    }
    let c = id.z / level.dims.z;
    let extinction = textureLoad(sigma_t, vec3u(id.xy, id.z % level.dims.z), 0).x;
    let swept = textureLoad(moments, id, 0);
    lobes[lobe_index(id)] = source_lobe(level, c, extinction, textureLoad(sources, id, 0), swept);
}
