// A thread: the optical depths along one direction of one light's grid, node by node outwards, and that of all of
// the way. Nodes behind the first surface are hidden.

#import "lib/walk.wgsl"
#import "lib/bvh.wgsl"
#import "lib/radial.wgsl"
#import "lib/shadow.wgsl"

struct RadialParams {
    shape: Shape,
    n_lights: u32,
    // Directions along an edge, of all lights.
    n_angular: u32,
    cell_m: f32,
    pad: u32,
}

@group(0) @binding(0) var<uniform> params: RadialParams;
@group(1) @binding(0) var sigma_t: texture_3d<f32>;
@group(1) @binding(1) var linear_clamp: sampler;
@group(1) @binding(2) var<storage, read> radial_lights: array<RadialLight>;
// In index space.
@group(1) @binding(3) var<storage, read> positions: array<vec4f>;
@group(1) @binding(4) var<storage, read> surface_nodes: array<SurfaceNode>;
@group(1) @binding(5) var<storage, read> surface_triangles: array<SurfaceTriangle>;
@group(2) @binding(0) var radial_out: texture_storage_3d<r32float, write>;
// Depth of the whole way of each direction, light by light, row by row.
@group(2) @binding(1) var<storage, read_write> exits: array<f32>;

const HAS_SHADOWS: bool = {shadows};
// A depth beyond which numbers that are interpolated would not be finite.
const DEEPEST: f32 = 6e4;

@compute @workgroup_size(8, 8, 1)
fn radial_depths(@builtin(global_invocation_id) id: vec3u) {
    let n = params.n_angular;
    if any(id.xy >= vec2u(n + 2u)) || id.z >= params.n_lights {
        return;
    }
    let light = radial_lights[id.z];
    let position = positions[id.z].xyz;
    // A border of one texel on all sides.
    let on_square = light.crop.xy + (vec2f(id.xy) - 0.5) / f32(n) * light.crop.zw;
    let direction = radial_frame(light) * octahedral_direction(on_square);
    var reach = 1e30;
    if HAS_SHADOWS {
        reach = nearest_surface(position, direction, 1e30).t;
    }
    var tau = 0.0;
    var until_exit = 0.0;
    var from_r = radial_distance(light, 0u);
    for (var node = 0u; node < light.n_radial; node += 1u) {
        let r = radial_distance(light, node);
        if r > from_r {
            let p = position + from_r * direction;
            if HAS_SHADOWS && from_r < reach {
                until_exit = tau + walk(sigma_t, linear_clamp, params.shape, params.cell_m, p, direction, min(r, reach) - from_r);
            }
            tau += walk(sigma_t, linear_clamp, params.shape, params.cell_m, p, direction, r - from_r);
        }
        let is_lit = !HAS_SHADOWS || r <= reach;
        textureStore(radial_out, light.origin + vec3u(id.xy, node), vec4f(select(HIDDEN, min(tau, DEEPEST), is_lit)));
        from_r = r;
    }
    if all(id.xy >= vec2u(1u)) && all(id.xy <= vec2u(n)) {
        exits[(id.z * n + id.y - 1u) * n + id.x - 1u] = select(tau, until_exit, HAS_SHADOWS);
    }
}
