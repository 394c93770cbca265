// Phase functions [1/sr] of the cosine mu between the light's travel and the outgoing direction.

const PI: f32 = 3.14159265358979;
const FOUR_PI: f32 = 12.5663706143592;

// Henyey-Greenstein with mean cosine g. (1-g)^2 + 2g(1-mu) keeps its digits where g and mu are near 1.
fn henyey_greenstein(mu: f32, g: f32) -> f32 {
    let d = (1.0 - g) * (1.0 - g) + 2.0 * g * (1.0 - mu);
    return (1.0 - g * g) / (FOUR_PI * d * sqrt(d));
}
