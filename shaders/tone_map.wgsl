// A thread: the display light of one pixel (image/tonemap.rs is the same on the CPU, and owns the constants).

struct ToneParams {
    n_pixels: u32,
    width: u32,
    // 0 none, 1 filmic, 2 aces.
    curve: u32,
    gain: f32,
    // Rows of the matrices into and out of the fit's working space.
    aces_in: array<vec4f, 3>,
    aces_out: array<vec4f, 3>,
    // p, q, r, s; t, ceiling, Hable's gain and white point.
    aces_fit: vec4f,
    ends: vec4f,
    // A, B, C, D; E, F.
    hable: array<vec4f, 2>,
}

@group(0) @binding(0) var<uniform> params: ToneParams;
@group(1) @binding(0) var<storage, read> radiance: array<f32>;
@group(2) @binding(0) var<storage, read_write> display: array<f32>;

const F32_MAX: f32 = 3.4028234e38;

fn hable(x: vec3f) -> vec3f {
    let a = params.hable[0].x;
    let b = params.hable[0].y;
    let c = params.hable[0].z;
    let d = params.hable[0].w;
    let e = params.hable[1].x;
    let f = params.hable[1].y;
    return x * (a * (f - e) * x + b * (c * f - e)) / (f * (x * (a * x + b) + d * f));
}

fn aces_fit(v: vec3f) -> vec3f {
    let fit = params.aces_fit;
    return (v * (v + fit.x) - fit.y) / (v * (fit.z * v + fit.w) + params.ends.x);
}

fn multiply(rows: array<vec4f, 3>, v: vec3f) -> vec3f {
    return vec3f(dot(rows[0].xyz, v), dot(rows[1].xyz, v), dot(rows[2].xyz, v));
}

@compute @workgroup_size(64, 1, 1)
fn tone_map(@builtin(global_invocation_id) id: vec3u) {
    let idx = id.y * params.width + id.x;
    if id.x >= params.width || idx >= params.n_pixels {
        return;
    }
    // No product may be infinite.
    let most = F32_MAX / max(params.gain, 1.0);
    let light = vec3f(radiance[3u * idx], radiance[3u * idx + 1u], radiance[3u * idx + 2u]);
    let exposed = params.gain * clamp(light, vec3f(-most), vec3f(most));
    let cut = clamp(exposed, vec3f(0.0), vec3f(params.ends.y));
    var mapped = exposed;
    if params.curve == 1u {
        mapped = clamp(hable(cut * params.ends.z) / hable(vec3f(params.ends.w)), vec3f(0.0), vec3f(1.0));
    } else if params.curve == 2u {
        mapped = clamp(multiply(params.aces_out, aces_fit(multiply(params.aces_in, cut))), vec3f(0.0), vec3f(1.0));
    }
    display[3u * idx] = mapped.x;
    display[3u * idx + 1u] = mapped.y;
    display[3u * idx + 2u] = mapped.z;
}
