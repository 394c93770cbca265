// Three channels: linear Rec. 709.

alias Spectrum = vec3f;

fn spectrum(v: vec4f) -> Spectrum {
    return v.xyz;
}

fn rgb(s: Spectrum) -> vec3f {
    return s;
}

fn largest(s: Spectrum) -> f32 {
    return max(s.x, max(s.y, s.z));
}
