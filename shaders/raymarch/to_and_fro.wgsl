// What light that goes to and fro along a beam sends towards the eye (optics/backward.rs).

// The table of phases: columns 255 sqrt(sin(theta/2)), theta from straight back; a row for those that turned an even
// number of times, and one for the others.
const BACKWARD_SIZE: vec2f = vec2f(256.0, 2.0);

// Phase function [1/sr] of a row, mu the cosine to the travel of the stream itself.
fn backward_phase(row: f32, mu: f32) -> f32 {
    let column = (BACKWARD_SIZE.x - 1.0) * sqrt(sqrt(max(0.0, 0.5 + 0.5 * mu)));
    return textureSampleLevel(backward, linear_clamp, (vec2f(column, row) + 0.5) / BACKWARD_SIZE, 0.0).x;
}
