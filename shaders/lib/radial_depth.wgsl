// Optical depths on the grids of point lights.
//
// Who imports this declares:
//   var radial: texture_3d<f32>;      (all grids; a border of one direction around each)

#import "lib/radial.wgsl"
#import "lib/shape.wgsl"
#import "lib/shadow.wgsl"

struct RadialDepth {
    // Of the nodes around, weighted, that the light reaches.
    share: f32,
    tau: f32,
}

// What is found at `line` from the light, of length r [cells]; of a shape in closed form its own depth.
fn radial_depth(light: RadialLight, linear_clamp: sampler, shape: Shape, cell_m: f32, has_shadows: bool, position: vec3f, line: vec3f, r: f32) -> RadialDepth {
    if shape.kind != VOXELS && !has_shadows {
        let span = ray_shape(shape, position, line / max(r, 1e-6));
        return RadialDepth(1.0, shape.sigma_t * max(0.0, min(span.y, r) - span.x) * cell_m);
    }
    let on_square = octahedral(line * radial_frame(light));
    let n = f32(light.n_angular);
    let at = clamp((on_square - light.crop.xy) / light.crop.zw, vec2f(0.0), vec2f(1.0)) * n + 1.0;
    let node = radial_node(light, r);
    if !has_shadows {
        let texel = vec3f(light.origin) + vec3f(at, node + 0.5);
        return RadialDepth(1.0, textureSampleLevel(radial, linear_clamp, texel / vec3f(textureDimensions(radial)), 0.0).x);
    }
    let texel = vec3f(at - 0.5, min(node, f32(light.n_radial) - 1.001));
    let low = floor(texel);
    let part = texel - low;
    var found = RadialDepth(0.0, 0.0);
    for (var corner = 0u; corner < 8u; corner += 1u) {
        let step = vec3u(corner & 1u, (corner >> 1u) & 1u, corner >> 2u);
        let side = select(1.0 - part, part, step == vec3u(1u));
        let tau = textureLoad(radial, light.origin + vec3u(low) + step, 0).x;
        let weight = select(side.x * side.y * side.z, 0.0, is_hidden(tau));
        found.share += weight;
        found.tau += weight * tau;
    }
    found.tau /= max(found.share, 1e-6);
    return found;
}
