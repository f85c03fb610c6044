//! Short words for what shaders are given and how pipelines are put together.

use wgpu::BindingType;

/// Format of the scene before it reaches the target. Shaders encode to sRGB themselves.
pub(crate) const SCENE_FORMAT: wgpu::TextureFormat = wgpu::TextureFormat::Rgba8Unorm;
/// Format of all depth textures.
pub(crate) const DEPTH_FORMAT: wgpu::TextureFormat = wgpu::TextureFormat::Depth32Float;

/// A uniform buffer.
pub(crate) fn uniform() -> BindingType {
    BindingType::Buffer {
        ty: wgpu::BufferBindingType::Uniform,
        has_dynamic_offset: false,
        min_binding_size: None,
    }
}

/// A colour texture, filterable.
pub(crate) fn texture() -> BindingType {
    sampled(wgpu::TextureSampleType::Float { filterable: true })
}

/// A depth texture.
pub(crate) fn depth_texture() -> BindingType {
    sampled(wgpu::TextureSampleType::Depth)
}

fn sampled(sample_type: wgpu::TextureSampleType) -> BindingType {
    BindingType::Texture { sample_type, view_dimension: wgpu::TextureViewDimension::D2, multisampled: false }
}

/// A layout with one entry for each type, numbered from zero, for both shader stages.
pub(crate) fn layout(device: &wgpu::Device, label: &str, types: &[BindingType]) -> wgpu::BindGroupLayout {
    let entries: Vec<_> = (0..)
        .zip(types)
        .map(|(binding, ty)| wgpu::BindGroupLayoutEntry {
            binding,
            visibility: wgpu::ShaderStages::VERTEX_FRAGMENT,
            ty: *ty,
            count: None,
        })
        .collect();
    device
        .create_bind_group_layout(&wgpu::BindGroupLayoutDescriptor { label: Some(label), entries: &entries })
}

/// A bind group of a layout made by [`layout`].
pub(crate) fn group(
    device: &wgpu::Device,
    layout: &wgpu::BindGroupLayout,
    resources: &[wgpu::BindingResource<'_>],
) -> wgpu::BindGroup {
    let entries: Vec<_> = (0..)
        .zip(resources)
        .map(|(binding, resource)| wgpu::BindGroupEntry { binding, resource: resource.clone() })
        .collect();
    device.create_bind_group(&wgpu::BindGroupDescriptor { label: None, layout, entries: &entries })
}

/// A uniform buffer that holds a `T`.
pub(crate) fn uniform_buffer<T>(device: &wgpu::Device, label: &str) -> wgpu::Buffer {
    device.create_buffer(&wgpu::BufferDescriptor {
        label: Some(label),
        size: size_of::<T>() as u64,
        usage: wgpu::BufferUsages::UNIFORM | wgpu::BufferUsages::COPY_DST,
        mapped_at_creation: false,
    })
}

/// A sampler with linear filtering that clamps at the border.
pub(crate) fn linear_sampler(device: &wgpu::Device) -> wgpu::Sampler {
    device.create_sampler(&wgpu::SamplerDescriptor {
        mag_filter: wgpu::FilterMode::Linear,
        min_filter: wgpu::FilterMode::Linear,
        ..Default::default()
    })
}

/// A shader module from WGSL text.
pub(crate) fn shader(device: &wgpu::Device, label: &str, wgsl: &str) -> wgpu::ShaderModule {
    device.create_shader_module(wgpu::ShaderModuleDescriptor {
        label: Some(label),
        source: wgpu::ShaderSource::Wgsl(wgsl.into()),
    })
}

/// WGSL of the triangle that covers a whole target.
pub(crate) const FULL_SCREEN: &str = include_str!("../../shaders/full_screen.wgsl");

/// A shader with the vertex stage of [`PipelineParts::full_screen`] in front of it.
pub(crate) fn with_full_screen(wgsl: &str) -> String {
    format!("{FULL_SCREEN}\n{wgsl}")
}

/// What tells one pipeline from another; everything else is the same for all.
pub(crate) struct PipelineParts<'a> {
    pub label: &'a str,
    pub shader: &'a wgpu::ShaderModule,
    pub layouts: &'a [&'a wgpu::BindGroupLayout],
    pub vertex_entry: &'a str,
    pub vertex_buffer: Option<wgpu::VertexBufferLayout<'a>>,
    /// Entry point and format of the colour target; `None` draws depth only.
    pub fragment: Option<(&'a str, wgpu::TextureFormat)>,
    pub depth: Option<wgpu::DepthStencilState>,
    pub cull: Option<wgpu::Face>,
    pub samples: u32,
    /// Values of the shader's `override`s that differ from what it says itself.
    pub constants: &'a [(&'a str, f64)],
}

impl<'a> PipelineParts<'a> {
    /// A pipeline that covers its whole target with one triangle; its shader begins as [`with_full_screen`] has it.
    pub fn full_screen(
        label: &'a str,
        shader: &'a wgpu::ShaderModule,
        layouts: &'a [&'a wgpu::BindGroupLayout],
        format: wgpu::TextureFormat,
    ) -> Self {
        Self {
            label,
            shader,
            layouts,
            vertex_entry: "vertex",
            vertex_buffer: None,
            fragment: Some(("fragment", format)),
            depth: None,
            cull: None,
            samples: 1,
            constants: &[],
        }
    }

    /// Builds the pipeline.
    pub fn build(self, device: &wgpu::Device) -> wgpu::RenderPipeline {
        let layouts: Vec<_> = self.layouts.iter().copied().map(Some).collect();
        let layout = device.create_pipeline_layout(&wgpu::PipelineLayoutDescriptor {
            label: Some(self.label),
            bind_group_layouts: &layouts,
            immediate_size: 0,
        });
        let target = self.fragment.map(|(_, format)| Some(format.into()));
        let options = wgpu::PipelineCompilationOptions { constants: self.constants, ..Default::default() };
        device.create_render_pipeline(&wgpu::RenderPipelineDescriptor {
            label: Some(self.label),
            layout: Some(&layout),
            vertex: wgpu::VertexState {
                module: self.shader,
                entry_point: Some(self.vertex_entry),
                compilation_options: options.clone(),
                buffers: &[self.vertex_buffer],
            },
            primitive: wgpu::PrimitiveState { cull_mode: self.cull, ..Default::default() },
            depth_stencil: self.depth,
            multisample: wgpu::MultisampleState { count: self.samples, ..Default::default() },
            fragment: self.fragment.map(|(entry, _)| wgpu::FragmentState {
                module: self.shader,
                entry_point: Some(entry),
                compilation_options: options,
                targets: target.as_slice(),
            }),
            multiview_mask: None,
            cache: None,
        })
    }
}

/// Depth test of the scene: depth falls with distance (see `Camera::clip_from_world`).
pub(crate) fn scene_depth() -> wgpu::DepthStencilState {
    wgpu::DepthStencilState {
        format: DEPTH_FORMAT,
        depth_write_enabled: Some(true),
        depth_compare: Some(wgpu::CompareFunction::GreaterEqual),
        stencil: Default::default(),
        bias: Default::default(),
    }
}

/// A square or rectangular texture that is drawn to and read from.
pub(crate) fn render_texture(
    device: &wgpu::Device,
    label: &str,
    [width, height]: [u32; 2],
    format: wgpu::TextureFormat,
) -> wgpu::Texture {
    device.create_texture(&wgpu::TextureDescriptor {
        label: Some(label),
        size: wgpu::Extent3d { width, height, depth_or_array_layers: 1 },
        mip_level_count: 1,
        sample_count: 1,
        dimension: wgpu::TextureDimension::D2,
        format,
        usage: wgpu::TextureUsages::RENDER_ATTACHMENT | wgpu::TextureUsages::TEXTURE_BINDING,
        view_formats: &[],
    })
}

/// The whole of a texture.
pub(crate) fn whole(texture: &wgpu::Texture) -> wgpu::TextureView {
    texture.create_view(&wgpu::TextureViewDescriptor::default())
}
