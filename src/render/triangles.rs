//! A frame's triangles on the GPU.

use crate::render::depth_pass::Casters;
use crate::render::geometry::{Geometry, SurfaceVertex};
use crate::render::gpu::{Gpu, GpuError};
use glam::Vec3;

/// Buffers that are filled anew for every frame, and grow.
#[derive(Debug)]
pub(crate) struct TriangleBuffers {
    pub vertices: wgpu::Buffer,
    caster_positions: wgpu::Buffer,
    caster_corners: wgpu::Buffer,
}

/// What has to be known of the triangles in such buffers.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Triangles {
    /// Vertices, three for each.
    pub count: u32,
    /// Corners of those that cast shadows.
    of_casters: u32,
    /// See [`Geometry`].
    pub bounds_m: Option<(Vec3, Vec3)>,
    /// See [`Geometry`].
    pub body_radius_m: f32,
}

impl TriangleBuffers {
    pub fn new(device: &wgpu::Device) -> Self {
        Self {
            vertices: new_buffer(device, wgpu::BufferUsages::VERTEX, 1 << 16),
            caster_positions: new_buffer(device, wgpu::BufferUsages::VERTEX, 1 << 14),
            caster_corners: new_buffer(device, wgpu::BufferUsages::INDEX, 1 << 14),
        }
    }

    /// Brings triangles to the GPU.
    ///
    /// # Errors
    /// [`GpuError::TooManyTriangles`].
    pub fn upload(&mut self, gpu: &Gpu, geometry: &Geometry) -> Result<Triangles, GpuError> {
        let bytes: &[u8] = bytemuck::cast_slice(&geometry.vertices);
        let limit = gpu.device.limits().max_buffer_size.min(1 << 31);
        if bytes.len() as u64 > limit {
            return Err(GpuError::TooManyTriangles {
                triangles: geometry.vertices.len() / 3,
                limit: limit as usize / size_of::<[SurfaceVertex; 3]>(),
                adapter: gpu.info.name.clone(),
            });
        }
        // Of the rest there is less: vertices are shared.
        fill(gpu, &mut self.vertices, bytes, limit);
        fill(gpu, &mut self.caster_positions, bytemuck::cast_slice(&geometry.casters_m), limit);
        fill(gpu, &mut self.caster_corners, bytemuck::cast_slice(&geometry.caster_triangles), limit);
        Ok(Triangles {
            count: geometry.vertices.len() as u32,
            of_casters: 3 * geometry.caster_triangles.len() as u32,
            bounds_m: geometry.bounds_m,
            body_radius_m: geometry.body_radius_m,
        })
    }

    pub fn casters(&self, triangles: &Triangles) -> Casters<'_> {
        let Self { caster_positions: positions, caster_corners: corners, .. } = self;
        Casters { positions, corners, count: triangles.of_casters }
    }
}

/// Fills a buffer from its start, and a larger one in its place where it is too small.
fn fill(gpu: &Gpu, buffer: &mut wgpu::Buffer, bytes: &[u8], limit: u64) {
    let needed = bytes.len() as u64;
    if needed > buffer.size() {
        // Some room to grow, so that a breaking body does not reallocate every frame.
        *buffer = new_buffer(&gpu.device, buffer.usage(), (needed + needed / 2).min(limit));
    }
    gpu.queue.write_buffer(buffer, 0, bytes);
}

fn new_buffer(device: &wgpu::Device, usage: wgpu::BufferUsages, size: u64) -> wgpu::Buffer {
    device.create_buffer(&wgpu::BufferDescriptor {
        label: Some("triangles"),
        size: size.next_multiple_of(wgpu::COPY_BUFFER_ALIGNMENT),
        usage: usage | wgpu::BufferUsages::COPY_DST,
        mapped_at_creation: false,
    })
}
