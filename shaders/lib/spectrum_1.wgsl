// One channel: everything that is grey, times one color.

alias Spectrum = f32;

fn spectrum(v: vec4f) -> Spectrum {
    return v.x;
}

fn rgb(s: Spectrum) -> vec3f {
    return vec3f(s);
}

fn largest(s: Spectrum) -> f32 {
    return s;
}
