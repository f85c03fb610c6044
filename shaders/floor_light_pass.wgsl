// How much light reaches the floor, in a map that covers the shadows: red for the key light,
// green for ambient light. Wide filters are affordable here, since the map is small and does
// not grow with the picture.

@group(1) @binding(0) var shadow_map: texture_depth_2d;
@group(1) @binding(1) var height_map: texture_depth_2d;

const GOLDEN_ANGLE: f32 = 2.3999632;
// Few taps are enough: the blur that follows gathers those of sixteen texels. Drafts take fewer.
override search_taps: i32 = 10;
override shadow_taps: i32 = 16;
override ambient_taps: i32 = 12;

// Evenly over the unit disk. Each of 4x4 neighbouring texels turns the pattern by another share
// of its pitch; the blur that follows averages just these sixteen, which leaves no pattern.
fn disk_tap(i: i32, count: i32, turn: f32) -> vec2<f32> {
    let radius = sqrt((f32(i) + 0.5) / f32(count));
    let angle = f32(i) * GOLDEN_ANGLE + turn;
    return radius * vec2<f32>(cos(angle), sin(angle));
}

fn turn_at(texel: vec2<f32>) -> f32 {
    let cell = vec2<i32>(texel) & vec2<i32>(3);
    // A magic order: neighbours differ much.
    let order = (cell.x * 5 + cell.y * 11) & 15;
    return f32(order) * (6.2831853 / 16.0);
}

// Depth in the shadow map at texture coordinates; 1 where nothing is in the light's way.
fn blocker_depth(uv: vec2<f32>, size: vec2<f32>) -> f32 {
    if any(uv < vec2<f32>(0.0)) || any(uv >= vec2<f32>(1.0)) {
        return 1.0;
    }
    return textureLoad(shadow_map, vec2<i32>(uv * size), 0);
}

// The share of the key light that arrives. All casters are above the floor, so whatever the map
// holds is in the way: no depths are compared and no bias is needed. The farther the caster, the
// softer its shadow.
fn key_visibility(point: vec3<f32>, turn: f32) -> f32 {
    let projected = frame.shadow_from_world * vec4<f32>(point, 1.0);
    let uv = vec2<f32>(0.5 + 0.5 * projected.x, 0.5 - 0.5 * projected.y);
    let size = vec2<f32>(textureDimensions(shadow_map));
    let side = frame.shadow_texel * size.x;
    let farthest = max(projected.z, 0.0) * frame.shadow_depth * frame.light_spread / side;

    var blockers = 0.0;
    var depth_sum = 0.0;
    for (var i = 0; i < search_taps; i++) {
        let depth = blocker_depth(uv + disk_tap(i, search_taps, turn) * farthest, size);
        if depth < 1.0 {
            blockers += 1.0;
            depth_sum += depth;
        }
    }
    if blockers == 0.0 {
        return 1.0;
    }
    let distance = max(projected.z - depth_sum / blockers, 0.0) * frame.shadow_depth;
    let radius = max(distance * frame.light_spread / side, 1.2 / size.x);
    var open = 0.0;
    for (var i = 0; i < shadow_taps; i++) {
        open += step(1.0, blocker_depth(uv + disk_tap(i, shadow_taps, turn) * radius, size));
    }
    return open / f32(shadow_taps);
}

// The share of ambient light that arrives: what hangs low nearby takes some.
fn ambient_visibility(place: vec2<f32>, turn: f32) -> f32 {
    let size = vec2<f32>(textureDimensions(height_map));
    let radius = frame.floor_reach / frame.floor_map_side;
    var taken = 0.0;
    var weights = 0.0;
    for (var i = 0; i < ambient_taps; i++) {
        let tap = disk_tap(i, ambient_taps, turn);
        let near = 1.0 - 0.8 * length(tap);
        let uv = place + tap * radius;
        var height = 1.0;
        if all(uv >= vec2<f32>(0.0)) && all(uv < vec2<f32>(1.0)) {
            height = textureLoad(height_map, vec2<i32>(vec2<f32>(uv.x, 1.0 - uv.y) * size), 0);
        }
        weights += near;
        taken += near * (1.0 - height) * (1.0 - height);
    }
    return 1.0 - taken / weights;
}

@fragment
fn fragment(in: Covered) -> @location(0) vec2<f32> {
    let ground = frame.floor_map_low + in.place * frame.floor_map_side;
    let point = vec3<f32>(ground, frame.floor_height);
    let turn = turn_at(in.position.xy);
    return vec2<f32>(key_visibility(point, turn), ambient_visibility(in.place, turn));
}
