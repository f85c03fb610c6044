//! The one place for what all passes of a picture share; `shaders/frame_uniforms.wgsl` mirrors
//! it and stands in front of every shader that reads it.

use crate::render::bindings;

/// WGSL that declares the uniforms and helpers.
pub(crate) const PRELUDE: &str = include_str!("../../shaders/frame_uniforms.wgsl");

/// See the WGSL for what each field means.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, PartialEq, bytemuck::Pod, bytemuck::Zeroable)]
pub(crate) struct FrameUniforms {
    pub clip_from_world: [[f32; 4]; 4],
    pub shadow_from_world: [[f32; 4]; 4],
    pub eye: [f32; 3],
    pub wireframe: f32,
    pub towards_light: [f32; 3],
    pub shadow_texel: f32,
    pub key_light: [f32; 3],
    pub wire_width: f32,
    pub sky_light: [f32; 3],
    pub floor_height: f32,
    pub bounce_light: [f32; 3],
    pub floor_radius: f32,
    pub rim_light: [f32; 3],
    pub map_row: f32,
    pub background_low: [f32; 3],
    pub shadow_depth: f32,
    pub background_high: [f32; 3],
    pub shadow_strength: f32,
    pub floor_color: [f32; 3],
    pub light_spread: f32,
    pub wire_color: [f32; 3],
    pub wire_opacity: f32,
    pub floor_center: [f32; 2],
    pub floor_map_low: [f32; 2],
    pub floor_map_side: f32,
    pub floor_reach: f32,
    pub picture_origin: [f32; 2],
    pub ray_corner: [f32; 3],
    pub unused_1: f32,
    pub ray_right: [f32; 3],
    pub unused_2: f32,
    pub ray_up: [f32; 3],
    pub unused_3: f32,
}

/// The uniforms on the GPU, bound as group 0 by the passes that read them.
#[derive(Debug)]
pub(crate) struct FrameBinding {
    pub layout: wgpu::BindGroupLayout,
    pub group: wgpu::BindGroup,
    buffer: wgpu::Buffer,
}

impl FrameBinding {
    pub fn new(device: &wgpu::Device) -> Self {
        let layout = bindings::layout(device, "frame uniforms", &[bindings::uniform()]);
        let buffer = bindings::uniform_buffer::<FrameUniforms>(device, "frame uniforms");
        let group = bindings::group(device, &layout, &[buffer.as_entire_binding()]);
        Self { layout, group, buffer }
    }

    pub fn write(&self, queue: &wgpu::Queue, uniforms: &FrameUniforms) {
        queue.write_buffer(&self.buffer, 0, bytemuck::bytes_of(uniforms));
    }
}

/// A shader with the uniforms declared in front of it.
pub(crate) fn with_prelude(wgsl: &str) -> String {
    format!("{PRELUDE}\n{wgsl}")
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Name and byte offset of every member of the WGSL struct.
    fn wgsl_members() -> (Vec<(String, u32)>, u32) {
        let module = naga::front::wgsl::parse_str(PRELUDE).expect("the prelude parses");
        let found = module.types.iter().find_map(|(_, ty)| match &ty.inner {
            naga::TypeInner::Struct { members, span } if ty.name.as_deref() == Some("FrameUniforms") => {
                let names = members.iter().map(|m| (m.name.clone().unwrap_or_default(), m.offset));
                Some((names.collect(), *span))
            }
            _ => None,
        });
        found.expect("the prelude declares FrameUniforms")
    }

    #[test]
    fn rust_and_wgsl_agree_on_every_offset() {
        use std::mem::offset_of;
        macro_rules! offsets {
            ($($field:ident),* $(,)?) => {
                vec![$((stringify!($field).to_owned(), offset_of!(FrameUniforms, $field) as u32)),*]
            };
        }
        let (members, span) = wgsl_members();
        let rust = offsets![
            clip_from_world,
            shadow_from_world,
            eye,
            wireframe,
            towards_light,
            shadow_texel,
            key_light,
            wire_width,
            sky_light,
            floor_height,
            bounce_light,
            floor_radius,
            rim_light,
            map_row,
            background_low,
            shadow_depth,
            background_high,
            shadow_strength,
            floor_color,
            light_spread,
            wire_color,
            wire_opacity,
            floor_center,
            floor_map_low,
            floor_map_side,
            floor_reach,
            picture_origin,
            ray_corner,
            unused_1,
            ray_right,
            unused_2,
            ray_up,
            unused_3,
        ];
        assert_eq!(members, rust);
        assert_eq!(span as usize, size_of::<FrameUniforms>());
    }
}
