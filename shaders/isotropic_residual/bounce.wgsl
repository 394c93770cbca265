// What the stages of surfaces' light share.

#import "isotropic_residual/common.wgsl"
#import "lib/layered.wgsl"
#import "lib/walk.wgsl"

struct BounceParams {
    level: Level,
    shape: Shape,
    n_beams: u32,
    // Points that are lit.
    n_points: u32,
    // Edge of the cells that surfaces light, in cells of the level.
    coarser: u32,
    pad: u32,
    // A ball around most of the flame: center in index space, and radius [cells].
    flame: vec4f,
}
