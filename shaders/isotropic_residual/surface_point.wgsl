// Points of surfaces at which light is known.

struct SurfacePoint {
    // In index space.
    p: vec3f,
    triangle: u32,
}

// Threads along x of one dispatch: beyond 65,535 groups of 64 they stand along y.
const ROW: u32 = 4194240u;
