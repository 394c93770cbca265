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

// The cell (x, y, layer) of a thread: there is one for each of the batch's channels.
fn cell_of(thread: vec3u) -> vec3u {
    return thread + vec3u(0u, 0u, batch.first_channel * batch.level.dims.z);
}

// Whether there is such a cell.
fn has_cell(id: vec3u) -> bool {
    return all(id.xy < batch.level.dims.xy);
}

// Where the lobe of a thread's cell stands among those that are bound.
fn lobe_index(id: vec3u) -> u32 {
    let dims = batch.level.dims;
    return id.x + dims.x * (id.y + dims.y * (id.z - batch.first_channel * dims.z));
}
