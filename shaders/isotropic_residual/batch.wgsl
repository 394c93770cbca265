// The directions of a sweep, and which of the (channel, direction) pairs one dispatch covers.

#import "isotropic_residual/common.wgsl"

struct Direction {
    // Cells per step, and the weight [sr].
    e: vec3i,
    weight: f32,
    // Unit vector, and length of a step [cells].
    omega: vec3f,
    stride: f32,
}

struct Batch {
    level: Level,
    // First (channel, direction) pair of this batch and their number.
    first: u32,
    n_pairs: u32,
    // Channel of the first lobe that is bound.
    first_channel: u32,
    pad: u32,
    directions: array<Direction, 50>,
}

@group(0) @binding(0) var<uniform> batch: Batch;

// Whether lobes have a direction; where g is 0 they have none.
const HAS_LOBES: bool = {lobes};

// Whether a thread (x, y, layer) has a cell in this batch's channels.
fn has_cell(id: vec3u) -> bool {
    let c = id.z / batch.level.dims.z;
    let first = batch.first / batch.level.n_directions;
    let last = (batch.first + batch.n_pairs - 1u) / batch.level.n_directions;
    return all(id.xy < batch.level.dims.xy) && c >= first && c <= last;
}

// Where the lobe of a thread's cell stands among those that are bound.
fn lobe_index(id: vec3u) -> u32 {
    let dims = batch.level.dims;
    return id.x + dims.x * (id.y + dims.y * (id.z - batch.first_channel * dims.z));
}
