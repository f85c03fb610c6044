// One triangle that covers the whole target. Stands in front of every shader of a pass that does so.

struct Covered {
    @builtin(position) position: vec4<f32>,
    // 0..1 over the target, from its lower left corner.
    @location(0) place: vec2<f32>,
}

@vertex
fn vertex(@builtin(vertex_index) index: u32) -> Covered {
    let corner = vec2<f32>(f32((index << 1u) & 2u), f32(index & 2u));
    return Covered(vec4<f32>(corner * 2.0 - 1.0, 0.0, 1.0), corner);
}
