//! Where passes draw to: the rectangle of a picture, and the textures of a scene on their way to it.

use crate::render::compose_pass::SceneTextures;

/// Where a picture goes: a rectangle of a texture.
#[derive(Clone, Copy, Debug)]
pub struct Target<'a> {
    /// The texture, in the format the renderer was made for.
    pub view: &'a wgpu::TextureView,
    /// Upper left corner of the rectangle, pixels.
    pub origin_px: [u32; 2],
    /// Size of the rectangle, pixels.
    pub size_px: [u32; 2],
}

impl<'a> Target<'a> {
    /// All of a texture.
    #[must_use]
    pub fn whole(view: &'a wgpu::TextureView) -> Self {
        Self { view, origin_px: [0, 0], size_px: texture_size_px(view) }
    }

    /// A rectangle of a texture, cut where it sticks out; what is outside it stays as it is.
    #[must_use]
    pub fn part(view: &'a wgpu::TextureView, origin_px: [u32; 2], size_px: [u32; 2]) -> Self {
        let all = texture_size_px(view);
        let origin_px = std::array::from_fn(|i| origin_px[i].min(all[i]));
        Self { view, origin_px, size_px: std::array::from_fn(|i| size_px[i].min(all[i] - origin_px[i])) }
    }

    /// Width over height.
    #[must_use]
    pub fn aspect(&self) -> f32 {
        self.size_px[0] as f32 / self.size_px[1].max(1) as f32
    }

    pub(crate) fn is_whole(&self) -> bool {
        self.origin_px == [0, 0] && self.size_px == texture_size_px(self.view)
    }
}

pub(crate) fn texture_size_px(view: &wgpu::TextureView) -> [u32; 2] {
    let texture = view.texture();
    [texture.width(), texture.height()]
}

/// A part of a picture's height, from the top.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Strip {
    pub number: u32,
    pub of: u32,
}

impl Strip {
    pub const ALL: Self = Self { number: 0, of: 1 };

    fn is_last(self) -> bool {
        self.number + 1 == self.of
    }

    /// First row and number of rows.
    pub fn rows(self, height_px: u32) -> (u32, u32) {
        let row = |number: u32| (u64::from(height_px) * u64::from(number) / u64::from(self.of)) as u32;
        (row(self.number), row(self.number + 1) - row(self.number))
    }
}

pub(crate) fn begin_scene<'e>(
    encoder: &'e mut wgpu::CommandEncoder,
    textures: &SceneTextures,
    strip: Strip,
) -> wgpu::RenderPass<'e> {
    // The first strip clears what is kept for the ones after it. Samples are resolved with the last; nobody needs them,
    // or the depth, after that.
    let kept = if strip.is_last() { wgpu::StoreOp::Discard } else { wgpu::StoreOp::Store };
    let (view, resolve_target, store) = match &textures.color {
        Some(samples) => (samples, strip.is_last().then_some(&textures.resolved), kept),
        None => (&textures.resolved, None, wgpu::StoreOp::Store),
    };
    let is_first = strip.number == 0;
    let color = if is_first { wgpu::LoadOp::Clear(wgpu::Color::TRANSPARENT) } else { wgpu::LoadOp::Load };
    let depth = if is_first { wgpu::LoadOp::Clear(0.0) } else { wgpu::LoadOp::Load };
    encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
        label: Some("scene"),
        color_attachments: &[Some(wgpu::RenderPassColorAttachment {
            view,
            depth_slice: None,
            resolve_target,
            ops: wgpu::Operations { load: color, store },
        })],
        depth_stencil_attachment: Some(wgpu::RenderPassDepthStencilAttachment {
            view: &textures.depth,
            depth_ops: Some(wgpu::Operations { load: depth, store: kept }),
            stencil_ops: None,
        }),
        ..Default::default()
    })
}

pub(crate) fn begin_target<'e>(
    encoder: &'e mut wgpu::CommandEncoder,
    target: &Target<'_>,
) -> wgpu::RenderPass<'e> {
    let load = if target.is_whole() { wgpu::LoadOp::Clear(wgpu::Color::BLACK) } else { wgpu::LoadOp::Load };
    encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
        label: Some("target"),
        color_attachments: &[Some(wgpu::RenderPassColorAttachment {
            view: target.view,
            depth_slice: None,
            resolve_target: None,
            ops: wgpu::Operations { load, store: wgpu::StoreOp::Store },
        })],
        ..Default::default()
    })
}
