// A thread: what one cell of an aligned grid holds after all power has hopped to a neighbor once.
//
// A texel holds the power of the lobe along the beam, that power times the lobe's anisotropy, the power
// that has lost its direction, all per area of a cell's face [W/m2], and the sum phi so far. The sum F
// has a field of its own.

#import "principal_propagation/aligned.wgsl"
#import "lib/walk.wgsl"
#import "lib/transmittance.wgsl"

struct HopParams {
    grid: Aligned,
    albedo: f32,
    g: f32,
    // Irradiance that enters at the front in this hop, and its anisotropy.
    entering: f32,
    a0: f32,
}

// A lobe of less anisotropy is split: as much as has this one stays, the rest has no direction.
const LEAST_ANISOTROPY: f32 = {least_anisotropy};

@group(0) @binding(0) var<uniform> params: HopParams;
@group(1) @binding(0) var sigma_t: texture_3d<f32>;
@group(1) @binding(1) var linear_clamp: sampler;
@group(1) @binding(2) var before: texture_3d<f32>;
@group(1) @binding(3) var before_flux: texture_3d<f32>;
@group(2) @binding(0) var after: texture_storage_3d<rgba32float, write>;
@group(2) @binding(1) var after_flux: texture_storage_3d<r32float, write>;

// Share of a lobe of mean cosine a that is within the cap mu > 2/3, a sixth of the sphere: the integral of
// Henyey and Greenstein's function, without a difference of near numbers.
fn cap_share(a: f32) -> f32 {
    let squared = (1.0 - a) * (1.0 - a) + 2.0 / 3.0 * a;
    return (1.0 + a) / (3.0 * (squared + (1.0 - a) * sqrt(squared)));
}

// What the cell at `sender` sends a neighbor: along the beam (1), against it (-1), or across (0).
fn sent(sender: vec3i, along: i32) -> vec3f {
    if any(sender < vec3i(0)) || any(sender >= vec3i(params.grid.dims)) {
        return vec3f(0.0);
    }
    let cell = textureLoad(before, sender, 0);
    let a = clamp(cell.y / max(cell.x, 1e-37), -1.0, 1.0);
    let ahead = cap_share(a);
    let back = cap_share(-a);
    let share = select(select(back, 0.25 * max(1.0 - ahead - back, 0.0), along == 0), ahead, along == 1);
    return vec3f(share * cell.xy, cell.z / 6.0);
}

@compute @workgroup_size(8, 8, 1)
fn principal_propagation_literal_hop(@builtin(global_invocation_id) id: vec3u) {
    if any(id >= params.grid.dims) {
        return;
    }
    let cell = vec3i(id);
    var arriving = sent(cell - vec3i(0, 0, 1), 1) + sent(cell + vec3i(0, 0, 1), -1)
        + sent(cell - vec3i(1, 0, 0), 0) + sent(cell + vec3i(1, 0, 0), 0)
        + sent(cell - vec3i(0, 1, 0), 0) + sent(cell + vec3i(0, 1, 0), 0);
    if cell.z == 0 {
        arriving += params.entering * vec3f(1.0, params.a0, 0.0);
    }
    let p = index_from_aligned(params.grid, vec3f(id));
    let depth = extinction(sigma_t, linear_clamp, p) * params.grid.cell_m;
    let mean = mean_transmittance(depth);
    let scattered = params.albedo * depth * mean;
    let unscattered = exp(-depth);
    let power = arriving.x * (unscattered + scattered);
    let flux = arriving.y * (unscattered + params.g * scattered);
    let directed = min(power, abs(flux) / LEAST_ANISOTROPY);
    let isotropic = arriving.z * (unscattered + scattered) + power - directed;
    let phi = textureLoad(before, cell, 0).w + mean * (arriving.x + arriving.z);
    textureStore(after, cell, vec4f(directed, flux, isotropic, phi));
    textureStore(after_flux, cell, vec4f(textureLoad(before_flux, cell, 0).x + mean * arriving.y));
}
