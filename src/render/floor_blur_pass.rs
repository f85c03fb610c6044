//! Smooths the floor's light map.

use crate::render::bindings::{self, PipelineParts, with_full_screen};
use crate::render::floor_light_pass::{FORMAT, FloorMap, begin};
use wgpu::{BindingResource, BindingType};

pub(crate) const WGSL: &str = include_str!("../../shaders/floor_blur_pass.wgsl");

#[derive(Debug)]
pub(crate) struct FloorBlurPass {
    layout: wgpu::BindGroupLayout,
    pipeline: wgpu::RenderPipeline,
    sampler: wgpu::Sampler,
}

impl FloorBlurPass {
    pub fn new(device: &wgpu::Device) -> Self {
        let types = [bindings::texture(), BindingType::Sampler(wgpu::SamplerBindingType::Filtering)];
        let layout = bindings::layout(device, "floor blur pass", &types);
        let shader = bindings::shader(device, "floor blur pass", &with_full_screen(WGSL));
        let layouts = [&layout];
        let parts = PipelineParts::full_screen("floor blur pass", &shader, &layouts, FORMAT);
        Self { pipeline: parts.build(device), sampler: bindings::linear_sampler(device), layout }
    }

    /// A map to be drawn from a rough one.
    pub fn new_map(&self, device: &wgpu::Device, rough: &FloorMap) -> FloorMap {
        let side_px = rough.view.texture().width();
        let texture = bindings::render_texture(device, "floor light", [side_px; 2], FORMAT);
        let resources = [BindingResource::TextureView(&rough.view), BindingResource::Sampler(&self.sampler)];
        FloorMap { view: bindings::whole(&texture), group: bindings::group(device, &self.layout, &resources) }
    }

    pub fn draw(&self, encoder: &mut wgpu::CommandEncoder, map: &FloorMap) {
        let mut pass = begin(encoder, &map.view);
        pass.set_pipeline(&self.pipeline);
        pass.set_bind_group(0, &map.group, &[]);
        pass.draw(0..3, 0..1);
    }
}
