//! The window without a screen: the same frame loop (events, layout, pictures, panels) onto a texture.

use super::app::App;
use super::stage::{Output, Stage};
use super::steering::Steering;
use super::ui::style;
use crate::render::{Gpu, GpuError, OffScreen, Picture};
use egui::{Context, RawInput, Rect, ViewportId, pos2};
use std::time::{Duration, Instant};

/// A window that nobody sees.
pub struct OffScreenWindow {
    /// What it shows.
    pub app: App,
    /// Its layout.
    pub context: Context,
    /// Width and height, pixels; zero is allowed.
    pub size_px: [u32; 2],
    /// Scale of the display.
    pub pixels_per_point: f32,
    /// The time that each frame is said to take, for tests of what hangs on it; `None` measures.
    pub assumed: Option<Duration>,
    time_s: f64,
    clock: Duration,
    stage: Stage,
    target: Option<wgpu::Texture>,
}

impl OffScreenWindow {
    /// Opens it.
    ///
    /// # Errors
    /// [`GpuError`] when nothing can be drawn.
    pub fn new(app: App, size_px: [u32; 2], pixels_per_point: f32) -> Result<Self, GpuError> {
        let stage = Stage::new(Gpu::headless()?, OffScreen::FORMAT, true)?;
        Ok(Self {
            app,
            context: new_context(),
            size_px,
            pixels_per_point,
            assumed: None,
            time_s: 0.0,
            clock: Duration::ZERO,
            stage,
            target: None,
        })
    }

    /// Draws what moves less finely where it takes long, as the window on the screen does; pictures to keep do not.
    pub fn steer(&mut self) {
        self.stage.steering = Some(Steering::default());
    }

    /// How moving pictures are drawn, if not as finely as still ones.
    #[must_use]
    pub fn detail(&self) -> Option<&'static str> {
        self.stage.steering.as_ref().and_then(Steering::name)
    }

    /// Events of a frame that comes `step_s` seconds after the last one, in a window of the size it has now. No clock
    /// on any wall has a say.
    #[must_use]
    pub fn input(&mut self, step_s: f64, events: Vec<egui::Event>) -> RawInput {
        self.time_s += step_s;
        let [width, height] = self.size_px.map(|side| side as f32 / self.pixels_per_point);
        let mut input = RawInput {
            screen_rect: Some(Rect::from_min_max(pos2(0.0, 0.0), pos2(width, height))),
            max_texture_side: Some(self.stage.max_side_px() as usize),
            time: Some(self.time_s),
            events,
            ..RawInput::default()
        };
        let viewport = input.viewports.entry(ViewportId::ROOT).or_default();
        viewport.native_pixels_per_point = Some(self.pixels_per_point);
        input
    }

    /// Lays out one frame and draws all of it, as [`super::window`] does; returns when the device is done with it.
    ///
    /// # Errors
    /// [`GpuError`] of the device.
    pub fn frame(&mut self, input: RawInput) -> Result<(), GpuError> {
        let (started, now) = (Instant::now(), self.clock);
        let app = &mut self.app;
        let full = self.context.run_ui(input, |ui| app.update(ui));
        let mut output = Output { context: &self.context, full };
        self.stage.draw_pictures(&mut self.app, output.full.pixels_per_point, now)?;
        self.target = fitting_target(&self.stage.gpu, self.target.take(), self.size_px);
        self.stage.paint(&self.app, &mut output, self.target.as_ref());
        self.stage.gpu.wait(None)?;
        let took = self.assumed.unwrap_or_else(|| started.elapsed());
        self.clock += took;
        self.stage.took(&mut self.app, Some(took), self.clock);
        Ok(())
    }

    /// Has all of it painted in the next frame, and not only what changes.
    #[cfg(test)]
    pub fn forget_what_is_painted(&mut self) {
        self.stage.forget_what_is_painted();
    }

    /// The moment that the picture of the scene shows.
    #[cfg(test)]
    pub fn drawn_frame(&self) -> Option<std::sync::Arc<crate::frame::Frame>> {
        self.stage.drawn_frame()
    }

    /// Time goes by without a frame.
    #[cfg(test)]
    pub fn idle(&mut self, time: Duration) {
        self.clock += time;
    }

    /// Lays out one frame and brings back what it looks like.
    ///
    /// # Errors
    /// [`GpuError`] of the device.
    pub fn picture(&mut self, input: RawInput) -> Result<Picture, GpuError> {
        let app = &mut self.app;
        let full = self.context.run_ui(input, |ui| app.update(ui));
        let mut output = Output { context: &self.context, full };
        self.stage.draw_pictures(&mut self.app, output.full.pixels_per_point, self.clock)?;
        let gpu = self.stage.gpu.clone();
        OffScreen::new(&gpu)?.draw_by(self.size_px, |view, _| {
            self.stage.paint(&self.app, &mut output, Some(view.texture()));
        })
    }

    /// Draws all pictures that are ready, and not one a frame.
    ///
    /// # Errors
    /// [`GpuError`] of the device.
    pub fn draw_waiting_pictures(&mut self) -> Result<(), GpuError> {
        let (scale, now) = (self.pixels_per_point, self.clock);
        while self.stage.draw_pictures(&mut self.app, scale, now)? == Some(Duration::ZERO) {}
        Ok(())
    }

    /// Takes the device away, as a driver might.
    #[cfg(test)]
    pub fn lose_device(&self) {
        self.stage.gpu.lose();
    }

    /// Opens the device anew after it was lost, as [`super::window`] does.
    ///
    /// # Errors
    /// [`GpuError`] when nothing can be drawn.
    #[cfg(test)]
    pub fn recover(&mut self) -> Result<(), GpuError> {
        self.target = None;
        self.stage = Stage::new(Gpu::headless()?, OffScreen::FORMAT, true)?;
        self.context = renewed_context(&self.context);
        self.app.forget_graphics();
        Ok(())
    }
}

/// A context with this program's fonts, spacing and colours.
#[must_use]
pub fn new_context() -> Context {
    let context = Context::default();
    style::install(&context);
    context
}

/// A context for a new device. Fonts have to be uploaded again, which only a new context does; what is folded, where
/// things are scrolled to and how large they are shown stays.
#[must_use]
pub fn renewed_context(old: &Context) -> Context {
    let memory = old.memory(Clone::clone);
    let context = new_context();
    context.memory_mut(|new| *new = memory);
    context
}

fn fitting_target(gpu: &Gpu, old: Option<wgpu::Texture>, size_px: [u32; 2]) -> Option<wgpu::Texture> {
    if size_px.contains(&0) {
        return None;
    }
    let old = old.filter(|texture| [texture.width(), texture.height()] == size_px);
    Some(old.unwrap_or_else(|| new_target(gpu, size_px)))
}

fn new_target(gpu: &Gpu, [width, height]: [u32; 2]) -> wgpu::Texture {
    gpu.device.create_texture(&wgpu::TextureDescriptor {
        label: Some("window without a screen"),
        size: wgpu::Extent3d { width, height, depth_or_array_layers: 1 },
        mip_level_count: 1,
        sample_count: 1,
        dimension: wgpu::TextureDimension::D2,
        format: OffScreen::FORMAT,
        usage: wgpu::TextureUsages::RENDER_ATTACHMENT | wgpu::TextureUsages::COPY_DST,
        view_formats: &[],
    })
}
