// A workgroup: the factor of one channel that makes power in equal to power out and absorbed.

#import "isotropic_residual/common.wgsl"

struct BalanceParams {
    level: Level,
    // Power that enters on all lines together for an inflow of 1 [W per W/(m2 sr)].
    entering: f32,
    // 0: the factor is 1 (inside a V-cycle).
    rebalance: u32,
    // line_sums and source_sums hold so many entries a channel.
    n_sums: u32,
    n_sources: u32,
}

@group(0) @binding(0) var<uniform> params: BalanceParams;
@group(1) @binding(0) var<storage, read> line_sums: array<vec2f>;
@group(1) @binding(1) var<storage, read> source_sums: array<f32>;
@group(2) @binding(0) var<storage, read_write> balance: array<f32>;

var<workgroup> lost: array<f32, 64>;
var<workgroup> given: array<f32, 64>;

@compute @workgroup_size(64, 1, 1)
fn isotropic_residual_balance(@builtin(local_invocation_id) local: vec3u, @builtin(workgroup_id) group: vec3u) {
    let c = group.z;
    var out = 0.0;
    for (var idx = local.x; idx < params.n_sums; idx += 64u) {
        let sums = line_sums[c * params.n_sums + idx];
        out += sums.x + sums.y;
    }
    var source = 0.0;
    for (var idx = local.x; idx < params.n_sources; idx += 64u) {
        source += source_sums[c * params.n_sources + idx];
    }
    lost[local.x] = out;
    given[local.x] = source;
    workgroupBarrier();
    if local.x == 0u {
        out = 0.0;
        source = params.entering * params.level.channels[c].inflow;
        for (var idx = 0u; idx < 64u; idx += 1u) {
            out += lost[idx];
            source += given[idx];
        }
        let balanced = params.rebalance == 0u || out <= 0.0;
        balance[c] = select(source / max(out, 1e-37), 1.0, balanced);
    }
}
