// A thread: one line along the beam, as a running sum of optical depth; what it has at each plane is kept.

#import "principal_propagation/shear.wgsl"
#import "lib/walk.wgsl"

@group(0) @binding(0) var<uniform> shear: Shear;
@group(1) @binding(0) var sigma_t: texture_3d<f32>;
@group(1) @binding(1) var linear_clamp: sampler;
@group(2) @binding(0) var lines: texture_storage_3d<r32float, write>;

@compute @workgroup_size(8, 8, 1)
fn principal_propagation_scan(@builtin(global_invocation_id) id: vec3u) {
    let kept = vec2i(textureDimensions(lines).xy);
    let line = vec2i(id.xy) + vec2i(shear.first_u, shear.first_v);
    let n_planes = shear.corners.z;
    // Two samples where the way from plane to plane is longer than a cell.
    let longest = max(abs(shear.direction.x), max(abs(shear.direction.y), abs(shear.direction.z)));
    let n_sub = select(2.0, 1.0, longest > 0.999);
    let step_m = shear.cell_m / (longest * n_sub);
    let extent = vec2f(shear.corners.xy);
    var tau = 0.0;
    for (var j = 0u; j < n_planes; j += 1u) {
        let plane = f32(j);
        let place = line - vec2i(line_base(shear, plane));
        if all(place >= vec2i(0)) && all(place < kept) {
            textureStore(lines, vec3i(place, i32(j)), vec4f(tau));
        }
        for (var sub = 0.0; sub < n_sub; sub += 1.0) {
            let at = plane + (sub + 0.5) / n_sub;
            let uv = 0.5 * vec2f(line) + shear.slope * at;
            if all(uv > vec2f(0.0)) && all(uv < extent) {
                let w = select(f32(n_planes) - 1.0 - at, at, shear.sense > 0.0);
                tau += step_m * extinction(sigma_t, linear_clamp, in_place(vec3f(uv, w), shear.along) - 0.5);
            }
        }
    }
}
