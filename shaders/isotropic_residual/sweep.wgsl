// A thread: one line through the grid along one direction of one channel, cell by cell. The line wraps
// at the sides; there the old line leaks and a new one enters, so that all lines of a direction are
// covered by the threads of one face (DESIGN 6.4, "line-exact").

#import "isotropic_residual/batch.wgsl"
#import "isotropic_residual/walls_{walls}.wgsl"
#import "lib/lobe.wgsl"

@group(1) @binding(0) var<storage, read> lobes: array<vec4u>;
@group(2) @binding(0) var<storage, read_write> mean_radiance: array<f32>;
@group(2) @binding(1) var<storage, read_write> line_powers: array<vec2f>;

// Whether surfaces stand between cells.
const HAS_WALLS: bool = {walls};

@compute @workgroup_size(8, 8, 1)
fn isotropic_residual_sweep(@builtin(global_invocation_id) id: vec3u) {
    let level = batch.level;
    let pair = batch.first + id.z;
    let c = pair / level.n_directions;
    let direction_idx = pair % level.n_directions;
    let direction = batch.directions[direction_idx];
    let e = direction.e;
    let n = vec3i(level.dims);

    // Lines march along the axis of the longest component, z before y before x: lanes then stand along x.
    var along = vec3i(0, 0, 1);
    if abs(e.z) < max(abs(e.x), abs(e.y)) {
        along = select(vec3i(1, 0, 0), vec3i(0, 1, 0), abs(e.y) >= abs(e.x));
    }
    let u_axis = select(vec3i(1, 0, 0), vec3i(0, 1, 0), along.x == 1);
    let v_axis = vec3i(1) - along - u_axis;
    let n_u = dot(n, u_axis);
    let n_v = dot(n, v_axis);
    let n_along = dot(n, along);
    // A direction that hops h cells at a time has h interleaved sets of lines, stacked along the second axis.
    let hop = abs(dot(e, along));
    var u = i32(id.x);
    var v = i32(id.y) % n_v;
    let phase = i32(id.y) / n_v;
    if u >= n_u || phase >= min(hop, n_along) || id.z >= batch.n_pairs {
        return;
    }
    let n_steps = (n_along - phase + hop - 1) / hop;

    // u and v count along the direction, so that a line only ever wraps at their ends; strides carry the sense.
    let steps = vec3i(dot(e, u_axis), dot(e, v_axis), dot(e, along));
    let strides = vec3i(1, n.x, n.x * n.y);
    let unsigned = vec3i(dot(strides, u_axis), dot(strides, v_axis), dot(strides, along));
    let signed = select(unsigned, -unsigned, steps < vec3i(0));
    let last = select(vec3i(0), vec3i(n_u, n_v, n_along) - 1, steps < vec3i(0)) * unsigned;
    var cell = last.x + last.y + last.z + u * signed.x + v * signed.y + phase * signed.z;
    let stride = abs(steps.x) * signed.x + abs(steps.y) * signed.y + hop * signed.z;
    let back_u = n_u * signed.x;
    let back_v = n_v * signed.y;

    let n_cells = n.x * n.y * n.z;
    let lobe_base = i32(c - batch.first_channel) * n_cells;
    let mean_base = i32(id.z) * n_cells;
    let inflow = level.channels[c].inflow;
    let s = direction.stride * level.cell_m;
    let a = 2.0 / s;

    // No branches below: software drivers pay for each by a round trip of every variable through memory.
    var radiance = inflow;
    // What of it is ambient light yet. Walls let that pass: what they hide of it is known from rays.
    var ambient = inflow;
    var leak = 0.0;
    var absorbed = 0.0;
    for (var step = 0; step < n_steps; step += 1) {
        let texel = lobes[lobe_base + cell];
        let t = bitcast<f32>(texel.w);
        var q = bitcast<f32>(texel.x);
        if HAS_LOBES {
            let shape = 1.0 + dot(unpack_slope(texel), direction.omega);
            q *= shape * shape;
        }
        let diamond = (q + a * radiance) / (t + a);
        let ahead = 2.0 * diamond - radiance;
        // Where the diamond runs dry the cell is so thick that nothing leaves it (t > 0 then).
        let dry = (q + 0.5 * a * radiance) / max(t, 1e-30);
        let is_void = t <= 0.0;
        let mean = select(select(diamond, dry, ahead < 0.0), radiance + 0.5 * q * s, is_void);
        var out = select(max(ahead, 0.0), radiance + q * s, is_void);
        absorbed += t * mean;
        mean_radiance[mean_base + cell] = mean;
        let here = cell;

        u += abs(steps.x);
        v += abs(steps.y);
        let wraps_u = u >= n_u;
        let wraps_v = v >= n_v;
        u -= select(0, n_u, wraps_u);
        v -= select(0, n_v, wraps_v);
        cell += stride - select(0, back_u, wraps_u) - select(0, back_v, wraps_v);
        let side = wraps_u || wraps_v;
        if HAS_WALLS {
            ambient *= max(0.0, (a - t) / (a + t));
            // Opposite directions share a segment. Of the last one the line's end is all that is left.
            let is_reversed = direction_idx % 2u == 1u && step + 1 < n_steps;
            let ends = is_walled(select(here, cell, is_reversed), direction_idx / 2u);
            leak += select(0.0, out - ambient, ends);
            out = select(out, ambient, ends);
            ambient = select(ambient, inflow, side);
        }
        leak += select(0.0, out, side);
        radiance = select(out, inflow, side);
    }
    // The last step may have wrapped: then its line has leaked, and the one that entered has no cell.
    leak += select(radiance, 0.0, u < abs(steps.x) && steps.x != 0 || v < abs(steps.y) && steps.y != 0);

    // Powers of this line: of its end and its wraps through the tube h^3 / s, and of what it loses inside.
    let cell_volume = level.cell_m * level.cell_m * level.cell_m;
    let absorbed_power = absorbed * level.channels[c].absorb;
    line_powers[pair * level.n_threads + id.y * u32(n_u) + id.x] = direction.weight * cell_volume * vec2f(leak / s, absorbed_power);
}
