//! How quickly the window answers while a scene is simulated: measured through its frame loop, without a screen.

use super::app::App;
use super::frame_times::FrameTimes;
use super::off_screen_window::OffScreenWindow;
use super::pacing::FRAME_S;
use super::simulation::Simulation;
use super::thumbnails::Sketcher;
use egui::{Event, Modifiers, PointerButton, Pos2, pos2};
use std::time::{Duration, Instant};

/// Size of the window, pixels.
const SIZE_PX: [u32; 2] = [1280, 720];
/// Longest wait for the scene to open.
const LONGEST_OPENING: Duration = Duration::from_secs(300);
/// Frames that are not counted: pipelines, fonts and the first layout.
const WARM_UP: u32 = 10;

/// Draws so many frames of the window while `scene` is simulated in its thread and the mouse turns the camera, then as
/// many while it moves over the buttons; tells how long they took, from the event to the picture that shows it.
///
/// # Errors
/// Why the scene does not open, or nothing can be drawn.
pub fn measure(scene: &str, overrides: &[String], frames: u32) -> Result<String, String> {
    let simulation = Simulation::start(Box::new(|| {})).map_err(|error| error.to_string())?;
    let mut app = App::new(simulation, Sketcher::idle());
    app.open(scene, overrides);
    let mut window = OffScreenWindow::new(app, SIZE_PX, 1.0).map_err(|error| error.to_string())?;
    window.steer();
    wait_for_scene(&mut window)?;
    let mut turning = Turning::new(SIZE_PX);
    let turned = series(&mut window, frames, |window| turning.frame(window))?;
    turning.let_go(&mut window)?;
    let mut over_buttons = 0;
    let pointed = series(&mut window, frames, |window| {
        over_buttons += 1;
        frame(window, vec![Event::PointerMoved(pos2(40.0 + 30.0 * (over_buttons % 9) as f32, 14.0))])
    })?;
    let [width, height] = SIZE_PX;
    let elements = window.app.snapshot.frame.status.elements;
    Ok(format!(
        "{elements} elements, window of {width} x {height}\nturning the camera: {turned}\nover the buttons: {pointed}"
    ))
}

/// Draws so many frames after some that are not counted; tells about them.
fn series(
    window: &mut OffScreenWindow,
    frames: u32,
    mut frame: impl FnMut(&mut OffScreenWindow) -> Result<Duration, String>,
) -> Result<String, String> {
    for _ in 0..WARM_UP {
        frame(window)?;
    }
    let (steps, started) = (window.app.snapshot.frame.status.steps, Instant::now());
    let mut times = FrameTimes::default();
    let mut moments = 0;
    for _ in 0..frames {
        let before = window.app.snapshot.clone();
        times.note(frame(window)?);
        moments += u32::from(!std::sync::Arc::ptr_eq(&before, &window.app.snapshot));
    }
    let rate = f64::from(frames) / started.elapsed().as_secs_f64().max(1e-9);
    let steps = window.app.snapshot.frame.status.steps.saturating_sub(steps);
    let detail = window.detail().unwrap_or("full");
    Ok(format!(
        "{frames} frames ({rate:.1} a second; detail: {detail}; {steps} steps, {moments} new moments); {times}"
    ))
}

/// One frame, from the events to the finished picture; returns how long it took.
fn frame(window: &mut OffScreenWindow, events: Vec<Event>) -> Result<Duration, String> {
    let started = Instant::now();
    let input = window.input(FRAME_S, events);
    window.frame(input).map_err(|error| error.to_string())?;
    Ok(started.elapsed())
}

fn wait_for_scene(window: &mut OffScreenWindow) -> Result<(), String> {
    let asked = Instant::now();
    loop {
        let input = window.input(FRAME_S, Vec::new());
        window.frame(input).map_err(|error| error.to_string())?;
        let app = &window.app;
        match app.notice() {
            Some(trouble) if app.snapshot.scene.is_none() => return Err(trouble.to_owned()),
            _ if app.snapshot.scene.is_some() && !app.is_waiting() => return Ok(()),
            _ if asked.elapsed() > LONGEST_OPENING => return Err("the scene does not open".to_owned()),
            _ => std::thread::sleep(Duration::from_millis(5)),
        }
    }
}

/// A mouse that drags the camera around the scene, frame by frame.
pub struct Turning {
    middle: Pos2,
    frames: u32,
}

impl Turning {
    /// Over the middle of a window of a size.
    #[must_use]
    pub fn new(size_px: [u32; 2]) -> Self {
        let [width, height] = size_px.map(|side| side as f32);
        Self { middle: pos2(0.5 * width, 0.4 * height), frames: 0 }
    }

    /// One frame, from the event to the finished picture; returns how long it took.
    ///
    /// # Errors
    /// What went wrong on the device.
    pub fn frame(&mut self, window: &mut OffScreenWindow) -> Result<Duration, String> {
        let swing = 60.0 * (0.2 * self.frames as f32).sin();
        let at = self.middle + egui::vec2(swing, 0.0);
        let first = (self.frames == 0).then(|| self.button(true));
        let events = std::iter::once(Event::PointerMoved(at)).chain(first).collect();
        self.frames += 1;
        frame(window, events)
    }

    /// Lets the camera go.
    ///
    /// # Errors
    /// What went wrong on the device.
    pub fn let_go(&mut self, window: &mut OffScreenWindow) -> Result<(), String> {
        self.frames = 0;
        frame(window, vec![self.button(false)]).map(|_| ())
    }

    fn button(&self, pressed: bool) -> Event {
        let (pos, button) = (self.middle, PointerButton::Primary);
        Event::PointerButton { pos, button, pressed, modifiers: Modifiers::NONE }
    }
}
