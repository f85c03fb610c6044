//! The bodies' surfaces, lit and coloured.

use crate::render::bindings::{self, PipelineParts, SCENE_FORMAT};
use crate::render::color_map::{ColorMap, TABLE_LENGTH};
use crate::render::depth_pass::DepthMap;
use crate::render::frame_uniforms::{FrameBinding, with_prelude};
use crate::render::geometry::SurfaceVertex;
use crate::render::quality::Quality;
use wgpu::{BindingResource, BindingType};

pub(crate) const WGSL: &str = include_str!("../../shaders/surface_pass.wgsl");

/// How a [`SurfaceVertex`] lies in a vertex buffer.
const VERTEX_LAYOUT: wgpu::VertexBufferLayout<'static> = wgpu::VertexBufferLayout {
    array_stride: size_of::<SurfaceVertex>() as u64,
    step_mode: wgpu::VertexStepMode::Vertex,
    attributes: &wgpu::vertex_attr_array![
        0 => Float32x3,
        1 => Snorm16x4,
        2 => Unorm8x4,
        3 => Float32,
    ],
};

#[derive(Debug)]
pub(crate) struct SurfacePass {
    fine: Pipelines,
    draft: Pipelines,
    /// By set of light maps.
    groups: [wgpu::BindGroup; 3],
}

/// For one quality.
#[derive(Debug)]
struct Pipelines {
    all: wgpu::RenderPipeline,
    above_floor: wgpu::RenderPipeline,
}

impl SurfacePass {
    pub fn new(gpu: (&wgpu::Device, &wgpu::Queue), frame: &FrameBinding, shadows: [&DepthMap; 3]) -> Self {
        let (device, queue) = gpu;
        let layout = bindings::layout(
            device,
            "surface pass",
            &[
                bindings::depth_texture(),
                BindingType::Sampler(wgpu::SamplerBindingType::Comparison),
                bindings::texture(),
                BindingType::Sampler(wgpu::SamplerBindingType::Filtering),
            ],
        );
        let (comparison, colors) = (comparison_sampler(device), color_map_texture(device, queue));
        let linear = bindings::linear_sampler(device);
        let groups = shadows.map(|shadow| {
            let resources = [
                BindingResource::TextureView(&shadow.view),
                BindingResource::Sampler(&comparison),
                BindingResource::TextureView(&colors),
                BindingResource::Sampler(&linear),
            ];
            bindings::group(device, &layout, &resources)
        });
        let shader = bindings::shader(device, "surface pass", &with_prelude(WGSL));
        let layouts = [&frame.layout, &layout];
        let pipeline = |entry: &str, samples| {
            let parts = PipelineParts {
                vertex_buffer: Some(VERTEX_LAYOUT),
                fragment: Some((entry, SCENE_FORMAT)),
                depth: Some(bindings::scene_depth()),
                // Surfaces of tetrahedral meshes are closed: their insides are never seen.
                cull: Some(wgpu::Face::Back),
                samples,
                ..PipelineParts::full_screen("surface pass", &shader, &layouts, SCENE_FORMAT)
            };
            parts.build(device)
        };
        let pipelines = |[all, above_floor]: [&str; 2], quality: Quality| Pipelines {
            all: pipeline(all, quality.samples()),
            above_floor: pipeline(above_floor, quality.samples()),
        };
        let draft = ["draft_fragment", "draft_fragment_above_floor"];
        Self {
            fine: pipelines(["fragment", "fragment_above_floor"], Quality::FULL),
            draft: pipelines(draft, Quality::draft([1, 1])),
            groups,
        }
    }

    /// Draws the triangles; `cut` leaves out what is below the floor.
    pub fn draw(
        &self,
        pass: &mut wgpu::RenderPass<'_>,
        (vertices, count): (&wgpu::Buffer, u32),
        cut: bool,
        (quality, light_set): (Quality, usize),
    ) {
        let pipelines = if quality.is_draft { &self.draft } else { &self.fine };
        pass.set_pipeline(if cut { &pipelines.above_floor } else { &pipelines.all });
        pass.set_bind_group(1, &self.groups[light_set], &[]);
        pass.set_vertex_buffer(0, vertices.slice(..));
        pass.draw(0..count, 0..1);
    }
}

/// Texture coordinate of a map's row in the texture of all maps.
pub(crate) fn map_row(map: ColorMap) -> f32 {
    match map {
        ColorMap::Sequential => 0.25,
        ColorMap::Diverging => 0.75,
    }
}

fn color_map_texture(device: &wgpu::Device, queue: &wgpu::Queue) -> wgpu::TextureView {
    use wgpu::util::DeviceExt as _;
    let rows = [ColorMap::Sequential.table(), ColorMap::Diverging.table()];
    let texture = device.create_texture_with_data(
        queue,
        &wgpu::TextureDescriptor {
            label: Some("colour maps"),
            size: wgpu::Extent3d {
                width: TABLE_LENGTH as u32,
                height: rows.len() as u32,
                depth_or_array_layers: 1,
            },
            mip_level_count: 1,
            sample_count: 1,
            dimension: wgpu::TextureDimension::D2,
            format: wgpu::TextureFormat::Rgba8UnormSrgb,
            usage: wgpu::TextureUsages::TEXTURE_BINDING,
            view_formats: &[],
        },
        wgpu::util::TextureDataOrder::LayerMajor,
        bytemuck::cast_slice(&rows),
    );
    bindings::whole(&texture)
}

fn comparison_sampler(device: &wgpu::Device) -> wgpu::Sampler {
    device.create_sampler(&wgpu::SamplerDescriptor {
        label: Some("shadow"),
        mag_filter: wgpu::FilterMode::Linear,
        min_filter: wgpu::FilterMode::Linear,
        compare: Some(wgpu::CompareFunction::LessEqual),
        ..Default::default()
    })
}
