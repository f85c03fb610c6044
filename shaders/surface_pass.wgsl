// The bodies: soft key light with shadow, ambient light from sky and floor, a faint rim, a
// little gloss; colours of materials or of values; element edges; lines where cracks reach the skin.

@group(1) @binding(0) var shadow_map: texture_depth_2d;
@group(1) @binding(1) var shadow_sampler: sampler_comparison;
@group(1) @binding(2) var color_map: texture_2d<f32>;
@group(1) @binding(3) var color_map_sampler: sampler;

struct VertexInput {
    @builtin(vertex_index) index: u32,
    @location(0) position: vec3<f32>,
    // Unit normal, and 1 on crack faces; elsewhere 1/32767 times a bit for each edge that is a dark line, bit k for
    // the edge opposite to corner k: where a crack reaches the skin, and around sections.
    @location(1) normal_and_crack: vec4<f32>,
    // sRGB, and gloss.
    @location(2) color_and_gloss: vec4<f32>,
    // Position on the colour map, negative for the base colour.
    @location(3) map_position: f32,
}

struct VertexOutput {
    @builtin(position) clip: vec4<f32>,
    @location(0) world: vec3<f32>,
    @location(1) normal: vec3<f32>,
    @location(2) corner: vec3<f32>,
    @location(3) map_position: f32,
    @location(4) @interpolate(flat) color: vec3<f32>,
    @location(5) @interpolate(flat) gloss_and_crack: vec2<f32>,
}

// The power of 2.4 as a sum of powers that are square roots and products: within 3e-5, and much cheaper for each of a
// hundred thousand vertices.
fn linear_from_srgb(srgb: vec3<f32>) -> vec3<f32> {
    let x = (srgb + 0.055) / 1.055;
    let root2 = sqrt(x);
    let root4 = sqrt(root2);
    let curved = x * x * (0.44110237 * root4 + 0.63493197 * root2 - 0.02805542 * x - 0.04800509);
    return select(curved, srgb / 12.92, srgb <= vec3<f32>(0.04045));
}

@vertex
fn vertex(in: VertexInput) -> VertexOutput {
    var out: VertexOutput;
    out.clip = frame.clip_from_world * vec4<f32>(in.position, 1.0);
    out.world = in.position;
    out.normal = in.normal_and_crack.xyz;
    out.corner = vec3<f32>(0.0);
    out.corner[in.index % 3u] = 1.0;
    out.map_position = in.map_position;
    out.color = linear_from_srgb(in.color_and_gloss.rgb);
    out.gloss_and_crack = vec2<f32>(in.color_and_gloss.a, in.normal_and_crack.w);
    return out;
}

// Half width of the soft edge of shadows, texture coordinates: as wide whatever the map's texels.
const SHADOW_BLUR: f32 = 3.0 / 1024.0;

// The share of the key light that arrives. The point is lifted off its surface, the more the
// flatter the light falls and the wider the filter, so that no surface shadows itself.
fn key_visibility(world: vec3<f32>, normal: vec3<f32>, facing: f32, is_draft: bool) -> f32 {
    let slope = sqrt(saturate(1.0 - facing * facing));
    let side_px = f32(textureDimensions(shadow_map).x);
    let lift = frame.shadow_texel * (0.7 + SHADOW_BLUR * side_px * slope);
    let projected = frame.shadow_from_world * vec4<f32>(world + normal * lift, 1.0);
    let uv = vec2<f32>(0.5 + 0.5 * projected.x, 0.5 - 0.5 * projected.y);
    let reach = vec2<f32>(SHADOW_BLUR);
    // Bilinear comparisons on an inner and an outer ring, turned against the grid.
    let inner = vec2<f32>(0.36, 0.15);
    let outer = vec2<f32>(0.36, 0.86);
    // Two opposite ones are enough for a draft.
    if is_draft {
        return 0.5 * (tap(uv, reach * inner, projected.z) + tap(uv, -reach * inner, projected.z));
    }
    let open = tap(uv, reach * inner, projected.z)
        + tap(uv, reach * vec2<f32>(-inner.y, inner.x), projected.z)
        + tap(uv, -reach * inner, projected.z)
        + tap(uv, reach * vec2<f32>(inner.y, -inner.x), projected.z)
        + tap(uv, reach * outer, projected.z)
        + tap(uv, reach * vec2<f32>(-outer.y, outer.x), projected.z)
        + tap(uv, -reach * outer, projected.z)
        + tap(uv, reach * vec2<f32>(outer.y, -outer.x), projected.z);
    return open * 0.125;
}

fn tap(uv: vec2<f32>, shift: vec2<f32>, depth: f32) -> f32 {
    return textureSampleCompareLevel(shadow_map, shadow_sampler, uv + shift, depth);
}

// How much of an element edge covers the pixel.
fn edge_cover(corner: vec3<f32>) -> f32 {
    let per_pixel = max(fwidth(corner), vec3<f32>(1e-6));
    let pixels = corner / per_pixel;
    let nearest = min(pixels.x, min(pixels.y, pixels.z));
    let half = 0.5 * frame.wire_width;
    let cover = 1.0 - smoothstep(half - 0.5, half + 0.5, nearest);
    // Elements of a few pixels would drown in their edges.
    let height = 1.0 / max(per_pixel.x, max(per_pixel.y, per_pixel.z));
    return cover * mix(0.25, 1.0, smoothstep(2.0, 9.0, height / frame.wire_width));
}

// Cracks that have not opened are dark lines: their share of the surface's colour, and how much they cover.
const CRACK_LINE_LIGHT: f32 = 0.08;
const CRACK_LINE_OPACITY: f32 = 0.85;

// How much of a crack's edge covers the pixel.
fn crack_cover(corner: vec3<f32>, mark: f32) -> f32 {
    let pixels = corner / max(fwidth(corner), vec3<f32>(1e-6));
    let edges = u32(round(mark * 32767.0));
    if mark > 0.5 || edges == 0u {
        return 0.0;
    }
    let is_edge = vec3<bool>((edges & 1u) != 0u, (edges & 2u) != 0u, (edges & 4u) != 0u);
    let distance = select(vec3<f32>(1e6), pixels, is_edge);
    let nearest = min(distance.x, min(distance.y, distance.z));
    let half = 0.5 * frame.wire_width;
    return 1.0 - smoothstep(half - 0.5, half + 0.5, nearest);
}

// Keeps highlights from clipping to flat white.
fn shoulder(color: vec3<f32>) -> vec3<f32> {
    let over = max(color - 0.8, vec3<f32>(0.0));
    return min(color, vec3<f32>(0.8)) + 0.2 * (1.0 - exp(-over / 0.2));
}

@fragment
fn fragment(in: VertexOutput) -> @location(0) vec4<f32> {
    return shaded(in, false);
}

@fragment
fn draft_fragment(in: VertexOutput) -> @location(0) vec4<f32> {
    return shaded(in, true);
}

// These leave out what is below the floor. Separate, since discarding costs the early depth test.
@fragment
fn fragment_above_floor(in: VertexOutput) -> @location(0) vec4<f32> {
    return cut_by_floor(in, false);
}

@fragment
fn draft_fragment_above_floor(in: VertexOutput) -> @location(0) vec4<f32> {
    return cut_by_floor(in, true);
}

fn cut_by_floor(in: VertexOutput, is_draft: bool) -> vec4<f32> {
    let color = shaded(in, is_draft);
    if in.world.z < frame.floor_height && frame.eye.z > frame.floor_height {
        discard;
    }
    return color;
}

fn shaded(in: VertexOutput, is_draft: bool) -> vec4<f32> {
    let normal = normalize(in.normal);
    let to_eye = normalize(frame.eye - in.world);
    let facing = dot(normal, frame.towards_light);
    // The base colour is asked for by -1; at the edge of a triangle a value of zero may come out a little below zero.
    let has_value = in.map_position >= -0.5;

    var base = in.color;
    var gloss = in.gloss_and_crack.x;
    if has_value {
        let place = vec2<f32>(saturate(in.map_position) * 0.99609375 + 0.001953125, frame.map_row);
        let mapped = textureSampleLevel(color_map, color_map_sampler, place, 0.0).rgb;
        // Crack faces keep a hint of their tint.
        base = mix(mapped, in.color, 0.3 * step(0.5, in.gloss_and_crack.y));
        gloss = gloss * 0.15;
    }

    var key = 0.0;
    if facing > 0.0 {
        key = facing * key_visibility(in.world, normal, facing, is_draft);
    }
    // Near the floor, less light comes from below.
    let above_floor = max(in.world.z - frame.floor_height, 0.0) / frame.floor_reach;
    let enclosed = exp(-2.5 * above_floor) * (0.5 - 0.5 * normal.z);
    let ambient = mix(frame.bounce_light, frame.sky_light, 0.5 + 0.5 * normal.z)
        * (1.0 - 0.7 * enclosed);
    let half_way = normalize(to_eye + frame.towards_light);
    let highlight = pow(saturate(dot(normal, half_way)), 48.0) * 0.22 * gloss;
    let grazing = 1.0 - saturate(dot(normal, to_eye));
    let fresnel = (0.03 + 0.5 * pow(grazing, 5.0)) * gloss;
    let mirrored = reflect(-to_eye, normal);
    let rim = frame.rim_light * (fresnel * smoothstep(-0.25, 0.55, mirrored.z));

    var light = frame.key_light * key + ambient;
    if has_value {
        // Flatter light, so that the colours stay near those of the legend.
        light = mix(0.9 * light, vec3<f32>(0.92), 0.3);
    }
    var color = base * light + frame.key_light * (highlight * key) + rim;
    let crack = crack_cover(in.corner, in.gloss_and_crack.y);
    color = mix(color, base * CRACK_LINE_LIGHT, crack * CRACK_LINE_OPACITY);
    if frame.wireframe > 0.0 {
        color = mix(color, frame.wire_color, edge_cover(in.corner) * frame.wire_opacity);
    }
    return encoded(shoulder(color));
}
