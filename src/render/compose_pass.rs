//! From the scene's own textures to a rectangle of the target.

use crate::render::bindings::{self, DEPTH_FORMAT, PipelineParts, SAMPLES, SCENE_FORMAT};
use wgpu::{BindingResource, TextureFormat, TextureUsages};

pub(crate) const WGSL: &str = include_str!("../../shaders/compose_pass.wgsl");

#[derive(Debug)]
pub(crate) struct ComposePass {
    layout: wgpu::BindGroupLayout,
    pipeline: wgpu::RenderPipeline,
    placement: wgpu::Buffer,
}

/// The textures of one picture size.
#[derive(Debug)]
pub(crate) struct SceneTextures {
    pub size_px: [u32; 2],
    /// Four samples per pixel.
    pub color: wgpu::TextureView,
    pub depth: wgpu::TextureView,
    /// One sample per pixel.
    pub resolved: wgpu::TextureView,
    group: wgpu::BindGroup,
}

impl ComposePass {
    pub fn new(device: &wgpu::Device, target_format: TextureFormat) -> Self {
        let types = [bindings::texture(), bindings::uniform()];
        let layout = bindings::layout(device, "compose pass", &types);
        let shader = bindings::shader(device, "compose pass", WGSL);
        let layouts = [&layout];
        let entry = if target_format.is_srgb() { "linear_fragment" } else { "fragment" };
        let parts = PipelineParts {
            fragment: Some((entry, target_format)),
            ..PipelineParts::full_screen("compose pass", &shader, &layouts, target_format)
        };
        Self {
            pipeline: parts.build(device),
            placement: bindings::uniform_buffer::<[f32; 4]>(device, "placement"),
            layout,
        }
    }

    pub fn new_textures(&self, device: &wgpu::Device, size_px: [u32; 2]) -> SceneTextures {
        let texture = |label, format, sample_count, usage| {
            device.create_texture(&wgpu::TextureDescriptor {
                label: Some(label),
                size: wgpu::Extent3d { width: size_px[0], height: size_px[1], depth_or_array_layers: 1 },
                mip_level_count: 1,
                sample_count,
                dimension: wgpu::TextureDimension::D2,
                format,
                usage: usage | TextureUsages::RENDER_ATTACHMENT,
                view_formats: &[],
            })
        };
        let none = TextureUsages::empty();
        let color = texture("scene colour", SCENE_FORMAT, SAMPLES, none);
        let depth = texture("scene depth", DEPTH_FORMAT, SAMPLES, none);
        let resolved = texture("scene", SCENE_FORMAT, 1, TextureUsages::TEXTURE_BINDING);
        let resolved = bindings::whole(&resolved);
        let resources = [BindingResource::TextureView(&resolved), self.placement.as_entire_binding()];
        SceneTextures {
            size_px,
            color: bindings::whole(&color),
            depth: bindings::whole(&depth),
            group: bindings::group(device, &self.layout, &resources),
            resolved,
        }
    }

    /// Tells where the picture's upper left corner lies in the target, pixels.
    pub fn place(&self, queue: &wgpu::Queue, [x, y]: [u32; 2]) {
        let placement = [x as f32, y as f32, 0.0, 0.0];
        queue.write_buffer(&self.placement, 0, bytemuck::bytes_of(&placement));
    }

    pub fn draw(&self, pass: &mut wgpu::RenderPass<'_>, textures: &SceneTextures) {
        pass.set_pipeline(&self.pipeline);
        pass.set_bind_group(0, &textures.group, &[]);
        pass.draw(0..3, 0..1);
    }
}
