//! The window's graphics: surface, the scene's picture, and the panels painted over it.

use super::app::App;
use super::thumbnails;
use crate::frame::Frame;
use crate::render::{Camera, Gpu, GpuError, Renderer, Target, View, new_instance};
use egui_wgpu::ScreenDescriptor;
use std::sync::Arc;
use winit::window::Window;

/// Format of pictures that panels show; egui expects this one.
const PICTURE_FORMAT: wgpu::TextureFormat = wgpu::TextureFormat::Rgba8Unorm;

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
    texture: wgpu::TextureView,
    id: egui::TextureId,
    size_px: [u32; 2],
    shows: Option<(Arc<Frame>, Camera, View)>,
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
        let options = egui_wgpu::RendererOptions::default();
        let mut graphics = Self {
            painter: egui_wgpu::Renderer::new(&gpu.device, config.format, options),
            renderer: Renderer::new(&gpu, PICTURE_FORMAT),
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

    /// Name of the adapter.
    #[must_use]
    pub fn adapter_name(&self) -> &str {
        &self.gpu.info.name
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
                let target = Target::whole(&picture.texture);
                let drawn = self.renderer.render(target, &wanted.0, &wanted.1, &wanted.2);
                picture.shows = drawn.is_ok().then_some(wanted);
                let id = picture.id;
                self.picture = Some(picture);
                app.picture = Some(id);
                return drawn;
            }
            app.picture = Some(picture.id);
            self.picture = Some(picture);
        }
        self.draw_thumbnail(app)
    }

    /// One thumbnail at a time, so that the gallery stays quick.
    fn draw_thumbnail(&mut self, app: &mut App) -> Result<(), GpuError> {
        let is_dark = app.look.is_dark;
        let Some(sketch) = app.next_sketch() else { return Ok(()) };
        let scene = sketch.scene;
        let known = self.thumbnails.iter().position(|(index, _)| *index == scene);
        let at = known.unwrap_or_else(|| {
            let picture = new_picture(&self.gpu, &mut self.painter, thumbnails::SIZE_PX);
            self.thumbnails.push((scene, picture));
            self.thumbnails.len() - 1
        });
        let picture = &self.thumbnails[at].1;
        let target = Target::whole(&picture.texture);
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
                let texture = new_texture(&self.gpu, size_px);
                let filter = wgpu::FilterMode::Linear;
                let device = &self.gpu.device;
                self.painter.update_egui_texture_from_wgpu_texture(device, &texture, filter, old.id);
                Picture { texture, id: old.id, size_px, shows: None }
            }
            None => new_picture(&self.gpu, &mut self.painter, size_px),
        }
    }

    /// Paints the panels and brings the frame onto the screen.
    ///
    /// # Errors
    /// [`GpuError`].
    pub fn paint(&mut self, context: &egui::Context, output: egui::FullOutput) -> Result<Shown, GpuError> {
        let egui::FullOutput { textures_delta: mut delta, shapes, pixels_per_point, .. } = output;
        for (id, images) in delta.set.drain() {
            for image in images {
                self.painter.update_texture(&self.gpu.device, &self.gpu.queue, id, &image);
            }
        }
        let shown = match self.acquire()? {
            None => Shown::NotNow,
            Some(texture) => {
                let jobs = context.tessellate(shapes, pixels_per_point);
                self.paint_jobs(&jobs, pixels_per_point, &texture);
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
    ) {
        let Gpu { device, queue, .. } = &self.gpu;
        let screen =
            ScreenDescriptor { size_in_pixels: [self.config.width, self.config.height], pixels_per_point };
        let mut encoder = device.create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
        // Only paint callbacks return command buffers, and there are none here.
        self.painter.update_buffers(device, queue, &mut encoder, jobs, &screen);
        let view = target.texture.create_view(&wgpu::TextureViewDescriptor::default());
        let pass = encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
            label: Some("panels"),
            color_attachments: &[Some(wgpu::RenderPassColorAttachment {
                view: &view,
                depth_slice: None,
                resolve_target: None,
                ops: wgpu::Operations {
                    load: wgpu::LoadOp::Clear(wgpu::Color::BLACK),
                    store: wgpu::StoreOp::Store,
                },
            })],
            ..Default::default()
        });
        let mut pass = pass.forget_lifetime();
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
    let formats = surface.get_capabilities(&gpu.adapter).formats;
    let plain = [wgpu::TextureFormat::Bgra8Unorm, wgpu::TextureFormat::Rgba8Unorm];
    if let Some(format) = formats.iter().find(|format| plain.contains(format)) {
        config.format = *format;
    }
    config.present_mode = wgpu::PresentMode::AutoVsync;
    config.desired_maximum_frame_latency = 1;
    Ok(config)
}

fn new_picture(gpu: &Gpu, painter: &mut egui_wgpu::Renderer, size_px: [u32; 2]) -> Picture {
    let texture = new_texture(gpu, size_px);
    let id = painter.register_native_texture(&gpu.device, &texture, wgpu::FilterMode::Linear);
    Picture { texture, id, size_px, shows: None }
}

fn new_texture(gpu: &Gpu, [width, height]: [u32; 2]) -> wgpu::TextureView {
    let texture = gpu.device.create_texture(&wgpu::TextureDescriptor {
        label: Some("picture in the window"),
        size: wgpu::Extent3d { width, height, depth_or_array_layers: 1 },
        mip_level_count: 1,
        sample_count: 1,
        dimension: wgpu::TextureDimension::D2,
        format: PICTURE_FORMAT,
        usage: wgpu::TextureUsages::RENDER_ATTACHMENT | wgpu::TextureUsages::TEXTURE_BINDING,
        view_formats: &[],
    });
    texture.create_view(&wgpu::TextureViewDescriptor::default())
}

fn is_same(a: &(Arc<Frame>, Camera, View), b: &(Arc<Frame>, Camera, View)) -> bool {
    Arc::ptr_eq(&a.0, &b.0) && a.1 == b.1 && a.2 == b.2
}
