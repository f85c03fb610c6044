//! The window's graphics: surface, the scene's picture, and the panels painted over it.

use super::app::App;
use super::thumbnails;
use crate::frame::Frame;
use crate::render::{Camera, Gpu, GpuError, Renderer, Target, View, new_instance};
use egui_wgpu::ScreenDescriptor;
use std::sync::Arc;
use winit::window::Window;

/// Whether a frame came onto the screen.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Shown {
    /// It did.
    Yes,
    /// The window has no size, is covered, or its surface was renewed.
    NotNow,
}

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
    /// Colour behind everything.
    pub background: egui::Color32,
    /// Shapes and textures.
    pub full: egui::FullOutput,
}

/// Everything on the GPU that belongs to the window.
pub struct Graphics {
    window: Arc<Window>,
    instance: wgpu::Instance,
    surface: wgpu::Surface<'static>,
    config: wgpu::SurfaceConfiguration,
    gpu: Gpu,
    painter: egui_wgpu::Renderer,
    renderer: Renderer,
    picture: Option<Picture>,
    thumbnails: Vec<(usize, Picture)>,
}

impl Graphics {
    /// Opens a device for the window.
    ///
    /// # Errors
    /// [`GpuError`]; the text names what to install when there is no driver.
    pub fn new(window: Arc<Window>) -> Result<Self, GpuError> {
        let instance = new_instance();
        let surface = new_surface(&instance, &window)?;
        let gpu = Gpu::for_surface(&instance, &surface)?;
        let config = configuration(&surface, &gpu, &window)?;
        // Dithering costs a software driver more than it shows.
        let options = egui_wgpu::RendererOptions { dithering: false, ..Default::default() };
        let mut graphics = Self {
            painter: egui_wgpu::Renderer::new(&gpu.device, config.format, options),
            renderer: Renderer::new(&gpu, config.format),
            window,
            instance,
            surface,
            config,
            gpu,
            picture: None,
            thumbnails: Vec::new(),
        };
        graphics.gpu.check()?;
        graphics.configure();
        Ok(graphics)
    }

    /// Longest side of a texture, pixels.
    #[must_use]
    pub fn max_side_px(&self) -> usize {
        self.gpu.device.limits().max_texture_dimension_2d as usize
    }

    /// The window has a new size.
    pub fn resize(&mut self) {
        self.configure();
    }

    /// Draws what `app` asks for into its pictures; call after the layout and before [`Self::paint`].
    ///
    /// # Errors
    /// [`GpuError`].
    pub fn draw_pictures(&mut self, app: &mut App, pixels_per_point: f32) -> Result<(), GpuError> {
        let size_limit = self.gpu.device.limits().max_texture_dimension_2d;
        if let Some(request) = app.picture_request(pixels_per_point) {
            let size_px = request.size_px.map(|side| side.min(size_limit));
            let mut picture = self.fitting_picture(size_px);
            let wanted = (request.frame.clone(), request.camera, request.view);
            if !picture.shows.as_ref().is_some_and(|shown| is_same(shown, &wanted)) {
                let target = Target::whole(&picture.view);
                let drawn = self.renderer.render(target, &wanted.0, &wanted.1, &wanted.2);
                picture.shows = drawn.is_ok().then_some(wanted);
                self.keep(picture, app);
                return drawn;
            }
            self.keep(picture, app);
        }
        self.draw_thumbnail(app)
    }

    /// Keeps the scene's picture; the panels paint it only where it cannot be copied to the surface.
    fn keep(&mut self, picture: Picture, app: &mut App) {
        app.picture = (!self.can_copy()).then_some(picture.id);
        self.picture = Some(picture);
    }

    /// Whether pictures can be copied to the surface. Copying is many times faster than painting on a software
    /// driver.
    fn can_copy(&self) -> bool {
        self.config.usage.contains(wgpu::TextureUsages::COPY_DST)
    }

    /// One thumbnail at a time, so that the gallery stays quick.
    fn draw_thumbnail(&mut self, app: &mut App) -> Result<(), GpuError> {
        let is_dark = app.look.is_dark;
        let Some(sketch) = app.next_sketch() else { return Ok(()) };
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
        self.window.request_redraw();
        drawn
    }

    /// The picture of this size: the old one, or one that takes its place.
    fn fitting_picture(&mut self, size_px: [u32; 2]) -> Picture {
        match self.picture.take() {
            Some(picture) if picture.size_px == size_px => picture,
            Some(old) => {
                let view = new_texture(&self.gpu, size_px, self.config.format);
                let filter = wgpu::FilterMode::Linear;
                let device = &self.gpu.device;
                self.painter.update_egui_texture_from_wgpu_texture(device, &view, filter, old.id);
                Picture { view, id: old.id, size_px, shows: None }
            }
            None => self.new_picture(size_px),
        }
    }

    fn new_picture(&mut self, size_px: [u32; 2]) -> Picture {
        let view = new_texture(&self.gpu, size_px, self.config.format);
        let filter = wgpu::FilterMode::Linear;
        let id = self.painter.register_native_texture(&self.gpu.device, &view, filter);
        Picture { view, id, size_px, shows: None }
    }

    /// Paints the panels and brings the frame onto the screen.
    ///
    /// # Errors
    /// [`GpuError`].
    pub fn paint(&mut self, app: &App, output: Output<'_>) -> Result<Shown, GpuError> {
        let Output { context, background, full } = output;
        let egui::FullOutput { textures_delta: mut delta, shapes, pixels_per_point, .. } = full;
        for (id, images) in delta.set.drain() {
            for image in images {
                self.painter.update_texture(&self.gpu.device, &self.gpu.queue, id, &image);
            }
        }
        let shown = match self.acquire()? {
            None => Shown::NotNow,
            Some(texture) => {
                let jobs = context.tessellate(shapes, pixels_per_point);
                let corner_px = app.picture_corner_px(pixels_per_point).filter(|_| self.can_copy());
                self.paint_jobs(&jobs, pixels_per_point, &texture, (background, corner_px));
                self.window.pre_present_notify();
                self.gpu.queue.present(texture);
                Shown::Yes
            }
        };
        for id in delta.free.drain() {
            self.painter.free_texture(&id);
        }
        self.gpu.check()?;
        Ok(shown)
    }

    fn paint_jobs(
        &mut self,
        jobs: &[egui::ClippedPrimitive],
        pixels_per_point: f32,
        target: &wgpu::SurfaceTexture,
        (background, corner_px): (egui::Color32, Option<[u32; 2]>),
    ) {
        let Gpu { device, queue, .. } = &self.gpu;
        let screen =
            ScreenDescriptor { size_in_pixels: [self.config.width, self.config.height], pixels_per_point };
        let mut encoder = device.create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
        // Only paint callbacks return command buffers, and there are none here.
        self.painter.update_buffers(device, queue, &mut encoder, jobs, &screen);
        let view = target.texture.create_view(&wgpu::TextureViewDescriptor::default());
        drop(begin_pass(&mut encoder, &view, wgpu::LoadOp::Clear(clear_color(background))));
        if let (Some(picture), Some(corner_px)) = (&self.picture, corner_px) {
            copy(&mut encoder, picture, &target.texture, corner_px);
        }
        let mut pass = begin_pass(&mut encoder, &view, wgpu::LoadOp::Load).forget_lifetime();
        self.painter.render(&mut pass, jobs, &screen);
        drop(pass);
        queue.submit([encoder.finish()]);
    }

    /// The next texture of the surface; `None` when there is none now, after renewing what needs it.
    fn acquire(&mut self) -> Result<Option<wgpu::SurfaceTexture>, GpuError> {
        use wgpu::CurrentSurfaceTexture as Current;
        if self.config.width == 0 || self.config.height == 0 {
            return Ok(None);
        }
        match self.surface.get_current_texture() {
            Current::Success(texture) => return Ok(Some(texture)),
            // Shown all the same: the resize that made it so brings a new configuration.
            Current::Suboptimal(texture) => return Ok(Some(texture)),
            Current::Timeout | Current::Occluded => return Ok(None),
            Current::Outdated => {}
            Current::Lost => self.surface = new_surface(&self.instance, &self.window)?,
            Current::Validation => self.gpu.check()?,
        }
        self.configure();
        self.window.request_redraw();
        Ok(None)
    }

    /// Fits the surface to the window; a window without size has no surface for now.
    fn configure(&mut self) {
        let size = self.window.inner_size();
        let limit = self.gpu.device.limits().max_texture_dimension_2d;
        (self.config.width, self.config.height) = (size.width.min(limit), size.height.min(limit));
        if self.config.width > 0 && self.config.height > 0 {
            self.surface.configure(&self.gpu.device, &self.config);
        }
    }
}

pub(super) fn begin_pass<'e>(
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
pub(super) fn clear_color(color: egui::Color32) -> wgpu::Color {
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

fn new_surface(instance: &wgpu::Instance, window: &Arc<Window>) -> Result<wgpu::Surface<'static>, GpuError> {
    // Without any driver there is no surface either; the device's message says what to install.
    instance.create_surface(window.clone()).map_err(|error| match Gpu::headless() {
        Err(no_driver @ GpuError::NoAdapter(_)) => no_driver,
        _ => GpuError::Other(format!("the window cannot be drawn to: {error}")),
    })
}

fn configuration(
    surface: &wgpu::Surface<'_>,
    gpu: &Gpu,
    window: &Window,
) -> Result<wgpu::SurfaceConfiguration, GpuError> {
    let size = window.inner_size();
    let mut config = surface
        .get_default_config(&gpu.adapter, size.width.max(1), size.height.max(1))
        .ok_or_else(|| GpuError::Other(format!("'{}' cannot show on this window", gpu.info.name)))?;
    // egui blends in sRGB bytes; a format that converts by itself would make everything pale.
    let capabilities = surface.get_capabilities(&gpu.adapter);
    let formats = capabilities.formats;
    config.usage |= capabilities.usages & wgpu::TextureUsages::COPY_DST;
    let plain = [wgpu::TextureFormat::Bgra8Unorm, wgpu::TextureFormat::Rgba8Unorm];
    if let Some(format) = formats.iter().find(|format| plain.contains(format)) {
        config.format = *format;
    }
    config.present_mode = wgpu::PresentMode::AutoVsync;
    config.desired_maximum_frame_latency = 1;
    Ok(config)
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
