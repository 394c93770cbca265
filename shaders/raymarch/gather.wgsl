// A thread: what all parallel beams together send from one corner of a cell towards the eye, for a march that
// then has no beam to look up (DESIGN 6.5, many ordinates).
//
// Of light E_n e^-tau and E*_n = E_n e^-k tau the march needs, per unit of albedo,
//   single       sum E_n e^-tau_n HG,
//   reaching     sum E_n e^-k tau_n K,
//   unscattered  sum E_n e^-tau_n K,
// with the eye's own depth in K walked from here. Kept are the logarithms: between corners those of one beam are
// linear, as its depth is.

#import "lib/spectrum_{channels}.wgsl"
#import "lib/walk.wgsl"
#import "lib/beam.wgsl"
#import "lib/phase.wgsl"
#import "raymarch/channels_{channels}.wgsl"
#import "raymarch/towards_eye.wgsl"

struct GatherParams {
    shape: Shape,
    eye: vec3f,
    cell_m: f32,
    corners: vec3u,
    n_beams: u32,
    k: vec4f,
    albedo: vec4f,
    g: f32,
    packs_per_column: u32,
    // First corner along z of this band.
    first: u32,
    // The march evaluates light so far from a sample that met matter, at most [cells].
    reach: i32,
}

@group(0) @binding(0) var<uniform> params: GatherParams;
@group(1) @binding(0) var sigma_t: texture_3d<f32>;
@group(1) @binding(1) var linear_clamp: sampler;
@group(1) @binding(2) var tau: texture_3d<f32>;
@group(1) @binding(3) var<storage, read> beams: array<Beam>;
@group(1) @binding(4) var peak: texture_2d<f32>;
@group(1) @binding(5) var blocks: texture_3d<f32>;
@group(2) @binding(0) var sums: texture_storage_3d<rgba32float, write>;

const HAS_PEAK: bool = {peak};
const HAS_WINDOW: bool = {window};
// Less than this is none; its logarithm is a number.
const DARK: f32 = 1e-30;

// Whether light that is evaluated in a cell around this corner can be that of a sample in matter.
fn is_read(corner: vec3u) -> bool {
    let last = vec3i(textureDimensions(blocks)) - 1;
    let low = max(vec3i(corner) - 1 - params.reach, vec3i(0)) / BLOCK;
    let high = min((vec3i(corner) + params.reach) / BLOCK, last);
    for (var z = low.z; z <= high.z; z += 1) {
        for (var y = low.y; y <= high.y; y += 1) {
            for (var x = low.x; x <= high.x; x += 1) {
                if textureLoad(blocks, vec3i(x, y, z), 0).x > 0.0 {
                    return true;
                }
            }
        }
    }
    return false;
}

@compute @workgroup_size(8, 8, 1)
fn gather_beams(@builtin(global_invocation_id) id: vec3u) {
    let corner = vec3u(id.xy, params.first + id.z);
    if any(corner >= params.corners) || !is_read(corner) {
        return;
    }
    let p = vec3f(corner) - 0.5;
    let to_eye = params.eye - p;
    let distance = length(to_eye);
    let direction = to_eye / max(distance, 1e-6);
    let tau_c = walk(sigma_t, linear_clamp, params.shape, params.cell_m, p, direction, distance);
    let k = spectrum(params.k);
    var single = Spectrum(0.0);
    var reaching = Spectrum(0.0);
    var unscattered = Spectrum(0.0);
    for (var first = 0u; first < params.n_beams; first += PACK) {
        let depths = textureLoad(tau, pack_origin(first / PACK, params.corners, params.packs_per_column) + corner, 0);
        for (var m = 0u; m < min(PACK, params.n_beams - first); m += 1u) {
            let beam = beams[first + m];
            let power = spectrum(beam.power);
            let tau_n = depths[m];
            let lit = exp(-tau_n);
            let mu = clamp(dot(beam.place.xyz, direction), -1.0, 1.0);
            let phases = phases_towards_eye(beam, mu, tau_n + tau_c);
            single += power * (lit * phases.single);
            if HAS_PEAK {
                reaching += power * exp_of(-k * tau_n) * phases.peak;
                unscattered += power * (lit * phases.peak);
            }
        }
    }
    let three = array<vec3f, 3>(rgb(single), rgb(reaching), rgb(unscattered));
    for (var c = 0u; c < {channels}u; c += 1u) {
        let sum = vec3f(three[0][c], three[1][c], three[2][c]);
        textureStore(sums, vec3u(corner.xy, corner.z + c * params.corners.z), vec4f(log(max(sum, vec3f(DARK))), 0.0));
    }
}
