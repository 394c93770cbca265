// A thread: a swept cell and channel with its defect added (a coarse grid's equation in a V-cycle).

#import "isotropic_residual/common.wgsl"
#import "isotropic_residual/realizable.wgsl"

@group(0) @binding(0) var<uniform> level: Level;
@group(1) @binding(0) var swept: texture_3d<f32>;
@group(1) @binding(1) var defect: texture_3d<f32>;
@group(2) @binding(0) var shifted: texture_storage_3d<rgba32float, write>;

@compute @workgroup_size(8, 8, 1)
fn isotropic_residual_shift(@builtin(global_invocation_id) id: vec3u) {
    if all(id.xy < level.dims.xy) && id.z < level.dims.z * level.n_channels {
        textureStore(shifted, id, realizable(textureLoad(swept, id, 0) + textureLoad(defect, id, 0)));
    }
}
