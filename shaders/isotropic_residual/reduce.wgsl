// A thread: phi and F of one cell and channel, the sum of its mean radiances over the directions of this
// batch, added to what earlier batches of the same sweep gave.

#import "isotropic_residual/batch.wgsl"

@group(0) @binding(0) var<uniform> batch: Batch;
@group(1) @binding(0) var<storage, read> mean_radiance: array<f32>;
@group(1) @binding(1) var earlier: texture_3d<f32>;
@group(2) @binding(0) var moments: texture_storage_3d<rgba32float, write>;

@compute @workgroup_size(8, 8, 1)
fn isotropic_residual_reduce(@builtin(global_invocation_id) id: vec3u) {
    let level = batch.level;
    if any(id.xy >= level.dims.xy) || id.z >= level.dims.z * level.n_channels {
        return;
    }
    let c = id.z / level.dims.z;
    let n_cells = level.dims.x * level.dims.y * level.dims.z;
    let cell = id.x + level.dims.x * (id.y + level.dims.y * (id.z % level.dims.z));
    // The pairs of this channel that lie in this batch.
    let first = max(c * level.n_directions, batch.first);
    let last = min((c + 1u) * level.n_directions, batch.first + batch.n_pairs);
    var sum = vec4f(0.0);
    if batch.first > 0u {
        sum = textureLoad(earlier, id, 0);
    }
    for (var pair = first; pair < last; pair += 1u) {
        let direction = batch.directions[pair - c * level.n_directions];
        let flux = direction.weight * mean_radiance[(pair - batch.first) * n_cells + cell];
        sum += flux * vec4f(1.0, direction.omega);
    }
    // Where first moments underflow |F| can exceed phi; it never may.
    let len = length(sum.yzw);
    if len > sum.x {
        sum = vec4f(sum.x, sum.yzw * (sum.x / len));
    }
    textureStore(moments, id, sum);
}
