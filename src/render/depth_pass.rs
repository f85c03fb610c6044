//! Depth seen along a direction: the shadow map, and the heights above the floor.

use crate::render::bindings::{self, DEPTH_FORMAT, PipelineParts};
use glam::Mat4;

pub(crate) const WGSL: &str = include_str!("../../shaders/depth_pass.wgsl");

/// How positions lie in a vertex buffer.
const VERTEX_LAYOUT: wgpu::VertexBufferLayout<'static> = wgpu::VertexBufferLayout {
    array_stride: size_of::<[f32; 3]>() as u64,
    step_mode: wgpu::VertexStepMode::Vertex,
    attributes: &wgpu::vertex_attr_array![0 => Float32x3],
};

/// What is in the light's way.
#[derive(Debug)]
pub(crate) struct Casters<'a> {
    /// Positions, metres, three `f32` each.
    pub positions: &'a wgpu::Buffer,
    /// Corners of triangles, `u32`.
    pub corners: &'a wgpu::Buffer,
    /// How many corners there are.
    pub count: u32,
}

/// The pipelines, shared by all depth maps.
#[derive(Debug)]
pub(crate) struct DepthPass {
    layout: wgpu::BindGroupLayout,
    /// By [`Seen`].
    pipelines: [wgpu::RenderPipeline; 2],
}

/// From where a map looks: only faces towards it are drawn, since the nearest ones of closed surfaces are among them.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Seen {
    /// From the far end of a right-handed frame, as a camera does.
    FromAbove,
    /// The other way round.
    FromBelow,
}

/// A depth texture and the matrix it is drawn with.
#[derive(Debug)]
pub(crate) struct DepthMap {
    pub view: wgpu::TextureView,
    matrix: wgpu::Buffer,
    group: wgpu::BindGroup,
}

impl DepthPass {
    pub fn new(device: &wgpu::Device) -> Self {
        let layout = bindings::layout(device, "depth pass", &[bindings::uniform()]);
        let shader = bindings::shader(device, "depth pass", WGSL);
        let layouts = [&layout];
        let pipeline = |cull| PipelineParts {
            label: "depth pass",
            shader: &shader,
            layouts: &layouts,
            vertex_entry: "vertex",
            vertex_buffer: Some(VERTEX_LAYOUT),
            fragment: None,
            depth: Some(depth_state()),
            cull: Some(cull),
            samples: 1,
            constants: &[],
        };
        let pipelines = [wgpu::Face::Back, wgpu::Face::Front].map(|cull| pipeline(cull).build(device));
        Self { pipelines, layout }
    }

    pub fn new_map(&self, device: &wgpu::Device, label: &str, side_px: u32) -> DepthMap {
        let texture = bindings::render_texture(device, label, [side_px; 2], DEPTH_FORMAT);
        let matrix = bindings::uniform_buffer::<[f32; 16]>(device, label);
        DepthMap {
            view: bindings::whole(&texture),
            group: bindings::group(device, &self.layout, &[matrix.as_entire_binding()]),
            matrix,
        }
    }

    /// Fills `map` with the smallest depth of the triangles, 1 where there are none.
    pub fn draw(
        &self,
        encoder: &mut wgpu::CommandEncoder,
        (map, seen): (&DepthMap, Seen),
        casters: &Casters<'_>,
    ) {
        let mut pass = encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
            label: Some("depth pass"),
            depth_stencil_attachment: Some(wgpu::RenderPassDepthStencilAttachment {
                view: &map.view,
                depth_ops: Some(wgpu::Operations {
                    load: wgpu::LoadOp::Clear(1.0),
                    store: wgpu::StoreOp::Store,
                }),
                stencil_ops: None,
            }),
            ..Default::default()
        });
        pass.set_pipeline(&self.pipelines[seen as usize]);
        pass.set_bind_group(0, &map.group, &[]);
        pass.set_vertex_buffer(0, casters.positions.slice(..));
        pass.set_index_buffer(casters.corners.slice(..), wgpu::IndexFormat::Uint32);
        pass.draw_indexed(0..casters.count, 0, 0..1);
    }
}

impl DepthMap {
    pub fn set_matrix(&self, queue: &wgpu::Queue, clip_from_world: Mat4) {
        queue.write_buffer(&self.matrix, 0, bytemuck::bytes_of(&clip_from_world.to_cols_array()));
    }
}

fn depth_state() -> wgpu::DepthStencilState {
    wgpu::DepthStencilState {
        format: DEPTH_FORMAT,
        depth_write_enabled: Some(true),
        depth_compare: Some(wgpu::CompareFunction::Less),
        stencil: Default::default(),
        bias: wgpu::DepthBiasState {
            constant: 0,
            // Steep faces span more depth per texel; pushing them back keeps them from
            // shadowing themselves. More would let light leak in where bodies touch.
            slope_scale: 1.5,
            clamp: 0.0,
        },
    }
}
