// What of a parallel or point light's beam goes towards the eye where it is scattered (DESIGN 6.5): once, and
// by what the forward peak adds to that (table K).

// The table of K: columns 255 sqrt(sin(theta/2)), rows 63 sqrt(x/60).
const PEAK_SIZE: vec2f = vec2f(256.0, 64.0);
const PEAK_X_MAX: f32 = 60.0;

// Phase functions [1/sr].
struct Phases {
    single: f32,
    peak: Spectrum,
}

// K of one channel at x = albedo (tau_n + tau_c) and this column.
fn forward_peak(x: f32, column: f32) -> f32 {
    let row = sqrt(clamp(x, 0.0, PEAK_X_MAX) / PEAK_X_MAX) * (PEAK_SIZE.y - 1.0);
    return textureSampleLevel(peak, linear_clamp, (vec2f(column, row) + 0.5) / PEAK_SIZE, 0.0).x;
}

// What of the phase function is as even as the residual's sources: it stays with the ordinates.
fn even_phase(mu: f32) -> f32 {
    let f = params.g * params.g;
    return max(0.0, (1.0 - f) + 3.0 * (params.g - f) * mu) / FOUR_PI;
}

// Of light whose way turns by an angle of cosine mu, `depth` being tau_n + tau_c.
fn phases_towards_eye(beam: Beam, mu: f32, depth: f32) -> Phases {
    var phases: Phases;
    phases.single = henyey_greenstein(mu, params.g * beam.power.w);
    if HAS_PEAK {
        let column = (PEAK_SIZE.x - 1.0) * sqrt(sqrt(0.5 - 0.5 * mu));
        phases.peak = peak_of(spectrum(params.albedo) * depth, column);
        if HAS_WINDOW {
            let part = saturate((mu - beam.window.y) / max(beam.window.x - beam.window.y, 1e-6));
            let kept = 1.0 - beam.window.z * part * part * (3.0 - 2.0 * part);
            let even = even_phase(mu);
            phases.single = even + kept * (phases.single - even);
            phases.peak = even + kept * (phases.peak - even);
        }
    }
    return phases;
}
