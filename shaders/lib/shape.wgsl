// What bounds the medium: the box of its voxels, or a homogeneous ellipsoid or box in closed form.

#import "lib/ray_box.wgsl"

const VOXELS: u32 = 0u;
const ELLIPSOID: u32 = 1u;
const BOX: u32 = 2u;

struct Shape {
    // Center (VOXELS and BOX: of the box) and half extents, in index space.
    center: vec3f,
    kind: u32,
    half_extent: vec3f,
    // Extinction inside a closed form [1/m]; 0 for VOXELS.
    sigma_t: f32,
}

fn ray_shape(shape: Shape, origin: vec3f, direction: vec3f) -> vec2f {
    if shape.kind == ELLIPSOID {
        return ray_ellipsoid(origin, direction, shape.center, shape.half_extent);
    }
    return ray_box(origin, direction, shape.center - shape.half_extent, shape.center + shape.half_extent);
}
