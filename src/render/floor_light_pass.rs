//! How much light reaches each place of the floor.

use crate::render::bindings::{self, PipelineParts, with_full_screen};
use crate::render::depth_pass::DepthMap;
use crate::render::frame_uniforms::{FrameBinding, with_prelude};
use crate::render::quality::Quality;
use wgpu::BindingResource;

pub(crate) const WGSL: &str = include_str!("../../shaders/floor_light_pass.wgsl");

/// Two channels are enough, and eight bits for what is at most a shade of grey.
pub(crate) const FORMAT: wgpu::TextureFormat = wgpu::TextureFormat::Rg8Unorm;

/// A third of what the shader says, which is a third of its time: a little grain in soft shadows.
const DRAFT_TAPS: &[(&str, f64)] = &[("search_taps", 4.0), ("shadow_taps", 5.0), ("ambient_taps", 4.0)];

#[derive(Debug)]
pub(crate) struct FloorLightPass {
    layout: wgpu::BindGroupLayout,
    fine: wgpu::RenderPipeline,
    draft: wgpu::RenderPipeline,
}

/// Key light in red, ambient light in green; see `FloorFit` for where it lies.
#[derive(Debug)]
pub(crate) struct FloorMap {
    pub view: wgpu::TextureView,
    /// What it is drawn from.
    pub group: wgpu::BindGroup,
}

impl FloorLightPass {
    pub fn new(device: &wgpu::Device, frame: &FrameBinding) -> Self {
        let types = [bindings::depth_texture(); 2];
        let layout = bindings::layout(device, "floor light pass", &types);
        let shader = bindings::shader(device, "floor light pass", &with_prelude(&with_full_screen(WGSL)));
        let layouts = [&frame.layout, &layout];
        let pipeline = |constants| {
            let parts = PipelineParts::full_screen("floor light pass", &shader, &layouts, FORMAT);
            PipelineParts { constants, ..parts }.build(device)
        };
        Self { fine: pipeline(&[]), draft: pipeline(DRAFT_TAPS), layout }
    }

    /// A map to be drawn from a shadow map and a map of heights.
    pub fn new_map(&self, device: &wgpu::Device, maps: [&DepthMap; 2], side_px: u32) -> FloorMap {
        let texture = bindings::render_texture(device, "floor light", [side_px; 2], FORMAT);
        let resources = maps.map(|map| BindingResource::TextureView(&map.view));
        FloorMap { view: bindings::whole(&texture), group: bindings::group(device, &self.layout, &resources) }
    }

    pub fn draw(
        &self,
        encoder: &mut wgpu::CommandEncoder,
        frame: &FrameBinding,
        map: &FloorMap,
        quality: Quality,
    ) {
        let mut pass = begin(encoder, &map.view);
        pass.set_pipeline(if quality.is_draft { &self.draft } else { &self.fine });
        pass.set_bind_group(0, &frame.group, &[]);
        pass.set_bind_group(1, &map.group, &[]);
        pass.draw(0..3, 0..1);
    }
}

/// Starts drawing over all of a floor map.
pub(crate) fn begin<'e>(
    encoder: &'e mut wgpu::CommandEncoder,
    map: &wgpu::TextureView,
) -> wgpu::RenderPass<'e> {
    encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
        label: Some("floor map"),
        color_attachments: &[Some(wgpu::RenderPassColorAttachment {
            view: map,
            depth_slice: None,
            resolve_target: None,
            ops: wgpu::Operations {
                load: wgpu::LoadOp::Clear(wgpu::Color::WHITE),
                store: wgpu::StoreOp::Store,
            },
        })],
        ..Default::default()
    })
}
