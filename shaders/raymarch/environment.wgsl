// What stands behind the medium, and what of it comes through nearly straight.

// Directions that light is asked for after half of its scatterings: so many about the view, for each turn.
const WAYS_AROUND: u32 = 4u;
const N_WAYS: u32 = STACK_TURNS * WAYS_AROUND;
// Less radiance than this is none.
const DARK: f32 = 1e-30;

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

// The stack towards a direction of the world, for each channel's number of scatterings: a level holds exp(-x)
// times the sum over scatterings.
fn stack_radiance(direction: vec3f, x: vec3f) -> vec3f {
    let at = latlong(direction);
    var light = vec3f(0.0);
    for (var c = 0u; c < 3u; c += 1u) {
        let level = (stack_level(x[c]) + 0.5) / f32(STACK_LEVELS);
        light[c] = textureSampleLevel(stack, linear_around, vec3f(at, level), 0.0)[c];
    }
    return light;
}

// Optical depth from a point to the medium's end.
fn depth_outwards(p: vec3f, direction: vec3f) -> f32 {
    if SKIPS {
        return walk_past(sigma_t, linear_clamp, blocks, params.shape, params.cell_m, p, direction, FAR);
    }
    return walk(sigma_t, linear_clamp, params.shape, params.cell_m, p, direction, FAR);
}

// What becomes of the stack's light because it leaves by bent ways: it comes from where the medium is thin.
// Half of the scatterings turn a ray, at its elbow, into directions of the table `stack_turns`; there the stack of
// the other half shines in through what is left of the medium. The mean of that over what it would be if all ways
// out were alike.
fn bend(direction: vec3f, elbow: vec3f, x: vec3f) -> vec3f {
    let level = stack_level(max(x.x, max(x.y, x.z)));
    let lower = min(u32(level), STACK_LEVELS - 2u);
    let turns = mix(params.stack_turns[lower], params.stack_turns[lower + 1u], level - f32(lower));
    let side = normalize(cross(direction, select(vec3f(1.0, 0.0, 0.0), vec3f(0.0, 1.0, 0.0), abs(direction.x) > 0.6)));
    let other = cross(direction, side);
    var depths: array<f32, N_WAYS>;
    var ways: array<vec3f, N_WAYS>;
    var least = FAR;
    for (var n = 0u; n < N_WAYS; n += 1u) {
        let ring = n / WAYS_AROUND;
        let around = 2.0 * PI * (f32(n % WAYS_AROUND) + 0.5 * f32(ring % 2u)) / f32(WAYS_AROUND);
        ways[n] = cos(turns[ring]) * direction + sin(turns[ring]) * (cos(around) * side + sin(around) * other);
        depths[n] = depth_outwards(elbow, ways[n]);
        least = min(least, depths[n]);
    }
    var arriving = vec3f(0.0);
    var open = vec3f(0.0);
    var shining = vec3f(0.0);
    for (var n = 0u; n < N_WAYS; n += 1u) {
        let left = exp(-params.k.xyz * (depths[n] - least));
        let light = max(stack_radiance(params.world_from_index * ways[n], 0.5 * x), vec3f(0.0));
        arriving += left * light;
        open += left;
        shining += light;
    }
    // The nearest way out is open: `open` is 1 at least. Where nothing shines nothing is bent.
    let share = f32(N_WAYS) * arriving / (open * max(shining, vec3f(DARK)));
    return select(share, vec3f(1.0), shining <= vec3f(DARK));
}

// Radiance that the medium scatters forward, by small angles, out of the environment: through the whole depth
// `tau` of a ray that bends at `elbow`, in three channels.
fn environment_forward(direction: vec3f, tau: f32, elbow: vec3f) -> vec3f {
    let x = params.albedo.xyz * (params.g * params.g * tau);
    let straight = exp(x - tau) * stack_radiance(params.world_from_index * direction, x);
    return straight * bend(direction, elbow, x);
}
