// Blocks of cells, and the way through the empty ones.

// Edge of a block [cells].
const BLOCK: i32 = 8;

// A ray's way through the block around a point.
struct BlockWay {
    // t at which the ray leaves the block.
    until: f32,
    // Whether something in it can be met.
    is_filled: bool,
}

// The block around `p` (index space), on a ray from `origin`.
fn block_way(blocks: texture_3d<f32>, origin: vec3f, direction: vec3f, p: vec3f) -> BlockWay {
    let block = floor((p + 0.5) / f32(BLOCK));
    let far = (block + select(vec3f(0.0), vec3f(1.0), direction >= vec3f(0.0))) * f32(BLOCK) - 0.5;
    // Along an axis that it does not follow, a ray never leaves.
    let t = select(vec3f(1e30), (far - origin) / direction, abs(direction) > vec3f(1e-9));
    return BlockWay(min(t.x, min(t.y, t.z)), textureLoad(blocks, vec3i(block), 0).x > 0.0);
}

// t at which a ray leaves the block around `p`, if nothing in that block can be met; else 0.
fn empty_until(blocks: texture_3d<f32>, origin: vec3f, direction: vec3f, p: vec3f) -> f32 {
    let way = block_way(blocks, origin, direction, p);
    return select(way.until, 0.0, way.is_filled);
}
