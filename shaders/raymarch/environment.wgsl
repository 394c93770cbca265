// What stands behind the medium, and what of it comes through nearly straight.

// Texture coordinates of a direction of the world in a lat-long picture.
fn latlong(direction: vec3f) -> vec2f {
    let longitude = atan2(direction.x, direction.z) - params.rotate_y;
    return vec2f(0.5 - longitude / (2.0 * PI), acos(clamp(direction.y, -1.0, 1.0)) / PI);
}

// Radiance of the sharp environment.
fn environment_radiance(direction: vec3f) -> vec3f {
    if params.backdrop == 1u {
        return params.background.xyz;
    }
    if params.backdrop == 2u {
        return params.background.xyz * textureSampleLevel(environment, linear_around, latlong(direction), 0.0).xyz;
    }
    return vec3f(0.0);
}

// Level of the stack for x forward scatterings, between levels linear in x.
fn stack_level(x: f32) -> f32 {
    var level = 0.0;
    for (var n = 0u; n < STACK_LEVELS - 1u; n += 1u) {
        let low = params.stack_x[n / 4u][n % 4u];
        let high = params.stack_x[(n + 1u) / 4u][(n + 1u) % 4u];
        level += saturate((x - low) / (high - low));
    }
    return level;
}

// Radiance that the medium scatters forward, by a few degrees, out of the environment: through the whole depth
// `tau` of the ray, in three channels. A level holds exp(-x) times the sum over scatterings.
fn environment_forward(direction: vec3f, tau: f32) -> vec3f {
    let at = latlong(direction);
    let x = params.albedo.xyz * (params.g * params.g * tau);
    var light = vec3f(0.0);
    for (var c = 0u; c < 3u; c += 1u) {
        let level = (stack_level(x[c]) + 0.5) / f32(STACK_LEVELS);
        light[c] = exp(x[c] - tau) * textureSampleLevel(stack, linear_around, vec3f(at, level), 0.0)[c];
    }
    return light;
}
