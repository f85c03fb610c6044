// Averages the floor's light map over 4x4 texels: four bilinear taps between texels.

@group(0) @binding(0) var map: texture_2d<f32>;
@group(0) @binding(1) var map_sampler: sampler;

@fragment
fn fragment(@builtin(position) pixel: vec4<f32>) -> @location(0) vec2<f32> {
    let texel = 1.0 / vec2<f32>(textureDimensions(map));
    // Half a texel off centre: a box of even width.
    let middle = (pixel.xy + 0.5) * texel;
    var sum = vec2<f32>(0.0);
    for (var i = 0; i < 4; i++) {
        let side = vec2<f32>(f32(i & 1), f32(i >> 1)) * 2.0 - 1.0;
        sum += textureSampleLevel(map, map_sampler, middle + side * texel, 0.0).rg;
    }
    return 0.25 * sum;
}
