// Blocks of cells, and the way through the empty ones.

// Edge of a block [cells].
const BLOCK: i32 = 8;

// t at which a ray leaves the block around `p` (index space), if nothing in that block can be met; else 0.
fn empty_until(blocks: texture_3d<f32>, origin: vec3f, direction: vec3f, p: vec3f) -> f32 {
    let block = floor((p + 0.5) / f32(BLOCK));
    if textureLoad(blocks, vec3i(block), 0).x > 0.0 {
        return 0.0;
    }
    let far = (block + select(vec3f(0.0), vec3f(1.0), direction >= vec3f(0.0))) * f32(BLOCK) - 0.5;
    // Along an axis that it does not follow, a ray never leaves.
    let t = select(vec3f(1e30), (far - origin) / direction, abs(direction) > vec3f(1e-9));
    return min(t.x, min(t.y, t.z));
}
