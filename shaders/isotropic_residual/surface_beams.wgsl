// A thread: the irradiance [W/m2] of beams at a point of a surface, through the medium and past surfaces; on its
// front and on its back of narrow beams, and then the same of the others.

#import "isotropic_residual/bounce.wgsl"
#import "isotropic_residual/surface_point.wgsl"
#import "lib/surface_beam.wgsl"

@group(0) @binding(0) var<uniform> params: BounceParams;
@group(1) @binding(0) var sigma_t: texture_3d<f32>;
@group(1) @binding(1) var linear_clamp: sampler;
@group(1) @binding(2) var blocks: texture_3d<f32>;
@group(1) @binding(3) var<storage, read> surface_nodes: array<SurfaceNode>;
@group(1) @binding(4) var<storage, read> surface_triangles: array<SurfaceTriangle>;
@group(1) @binding(5) var<storage, read> points: array<SurfacePoint>;
@group(1) @binding(6) var<storage, read> beams: array<Beam>;
@group(2) @binding(0) var<storage, read_write> lit_by_beams: array<vec4f>;

// Whether the medium dims them.
const HAS_DEPTHS: bool = {depths};

@compute @workgroup_size(64, 1, 1)
fn isotropic_residual_surface_beams(@builtin(global_invocation_id) id: vec3u) {
    let idx = id.x + ROW * id.y;
    if idx >= params.n_points {
        return;
    }
    let level = params.level;
    let k = vec3f(level.channels[0].k, level.channels[1].k, level.channels[2].k);
    let lit = points[idx];
    let front = front_normal(lit.triangle);
    var sums: array<vec3f, 4>;
    for (var n = 0u; n < params.n_beams; n += 1u) {
        let beam = beams[n];
        let way = to_light(beam, true, level.cell_m, lit.p);
        let cosine = dot(front, way.direction);
        if cosine != 0.0 && !is_occluded(lit.p, way.direction, way.reach) {
            var tau = 0.0;
            if HAS_DEPTHS {
                tau = walk_past(sigma_t, linear_clamp, blocks, params.shape, level.cell_m, lit.p, way.direction, way.reach);
            }
            sums[u32(cosine < 0.0) + 2u * u32(!is_narrow(beam))] += abs(cosine) * way.falloff * beam.power.xyz * exp(-k * tau);
        }
    }
    for (var n = 0u; n < 4u; n += 1u) {
        lit_by_beams[4u * idx + n] = vec4f(sums[n], 0.0);
    }
}
