// phi and F of a cell: the sum of its mean radiances over the directions of a batch, added to what earlier
// batches of the same sweep gave.

#import "isotropic_residual/batch.wgsl"
#import "isotropic_residual/realizable.wgsl"

@group(1) @binding(0) var<storage, read> mean_radiance: array<f32>;
@group(1) @binding(1) var earlier: texture_3d<f32>;

fn gather(id: vec3u) -> vec4f {
    let level = batch.level;
    let c = id.z / level.dims.z;
    let n_cells = level.dims.x * level.dims.y * level.dims.z;
    let cell = id.x + level.dims.x * (id.y + level.dims.y * (id.z % level.dims.z));
    // The pairs of this channel that lie in this batch.
    let first = max(c * level.n_directions, batch.first);
    let last = min((c + 1u) * level.n_directions, batch.first + batch.n_pairs);
    var sum = vec4f(0.0);
    if first > c * level.n_directions {
        sum = textureLoad(earlier, id, 0);
    }
    for (var pair = first; pair < last; pair += 1u) {
        let direction = batch.directions[pair - c * level.n_directions];
        let flux = direction.weight * mean_radiance[(pair - batch.first) * n_cells + cell];
        sum += flux * vec4f(1.0, direction.omega);
    }
    return sum;
}

// The same once the sweep is complete: rebalanced, and |F| <= phi, which rounding can break where first
// moments underflow.
fn gather_balanced(id: vec3u, balance: f32) -> vec4f {
    return realizable(balance * gather(id));
}
