//! What the window draws with, whatever it draws on: the scene's picture, and the panels painted over it.

use super::app::App;
use super::thumbnails;
use crate::frame::Frame;
use crate::render::{Camera, Gpu, GpuError, Renderer, Target, View};
use egui_wgpu::{RendererOptions, ScreenDescriptor};
use std::sync::Arc;

/// A picture that egui can paint, and what it shows.
struct Picture {
    view: wgpu::TextureView,
    id: egui::TextureId,
    size_px: [u32; 2],
    shows: Option<(Arc<Frame>, Camera, View)>,
}

/// What the layout of one frame came to.
pub struct Output<'a> {
    /// The context of the layout.
    pub context: &'a egui::Context,
    /// Shapes and textures.
    pub full: egui::FullOutput,
}

/// egui minds textures that nobody has taken in. Where drawing fails, the next device gets all of them anew.
impl Drop for Output<'_> {
    fn drop(&mut self) {
        self.full.textures_delta.clear();
    }
}

/// Pictures and panels on one device.
pub struct Stage {
    /// The device.
    pub gpu: Gpu,
    format: wgpu::TextureFormat,
    /// Whether pictures are copied to the target. Copying is many times faster than painting on a software driver.
    can_copy: bool,
    painter: egui_wgpu::Renderer,
    renderer: Renderer,
    picture: Option<Picture>,
    thumbnails: Vec<(usize, Picture)>,
    /// Why a picture could not be drawn, as it was told last.
    told: Option<GpuError>,
}

impl Stage {
    /// Makes ready to draw on targets of a format, to which pictures can be copied or not.
    ///
    /// # Errors
    /// What the device reported while the pipelines were built.
    pub fn new(gpu: Gpu, format: wgpu::TextureFormat, can_copy: bool) -> Result<Self, GpuError> {
        // Dithering costs a software driver more than it shows.
        let options = RendererOptions { dithering: false, ..RendererOptions::default() };
        let stage = Self {
            painter: egui_wgpu::Renderer::new(&gpu.device, format, options),
            renderer: Renderer::new(&gpu, format),
            gpu,
            format,
            can_copy,
            picture: None,
            thumbnails: Vec::new(),
            told: None,
        };
        stage.gpu.check()?;
        Ok(stage)
    }

    /// Longest side of a texture, pixels.
    #[must_use]
    pub fn max_side_px(&self) -> u32 {
        self.gpu.device.limits().max_texture_dimension_2d
    }

    /// Draws what `app` asks for into its pictures; call after the layout and before [`Self::paint`]. Returns whether
    /// there may be more to draw.
    ///
    /// # Errors
    /// [`GpuError`] of the device; that a picture is too large for it is said in the window.
    pub fn draw_pictures(&mut self, app: &mut App, pixels_per_point: f32) -> Result<bool, GpuError> {
        if let Err(error) = self.draw_scene(app, pixels_per_point) {
            if !matches!(error, GpuError::BadSize { .. } | GpuError::TooManyTriangles { .. }) {
                return Err(error);
            }
            // The device is sound and the panels work: no reason to open it anew.
            if self.told.as_ref() != Some(&error) {
                app.tell(error.to_string());
                self.told = Some(error);
            }
        }
        self.draw_thumbnail(app)
    }

    fn draw_scene(&mut self, app: &mut App, pixels_per_point: f32) -> Result<(), GpuError> {
        let size_limit = self.max_side_px();
        let Some(request) = app.picture_request(pixels_per_point) else { return Ok(()) };
        let size_px = request.size_px.map(|side| side.min(size_limit));
        let mut picture = self.fitting_picture(size_px);
        let wanted = (request.frame.clone(), request.camera, request.view);
        let mut drawn = Ok(());
        if !picture.shows.as_ref().is_some_and(|shown| is_same(shown, &wanted)) {
            let target = Target::whole(&picture.view);
            drawn = self.renderer.render(target, &wanted.0, &wanted.1, &wanted.2);
            picture.shows = drawn.is_ok().then_some(wanted);
        }
        // The panels paint it only where it cannot be copied.
        app.picture = (!self.can_copy).then_some(picture.id);
        self.picture = Some(picture);
        drawn
    }

    /// One thumbnail at a time, so that the gallery stays quick; returns whether there was one.
    fn draw_thumbnail(&mut self, app: &mut App) -> Result<bool, GpuError> {
        let is_dark = app.look.is_dark;
        let Some(sketch) = app.next_sketch() else { return Ok(false) };
        let scene = sketch.scene;
        let known = self.thumbnails.iter().position(|(index, _)| *index == scene);
        let at = known.unwrap_or_else(|| {
            let picture = self.new_picture(thumbnails::SIZE_PX);
            self.thumbnails.push((scene, picture));
            self.thumbnails.len() - 1
        });
        let picture = &self.thumbnails[at].1;
        let target = Target::whole(&picture.view);
        let drawn = self.renderer.render(target, &sketch.frame, &sketch.camera, &sketch.view(is_dark));
        app.thumbnails[scene] = Some(picture.id);
        drawn.map(|()| true)
    }

    /// The picture of this size: the old one, or one that takes its place.
    fn fitting_picture(&mut self, size_px: [u32; 2]) -> Picture {
        match self.picture.take() {
            Some(picture) if picture.size_px == size_px => picture,
            Some(old) => {
                let view = new_texture(&self.gpu, size_px, self.format);
                let filter = wgpu::FilterMode::Linear;
                let device = &self.gpu.device;
                self.painter.update_egui_texture_from_wgpu_texture(device, &view, filter, old.id);
                Picture { view, id: old.id, size_px, shows: None }
            }
            None => self.new_picture(size_px),
        }
    }

    fn new_picture(&mut self, size_px: [u32; 2]) -> Picture {
        let view = new_texture(&self.gpu, size_px, self.format);
        let filter = wgpu::FilterMode::Linear;
        let id = self.painter.register_native_texture(&self.gpu.device, &view, filter);
        Picture { view, id, size_px, shows: None }
    }

    /// Paints panels and pictures onto a target; without one, only takes in what changed in the textures.
    pub fn paint(&mut self, app: &App, output: &mut Output<'_>, target: Option<&wgpu::Texture>) {
        let Output { context, full } = output;
        let (delta, pixels_per_point) = (&mut full.textures_delta, full.pixels_per_point);
        for (id, images) in delta.set.drain() {
            for image in images {
                self.painter.update_texture(&self.gpu.device, &self.gpu.queue, id, &image);
            }
        }
        if let Some(target) = target {
            let jobs = context.tessellate(std::mem::take(&mut full.shapes), pixels_per_point);
            let corner_px = app.picture_corner_px(pixels_per_point).filter(|_| self.can_copy);
            let background = context.global_style().visuals.panel_fill;
            self.paint_jobs(&jobs, pixels_per_point, target, (background, corner_px));
        }
        for id in delta.free.drain() {
            self.painter.free_texture(&id);
        }
    }

    fn paint_jobs(
        &mut self,
        jobs: &[egui::ClippedPrimitive],
        pixels_per_point: f32,
        target: &wgpu::Texture,
        (background, corner_px): (egui::Color32, Option<[u32; 2]>),
    ) {
        let Gpu { device, queue, .. } = &self.gpu;
        let screen = ScreenDescriptor { size_in_pixels: [target.width(), target.height()], pixels_per_point };
        let mut encoder = device.create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
        // Only paint callbacks return command buffers, and there are none here.
        self.painter.update_buffers(device, queue, &mut encoder, jobs, &screen);
        let view = target.create_view(&wgpu::TextureViewDescriptor::default());
        drop(begin_pass(&mut encoder, &view, wgpu::LoadOp::Clear(clear_color(background))));
        if let (Some(picture), Some(corner_px)) = (&self.picture, corner_px) {
            copy(&mut encoder, picture, target, corner_px);
        }
        let mut pass = begin_pass(&mut encoder, &view, wgpu::LoadOp::Load).forget_lifetime();
        self.painter.render(&mut pass, jobs, &screen);
        drop(pass);
        queue.submit([encoder.finish()]);
    }
}

fn begin_pass<'e>(
    encoder: &'e mut wgpu::CommandEncoder,
    view: &wgpu::TextureView,
    load: wgpu::LoadOp<wgpu::Color>,
) -> wgpu::RenderPass<'e> {
    encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
        label: Some("panels"),
        color_attachments: &[Some(wgpu::RenderPassColorAttachment {
            view,
            depth_slice: None,
            resolve_target: None,
            ops: wgpu::Operations { load, store: wgpu::StoreOp::Store },
        })],
        ..Default::default()
    })
}

/// The bytes of an opaque colour, in a format that does not convert them.
fn clear_color(color: egui::Color32) -> wgpu::Color {
    let [r, g, b] = [color.r(), color.g(), color.b()].map(|level| f64::from(level) / 255.0);
    wgpu::Color { r, g, b, a: 1.0 }
}

/// Copies the part of a picture that lies on the target.
fn copy(encoder: &mut wgpu::CommandEncoder, picture: &Picture, target: &wgpu::Texture, [x, y]: [u32; 2]) {
    let width = picture.size_px[0].min(target.width().saturating_sub(x));
    let height = picture.size_px[1].min(target.height().saturating_sub(y));
    if width == 0 || height == 0 {
        return;
    }
    encoder.copy_texture_to_texture(
        picture.view.texture().as_image_copy(),
        wgpu::TexelCopyTextureInfo { origin: wgpu::Origin3d { x, y, z: 0 }, ..target.as_image_copy() },
        wgpu::Extent3d { width, height, depth_or_array_layers: 1 },
    );
}

fn new_texture(gpu: &Gpu, [width, height]: [u32; 2], format: wgpu::TextureFormat) -> wgpu::TextureView {
    let texture = gpu.device.create_texture(&wgpu::TextureDescriptor {
        label: Some("picture in the window"),
        size: wgpu::Extent3d { width, height, depth_or_array_layers: 1 },
        mip_level_count: 1,
        sample_count: 1,
        dimension: wgpu::TextureDimension::D2,
        format,
        usage: wgpu::TextureUsages::RENDER_ATTACHMENT
            | wgpu::TextureUsages::TEXTURE_BINDING
            | wgpu::TextureUsages::COPY_SRC,
        view_formats: &[],
    });
    texture.create_view(&wgpu::TextureViewDescriptor::default())
}

fn is_same(a: &(Arc<Frame>, Camera, View), b: &(Arc<Frame>, Camera, View)) -> bool {
    Arc::ptr_eq(&a.0, &b.0) && a.1 == b.1 && a.2 == b.2
}
