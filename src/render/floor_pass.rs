//! The floor and the background.

use crate::render::bindings::{self, PipelineParts, SAMPLES, SCENE_FORMAT};
use crate::render::frame_uniforms::{FrameBinding, with_prelude};
use wgpu::{BindingResource, BindingType};

pub(crate) const WGSL: &str = include_str!("../../shaders/floor_pass.wgsl");

#[derive(Debug)]
pub(crate) struct FloorPass {
    floor: wgpu::RenderPipeline,
    background: wgpu::RenderPipeline,
    group: wgpu::BindGroup,
}

impl FloorPass {
    pub fn new(device: &wgpu::Device, frame: &FrameBinding, light: &wgpu::TextureView) -> Self {
        let types = [bindings::texture(), BindingType::Sampler(wgpu::SamplerBindingType::Filtering)];
        let layout = bindings::layout(device, "floor pass", &types);
        let sampler = bindings::linear_sampler(device);
        let resources = [BindingResource::TextureView(light), BindingResource::Sampler(&sampler)];
        let shader = bindings::shader(device, "floor pass", &with_prelude(WGSL));
        let layouts = [&frame.layout, &layout];
        let floor = PipelineParts {
            vertex_entry: "floor_vertex",
            fragment: Some(("floor_fragment", SCENE_FORMAT)),
            depth: Some(bindings::scene_depth()),
            topology: wgpu::PrimitiveTopology::TriangleStrip,
            // From below, the floor does not hide what stands on it.
            cull: Some(wgpu::Face::Back),
            samples: SAMPLES,
            ..PipelineParts::full_screen("floor", &shader, &layouts, SCENE_FORMAT)
        };
        let background = PipelineParts {
            vertex_entry: "background_vertex",
            fragment: Some(("background_fragment", SCENE_FORMAT)),
            depth: Some(bindings::scene_depth()),
            samples: SAMPLES,
            ..PipelineParts::full_screen("background", &shader, &layouts[..1], SCENE_FORMAT)
        };
        Self {
            floor: floor.build(device),
            background: background.build(device),
            group: bindings::group(device, &layout, &resources),
        }
    }

    pub fn draw_floor(&self, pass: &mut wgpu::RenderPass<'_>) {
        pass.set_pipeline(&self.floor);
        pass.set_bind_group(1, &self.group, &[]);
        pass.draw(0..4, 0..1);
    }

    pub fn draw_background(&self, pass: &mut wgpu::RenderPass<'_>) {
        pass.set_pipeline(&self.background);
        pass.draw(0..3, 0..1);
    }
}
