// A thread: the irradiance [W/m2] that beams bring to one side of a point of a surface, past surfaces and through
// the medium, in three channels.

#import "lib/beam.wgsl"
#import "lib/surface_beam.wgsl"

struct ArrivalParams {
    shape: Shape,
    // sigma_t* / sigma_t of three channels.
    k: vec3f,
    cell_m: f32,
    n_beams: u32,
    n_points: u32,
    pad_0: u32,
    pad_1: u32,
}

struct SurfacePoint {
    // In index space.
    p: vec3f,
    triangle: u32,
}

@group(0) @binding(0) var<uniform> params: ArrivalParams;
@group(1) @binding(0) var sigma_t: texture_3d<f32>;
@group(1) @binding(1) var linear_clamp: sampler;
@group(1) @binding(2) var<storage, read> surface_nodes: array<SurfaceNode>;
@group(1) @binding(3) var<storage, read> surface_triangles: array<SurfaceTriangle>;
@group(1) @binding(4) var<storage, read> points: array<SurfacePoint>;
@group(1) @binding(5) var<storage, read> beams: array<Beam>;
@group(2) @binding(0) var<storage, read_write> irradiances: array<vec4f>;

// Threads along x of one dispatch.
const ROW: u32 = 4194240u;

@compute @workgroup_size(64, 1, 1)
fn bounce_lights(@builtin(global_invocation_id) id: vec3u) {
    let idx = id.x + ROW * id.y;
    if idx >= 2u * params.n_points {
        return;
    }
    let point = points[idx / 2u];
    let front = front_normal(point.triangle);
    let normal = select(front, -front, idx % 2u == 1u);
    var irradiance = vec3f(0.0);
    for (var n = 0u; n < params.n_beams; n += 1u) {
        let beam = beams[n];
        let found = arrival(beam, true, sigma_t, linear_clamp, params.shape, params.cell_m, point.p, normal);
        irradiance += found.share * beam.power.xyz * exp(-params.k * found.tau);
    }
    irradiances[idx] = vec4f(irradiance, 0.0);
}
