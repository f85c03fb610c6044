// What all passes of one picture share. Mirrors `FrameUniforms` in frame_uniforms.rs.
// Colours are linear; lengths are metres in world coordinates.

struct FrameUniforms {
    clip_from_world: mat4x4<f32>,
    // Clip coordinates of the key light's shadow map.
    shadow_from_world: mat4x4<f32>,
    eye: vec3<f32>,
    // Whether element edges are drawn, 0 or 1.
    wireframe: f32,
    // Unit vector.
    towards_light: vec3<f32>,
    // Side of one texel of the shadow map.
    shadow_texel: f32,
    key_light: vec3<f32>,
    // Width of element edges, pixels.
    wire_width: f32,
    // Ambient light from above and from below.
    sky_light: vec3<f32>,
    // World z of the floor.
    floor_height: f32,
    bounce_light: vec3<f32>,
    // Distance from `floor_center` at which a quarter of the floor has become background.
    floor_radius: f32,
    rim_light: vec3<f32>,
    // Row of the colour map, 0..1 as a texture coordinate.
    map_row: f32,
    // Background at the bottom and at the top of the picture.
    background_low: vec3<f32>,
    // Depth that the shadow map covers.
    shadow_depth: f32,
    background_high: vec3<f32>,
    // How far shadows darken the floor, 0..1.
    shadow_strength: f32,
    floor_color: vec3<f32>,
    // Half width of a penumbra per distance from what casts it.
    light_spread: f32,
    wire_color: vec3<f32>,
    wire_opacity: f32,
    floor_center: vec2<f32>,
    // Smallest x and y of the floor's light map, and its side.
    floor_map_low: vec2<f32>,
    floor_map_side: f32,
    // Height above the floor up to which bodies dim the ambient light.
    floor_reach: f32,
    // Upper left corner of the picture in its target, pixels.
    picture_origin: vec2<f32>,
    // From the eye through the lower left corner of the picture, and from there along its lower
    // and left edges.
    ray_corner: vec3<f32>,
    unused_1: f32,
    ray_right: vec3<f32>,
    unused_2: f32,
    ray_up: vec3<f32>,
    unused_3: f32,
}

@group(0) @binding(0) var<uniform> frame: FrameUniforms;

// sRGB encoding of linear colour. The scene's textures hold encoded values, so that the samples
// of a pixel are averaged as the eye sees them and edges look smooth. The curve is a fit in square
// roots, within 0.02 of an 8-bit step of the exact one, and much cheaper than powers.
fn encoded(linear: vec3<f32>) -> vec4<f32> {
    let x = saturate(linear);
    let root2 = sqrt(x);
    let root4 = sqrt(root2);
    let root8 = sqrt(root4);
    let curve = 0.64236468 * root2 + 0.71211170 * root4 - 0.33687049 * root8 - 0.01756283 * x;
    return vec4<f32>(select(curve, 12.92 * x, x <= vec3<f32>(0.0031308)), 1.0);
}
