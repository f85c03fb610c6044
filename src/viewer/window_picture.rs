//! The window as a picture, without a screen: the same panels over the same scene, and no clock.

use super::aim::Aim;
use super::app::App;
use super::off_screen_window::OffScreenWindow;
use super::pick::pick;
use super::session::Session;
use super::simulation::Simulation;
use super::snapshot::Command;
use super::thumbnails::Sketcher;
use super::ui::open_only;
use crate::frame::ColorBy;
use crate::render::{GpuError, NamedView, Picture};
use glam::Vec2;

/// Layouts after which everything has found its place.
const LAYOUTS: u32 = 4;
/// Time between them, s: nothing fades in any more.
const LAYOUT_S: f64 = 1.0;
/// Places in each direction at which an element is looked for.
const LOOKS: u32 = 24;

/// What the window is busy with.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum WindowState {
    /// The scene between its panels.
    #[default]
    Scene,
    /// The gallery of scenes.
    Gallery,
    /// Plots of energy, force and pieces.
    Plots,
    /// The element in sight that is nearest to failing, or else the one under the highest stress.
    Element,
    /// Keys and mouse.
    Help,
}

/// What to draw of the window.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct WindowShot {
    /// Built-in scene or scene file.
    pub scene: String,
    /// Its overrides, `path=value`.
    pub overrides: Vec<String>,
    /// Plays up to this time, s.
    pub at_s: f64,
    /// Width and height, pixels.
    pub size_px: [u32; 2],
    /// Scale of the display; 0 stands for 1.
    pub pixels_per_point: f32,
    /// What the window is busy with.
    pub state: WindowState,
    /// Dark surroundings.
    pub is_dark: bool,
    /// Edges of the elements.
    pub wireframe: bool,
    /// Meaning of the colours; `None`: what the scene says.
    pub color_by: Option<ColorBy>,
    /// From where; `None`: what the scene says.
    pub camera: Option<NamedView>,
}

/// Plays a scene and draws the window then.
///
/// # Errors
/// Why the scene does not open or run, or nothing can be drawn.
pub fn window_picture(shot: &WindowShot) -> Result<Picture, String> {
    let mut session = Session::default();
    let (scene, overrides) = (shot.scene.clone(), shot.overrides.clone());
    session.execute(Command::Open { scene, overrides, play: true });
    let snapshot = session.snapshot();
    let recording = snapshot.scene.as_ref().map(|scene| &scene.description.recording);
    let looks_inside = recording.is_some_and(|recording| recording.cut.is_some() || recording.crosses);
    session.execute(Command::SetInterior(looks_inside));
    play_to(&mut session, shot.at_s)?;
    draw(shot, &mut session).map_err(|error| error.to_string())
}

/// Up to the very moment that `render` without panels shows.
fn play_to(session: &mut Session, at_s: f64) -> Result<(), String> {
    let snapshot = session.snapshot();
    if snapshot.scene.is_none() {
        return Err(snapshot.notice.map_or_else(String::new, |notice| notice.text));
    }
    let is_there = session.simulate_to(at_s);
    session.execute(Command::Pause);
    match session.snapshot().run_error {
        Some(error) => Err(error),
        None if is_there => Ok(()),
        None => Err("the moment was not reached".to_owned()),
    }
}

fn draw(shot: &WindowShot, session: &mut Session) -> Result<Picture, GpuError> {
    let is_gallery = shot.state == WindowState::Gallery;
    let sketcher = if is_gallery { Sketcher::finished() } else { Sketcher::idle() };
    // What the panel tells of it; nobody answers later.
    let throw = Aim::default().foresight();
    session.execute(Command::Foresee { number: 0, throw, time_s: None });
    let mut app = App::new(Simulation::still(session.snapshot()), sketcher);
    app.is_gallery = is_gallery;
    // Not where this happens to run: the same picture everywhere.
    app.save.folder = ".".to_owned();
    app.panels.help = shot.state == WindowState::Help;
    app.look.is_dark = shot.is_dark;
    app.look.wireframe = shot.wireframe;
    let scale = if shot.pixels_per_point > 0.0 { shot.pixels_per_point } else { 1.0 };
    let mut window = OffScreenWindow::new(app, shot.size_px, scale)?;
    open_only(&window.context, sections_open(shot.state));
    window.draw_waiting_pictures()?;
    lay_out(&mut window)?;
    choose_look(&mut window.app, shot);
    if shot.state == WindowState::Element {
        session.execute(Command::Inspect(worst_in_sight(&window.app)));
        window.app.show_still(session.snapshot());
    }
    lay_out(&mut window)?;
    let input = window.input(LAYOUT_S, Vec::new());
    window.picture(input)
}

/// The sections that stay open; `None`: all of them.
fn sections_open(state: WindowState) -> Option<&'static [&'static str]> {
    match state {
        WindowState::Plots => Some(&["Throw and drop", "Contact", "Energy", "Contact force", "Pieces"]),
        WindowState::Element => Some(&["Throw and drop", "Contact", "Element"]),
        _ => None,
    }
}

fn lay_out(window: &mut OffScreenWindow) -> Result<(), GpuError> {
    for _ in 0..LAYOUTS {
        let input = window.input(LAYOUT_S, Vec::new());
        window.frame(input)?;
    }
    Ok(())
}

/// What a scene says of colours and camera, it says when it opens; this comes after.
fn choose_look(app: &mut App, shot: &WindowShot) {
    let frame = app.shown().clone();
    if let Some(color_by) = shot.color_by {
        // The scene's range is meant for its own field.
        app.look.typed_range.is_on &= app.look.color_by == color_by;
        app.look.color_by = color_by;
        app.look.forget_range();
        app.look.take_in(&frame);
    }
    if let (Some(camera), Some(area)) = (shot.camera, app.viewport) {
        app.look.look_from(camera, &frame, area.width() / area.height().max(1.0));
    }
}

/// Body and element behind the point in sight whose value is the largest.
fn worst_in_sight(app: &App) -> Option<(usize, u32)> {
    let aspect = app.viewport.map(|area| area.width() / area.height().max(1.0))?;
    let places = (0..LOOKS * LOOKS).map(|at| Vec2::new((at % LOOKS) as f32, (at / LOOKS) as f32));
    let hits = places.filter_map(|place| {
        let share = (place + 0.5) / LOOKS as f32;
        let hit = pick(app.drawn(), &app.look.camera.ray_in_world(share, aspect))?;
        Some((hit.body, hit.element))
    });
    hits.max_by(|a, b| value_of(app, *a).total_cmp(&value_of(app, *b)))
}

/// The failure index of an element at its skin, above all stresses; where nothing can break, the von Mises stress, Pa.
fn value_of(app: &App, (body, element): (usize, u32)) -> f32 {
    const ABOVE_STRESSES: f32 = 1e15;
    let Some(body) = app.drawn().bodies.get(body) else { return 0.0 };
    let surface = &body.surface;
    let own = surface.triangles.iter().zip(&surface.triangle_element).filter(|(_, of)| **of == element);
    let (values, scale) = match body.fields.failure_index.as_slice() {
        [] => (body.fields.von_mises_pa.as_slice(), 1.0),
        indices => (indices, ABOVE_STRESSES),
    };
    let at = |vertex: &u32| values.get(*vertex as usize).map_or(0.0, |value| value * scale);
    own.flat_map(|(triangle, _)| triangle.iter().map(at)).fold(0.0, f32::max)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_window_shows_the_moment_that_was_asked_for() {
        let opened = |scene: &str| {
            let mut session = Session::default();
            let (scene, overrides) = (scene.to_owned(), Vec::new());
            session.execute(Command::Open { scene, overrides, play: true });
            session
        };
        // In free flight, and beyond the end of the scene.
        for at_s in [0.123_456_7, 5.000_1] {
            let mut session = opened("bounce");
            play_to(&mut session, at_s).unwrap();
            let time_s = session.snapshot().frame.time_s;
            let step_s = session.snapshot().stable_step_s;
            assert!(time_s >= at_s * (1.0 - 1e-12) && time_s < at_s + step_s, "{time_s} for {at_s}");
        }
        assert!(play_to(&mut opened("no-such-scene"), 0.1).unwrap_err().contains("no-such-scene"));
    }
}
