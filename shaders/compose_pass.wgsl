// Copies the finished picture into a rectangle of the target, pixel by pixel.

struct Placement {
    // Upper left corner of the rectangle in the target, pixels.
    origin: vec2<f32>,
    unused: vec2<f32>,
}

@group(0) @binding(0) var picture: texture_2d<f32>;
@group(0) @binding(1) var<uniform> placement: Placement;

@vertex
fn vertex(@builtin(vertex_index) index: u32) -> @builtin(position) vec4<f32> {
    let corner = vec2<f32>(f32((index << 1u) & 2u), f32(index & 2u));
    return vec4<f32>(corner * 2.0 - 1.0, 0.0, 1.0);
}

@fragment
fn fragment(@builtin(position) pixel: vec4<f32>) -> @location(0) vec4<f32> {
    return textureLoad(picture, vec2<i32>(pixel.xy - placement.origin), 0);
}

// For targets that encode by themselves.
@fragment
fn linear_fragment(@builtin(position) pixel: vec4<f32>) -> @location(0) vec4<f32> {
    let srgb = textureLoad(picture, vec2<i32>(pixel.xy - placement.origin), 0).rgb;
    let curve = pow((srgb + 0.055) / 1.055, vec3<f32>(2.4));
    return vec4<f32>(select(curve, srgb / 12.92, srgb <= vec3<f32>(0.04045)), 1.0);
}
