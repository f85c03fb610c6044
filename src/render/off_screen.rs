//! Pictures without a window.

use crate::frame::Frame;
use crate::render::camera::Camera;
use crate::render::gpu::{Gpu, GpuError, TIME_LIMIT};
use crate::render::renderer::Renderer;
use crate::render::target::Target;
use crate::render::view::View;
use std::sync::mpsc;

/// Bytes of one pixel.
const PIXEL_BYTES: u32 = 4;

/// A finished picture.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Picture {
    /// Width, pixels.
    pub width: u32,
    /// Height, pixels.
    pub height: u32,
    /// Red, green, blue and opacity of each pixel, sRGB, rows from top to bottom.
    pub rgba: Vec<u8>,
}

impl Picture {
    /// Red, green and blue of a pixel; black outside the picture.
    #[must_use]
    pub fn rgb_at(&self, x: u32, y: u32) -> [u8; 3] {
        if x >= self.width || y >= self.height {
            return [0; 3];
        }
        let start = PIXEL_BYTES as usize * (y as usize * self.width as usize + x as usize);
        std::array::from_fn(|i| self.rgba.get(start + i).copied().unwrap_or(0))
    }

    /// Red, green and blue of every pixel, rows from top to bottom.
    pub fn colors(&self) -> impl Iterator<Item = [u8; 3]> + '_ {
        self.rgba.chunks_exact(PIXEL_BYTES as usize).map(|p| [p[0], p[1], p[2]])
    }
}

/// Draws frames into memory. Textures live on between pictures of the same size.
pub struct OffScreen {
    gpu: Gpu,
    renderer: Renderer,
    target: Option<ReadableTarget>,
}

impl OffScreen {
    /// Format of textures that are read back.
    pub const FORMAT: wgpu::TextureFormat = wgpu::TextureFormat::Rgba8Unorm;

    /// Makes ready to draw.
    ///
    /// # Errors
    /// What the device reported while the pipelines were built.
    pub fn new(gpu: &Gpu) -> Result<Self, GpuError> {
        let renderer = Renderer::new(gpu, Self::FORMAT);
        gpu.check()?;
        Ok(Self { gpu: gpu.clone(), renderer, target: None })
    }

    /// Draws one frame at a size in pixels.
    ///
    /// # Errors
    /// [`GpuError`]: a size the device cannot draw, or what went wrong on it.
    pub fn render(
        &mut self,
        size_px: [u32; 2],
        frame: &Frame,
        camera: &Camera,
        view: &View,
    ) -> Result<Picture, GpuError> {
        self.gpu.check_size(size_px)?;
        let target = match self.target.take() {
            Some(target) if target.size_px == size_px => target,
            _ => ReadableTarget::new(&self.gpu, size_px)?,
        };
        self.renderer.render(Target::whole(&target.view), frame, camera, view)?;
        let picture = target.read(&self.gpu)?;
        self.target = Some(target);
        Ok(picture)
    }
}

impl OffScreen {
    /// Lets `draw` paint into a texture of the given size and format, and brings the picture back.
    ///
    /// # Errors
    /// As for [`OffScreen::render`].
    pub fn draw_by(
        &mut self,
        size_px: [u32; 2],
        draw: impl FnOnce(&wgpu::TextureView, wgpu::TextureFormat),
    ) -> Result<Picture, GpuError> {
        self.gpu.check_size(size_px)?;
        let target = ReadableTarget::new(&self.gpu, size_px)?;
        draw(&target.view, Self::FORMAT);
        self.gpu.check()?;
        target.read(&self.gpu)
    }
}

/// A texture and the buffer through which it comes back.
struct ReadableTarget {
    size_px: [u32; 2],
    texture: wgpu::Texture,
    view: wgpu::TextureView,
    buffer: wgpu::Buffer,
    /// Rows in the buffer are padded to a multiple of what the device copies.
    padded_row_bytes: u32,
}

impl ReadableTarget {
    fn new(gpu: &Gpu, size_px: [u32; 2]) -> Result<Self, GpuError> {
        let [width, height] = size_px;
        let row_bytes = width * PIXEL_BYTES;
        let padded_row_bytes = row_bytes.next_multiple_of(wgpu::COPY_BYTES_PER_ROW_ALIGNMENT);
        let texture = gpu.device.create_texture(&wgpu::TextureDescriptor {
            label: Some("picture"),
            size: extent(size_px),
            mip_level_count: 1,
            sample_count: 1,
            dimension: wgpu::TextureDimension::D2,
            format: OffScreen::FORMAT,
            usage: wgpu::TextureUsages::RENDER_ATTACHMENT
                | wgpu::TextureUsages::COPY_SRC
                | wgpu::TextureUsages::COPY_DST,
            view_formats: &[],
        });
        let buffer = gpu.device.create_buffer(&wgpu::BufferDescriptor {
            label: Some("picture"),
            size: u64::from(padded_row_bytes) * u64::from(height),
            usage: wgpu::BufferUsages::MAP_READ | wgpu::BufferUsages::COPY_DST,
            mapped_at_creation: false,
        });
        gpu.check()?;
        Ok(Self {
            size_px,
            view: texture.create_view(&wgpu::TextureViewDescriptor::default()),
            texture,
            buffer,
            padded_row_bytes,
        })
    }

    fn read(&self, gpu: &Gpu) -> Result<Picture, GpuError> {
        let submission = self.copy(gpu);
        let (sender, receiver) = mpsc::channel();
        self.buffer.slice(..).map_async(wgpu::MapMode::Read, move |result| {
            // The receiver is gone only if waiting failed, which is reported there.
            let _ = sender.send(result);
        });
        gpu.wait(Some(submission))?;
        let mapped = receiver.recv_timeout(TIME_LIMIT);
        let mapped = mapped.map_err(|_| GpuError::TimedOut(TIME_LIMIT.as_secs()))?;
        mapped.map_err(|error| GpuError::Other(error.to_string()))?;
        let picture = self.unpadded()?;
        self.buffer.unmap();
        Ok(picture)
    }

    fn copy(&self, gpu: &Gpu) -> wgpu::SubmissionIndex {
        let mut encoder = gpu.device.create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
        encoder.copy_texture_to_buffer(
            self.texture.as_image_copy(),
            wgpu::TexelCopyBufferInfo {
                buffer: &self.buffer,
                layout: wgpu::TexelCopyBufferLayout {
                    offset: 0,
                    bytes_per_row: Some(self.padded_row_bytes),
                    rows_per_image: None,
                },
            },
            extent(self.size_px),
        );
        gpu.queue.submit([encoder.finish()])
    }

    fn unpadded(&self) -> Result<Picture, GpuError> {
        let [width, height] = self.size_px;
        let row_bytes = (width * PIXEL_BYTES) as usize;
        let bytes = self.buffer.get_mapped_range(..).map_err(|error| GpuError::Other(error.to_string()))?;
        let mut rgba = Vec::with_capacity(row_bytes * height as usize);
        for row in bytes.chunks_exact(self.padded_row_bytes as usize) {
            rgba.extend_from_slice(&row[..row_bytes]);
        }
        Ok(Picture { width, height, rgba })
    }
}

fn extent([width, height]: [u32; 2]) -> wgpu::Extent3d {
    wgpu::Extent3d { width, height, depth_or_array_layers: 1 }
}
