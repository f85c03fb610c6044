//! A picture drawn small, shown large: less work while things move on slow hardware.

use crate::render::bindings::{self, PipelineParts, with_full_screen};
use wgpu::{BindingResource, BindingType, TextureFormat};

pub(crate) const WGSL: &str = include_str!("../../shaders/enlarge_pass.wgsl");

#[derive(Debug)]
pub(crate) struct EnlargePass {
    layout: wgpu::BindGroupLayout,
    pipeline: wgpu::RenderPipeline,
    sampler: wgpu::Sampler,
    format: TextureFormat,
}

/// The small picture.
#[derive(Debug)]
pub(crate) struct SmallPicture {
    pub view: wgpu::TextureView,
    group: wgpu::BindGroup,
}

impl EnlargePass {
    pub fn new(device: &wgpu::Device, target_format: TextureFormat) -> Self {
        let types = [bindings::texture(), BindingType::Sampler(wgpu::SamplerBindingType::Filtering)];
        let layout = bindings::layout(device, "enlarge pass", &types);
        let shader = bindings::shader(device, "enlarge pass", &with_full_screen(WGSL));
        let layouts = [&layout];
        let parts = PipelineParts::full_screen("enlarge pass", &shader, &layouts, target_format);
        Self {
            pipeline: parts.build(device),
            layout,
            sampler: bindings::linear_sampler(device),
            format: target_format,
        }
    }

    pub fn new_picture(&self, device: &wgpu::Device, size_px: [u32; 2]) -> SmallPicture {
        let texture = bindings::render_texture(device, "small picture", size_px, self.format);
        let view = bindings::whole(&texture);
        let resources = [BindingResource::TextureView(&view), BindingResource::Sampler(&self.sampler)];
        SmallPicture { group: bindings::group(device, &self.layout, &resources), view }
    }

    pub fn draw(&self, pass: &mut wgpu::RenderPass<'_>, picture: &SmallPicture) {
        pass.set_pipeline(&self.pipeline);
        pass.set_bind_group(0, &picture.group, &[]);
        pass.draw(0..3, 0..1);
    }
}
