//! Smooths the floor's light map.

use crate::render::bindings::{self, PipelineParts};
use crate::render::floor_light_pass::{FORMAT, begin};
use wgpu::{BindingResource, BindingType};

pub(crate) const WGSL: &str = include_str!("../../shaders/floor_blur_pass.wgsl");

#[derive(Debug)]
pub(crate) struct FloorBlurPass {
    /// The smooth map.
    pub map: wgpu::TextureView,
    pipeline: wgpu::RenderPipeline,
    group: wgpu::BindGroup,
}

impl FloorBlurPass {
    pub fn new(device: &wgpu::Device, rough: &wgpu::TextureView) -> Self {
        let types = [bindings::texture(), BindingType::Sampler(wgpu::SamplerBindingType::Filtering)];
        let layout = bindings::layout(device, "floor blur pass", &types);
        let sampler = bindings::linear_sampler(device);
        let resources = [BindingResource::TextureView(rough), BindingResource::Sampler(&sampler)];
        let shader = bindings::shader(device, "floor blur pass", WGSL);
        let layouts = [&layout];
        let parts = PipelineParts::full_screen("floor blur pass", &shader, &layouts, FORMAT);
        let side_px = rough.texture().width();
        let texture = bindings::render_texture(device, "floor light", [side_px; 2], FORMAT);
        Self {
            map: bindings::whole(&texture),
            pipeline: parts.build(device),
            group: bindings::group(device, &layout, &resources),
        }
    }

    pub fn draw(&self, encoder: &mut wgpu::CommandEncoder) {
        let mut pass = begin(encoder, &self.map);
        pass.set_pipeline(&self.pipeline);
        pass.set_bind_group(0, &self.group, &[]);
        pass.draw(0..3, 0..1);
    }
}
