// The finished picture: the bodies over the studio, which is a floor that catches shadows and
// turns into the background. The studio has no edges, so one sample per pixel is enough for it.

// The bodies, sRGB, times how much of the pixel they cover, which is the fourth channel.
@group(1) @binding(0) var bodies: texture_2d<f32>;
@group(1) @binding(1) var floor_light: texture_2d<f32>;
@group(1) @binding(2) var floor_light_sampler: sampler;

// `height` is 0 at the bottom of the picture, 1 at the top.
fn studio(ray: vec3<f32>, height: f32) -> vec3<f32> {
    let background =
        mix(frame.background_low, frame.background_high, smoothstep(0.0, 1.0, height));
    let above = frame.eye.z - frame.floor_height;
    // From below, the floor does not hide what stands on it.
    if above <= 0.0 || ray.z >= 0.0 {
        return background;
    }
    let ground = frame.eye.xy - ray.xy * (above / ray.z);
    // Nearly linear over the picture, from 1 at the middle to 0 at the horizon: the floor has no edge, however far it is
    // seen from.
    let near = 1.0 / (1.0 + distance(ground, frame.floor_center) / frame.floor_radius);
    let lit = mix(background, frame.floor_color, smoothstep(0.0, 0.75, near));
    let place = (ground - frame.floor_map_low) / frame.floor_map_side;
    if any(place <= vec2<f32>(0.0)) || any(place >= vec2<f32>(1.0)) {
        return lit;
    }
    // Row 0 of the map is its upper edge, the largest y.
    let uv = vec2<f32>(place.x, 1.0 - place.y);
    let light = textureSampleLevel(floor_light, floor_light_sampler, uv, 0.0).rg;
    let key = 1.0 - (1.0 - light.r) * frame.shadow_strength;
    let ambient = 1.0 - (1.0 - light.g) * 0.75;
    return lit * key * ambient;
}

fn composed(in: Covered) -> vec3<f32> {
    let pixel = vec2<i32>(in.position.xy - frame.picture_origin);
    let body = textureLoad(bodies, pixel, 0);
    if body.a >= 1.0 {
        return body.rgb;
    }
    // From the eye through the pixel, any length.
    let ray = frame.ray_corner + frame.ray_right * in.place.x + frame.ray_up * in.place.y;
    return body.rgb + (1.0 - body.a) * encoded(studio(ray, in.place.y)).rgb;
}

@fragment
fn fragment(in: Covered) -> @location(0) vec4<f32> {
    return vec4<f32>(composed(in), 1.0);
}

// For targets that encode by themselves.
@fragment
fn linear_fragment(in: Covered) -> @location(0) vec4<f32> {
    let srgb = composed(in);
    let curve = pow((srgb + 0.055) / 1.055, vec3<f32>(2.4));
    return vec4<f32>(select(curve, srgb / 12.92, srgb <= vec3<f32>(0.04045)), 1.0);
}
