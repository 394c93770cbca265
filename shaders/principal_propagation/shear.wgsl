// A beam's sheared lines: half a cell apart, each exactly along the beam, one sample a plane of corners.
// Planes are numbered in the order in which the light meets them. Line a crosses plane j at
// u = a / 2 + slope_u j (corner coordinates); of each plane those lines are kept that can matter to it,
// from a = base(j) on, so that the first one kept stands at an offset in (-1/2, 0].

struct Shear {
    // Corners along u, v and the beam's longest axis.
    corners: vec3u,
    // That axis: 0, 1, 2.
    along: u32,
    slope: vec2f,
    // 1: the light meets plane 0 first; -1: the last one.
    sense: f32,
    cell_m: f32,
    // Unit direction of travel in index space.
    direction: vec3f,
    // The first line that has a thread.
    first_u: i32,
    first_v: i32,
    pad_0: u32,
    pad_1: u32,
    pad_2: u32,
}

// The first line that is kept of plane j.
fn line_base(shear: Shear, j: f32) -> vec2f {
    return floor(-2.0 * shear.slope * j);
}

// Where that line crosses plane j.
fn line_offset(shear: Shear, j: f32) -> vec2f {
    return 0.5 * line_base(shear, j) + shear.slope * j;
}

// (u, v, along) as (x, y, z).
fn in_place(v: vec3f, along: u32) -> vec3f {
    if along == 0u {
        return v.zxy;
    }
    return select(v, v.xzy, along == 1u);
}
