// A thread: the sources of one cell and channel with those of point lights that have grids, so that these give
// just the power that leaves their rays (DESIGN 6.7).

#import "isotropic_residual/common.wgsl"

struct SettleParams {
    level: Level,
    // What sources of the lights are multiplied by, per channel.
    factor: vec3f,
    n_own: u32,
}

// What is given to one cell besides.
struct OwnCell {
    // [W/m3]
    power: vec3f,
    // x + dims.x (y + dims.y z)
    cell: u32,
}

@group(0) @binding(0) var<uniform> params: SettleParams;
@group(1) @binding(0) var before: texture_3d<f32>;
@group(1) @binding(1) var of_lights: texture_3d<f32>;
@group(1) @binding(2) var<storage, read> own: array<OwnCell>;
@group(2) @binding(0) var sources: texture_storage_3d<rgba32float, write>;

@compute @workgroup_size(8, 8, 1)
fn isotropic_residual_radial_settle(@builtin(global_invocation_id) id: vec3u) {
    let level = params.level;
    if any(id.xy >= level.dims.xy) || id.z >= level.dims.z * level.n_channels {
        return;
    }
    let c = id.z / level.dims.z;
    let cell = id.x + level.dims.x * (id.y + level.dims.y * (id.z % level.dims.z));
    var total = textureLoad(before, id, 0) + params.factor[c] * textureLoad(of_lights, id, 0);
    for (var n = 0u; n < params.n_own; n += 1u) {
        total.x += select(0.0, own[n].power[c], own[n].cell == cell);
    }
    textureStore(sources, id, total);
}
