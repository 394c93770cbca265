// A thread: the power of the sources in one column of cells of one channel [W].

#import "isotropic_residual/common.wgsl"

@group(0) @binding(0) var<uniform> level: Level;
@group(1) @binding(0) var sources: texture_3d<f32>;
@group(2) @binding(0) var<storage, read_write> source_sums: array<f32>;

@compute @workgroup_size(8, 8, 1)
fn isotropic_residual_source_sum(@builtin(global_invocation_id) id: vec3u) {
    if any(id.xy >= level.dims.xy) || id.z >= level.n_channels {
        return;
    }
    var sum = 0.0;
    for (var z = 0u; z < level.dims.z; z += 1u) {
        sum += textureLoad(sources, vec3u(id.xy, id.z * level.dims.z + z), 0).x;
    }
    let idx = id.x + level.dims.x * (id.y + level.dims.y * id.z);
    source_sums[idx] = sum * level.cell_m * level.cell_m * level.cell_m;
}
