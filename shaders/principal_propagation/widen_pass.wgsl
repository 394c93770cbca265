// A thread: one column of a beam's aligned grid, at one face between slices, and through the slice behind it
// (DESIGN 6.5, Fermi and Eyges).

#import "principal_propagation/aligned.wgsl"
#import "principal_propagation/widen_column.wgsl"
#import "lib/bvh.wgsl"
#import "lib/walk.wgsl"
#import "lib/transmittance.wgsl"

struct WidenParams {
    grid: Aligned,
    // sigma_t* / sigma_t, and what it lacks of 1: the peak's scattering.
    k: f32,
    peak: f32,
    // Variance of angle, an axis, that an optical depth adds.
    spread: f32,
    face: u32,
}

// Of the light that is the peak's: where less is, rounding decides what it is, and it does not widen.
const LEAST_SHARE: f32 = {least_share};
// Of a peak at all [of what entered].
const LEAST_POWER: f32 = {least_power};

@group(0) @binding(0) var<uniform> params: WidenParams;
@group(1) @binding(0) var sigma_t: texture_3d<f32>;
@group(1) @binding(1) var linear_clamp: sampler;
@group(1) @binding(2) var<storage, read> surface_nodes: array<SurfaceNode>;
@group(1) @binding(3) var<storage, read> surface_triangles: array<SurfaceTriangle>;
@group(2) @binding(0) var<storage, read_write> columns: array<Column>;
@group(2) @binding(1) var star: texture_storage_3d<r32float, write>;
@group(2) @binding(2) var straight: texture_storage_3d<r32float, write>;

@compute @workgroup_size(8, 8, 1)
fn principal_propagation_widen_pass(@builtin(global_invocation_id) id: vec3u) {
    let grid = params.grid;
    if any(id.xy >= grid.dims.xy) {
        return;
    }
    let idx = id.x + grid.dims.x * id.y;
    var column = columns[idx];
    var reach = 1.0 + 2.0 * SURFACE_GAP;
    if params.face == 0u {
        column = Column(1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0);
        reach = 1e30;
    }
    let place = vec3f(vec2f(id.xy), f32(params.face));
    if is_occluded(index_from_aligned(grid, place - vec3f(0.0, 0.0, 0.5)), -grid.w, reach) {
        column = Column(0.0, 0.0, 0.0, 0.0, column.straight, 0.0, 0.0, 0.0);
    }
    let texel = vec3u(id.xy, params.face);
    textureStore(star, texel, vec4f(column.unscattered + column.power));
    textureStore(straight, texel, vec4f(column.straight));
    if params.face < grid.dims.z {
        let h = grid.cell_m;
        let depth = extinction(sigma_t, linear_clamp, index_from_aligned(grid, place)) * h;
        let kept = exp(-params.k * depth);
        let em = (column.unscattered + column.power) * mean_transmittance(params.k * depth);
        let widened = params.spread * depth * em;
        let to_peak = params.peak * depth * mean_transmittance(params.peak * depth);
        column.power = kept * (column.power + column.unscattered * to_peak);
        column.unscattered *= exp(-depth);
        // Of place in lengths of a cell.
        column.covariance = column.covariance * kept + column.variance * kept + 0.5 * widened;
        column.variance = column.variance * kept + widened;
        column.straight *= kept;
        let least = max(LEAST_SHARE * (column.unscattered + column.power), LEAST_POWER);
        column.number = column.covariance / max(column.power, least);
    }
    columns[idx] = column;
}
