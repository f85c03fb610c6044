// The studio: a floor that catches shadows and turns into the background, and the background.

@group(1) @binding(0) var floor_light: texture_2d<f32>;
@group(1) @binding(1) var floor_light_sampler: sampler;

struct FloorVertex {
    @builtin(position) position: vec4<f32>,
    @location(0) ground: vec2<f32>,
}

// Two triangles that reach beyond the radius where the floor ends.
@vertex
fn floor_vertex(@builtin(vertex_index) index: u32) -> FloorVertex {
    let corner = vec2<f32>(f32(index & 1u), f32(index >> 1u)) * 2.0 - 1.0;
    let ground = frame.floor_center + corner * frame.floor_radius;
    let position = frame.clip_from_world * vec4<f32>(ground, frame.floor_height, 1.0);
    return FloorVertex(position, ground);
}

@fragment
fn floor_fragment(in: FloorVertex) -> @location(0) vec4<f32> {
    let background = background_at(in.position.xy);
    let place = (in.ground - frame.floor_map_low) / frame.floor_map_side;
    var light = vec2<f32>(1.0);
    if all(place > vec2<f32>(0.0)) && all(place < vec2<f32>(1.0)) {
        // Row 0 of the map is its upper edge, the largest y.
        let uv = vec2<f32>(place.x, 1.0 - place.y);
        light = textureSampleLevel(floor_light, floor_light_sampler, uv, 0.0).rg;
    }
    let away = length(in.ground - frame.floor_center) / frame.floor_radius;
    let floor_share = 1.0 - smoothstep(0.12, 0.9, away);
    let lit = mix(background, frame.floor_color, floor_share);
    let ambient = 1.0 - (1.0 - light.g) * 0.75;
    let key = 1.0 - (1.0 - light.r) * frame.shadow_strength;
    return encoded(lit * key * ambient);
}

// One triangle over the whole picture, at the depth of infinity.
@vertex
fn background_vertex(@builtin(vertex_index) index: u32) -> @builtin(position) vec4<f32> {
    let corner = vec2<f32>(f32((index << 1u) & 2u), f32(index & 2u));
    return vec4<f32>(corner * 2.0 - 1.0, 0.0, 1.0);
}

@fragment
fn background_fragment(@builtin(position) pixel: vec4<f32>) -> @location(0) vec4<f32> {
    return encoded(background_at(pixel.xy));
}
