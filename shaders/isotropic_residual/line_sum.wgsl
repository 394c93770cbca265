// A workgroup: the sum of some of the powers of lines of one channel. There are tens of thousands, and a GPU that adds
// them up in one workgroup waits for memory longer than it sweeps.

struct LineSumParams {
    // Lines and sums of a channel, and lines of a sum.
    n_lines: u32,
    n_sums: u32,
    lines_per_sum: u32,
    pad: u32,
}

@group(0) @binding(0) var<uniform> params: LineSumParams;
@group(1) @binding(0) var<storage, read> line_powers: array<vec2f>;
@group(2) @binding(0) var<storage, read_write> line_sums: array<vec2f>;

const THREADS: u32 = 64u;

var<workgroup> sums: array<vec2f, THREADS>;

@compute @workgroup_size(THREADS, 1, 1)
fn isotropic_residual_line_sum(@builtin(local_invocation_id) local: vec3u, @builtin(workgroup_id) group: vec3u) {
    let c = group.z;
    let end = min((group.x + 1u) * params.lines_per_sum, params.n_lines);
    var sum = vec2f(0.0);
    for (var idx = group.x * params.lines_per_sum + local.x; idx < end; idx += THREADS) {
        sum += line_powers[c * params.n_lines + idx];
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
