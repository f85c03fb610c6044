//! The window: events in, frames out.

use super::app::{App, TITLE};
use super::graphics::{Graphics, Output, Shown};
use super::simulation::Simulation;
use super::smoke::SmokeRun;
use super::thumbnails::Sketcher;
use super::ui::style;
use super::{ViewerError, ViewerOptions};
use crate::render::GpuError;
use std::sync::Arc;
use std::time::{Duration, Instant};
use winit::application::ApplicationHandler;
use winit::dpi::LogicalSize;
use winit::event::WindowEvent;
use winit::event_loop::{ActiveEventLoop, ControlFlow, EventLoopProxy};
use winit::window::{Window, WindowId};

/// Size of a new window, points.
const SIZE: LogicalSize<f64> = LogicalSize::new(1280.0, 800.0);
/// Below this the panels do not fit, points.
const LEAST_SIZE: LogicalSize<f64> = LogicalSize::new(640.0, 420.0);
/// Lost devices in a row after which there is no point in trying again.
const MOST_LOSSES: u32 = 3;
/// How long to wait before trying again to show a frame.
const RETRY: Duration = Duration::from_millis(100);

/// Another thread has something new to show.
#[derive(Clone, Copy, Debug)]
pub struct News;

/// The application before and after its window exists.
pub struct Program {
    options: ViewerOptions,
    proxy: EventLoopProxy<News>,
    open: Option<OpenWindow>,
    /// What ended it, if something did.
    pub failure: Option<ViewerError>,
}

struct OpenWindow {
    window: Arc<Window>,
    graphics: Graphics,
    context: egui::Context,
    input: egui_winit::State,
    app: App,
    title: String,
    smoke: Option<SmokeRun>,
    redraw_at: Option<Instant>,
    losses: u32,
}

impl Program {
    /// An application that opens its window as soon as the system allows it.
    #[must_use]
    pub fn new(options: ViewerOptions, proxy: EventLoopProxy<News>) -> Self {
        Self { options, proxy, open: None, failure: None }
    }

    fn waker(&self) -> Box<dyn Fn() + Send> {
        let proxy = self.proxy.clone();
        Box::new(move || {
            // Fails only when the window is already gone.
            let _ = proxy.send_event(News);
        })
    }

    fn open_window(&self, event_loop: &ActiveEventLoop) -> Result<OpenWindow, ViewerError> {
        let attributes = Window::default_attributes()
            .with_title(TITLE)
            .with_inner_size(SIZE)
            .with_min_inner_size(LEAST_SIZE);
        let window =
            event_loop.create_window(attributes).map_err(|error| ViewerError::Window(error.to_string()))?;
        let window = Arc::new(window);
        let graphics = Graphics::new(window.clone())?;
        let simulation = Simulation::start(self.waker()).map_err(ViewerError::Thread)?;
        let mut app = App::new(simulation, Sketcher::start(self.waker()));
        if let Some(scene) = &self.options.scene {
            app.open(scene, &self.options.overrides);
        }
        let context = new_context();
        let input = new_input(&context, &window, &graphics);
        Ok(OpenWindow {
            title: TITLE.to_owned(),
            smoke: self.options.quit_after_frames.map(SmokeRun::new),
            redraw_at: None,
            losses: 0,
            window,
            graphics,
            context,
            input,
            app,
        })
    }
}

fn new_context() -> egui::Context {
    let context = egui::Context::default();
    style::install(&context);
    context
}

fn new_input(context: &egui::Context, window: &Window, graphics: &Graphics) -> egui_winit::State {
    egui_winit::State::new(
        context.clone(),
        egui::ViewportId::ROOT,
        window,
        Some(window.scale_factor() as f32),
        window.theme(),
        Some(graphics.max_side_px()),
    )
}

impl ApplicationHandler<News> for Program {
    fn resumed(&mut self, event_loop: &ActiveEventLoop) {
        if self.open.is_some() {
            return;
        }
        match self.open_window(event_loop) {
            Ok(open) => {
                open.window.request_redraw();
                self.open = Some(open);
            }
            Err(error) => {
                self.failure = Some(error);
                event_loop.exit();
            }
        }
    }

    fn user_event(&mut self, _: &ActiveEventLoop, _: News) {
        if let Some(open) = &self.open {
            open.window.request_redraw();
        }
    }

    fn window_event(&mut self, event_loop: &ActiveEventLoop, _: WindowId, event: WindowEvent) {
        let Some(open) = &mut self.open else { return };
        let is_done = match event {
            WindowEvent::CloseRequested => Ok(true),
            WindowEvent::RedrawRequested => open.redraw(),
            event => {
                open.take_event(&event);
                Ok(false)
            }
        };
        match is_done {
            Ok(false) => {}
            Ok(true) => event_loop.exit(),
            Err(error) => {
                self.failure = Some(error.into());
                event_loop.exit();
            }
        }
    }

    fn about_to_wait(&mut self, event_loop: &ActiveEventLoop) {
        let Some(open) = &mut self.open else { return };
        match open.redraw_at {
            Some(at) if at <= Instant::now() => {
                open.redraw_at = None;
                open.window.request_redraw();
                event_loop.set_control_flow(ControlFlow::Wait);
            }
            Some(at) => event_loop.set_control_flow(ControlFlow::WaitUntil(at)),
            None => event_loop.set_control_flow(ControlFlow::Wait),
        }
    }

    fn exiting(&mut self, _: &ActiveEventLoop) {
        // The simulation thread ends here, before the event loop does.
        if let Some(smoke) = self.open.take().and_then(|open| open.smoke) {
            smoke.report();
        }
    }
}

impl OpenWindow {
    fn take_event(&mut self, event: &WindowEvent) {
        match event {
            WindowEvent::Resized(_) | WindowEvent::ScaleFactorChanged { .. } => self.graphics.resize(),
            WindowEvent::DroppedFile(path) => self.app.open(&path.to_string_lossy(), &[]),
            _ => {}
        }
        if self.input.on_window_event(&self.window, event).repaint {
            self.window.request_redraw();
        }
    }

    /// Lays out, draws and shows one frame; returns whether the window should close.
    fn redraw(&mut self) -> Result<bool, GpuError> {
        let raw = self.input.take_egui_input(&self.window);
        let output = self.context.run_ui(raw, |ui| self.app.update(ui));
        self.plan_next(&output);
        self.input.handle_platform_output(&self.window, output.platform_output.clone());
        let pixels_per_point = output.pixels_per_point;
        let drawn = self.graphics.draw_pictures(&mut self.app, pixels_per_point);
        let background = self.context.global_style().visuals.panel_fill;
        let output = Output { context: &self.context, background, full: output };
        let shown = drawn.and_then(|()| self.graphics.paint(&self.app, output));
        match shown {
            Ok(shown) => self.after(shown),
            Err(error) => self.recover(error)?,
        }
        self.update_title();
        Ok(self.smoke.as_ref().is_some_and(SmokeRun::is_done))
    }

    fn after(&mut self, shown: Shown) {
        match shown {
            Shown::Yes => {
                self.losses = 0;
                if let Some(smoke) = &mut self.smoke {
                    smoke.frame_shown(&self.window, &self.app.snapshot);
                    self.window.request_redraw();
                }
            }
            // A covered or minimised window must not keep a core busy.
            Shown::NotNow => self.redraw_at = Some(Instant::now() + RETRY),
        }
    }

    fn plan_next(&mut self, output: &egui::FullOutput) {
        let delay =
            output.viewport_output.get(&egui::ViewportId::ROOT).map(|viewport| viewport.repaint_delay);
        self.redraw_at = delay.and_then(|delay| Instant::now().checked_add(delay));
    }

    /// Opens the device again after it was lost; gives up when that does not help.
    fn recover(&mut self, error: GpuError) -> Result<(), GpuError> {
        self.losses += 1;
        if self.losses > MOST_LOSSES {
            return Err(error);
        }
        self.graphics = Graphics::new(self.window.clone())?;
        // Fonts have to be uploaded again, which only a new context does.
        let memory = self.context.memory(Clone::clone);
        self.context = new_context();
        self.context.memory_mut(|new| *new = memory);
        self.input = new_input(&self.context, &self.window, &self.graphics);
        self.app.picture = None;
        self.app.thumbnails.fill(None);
        self.app.redraw_thumbnails();
        self.window.request_redraw();
        Ok(())
    }

    fn update_title(&mut self) {
        let title = self.app.title();
        if title != self.title {
            self.window.set_title(&title);
            self.title = title;
        }
    }
}
