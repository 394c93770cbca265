// Light that hot gas emits: flame and temperature are interpolated, and Planck's law comes after that (the
// other way round a fire is 21 % too bright).

struct Heat {
    // Rows of the maps from index space to texture coordinates.
    flame_from_index: array<vec4f, 3>,
    temperature_from_index: array<vec4f, 3>,
    kelvin_offset: f32,
    kelvin_per_unit: f32,
    // Temperature in the middle of the table of black bodies [K].
    knee: f32,
    pad: u32,
}

fn texture_from_index(rows: array<vec4f, 3>, p: vec3f) -> vec3f {
    let point = vec4f(p, 1.0);
    return vec3f(dot(rows[0], point), dot(rows[1], point), dot(rows[2], point));
}

// The color of a black body from its table: B / (T + knee), over T / (T + knee) in equal steps.
fn blackbody(table: texture_2d<f32>, knee: f32, kelvin: f32) -> vec3f {
    let t = max(kelvin, 0.0);
    let last = i32(textureDimensions(table).x) - 1;
    let at = t / (t + knee) * f32(last);
    let low = min(i32(at), last - 1);
    let below = textureLoad(table, vec2i(low, 0), 0).xyz;
    let above = textureLoad(table, vec2i(low + 1, 0), 0).xyz;
    return mix(below, above, at - f32(low)) * (t + knee);
}

// Emitted radiance per meter [W/(m3 sr)] at a point of index space. Both grids have a border of what stands
// outside of them.
fn emitted(heat: Heat, flame: texture_3d<f32>, temperature: texture_3d<f32>, table: texture_2d<f32>, linear_clamp: sampler, p: vec3f) -> vec3f {
    let amount = textureSampleLevel(flame, linear_clamp, texture_from_index(heat.flame_from_index, p), 0.0).x;
    if amount <= 0.0 {
        return vec3f(0.0);
    }
    let units = textureSampleLevel(temperature, linear_clamp, texture_from_index(heat.temperature_from_index, p), 0.0).x;
    return amount * blackbody(table, heat.knee, heat.kelvin_offset + heat.kelvin_per_unit * units);
}
