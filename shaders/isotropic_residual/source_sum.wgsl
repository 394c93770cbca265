// A thread: the power of the sources in one column of cells of one channel [W]; a workgroup: their sum.

#import "isotropic_residual/common.wgsl"

@group(0) @binding(0) var<uniform> level: Level;
@group(1) @binding(0) var sources: texture_3d<f32>;
@group(2) @binding(0) var<storage, read_write> source_sums: array<f32>;

// Columns of a workgroup along an axis; COLUMNS_OF_A_SUM of sources.rs.
const EDGE: u32 = 8u;

var<workgroup> sums: array<f32, EDGE * EDGE>;

@compute @workgroup_size(EDGE, EDGE, 1)
fn isotropic_residual_source_sum(
    @builtin(global_invocation_id) id: vec3u,
    @builtin(local_invocation_index) local: u32,
    @builtin(workgroup_id) group: vec3u,
    @builtin(num_workgroups) n_groups: vec3u,
) {
    var sum = 0.0;
    let n_cells = select(0u, level.dims.z, all(id.xy < level.dims.xy));
    for (var z = 0u; z < n_cells; z += 1u) {
        sum += textureLoad(sources, vec3u(id.xy, id.z * level.dims.z + z), 0).x;
    }
    sums[local] = sum;
    workgroupBarrier();
    if local == 0u {
        sum = 0.0;
        for (var n = 0u; n < EDGE * EDGE; n += 1u) {
            sum += sums[n];
        }
        let idx = group.x + n_groups.x * (group.y + n_groups.y * group.z);
        source_sums[idx] = sum * level.cell_m * level.cell_m * level.cell_m;
    }
}
