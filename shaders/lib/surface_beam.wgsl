// A beam where it meets a surface, past others and through the medium.

#import "lib/beam.wgsl"
#import "lib/bvh.wgsl"
#import "lib/walk.wgsl"

struct Arrival {
    // Irradiance per power, were there no medium: cosine, and falloff of a point light; 0 in shadow and from behind.
    share: f32,
    // Optical depth of the way.
    tau: f32,
}

// A beam at a point p of a surface. `has_points` is known when the shader is compiled: whether any light is near.
fn arrival(beam: Beam, has_points: bool, sigma_t: texture_3d<f32>, linear_clamp: sampler, shape: Shape, cell_m: f32, p: vec3f, normal: vec3f) -> Arrival {
    var to_light = -beam.place.xyz;
    var reach = 1e30;
    var falloff = 1.0;
    if has_points && beam.place.w > 0.0 {
        let line = beam.place.xyz - p;
        reach = max(length(line), SURFACE_GAP);
        to_light = line / reach;
        falloff = emission_along(beam, -to_light) / (reach * reach * cell_m * cell_m);
    }
    let cosine = dot(normal, to_light);
    if cosine <= 0.0 || is_occluded(p, to_light, reach) {
        return Arrival(0.0, 0.0);
    }
    return Arrival(cosine * falloff, walk(sigma_t, linear_clamp, shape, cell_m, p, to_light, reach));
}
