// Rays of a camera.

// Unit direction of the ray through `at`, (0, 0) the picture's upper left corner and (1, 1) its lower right one;
// right and up reach from the view's middle to its edges.
fn view_ray(forward: vec3f, right: vec3f, up: vec3f, at: vec2f) -> vec3f {
    return normalize(forward + (2.0 * at.x - 1.0) * right + (1.0 - 2.0 * at.y) * up);
}
