// Draws nothing but depth, as seen along any direction: the key light's shadow map and the map
// of heights above the floor.

@group(0) @binding(0) var<uniform> clip_from_world: mat4x4<f32>;

@vertex
fn vertex(@location(0) position: vec3<f32>) -> @builtin(position) vec4<f32> {
    return clip_from_world * vec4<f32>(position, 1.0);
}
