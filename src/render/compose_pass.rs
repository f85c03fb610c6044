//! The finished picture: bodies over floor and background, in a rectangle of the target.

use crate::render::bindings::{self, DEPTH_FORMAT, PipelineParts, SCENE_FORMAT, with_full_screen};
use crate::render::frame_uniforms::{FrameBinding, with_prelude};
use wgpu::{BindingResource, BindingType, TextureFormat, TextureUsages};

pub(crate) const WGSL: &str = include_str!("../../shaders/compose_pass.wgsl");

#[derive(Debug)]
pub(crate) struct ComposePass {
    layout: wgpu::BindGroupLayout,
    pipeline: wgpu::RenderPipeline,
    /// By set of light maps.
    floor_lights: [wgpu::TextureView; 3],
    sampler: wgpu::Sampler,
}

/// The textures of one picture size.
#[derive(Debug)]
pub(crate) struct SceneTextures {
    pub size_px: [u32; 2],
    pub samples: u32,
    /// Several samples per pixel; `None` where one is enough.
    pub color: Option<wgpu::TextureView>,
    pub depth: wgpu::TextureView,
    /// One sample per pixel.
    pub resolved: wgpu::TextureView,
    /// By set of light maps.
    groups: [wgpu::BindGroup; 3],
}

impl ComposePass {
    pub fn new(
        device: &wgpu::Device,
        frame: &FrameBinding,
        floor_lights: [&wgpu::TextureView; 3],
        target_format: TextureFormat,
    ) -> Self {
        let types = [
            bindings::texture(),
            bindings::texture(),
            BindingType::Sampler(wgpu::SamplerBindingType::Filtering),
        ];
        let layout = bindings::layout(device, "compose pass", &types);
        let shader = bindings::shader(device, "compose pass", &with_prelude(&with_full_screen(WGSL)));
        let layouts = [&frame.layout, &layout];
        let entry = if target_format.is_srgb() { "linear_fragment" } else { "fragment" };
        let parts = PipelineParts {
            fragment: Some((entry, target_format)),
            ..PipelineParts::full_screen("compose pass", &shader, &layouts, target_format)
        };
        Self {
            pipeline: parts.build(device),
            layout,
            floor_lights: floor_lights.map(Clone::clone),
            sampler: bindings::linear_sampler(device),
        }
    }

    pub fn new_textures(&self, device: &wgpu::Device, size_px: [u32; 2], samples: u32) -> SceneTextures {
        let texture = |label, format, sample_count, usage| {
            let texture = device.create_texture(&wgpu::TextureDescriptor {
                label: Some(label),
                size: wgpu::Extent3d { width: size_px[0], height: size_px[1], depth_or_array_layers: 1 },
                mip_level_count: 1,
                sample_count,
                dimension: wgpu::TextureDimension::D2,
                format,
                usage: usage | TextureUsages::RENDER_ATTACHMENT,
                view_formats: &[],
            });
            bindings::whole(&texture)
        };
        let none = TextureUsages::empty();
        let resolved = texture("bodies", SCENE_FORMAT, 1, TextureUsages::TEXTURE_BINDING);
        let group = |floor_light: &wgpu::TextureView| {
            let resources = [
                BindingResource::TextureView(&resolved),
                BindingResource::TextureView(floor_light),
                BindingResource::Sampler(&self.sampler),
            ];
            bindings::group(device, &self.layout, &resources)
        };
        SceneTextures {
            size_px,
            samples,
            color: (samples > 1).then(|| texture("body samples", SCENE_FORMAT, samples, none)),
            depth: texture("body depth", DEPTH_FORMAT, samples, none),
            groups: self.floor_lights.each_ref().map(group),
            resolved,
        }
    }

    pub fn draw(
        &self,
        pass: &mut wgpu::RenderPass<'_>,
        frame: &FrameBinding,
        (textures, light_set): (&SceneTextures, usize),
    ) {
        pass.set_pipeline(&self.pipeline);
        pass.set_bind_group(0, &frame.group, &[]);
        pass.set_bind_group(1, &textures.groups[light_set], &[]);
        pass.draw(0..3, 0..1);
    }
}
