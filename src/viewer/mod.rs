//! The viewer: a window on a running simulation.
//!
//! ```text
//!   window ──events──▶ app ──Command──▶ simulation thread (session: World, history)
//!     ▲                 ▲ │                      │
//!     │                 │ └─ui: panels, keys     │ Snapshot (Frame, balances, state)
//!     └─stage◀─look, frame                       ▼
//!                       └──────────────── latest-wins slot
//! ```
//!
//! The thread of the simulation owns the world and steps it exactly as the command line does; the window only
//! sends commands and shows the latest snapshot. Nothing waits for the other.

mod aim;
mod app;
mod background;
mod closer;
mod criterion_edit;
mod damage;
mod edits;
mod exploded;
mod foresight;
mod frame_times;
mod graphics;
mod history;
mod inspection;
mod look;
mod measure;
mod off_screen_window;
mod orbit;
mod pacing;
mod pick;
mod player;
mod preferences;
mod recording;
mod saver;
mod saving;
mod scene_camera;
mod session;
mod simulation;
mod slot;
mod smoke;
mod snapshot;
mod stage;
mod steering;
#[cfg(test)]
mod tests;
mod thrown;
mod thumbnails;
mod ui;
mod window;
mod window_picture;

pub use measure::measure;
pub use scene_camera::scene_camera;
pub use window_picture::{WindowShot, WindowState, window_picture};

use crate::render::GpuError;
use thiserror::Error;
use winit::error::EventLoopError;
use winit::event_loop::EventLoop;

/// What the viewer starts with.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct ViewerOptions {
    /// Built-in scene or scene file; `None` starts at the gallery.
    pub scene: Option<String>,
    /// Overrides of the scene, `path=value`.
    pub overrides: Vec<String>,
    /// For tests: change the window's size twice, close it after so many frames, and tell about it on stdout.
    pub quit_after_frames: Option<u64>,
    /// With the above: also squeeze and hide the window and take its graphics device away.
    pub is_rough: bool,
}

/// Why there is no window, or no window any more.
#[derive(Debug, Error)]
pub enum ViewerError {
    /// No display to open a window on.
    #[error(
        "no window can be opened: {0}\nOn a machine without a display, `hammerfall render SCENE -o out.gif` draws \
         without one; over ssh, `ssh -X` brings a display along; `xvfb-run hammerfall` (package `xvfb`) makes one."
    )]
    NoDisplay(String),
    /// A library that windows need is missing.
    #[error(
        "a library that windows need is missing: {0}\nDebian, Ubuntu: apt install libxkbcommon-x11-0 libxcursor1 \
         libxi6 libx11-xcb1\nFedora: dnf install libxkbcommon-x11 libXcursor libXi libX11-xcb"
    )]
    MissingLibrary(String),
    /// The system refused the window.
    #[error("the window could not be opened: {0}")]
    Window(String),
    /// The system refused the simulation's thread.
    #[error("the simulation's thread could not be started: {0}")]
    Thread(std::io::Error),
    /// Nothing can be drawn.
    #[error(transparent)]
    Gpu(#[from] GpuError),
}

/// Opens the window and returns when it is closed.
///
/// # Errors
/// [`ViewerError`] when the window cannot be opened, or can no longer be drawn.
pub fn run(options: ViewerOptions) -> Result<(), ViewerError> {
    let event_loop = new_event_loop()?;
    let mut program = window::Program::new(options, event_loop.create_proxy());
    event_loop.run_app(&mut program).map_err(|error| ViewerError::Window(error.to_string()))?;
    program.failure.map_or(Ok(()), Err)
}

/// The window system's own words name its source files; these name the display.
fn why_no_display(error: &EventLoopError) -> String {
    let named = ["WAYLAND_DISPLAY", "DISPLAY"].into_iter().filter_map(|name| {
        let value = std::env::var(name).ok().filter(|value| !value.is_empty())?;
        Some(format!("{name} is `{value}`"))
    });
    let named: Vec<String> = named.collect();
    match (cfg!(target_os = "linux"), named.as_slice()) {
        (true, []) => "there is no display (neither DISPLAY nor WAYLAND_DISPLAY is set)".to_owned(),
        (true, named) => format!("the display does not answer ({})", named.join(", ")),
        _ => error.to_string(),
    }
}

/// The event loop; where the window system's libraries are missing it panics instead of failing.
fn new_event_loop() -> Result<EventLoop<window::News>, ViewerError> {
    let hook = std::panic::take_hook();
    std::panic::set_hook(Box::new(|_| {}));
    let built = std::panic::catch_unwind(|| EventLoop::with_user_event().build());
    std::panic::set_hook(hook);
    match built {
        Ok(built) => built.map_err(|error| ViewerError::NoDisplay(why_no_display(&error))),
        Err(payload) => {
            let text = payload.downcast_ref::<String>().cloned();
            let text = text.or_else(|| payload.downcast_ref::<&str>().map(|text| (*text).to_owned()));
            Err(ViewerError::MissingLibrary(text.unwrap_or_default()))
        }
    }
}
