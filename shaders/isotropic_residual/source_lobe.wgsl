// The lobe of a cell: what scatters of (phi, F), and the cell's own sources.

#import "isotropic_residual/common.wgsl"
#import "lib/lobe.wgsl"

fn source_lobe(level: Level, c: u32, sigma_t: f32, source: vec4f, moments: vec4f) -> vec4u {
    let channel = level.channels[c];
    let total = sigma_t * channel.scatter * moments * vec4f(1.0, vec3f(level.g_star)) + source;
    let first = select(vec3f(0.0), total.yzw, HAS_LOBES);
    return pack_lobe(lobe_from_moments(total.x, first), sigma_t * channel.k);
}
