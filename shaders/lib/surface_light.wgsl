// What arrives on surfaces, and what they send back.
//
// Who imports this declares, beside what lib/bvh.wgsl wants:
//   var<storage, read> surface_corners: array<vec4u>;    (the points that a triangle's corners are lit as; w unused)
//   var<storage, read> surface_light: array<vec4f>;      (two for each point: the side of the normal, the other)

#import "lib/bvh.wgsl"
#import "lib/phase.wgsl"

// Irradiance [W/m2] at point p of a triangle, on the side that a ray of this direction comes from, in the
// channels that are solved; of one channel all components hold it.
fn surface_irradiance(triangle: u32, p: vec3f, direction: vec3f) -> vec3f {
    let corners = surface_triangles[triangle];
    let ab = corners.b.xyz - corners.a.xyz;
    let ac = corners.c.xyz - corners.a.xyz;
    let ap = p - corners.a.xyz;
    let normal = cross(ab, ac);
    let area2 = max(dot(normal, normal), 1e-37);
    let at = saturate(vec2f(dot(cross(ap, ac), normal), dot(cross(ab, ap), normal)) / area2);
    // Rounding alone makes it negative.
    let rest = max(0.0, 1.0 - at.x - at.y);
    let points = 2u * surface_corners[triangle].xyz + u32(dot(normal, direction) > 0.0);
    return rest * surface_light[points.x].xyz + at.x * surface_light[points.y].xyz + at.y * surface_light[points.z].xyz;
}

// Radiance that comes back towards a ray of this direction from where it meets a triangle, at `p`.
fn returned_radiance(triangle: u32, p: vec3f, direction: vec3f) -> vec3f {
    // One channel is grey, whatever component is taken.
    return surface_reflectance(triangle) / PI * surface_irradiance(triangle, p, direction);
}
