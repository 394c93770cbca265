// A workgroup: the sum of so many powers of lines of one channel. There are ten thousands, and a GPU that adds
// them up in one workgroup waits for memory longer than it sweeps.

struct LineSumParams {
    // Lines and sums of a channel.
    n_lines: u32,
    n_sums: u32,
    pad_0: u32,
    pad_1: u32,
}

@group(0) @binding(0) var<uniform> params: LineSumParams;
@group(1) @binding(0) var<storage, read> lines: array<vec2f>;
@group(2) @binding(0) var<storage, read_write> line_sums: array<vec2f>;

const THREADS: u32 = 64u;
// Lines of a workgroup; LINES_OF_A_SUM of level.rs.
const LINES: u32 = 1024u;

var<workgroup> sums: array<vec2f, THREADS>;

@compute @workgroup_size(THREADS, 1, 1)
fn isotropic_residual_line_sum(@builtin(local_invocation_id) local: vec3u, @builtin(workgroup_id) group: vec3u) {
    let c = group.z;
    let end = min((group.x + 1u) * LINES, params.n_lines);
    var sum = vec2f(0.0);
    for (var idx = group.x * LINES + local.x; idx < end; idx += THREADS) {
        sum += lines[c * params.n_lines + idx];
    }
    sums[local.x] = sum;
    workgroupBarrier();
    if local.x == 0u && group.x < params.n_sums {
        sum = vec2f(0.0);
        for (var n = 0u; n < THREADS; n += 1u) {
            sum += sums[n];
        }
        line_sums[c * params.n_sums + group.x] = sum;
    }
}
