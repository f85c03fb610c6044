//! Pictures of the built-in scenes for the gallery: made from the scenes themselves, in the background.

use super::scene_camera::opening_camera;
use crate::frame::{ColorBy, Frame};
use crate::render::{Background, Camera, Framing, Ground, View};
use crate::scene::{BUILTIN_SCENES, Scene, SceneDescription};
use crate::sim::World;
use glam::Vec3;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{Receiver, Sender, channel};

/// Width and height of a thumbnail, pixels.
pub const SIZE_PX: [u32; 2] = [480, 270];

/// A scene's first moment, ready to be drawn.
pub struct Sketch {
    /// Index of the scene.
    pub scene: usize,
    /// The first frame.
    pub frame: Frame,
    /// From where it is seen.
    pub camera: Camera,
    ground: Ground,
    color_by: ColorBy,
}

impl Sketch {
    /// How it is drawn.
    #[must_use]
    pub fn view(&self, is_dark: bool) -> View {
        View {
            ground: self.ground,
            color_by: self.color_by,
            legend: false,
            background: if is_dark { Background::Dark } else { Background::Light },
            ..View::for_size(SIZE_PX)
        }
    }
}

/// A thread that prepares the sketches; it ends early when this is dropped.
pub struct Sketcher {
    sketches: Receiver<Sketch>,
    wants_end: Arc<AtomicBool>,
}

impl Sketcher {
    /// Starts the thread; `waker` is called after each sketch. Without a thread there are no thumbnails.
    #[must_use]
    pub fn start(waker: Box<dyn Fn() + Send>) -> Self {
        let (sender, sketches) = channel();
        let wants_end = Arc::new(AtomicBool::new(false));
        let end = wants_end.clone();
        let thread = std::thread::Builder::new().name("thumbnails".to_owned());
        // The gallery does without pictures if there is no thread to be had.
        let _ = thread.spawn(move || {
            super::background::stand_back();
            sketch_all(&sender, &end, &*waker);
        });
        Self { sketches, wants_end }
    }

    /// One that prepares nothing.
    #[must_use]
    pub fn idle() -> Self {
        Self { sketches: channel().1, wants_end: Arc::default() }
    }

    /// One that has prepared all of them already.
    #[must_use]
    pub fn finished() -> Self {
        let (sender, sketches) = channel();
        let wants_end = Arc::new(AtomicBool::new(false));
        sketch_all(&sender, &wants_end, &|| {});
        Self { sketches, wants_end }
    }

    /// A finished sketch, if there is a new one.
    #[must_use]
    pub fn next(&self) -> Option<Sketch> {
        self.sketches.try_recv().ok()
    }
}

impl Drop for Sketcher {
    fn drop(&mut self) {
        self.wants_end.store(true, Ordering::Relaxed);
    }
}

fn sketch_all(sender: &Sender<Sketch>, wants_end: &AtomicBool, waker: &dyn Fn()) {
    for index in 0..BUILTIN_SCENES.len() {
        if wants_end.load(Ordering::Relaxed) {
            return;
        }
        // A scene that does not load has no thumbnail; opening it tells why.
        let Some(sketch) = sketch(index) else { continue };
        if sender.send(sketch).is_err() {
            return;
        }
        waker();
    }
}

fn sketch(index: usize) -> Option<Sketch> {
    let scene = Scene::load(BUILTIN_SCENES[index].name, &[]).ok()?;
    let frame = World::new(scene.setup.clone()).ok()?.publish();
    let framing = Framing::of(&frame);
    Some(Sketch {
        scene: index,
        camera: opening_view(&scene.description, &frame, &framing),
        ground: framing.floor().map_or(Ground::Hidden, Ground::At),
        color_by: ColorBy::Material,
        frame,
    })
}

/// From where the scene is recorded; as near as shows everything where that would cut off what is there at the start, or
/// show it from farther away than need be: a small picture has no room for what comes later.
fn opening_view(scene: &SceneDescription, frame: &Frame, framing: &Framing) -> Camera {
    let aspect = SIZE_PX[0] as f32 / SIZE_PX[1] as f32;
    let recorded = opening_camera(scene, framing, aspect);
    let mut fitted = recorded;
    framing.fit(&mut fitted, aspect);
    let is_in_sight = |point: &[f32; 3]| {
        let at = recorded.picture_position(Vec3::from(*point), aspect);
        at.is_some_and(|at| at.min_element() > 0.0 && at.max_element() < 1.0)
    };
    let shows_all = frame.moving().flat_map(|body| &body.positions_m).all(is_in_sight);
    if shows_all && recorded.distance_m <= fitted.distance_m { recorded } else { fitted }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn thumbnails_show_everything_that_moves() {
        for (index, scene) in BUILTIN_SCENES.iter().enumerate() {
            let Sketch { frame, camera, .. } = sketch(index).unwrap();
            let aspect = SIZE_PX[0] as f32 / SIZE_PX[1] as f32;
            for body in frame.moving() {
                for point in &body.positions_m {
                    let at = camera.picture_position(Vec3::from(*point), aspect).unwrap();
                    assert!(
                        at.min_element() > 0.0 && at.max_element() < 1.0,
                        "{} of {}",
                        body.name,
                        scene.name
                    );
                }
            }
        }
    }
}
