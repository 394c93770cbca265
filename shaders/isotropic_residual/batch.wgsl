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
    pad_0: u32,
    pad_1: u32,
    directions: array<Direction, 50>,
}
