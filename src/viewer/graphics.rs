//! The window's surface, and the stage that draws on it.

use super::app::App;
use super::stage::{Output, Stage};
use super::steering::{Steering, without_wait};
use crate::render::{AdapterChoice, Gpu, GpuError, new_instance};
use std::sync::Arc;
use std::time::{Duration, Instant};
use winit::window::Window;

/// Time between two pictures of a screen that does not say how often it shows one.
const USUAL_REFRESH: Duration = Duration::from_micros(16_667);

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
    /// Time between two pictures of the screen.
    refresh: Duration,
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
        let refresh = USUAL_REFRESH;
        let mut graphics = Self { window, instance, surface, config, stage, opened, refresh, is_software };
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
        let asked = Instant::now();
        let acquired = self.acquire()?;
        let waited = asked.elapsed();
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
        let took = without_wait(started.elapsed(), waited, self.refresh);
        let took = Some(took).filter(|_| shown == Shown::Yes);
        let is_news = self.stage.took(app, took, self.opened.elapsed());
        Ok((shown, if is_news { Some(Duration::ZERO) } else { more }))
    }

    /// The next texture of the surface; `None` when there is none now, after renewing what needs it.
    fn acquire(&mut self) -> Result<Option<wgpu::SurfaceTexture>, GpuError> {
        use wgpu::CurrentSurfaceTexture as Current;
        if self.config.width == 0 || self.config.height == 0 {
            return Ok(None);
        }
        let trouble = match self.surface.get_current_texture() {
            // A suboptimal one is shown all the same: the resize that made it so brings a new configuration.
            Current::Success(texture) | Current::Suboptimal(texture) => return Ok(Some(texture)),
            trouble => trouble,
        };
        match remedy(&trouble) {
            Remedy::Wait => return Ok(None),
            Remedy::Configure => {}
            Remedy::Renew => self.surface = new_surface(&self.instance, &self.window)?,
            Remedy::AskDevice => self.stage.gpu.check()?,
        }
        self.configure();
        self.window.request_redraw();
        Ok(None)
    }

    /// Fits the surface to the window; a window without size has no surface for now.
    fn configure(&mut self) {
        let rate_mhz = self.window.current_monitor().and_then(|monitor| monitor.refresh_rate_millihertz());
        let rate_mhz = rate_mhz.filter(|rate| *rate > 0);
        self.refresh = rate_mhz.map_or(USUAL_REFRESH, |rate| Duration::from_secs(1000) / rate);
        let size = self.window.inner_size();
        let limit = self.stage.max_side_px();
        (self.config.width, self.config.height) = (size.width.min(limit), size.height.min(limit));
        if self.config.width > 0 && self.config.height > 0 {
            self.surface.configure(&self.stage.gpu.device, &self.config);
        }
    }
}

/// What to do where the surface has no texture to draw on.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Remedy {
    /// Nothing: later there will be one.
    Wait,
    /// Fit the surface to the window.
    Configure,
    /// Make a new surface, and fit that.
    Renew,
    /// The device knows what is wrong; if it does not, fit the surface.
    AskDevice,
}

fn remedy(trouble: &wgpu::CurrentSurfaceTexture) -> Remedy {
    use wgpu::CurrentSurfaceTexture as Current;
    match trouble {
        Current::Timeout | Current::Occluded => Remedy::Wait,
        Current::Lost => Remedy::Renew,
        Current::Validation => Remedy::AskDevice,
        Current::Outdated | Current::Success(_) | Current::Suboptimal(_) => Remedy::Configure,
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_surface_without_a_texture_is_waited_for_fitted_or_made_anew() {
        use wgpu::CurrentSurfaceTexture as Current;
        let cases = [
            (Current::Timeout, Remedy::Wait),
            (Current::Occluded, Remedy::Wait),
            (Current::Outdated, Remedy::Configure),
            (Current::Lost, Remedy::Renew),
            (Current::Validation, Remedy::AskDevice),
        ];
        for (trouble, expected) in cases {
            assert_eq!(remedy(&trouble), expected);
        }
    }
}
