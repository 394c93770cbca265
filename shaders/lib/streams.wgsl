// Light that goes to and fro along the line of a beam (optics/backward.rs), where g < 0.

#import "lib/transmittance.wgsl"

// Of light 1: on and back, both over exp(-kappa tau).
struct Streams {
    kappa: f32,
    on: f32,
    back: f32,
}

// (1 - exp(-2 kappa u)) / kappa + 1 + exp(-2 kappa u) of the depth u, and its first term.
fn to_and_fro(kappa: f32, u: f32) -> vec2f {
    let x = 2.0 * kappa * u;
    let s = 2.0 * u * mean_transmittance(x);
    return vec2f(s + 1.0 + exp(-x), s);
}

// At the depth tau from the light, with the depth `ahead` until the medium's end.
fn streams(g: f32, albedo: f32, tau: f32, ahead: f32) -> Streams {
    let turned = albedo * g * g;
    let kappa = sqrt(((1.0 - albedo) + albedo * (1.0 - g) * (1.0 + g)) * (1.0 + turned));
    let here = to_and_fro(kappa, ahead);
    let all = to_and_fro(kappa, tau + ahead).x;
    return Streams(kappa, here.x / all, turned * here.y / all);
}
