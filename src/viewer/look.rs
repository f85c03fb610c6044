//! How the scene is shown: colours, range, light, camera, floor.

use super::closer::{Closer, Seeing, TypedRange};
use super::orbit::{self, MouseInput};
use super::scene_camera::opening_camera;
use super::snapshot::Snapshot;
use crate::frame::{ColorBy, Frame};
use crate::render::{Background, Camera, Framing, Ground, NamedView, Range, View};

/// What the user chose about the picture, and what was derived from the scene for it.
#[derive(Clone, Debug)]
pub struct Look {
    /// Meaning of the colours.
    pub color_by: ColorBy,
    /// Whether the elements' edges are drawn.
    pub wireframe: bool,
    /// How far fragments are moved apart, as a share of their distance from the middle.
    pub explode: f32,
    /// What is looked at inside the bodies.
    pub closer: Closer,
    /// The colours' range, if it was typed.
    pub typed_range: TypedRange,
    /// Dark surroundings, of the picture and the panels.
    pub is_dark: bool,
    /// Whether moving pictures are drawn as finely as still ones, however long that takes.
    pub is_always_fine: bool,
    /// The camera.
    pub camera: Camera,
    /// Range of the colour map: grows with what was seen, so that colours do not flicker.
    range: Option<Range>,
    ground: Ground,
    /// A new scene waits for its camera until the view's shape is known.
    wants_opening_camera: bool,
}

impl Default for Look {
    fn default() -> Self {
        Self {
            color_by: ColorBy::default(),
            wireframe: false,
            explode: 0.0,
            closer: Closer::default(),
            typed_range: TypedRange::default(),
            is_dark: false,
            is_always_fine: false,
            camera: Camera::default(),
            range: None,
            ground: Ground::Auto,
            wants_opening_camera: false,
        }
    }
}

impl Look {
    /// A new scene was opened: its colours, floor and camera.
    pub fn open(&mut self, snapshot: &Snapshot) {
        let framing = Framing::of(&snapshot.frame);
        self.ground = framing.floor().map_or(Ground::Hidden, Ground::At);
        if let Some(scene) = &snapshot.scene {
            self.color_by = scene.description.recording.color_by.name().parse().unwrap_or_default();
        }
        self.forget_range();
        self.typed_range = TypedRange::default();
        self.explode = 0.0;
        self.closer.open(&snapshot.frame);
        if let Some(scene) = &snapshot.scene {
            self.typed_range = TypedRange::of_scene(&scene.description.recording);
            // As `render` does: where the bodies are at the start, however far the scene has run by now.
            let start = snapshot.recording.moments().first().map_or(&snapshot.frame, |moment| &moment.frame);
            self.closer.look_as(&scene.description.recording, start);
        }
        self.wants_opening_camera = true;
    }

    /// Takes the colours' range from the next frame on anew.
    pub fn forget_range(&mut self) {
        self.range = None;
    }

    /// Makes the colours' range cover a frame.
    pub fn take_in(&mut self, frame: &Frame) {
        self.closer.take_in(frame);
        if self.color_by.has_values() {
            let now = Range::of_frame(frame, self.color_by);
            // Before anything has happened there is nothing to keep: the range of nothing is 1.
            let is_nothing = frame.status.steps == 0;
            self.range = Some(self.range.filter(|_| !is_nothing).map_or(now, |range| range.union(now)));
        }
    }

    /// Gives a newly opened scene its camera, now that the view's width over height is known.
    pub fn settle(&mut self, snapshot: &Snapshot, aspect: f32) {
        let Some(scene) = snapshot.scene.as_ref().filter(|_| self.wants_opening_camera) else { return };
        self.wants_opening_camera = false;
        self.camera = opening_camera(&scene.description, &Framing::of(&snapshot.frame), aspect);
    }

    /// Shows what is there now, from where the camera looks, without what has flown or fallen far off. The floor comes along: what has fallen
    /// below the one from the start would stay hidden under it.
    pub fn frame_all(&mut self, frame: &Frame, aspect: f32) {
        let framing = Framing::of_near(frame);
        self.ground = framing.floor().map_or(Ground::Hidden, Ground::At);
        framing.fit(&mut self.camera, aspect);
    }

    /// Shows everything, from a named direction.
    pub fn look_from(&mut self, view: NamedView, frame: &Frame, aspect: f32) {
        self.camera.look_from(view);
        self.frame_all(frame, aspect);
    }

    /// Moves the camera as the mouse did over a view of the given height in points.
    pub fn move_camera(&mut self, input: &MouseInput, height: f32) {
        orbit::apply(&mut self.camera, input, height);
    }

    /// The colours' range that was found.
    #[must_use]
    pub fn found_range(&self) -> Option<Range> {
        self.range
    }

    /// What is done to frames before they are drawn.
    #[must_use]
    pub fn seeing(&self) -> Seeing {
        Seeing {
            explode: self.explode.max(0.0),
            cut: self.closer.cut(),
            with_crosses: self.closer.with_crosses,
        }
    }

    /// The view for the renderer.
    #[must_use]
    pub fn view(&self, pixels_per_point: f32) -> View {
        let typed = self.typed_range.range(self.color_by).ok().flatten();
        View {
            color_by: self.color_by,
            range: typed.or(self.range),
            is_range_chosen: typed.is_some(),
            wireframe: self.wireframe,
            ground: self.ground,
            background: if self.is_dark { Background::Dark } else { Background::Light },
            pixels_per_point,
            ..View::default()
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::frame::BodyFrame;
    use glam::Vec3;

    fn frame_at(x_m: f32, z_m: f32) -> Frame {
        let positions_m = vec![[x_m, 0.0, z_m], [x_m + 1.0, 1.0, z_m + 1.0]];
        Frame { bodies: vec![BodyFrame { positions_m, ..Default::default() }], ..Default::default() }
    }

    #[test]
    fn a_scene_is_cut_where_its_bodies_start() {
        let mut scene = crate::scene::Scene::load("bounce", &[]).unwrap();
        scene.description.recording.cut =
            Some(crate::scene::description::CutPlane { across: glam::DVec3::X, at_m: None });
        let mut recording = crate::viewer::recording::Recording::default();
        recording.push(frame_at(0.0, 0.0).into(), 0);
        let snapshot = Snapshot {
            frame: frame_at(7.0, 0.0).into(),
            recording: recording.into(),
            scene: Some(scene.into()),
            ..Default::default()
        };
        let mut look = Look::default();
        look.open(&snapshot);
        assert_eq!(look.closer.position_m, 0.5);
    }

    #[test]
    fn a_view_shows_what_is_there_now_and_no_floor_above_it() {
        let mut look = Look::default();
        look.open(&Snapshot { frame: frame_at(0.0, 0.0).into(), ..Default::default() });
        look.frame_all(&frame_at(0.0, 0.0), 1.5);
        let now = frame_at(40.0, -30.0);
        look.look_from(NamedView::Front, &now, 1.5);
        for point in &now.bodies[0].positions_m {
            let at = look.camera.picture_position(Vec3::from(*point), 1.5).unwrap();
            assert!(at.min_element() > 0.0 && at.max_element() < 1.0, "{at}");
        }
        assert!(matches!(look.ground, Ground::At(floor) if floor.height_m < -30.0));
    }
}
