// A thread: the largest extinction or emission that a sample in one block of cells can meet. A sample reads
// the cells around it, so a block reaches one cell beyond its own on every side.

#import "lib/block.wgsl"

struct OccupancyParams {
    n_blocks: vec3u,
    pad: u32,
}

@group(0) @binding(0) var<uniform> params: OccupancyParams;
@group(1) @binding(0) var sigma_t: texture_3d<f32>;
@group(1) @binding(1) var emission: texture_3d<f32>;
@group(2) @binding(0) var blocks: texture_storage_3d<r32float, write>;

const HAS_EMISSION: bool = {emission};

@compute @workgroup_size(8, 8, 1)
fn occupancy(@builtin(global_invocation_id) id: vec3u) {
    if any(id >= params.n_blocks) {
        return;
    }
    let n_cells = vec3i(textureDimensions(sigma_t));
    let low = max(vec3i(id) * BLOCK - 1, vec3i(0));
    let high = min(vec3i(id + 1u) * BLOCK, n_cells - 1);
    var largest = 0.0;
    for (var z = low.z; z <= high.z; z += 1) {
        for (var y = low.y; y <= high.y; y += 1) {
            for (var x = low.x; x <= high.x; x += 1) {
                largest = max(largest, textureLoad(sigma_t, vec3i(x, y, z), 0).x);
                if HAS_EMISSION {
                    let glow = textureLoad(emission, vec3i(x, y, z), 0).xyz;
                    largest = max(largest, max(glow.x, max(glow.y, glow.z)));
                }
            }
        }
    }
    textureStore(blocks, id, vec4f(largest));
}
