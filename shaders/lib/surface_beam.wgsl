// A beam where it meets a surface, past others and through the medium.

#import "lib/beam.wgsl"
#import "lib/bvh.wgsl"
#import "lib/walk.wgsl"

// From a point to where a beam's light comes from.
struct ToLight {
    // Unit vector.
    direction: vec3f,
    // [cells]
    reach: f32,
    // Irradiance per power across the way.
    falloff: f32,
}

// `has_points` is known when the shader is compiled: whether any light is near.
fn to_light(beam: Beam, has_points: bool, cell_m: f32, p: vec3f) -> ToLight {
    if has_points && beam.place.w > 0.0 {
        let line = beam.place.xyz - p;
        let reach = max(length(line), SURFACE_GAP);
        let direction = line / reach;
        return ToLight(direction, reach, emission_along(beam, -direction) / (reach * reach * cell_m * cell_m));
    }
    return ToLight(-beam.place.xyz, 1e30, 1.0);
}

struct Arrival {
    // Irradiance per power, were there no medium: cosine, and falloff of a point light; 0 in shadow and from behind.
    share: f32,
    // Optical depth of the way.
    tau: f32,
}

// A beam at a point p of a surface, on the side of its normal.
fn arrival(beam: Beam, has_points: bool, sigma_t: texture_3d<f32>, linear_clamp: sampler, shape: Shape, cell_m: f32, p: vec3f, normal: vec3f) -> Arrival {
    let way = to_light(beam, has_points, cell_m, p);
    let cosine = dot(normal, way.direction);
    if cosine <= 0.0 || is_occluded(p, way.direction, way.reach) {
        return Arrival(0.0, 0.0);
    }
    return Arrival(cosine * way.falloff, walk(sigma_t, linear_clamp, shape, cell_m, p, way.direction, way.reach));
}
