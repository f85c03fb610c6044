//! The window: events in, frames out.

use super::app::{App, TITLE};
use super::graphics::{Graphics, Shown};
use super::off_screen_window::{new_context, renewed_context};
use super::preferences::{Keeper, LEAST_WINDOW, Preferences};
use super::simulation::Simulation;
use super::smoke::SmokeRun;
use super::stage::Output;
use super::thumbnails::Sketcher;
use super::{ViewerError, ViewerOptions};
use crate::render::{AdapterChoice, GpuError};
use std::sync::Arc;
use std::time::{Duration, Instant};
use winit::application::ApplicationHandler;
use winit::dpi::LogicalSize;
use winit::event::WindowEvent;
use winit::event_loop::{ActiveEventLoop, ControlFlow, EventLoopProxy};
use winit::window::{Window, WindowId};

/// Devices lost in a row after which every other one is a software driver, if none was chosen.
const MOST_LOSSES: u32 = 3;
/// Devices lost in a row after which a scripted run gives up.
const MOST_SCRIPTED_LOSSES: u32 = 12;
/// How long to wait before trying again to show a frame.
const RETRY: Duration = Duration::from_millis(100);
/// Longest wait before trying again to open the device.
const LONGEST_RETRY: Duration = Duration::from_secs(3);
/// Title of a window that cannot be drawn.
const LOST_TITLE: &str =
    "hammerfall: the graphics device is lost, trying again (nothing of the scene is lost)";

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
    /// `None` while the device is lost.
    graphics: Option<Graphics>,
    context: egui::Context,
    input: egui_winit::State,
    app: App,
    title: String,
    smoke: Option<SmokeRun>,
    redraw_at: Option<Instant>,
    /// When to try to open the device again.
    reopen_at: Instant,
    losses: u32,
    keeper: Keeper,
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
        let (keeper, trouble) = Keeper::open();
        let preferences = keeper.preferences().clone();
        let [width, height] = preferences.window;
        let attributes = Window::default_attributes()
            .with_title(TITLE)
            .with_inner_size(LogicalSize::new(width, height))
            .with_maximized(preferences.is_maximized)
            .with_min_inner_size(LogicalSize::new(LEAST_WINDOW[0], LEAST_WINDOW[1]));
        let window =
            event_loop.create_window(attributes).map_err(|error| ViewerError::Window(error.to_string()))?;
        let window = Arc::new(window);
        let graphics = Graphics::new(window.clone(), &adapter_choice(0))?;
        let simulation = Simulation::start(self.waker()).map_err(ViewerError::Thread)?;
        let mut app = App::new(simulation, Sketcher::start(self.waker()));
        let context = new_context();
        preferences.apply(&mut app, &context);
        if let Some(trouble) = trouble {
            app.tell(trouble);
        }
        if let Some(scene) = &self.options.scene {
            app.open(scene, &self.options.overrides);
        }
        let input = new_input(&context, &window, &graphics);
        let options = &self.options;
        Ok(OpenWindow {
            title: TITLE.to_owned(),
            smoke: options.quit_after_frames.map(|frames| SmokeRun::new(frames, options.is_rough)),
            redraw_at: None,
            reopen_at: Instant::now(),
            losses: 0,
            window,
            graphics: Some(graphics),
            context,
            input,
            app,
            keeper,
        })
    }
}

/// The user's choice, else the fastest; after some losses in a row also a software driver, which does not get lost.
fn adapter_choice(losses: u32) -> AdapterChoice {
    let is_desperate = losses > MOST_LOSSES && losses.is_multiple_of(2);
    AdapterChoice::from_env_or(if is_desperate { AdapterChoice::Software } else { AdapterChoice::Fastest })
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
        let Some(mut open) = self.open.take() else { return };
        open.keep_layout();
        if let Some(trouble) = open.keeper.close() {
            eprintln!("warning: {trouble}");
        }
        if let Some(smoke) = open.smoke {
            smoke.report();
        }
    }
}

impl OpenWindow {
    fn take_event(&mut self, event: &WindowEvent) {
        match event {
            WindowEvent::Resized(_) | WindowEvent::ScaleFactorChanged { .. } => {
                self.graphics.iter_mut().for_each(Graphics::resize);
            }
            WindowEvent::DroppedFile(path) => self.app.open(&path.to_string_lossy(), &[]),
            _ => {}
        }
        if self.input.on_window_event(&self.window, event).repaint {
            self.window.request_redraw();
        }
    }

    /// Lays out, draws and shows one frame; returns whether the window should close.
    fn redraw(&mut self) -> Result<bool, GpuError> {
        let started = Instant::now();
        self.reopen_graphics()?;
        let raw = self.input.take_egui_input(&self.window);
        let full = self.context.run_ui(raw, |ui| self.app.update(ui));
        self.plan_next(&full);
        self.input.handle_platform_output(&self.window, full.platform_output.clone());
        if let Some(smoke) = &mut self.smoke {
            smoke.laid_out(&self.window);
        }
        let mut output = Output { context: &self.context, full };
        let shown = self.graphics.as_mut().map(|graphics| graphics.show(&mut self.app, &mut output, started));
        drop(output);
        match shown {
            Some(Ok((shown, more))) => {
                let more_at = more.and_then(|delay| Instant::now().checked_add(delay));
                self.redraw_at = self.redraw_at.into_iter().chain(more_at).min();
                self.after(shown, started.elapsed());
            }
            Some(Err(error)) => self.lose_graphics(&error)?,
            None => self.redraw_at = Some(self.reopen_at.max(Instant::now() + RETRY)),
        }
        self.update_title();
        self.keep_layout();
        Ok(self.smoke.as_ref().is_some_and(SmokeRun::is_done))
    }

    fn after(&mut self, shown: Shown, took: Duration) {
        match shown {
            Shown::Yes => {
                self.losses = 0;
                if let Some(smoke) = &mut self.smoke {
                    smoke.took(took);
                    if smoke.frame_shown(&self.window, &self.app.snapshot) {
                        self.graphics.iter().for_each(Graphics::lose_device);
                    }
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

    /// The device is gone: forgets everything on it. The simulation goes on meanwhile, and so does trying.
    fn lose_graphics(&mut self, error: &GpuError) -> Result<(), GpuError> {
        if self.smoke.is_some() && self.losses > MOST_SCRIPTED_LOSSES {
            return Err(error.clone());
        }
        self.graphics = None;
        self.app.forget_graphics();
        self.app.tell(format!(
            "Drawing was interrupted and the graphics device had to be opened anew. Nothing of the scene is lost. The reason: {error}"
        ));
        // At once the first time, then ever later: a driver that is being replaced takes its time.
        let delay = (RETRY * 2_u32.pow(self.losses.min(8))).min(LONGEST_RETRY);
        self.reopen_at = Instant::now() + if self.losses > 0 { delay } else { Duration::ZERO };
        self.losses += 1;
        self.window.request_redraw();
        Ok(())
    }

    /// Opens the device again after it was lost, when it is time to.
    fn reopen_graphics(&mut self) -> Result<(), GpuError> {
        if self.graphics.is_some() || self.reopen_at > Instant::now() {
            return Ok(());
        }
        match Graphics::new(self.window.clone(), &adapter_choice(self.losses)) {
            Ok(graphics) => {
                self.context = renewed_context(&self.context);
                self.input = new_input(&self.context, &self.window, &graphics);
                self.graphics = Some(graphics);
                self.smoke.iter_mut().for_each(SmokeRun::recovered);
                Ok(())
            }
            Err(error) => self.lose_graphics(&error),
        }
    }

    /// Remembers size, panels and theme for the next run.
    fn keep_layout(&mut self) {
        let mut now: Preferences = self.keeper.preferences().clone();
        now.take_in(&self.app, &self.context);
        now.is_maximized = self.window.is_maximized();
        let size: LogicalSize<f64> = self.window.inner_size().to_logical(self.window.scale_factor());
        // A window that is minimised or squeezed says nothing about the size that is wanted.
        let is_usual = size.width >= LEAST_WINDOW[0] && size.height >= LEAST_WINDOW[1];
        if is_usual && !now.is_maximized {
            now.window = [size.width, size.height].map(f64::round);
        }
        if let Some(trouble) = self.keeper.keep(now) {
            self.app.tell(trouble);
        }
    }

    fn update_title(&mut self) {
        let title = if self.graphics.is_some() { self.app.title() } else { LOST_TITLE.to_owned() };
        if title != self.title {
            self.window.set_title(&title);
            self.title = title;
        }
    }
}
