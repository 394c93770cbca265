// A thread: what a cell and channel has so far of a sweep in several batches.

#import "isotropic_residual/gather.wgsl"

@group(2) @binding(0) var partial: texture_storage_3d<rgba32float, write>;

@compute @workgroup_size(8, 8, 1)
fn isotropic_residual_gather_partial(@builtin(global_invocation_id) thread: vec3u) {
    let id = cell_of(thread);
    if has_cell(id) {
        textureStore(partial, id, gather(id));
    }
}
