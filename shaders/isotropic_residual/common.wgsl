// What the stages of the residual share: a level of the cascade and its channels.

struct Channel {
    // sigma_t* / sigma_t, sigma_s* / sigma_t, sigma_a / sigma_t*.
    k: f32,
    scatter: f32,
    absorb: f32,
    // Radiance of the constant environment that flows in [W/(m2 sr)].
    inflow: f32,
}

struct Level {
    dims: vec3u,
    n_channels: u32,
    cell_m: f32,
    g_star: f32,
    n_directions: u32,
    // The most threads that a direction has on this level.
    n_threads: u32,
    channels: array<Channel, 3>,
}
