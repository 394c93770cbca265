// A thread: one line through the grid along one direction of one channel, cell by cell. The line wraps
// at the sides; there the old line leaks and a new one enters, so that all lines of a direction are
// covered by the threads of one face (DESIGN 6.4, "line-exact").

#import "isotropic_residual/batch.wgsl"
#import "lib/lobe.wgsl"

@group(0) @binding(0) var<uniform> batch: Batch;
@group(1) @binding(0) var lobes: texture_3d<u32>;
@group(2) @binding(0) var<storage, read_write> mean_radiance: array<f32>;
@group(2) @binding(1) var<storage, read_write> line_sums: array<vec2f>;

@compute @workgroup_size(8, 8, 1)
fn isotropic_residual_sweep(@builtin(global_invocation_id) id: vec3u) {
    let level = batch.level;
    let pair = batch.first + id.z;
    let c = pair / level.n_directions;
    let direction = batch.directions[pair % level.n_directions];
    let e = direction.e;
    let n = vec3i(level.dims);
    let cells = abs(e);

    // Lines march along the axis of the longest component, z before y before x: lanes then stand along x.
    var along = vec3i(0, 0, 1);
    if cells.z < max(cells.x, cells.y) {
        along = select(vec3i(1, 0, 0), vec3i(0, 1, 0), cells.y >= cells.x);
    }
    let hop = dot(cells, along);
    let u_axis = select(vec3i(1, 0, 0), vec3i(0, 1, 0), along.x == 1);
    let v_axis = vec3i(1) - along - u_axis;
    // A direction that hops h cells at a time has h interleaved sets of lines, stacked along the second axis.
    let n_u = dot(n, u_axis);
    let n_v = dot(n, v_axis);
    let u = i32(id.x);
    let v = i32(id.y) % n_v;
    let phase = i32(id.y) / n_v;
    let n_along = dot(n, along);
    if u >= n_u || phase >= min(hop, n_along) || id.z >= batch.n_pairs {
        return;
    }
    let forward = dot(e, along) > 0;
    var p = u * u_axis + v * v_axis + select(n_along - 1 - phase, phase, forward) * along;
    let n_steps = (n_along - phase + hop - 1) / hop;

    let inflow = level.channels[c].inflow;
    let absorb = level.channels[c].absorb;
    let s = direction.stride * level.cell_m;
    let a = 2.0 / s;
    let layer = i32(c * level.dims.z);
    let base = id.z * level.dims.x * level.dims.y * level.dims.z;

    var radiance = inflow;
    var leak = 0.0;
    var absorbed = 0.0;
    for (var step = 0; step < n_steps; step += 1) {
        let texel = textureLoad(lobes, p + vec3i(0, 0, layer), 0);
        let t = bitcast<f32>(texel.w);
        let shape = 1.0 + dot(unpack_slope(texel), direction.omega);
        let q = bitcast<f32>(texel.x) * shape * shape;
        var mean = radiance;
        var out = radiance;
        if t > 0.0 {
            let diamond = (q + a * radiance) / (t + a);
            out = 2.0 * diamond - radiance;
            mean = diamond;
            if out < 0.0 {
                mean = (q + 0.5 * a * radiance) / t;
                out = 0.0;
            }
            absorbed += t * mean;
        } else {
            mean += 0.5 * q * s;
            out += q * s;
        }
        mean_radiance[base + u32(p.x + n.x * (p.y + n.y * p.z))] = mean;
        radiance = out;
        let next = p + e;
        p = next;
        p = select(p, p + n, next < vec3i(0));
        p = select(p, p - n, next >= n);
        let side = any((p != next) & (along == vec3i(0)));
        // A line that leaves through an edge after the last cell is ended below, and none begins there.
        if side && step + 1 < n_steps {
            leak += radiance;
            radiance = inflow;
        }
    }
    leak += radiance;
    // Powers of this line: of its end and its wraps through the tube h^3 / s, and of what it loses inside.
    let cell_volume = level.cell_m * level.cell_m * level.cell_m;
    let power = direction.weight * cell_volume;
    line_sums[pair * level.n_threads + id.y * u32(n_u) + id.x] = vec2f(leak / s, absorbed * absorb) * power;
}
