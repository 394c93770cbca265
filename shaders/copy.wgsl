// A thread: one texel copied. The floor that every stage is measured against.

@group(0) @binding(0) var<uniform> dims: vec4u;
@group(1) @binding(0) var source: texture_3d<f32>;
@group(2) @binding(0) var target_field: texture_storage_3d<rgba32float, write>;

@compute @workgroup_size(8, 8, 1)
fn copy(@builtin(global_invocation_id) id: vec3u) {
    if any(id >= dims.xyz) {
        return;
    }
    textureStore(target_field, id, textureLoad(source, id, 0));
}
