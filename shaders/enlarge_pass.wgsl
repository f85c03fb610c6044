// A small picture drawn large, smoothly.

@group(0) @binding(0) var picture: texture_2d<f32>;
@group(0) @binding(1) var picture_sampler: sampler;

@fragment
fn fragment(in: Covered) -> @location(0) vec4<f32> {
    // Row 0 of a texture is its upper edge.
    let place = vec2<f32>(in.place.x, 1.0 - in.place.y);
    return textureSampleLevel(picture, picture_sampler, place, 0.0);
}
