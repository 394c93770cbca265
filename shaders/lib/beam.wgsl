// Beams in index space, and the atlas of their optical depths at the corners of cells.

#import "lib/octahedral.wgsl"

struct Beam {
    // Parallel: unit direction of travel, w = 0. Point: position in index space, w = 1, or 2 where it shines by the cosine.
    place: vec4f,
    // Irradiance [W/m2] or intensity [W/sr] in xyz, spread a0 in w.
    power: vec4f,
    // Cosines of the angles up to which a share, and from which none, of what it scatters comes from the
    // environment's stack instead; 2 and 2 for a beam that keeps all. Then of parallel light that share, of a point
    // what it faces, octahedral.
    window: vec4f,
}

// From this spread on a parallel beam's shadows are sharp: within 1.8 degrees of its direction.
const NARROW: f32 = 0.9995;

// Whether surfaces that are seen are lit by this beam point by point, because its shadows are sharp.
fn is_narrow(beam: Beam) -> bool {
    return beam.place.w > 0.0 || beam.power.w >= NARROW;
}

// What of a point light's mean intensity goes along a unit vector: all, or four times the cosine before a surface.
fn emission_along(beam: Beam, travel: vec3f) -> f32 {
    if beam.place.w < 1.5 {
        return 1.0;
    }
    return 4.0 * max(0.0, dot(octahedral_direction(beam.window.zw), travel));
}

// Beams whose optical depths share a texel of the atlas.
const PACK: u32 = {pack}u;

// First texel of a pack: packs stand along z, then along y.
fn pack_origin(pack: u32, corners: vec3u, packs_per_column: u32) -> vec3u {
    return vec3u(0u, (pack / packs_per_column) * corners.y, (pack % packs_per_column) * corners.z);
}
