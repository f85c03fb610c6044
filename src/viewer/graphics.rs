//! The window's surface, and the stage that draws on it.

use super::app::App;
use super::stage::{Output, Stage};
use super::steering::Steering;
use crate::render::{AdapterChoice, Gpu, GpuError, new_instance};
use std::sync::Arc;
use std::time::{Duration, Instant};
use winit::window::Window;

/// Whether a frame came onto the screen.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Shown {
    /// It did.
    Yes,
    /// The window has no size, is covered, or its surface was renewed.
    NotNow,
}

/// Everything on the GPU that belongs to the window.
pub struct Graphics {
    window: Arc<Window>,
    instance: wgpu::Instance,
    surface: wgpu::Surface<'static>,
    config: wgpu::SurfaceConfiguration,
    stage: Stage,
    opened: Instant,
    /// Whether the device is made of the same cores as everything else: nothing is gained by not waiting for it then,
    /// and only so does a frame's time tell how slow it is.
    is_software: bool,
}

impl Graphics {
    /// Opens a device for the window, chosen as told. There must be no other one for this window: some systems give a
    /// window only one surface.
    ///
    /// # Errors
    /// [`GpuError`]; the text names what to install when there is no driver.
    pub fn new(window: Arc<Window>, choice: &AdapterChoice) -> Result<Self, GpuError> {
        let instance = new_instance();
        let surface = new_surface(&instance, &window)?;
        let gpu = Gpu::for_surface(&instance, &surface, choice)?;
        let config = configuration(&surface, &gpu, &window)?;
        let can_copy = config.usage.contains(wgpu::TextureUsages::COPY_DST);
        let is_software = gpu.info.device_type == wgpu::DeviceType::Cpu;
        let mut stage = Stage::new(gpu, config.format, can_copy)?;
        stage.steering = Some(Steering::default());
        let opened = Instant::now();
        let mut graphics = Self { window, instance, surface, config, stage, opened, is_software };
        graphics.configure();
        Ok(graphics)
    }

    /// Longest side of a texture, pixels.
    #[must_use]
    pub fn max_side_px(&self) -> usize {
        self.stage.max_side_px() as usize
    }

    /// The window has a new size.
    pub fn resize(&mut self) {
        self.configure();
    }

    /// Takes the device away, as a driver might; for tests.
    pub fn lose_device(&self) {
        self.stage.gpu.lose();
    }

    /// Draws and shows what was laid out from `started` on; returns also in how long there is more to draw.
    ///
    /// # Errors
    /// [`GpuError`].
    pub fn show(
        &mut self,
        app: &mut App,
        output: &mut Output<'_>,
        started: Instant,
    ) -> Result<(Shown, Option<Duration>), GpuError> {
        let now = self.opened.elapsed();
        let more = self.stage.draw_pictures(app, output.full.pixels_per_point, now)?;
        let acquired = self.acquire()?;
        self.stage.paint(app, output, acquired.as_ref().map(|surface| &surface.texture));
        let shown = if acquired.is_some() { Shown::Yes } else { Shown::NotNow };
        if let Some(acquired) = acquired {
            self.window.pre_present_notify();
            self.stage.gpu.queue.present(acquired);
        }
        if self.is_software {
            self.stage.gpu.wait(None)?;
        }
        self.stage.gpu.check()?;
        self.stage.took(started.elapsed(), self.opened.elapsed());
        Ok((shown, more))
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
            Current::Validation => self.stage.gpu.check()?,
        }
        self.configure();
        self.window.request_redraw();
        Ok(None)
    }

    /// Fits the surface to the window; a window without size has no surface for now.
    fn configure(&mut self) {
        let size = self.window.inner_size();
        let limit = self.stage.max_side_px();
        (self.config.width, self.config.height) = (size.width.min(limit), size.height.min(limit));
        if self.config.width > 0 && self.config.height > 0 {
            self.surface.configure(&self.stage.gpu.device, &self.config);
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
