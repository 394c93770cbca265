// A workgroup: the factor of one channel that makes power in equal to power out and absorbed.

#import "isotropic_residual/common.wgsl"

struct BalanceParams {
    level: Level,
    // Power that enters on all lines together for an inflow of 1 [W per W/(m2 sr)].
    entering: f32,
    // 0: the factor is 1 (inside a V-cycle).
    rebalance: u32,
    // line_sums holds so many entries a channel.
    n_sums: u32,
    n_sources: u32,
}

@group(0) @binding(0) var<uniform> params: BalanceParams;
@group(1) @binding(0) var<storage, read> line_sums: array<vec2f>;
@group(1) @binding(1) var<storage, read> source_sums: array<f32>;
@group(2) @binding(0) var<storage, read_write> balance: array<f32>;

// Threads, and how many sums each has under way at once: a GPU waits for memory, not for additions.
const THREADS: u32 = 256u;
const AT_ONCE: u32 = 8u;

var<workgroup> lost: array<f32, THREADS>;
var<workgroup> given: array<f32, THREADS>;

@compute @workgroup_size(THREADS, 1, 1)
fn isotropic_residual_balance(@builtin(local_invocation_id) local: vec3u, @builtin(workgroup_id) group: vec3u) {
    let c = group.z;
    let end = params.n_sums;
    var partial: array<f32, AT_ONCE>;
    for (var first = local.x; first < end; first += THREADS * AT_ONCE) {
        for (var n = 0u; n < AT_ONCE; n += 1u) {
            let idx = first + n * THREADS;
            let sums = line_sums[c * end + min(idx, end - 1u)];
            partial[n] += select(0.0, sums.x + sums.y, idx < end);
        }
    }
    var out = 0.0;
    for (var n = 0u; n < AT_ONCE; n += 1u) {
        out += partial[n];
    }
    var source = 0.0;
    for (var idx = local.x; idx < params.n_sources; idx += THREADS) {
        source += source_sums[c * params.n_sources + idx];
    }
    lost[local.x] = out;
    given[local.x] = source;
    for (var half = THREADS / 2u; half > 0u; half /= 2u) {
        workgroupBarrier();
        if local.x < half {
            lost[local.x] += lost[local.x + half];
            given[local.x] += given[local.x + half];
        }
    }
    if local.x == 0u {
        let total = lost[0];
        let all_given = given[0] + params.entering * params.level.channels[c].inflow;
        let balanced = params.rebalance == 0u || total <= 0.0;
        balance[c] = select(all_given / max(total, 1e-37), 1.0, balanced);
    }
}
