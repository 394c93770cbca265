// A thread: phi and F of one cell and channel after a sweep.

#import "isotropic_residual/gather.wgsl"

@group(1) @binding(2) var<storage, read> balance: array<f32>;
@group(2) @binding(0) var moments: texture_storage_3d<rgba32float, write>;

@compute @workgroup_size(8, 8, 1)
fn isotropic_residual_gather_moments(@builtin(global_invocation_id) thread: vec3u) {
    let id = cell_of(thread);
    if has_cell(id) {
        textureStore(moments, id, gather_balanced(id, balance[id.z / batch.level.dims.z]));
    }
}
