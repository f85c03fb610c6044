//! How the scene is shown: colours, range, light, camera, floor.

use super::closer::{Closer, Seeing, TypedRange};
use super::orbit::{self, MouseInput};
use super::scene_camera::opening_camera;
use super::snapshot::Snapshot;
use crate::frame::{ColorBy, Frame};
use crate::render::{
    Background, Camera, Framing, Ground, NamedView, Range, View, cross_room_m, cross_scale_pa,
};

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
    /// What it covers as long as nothing was seen but round-off.
    range_at_rest: Option<Range>,
    crosses: CrossMeasure,
    ground: Ground,
    opening: Opening,
}

/// How long the lines of stress crosses are: the same for the same stress at every moment.
#[derive(Clone, Copy, Debug, Default)]
struct CrossMeasure {
    /// Room of a cross, m: of the moment at which they were first drawn.
    room_m: Option<f32>,
    /// Stress of the longest line, Pa: grows with what was seen, as the colours' range does.
    scale_pa: Option<f32>,
}

/// How far a new scene has got its camera.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
enum Opening {
    /// It waits until the view's shape is known.
    Waits,
    /// It has the one for a view of this width over height, and nobody has turned it yet.
    Fitted { camera: Camera, aspect: f32 },
    /// Somebody has chosen another one.
    #[default]
    Over,
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
            range_at_rest: None,
            crosses: CrossMeasure::default(),
            ground: Ground::Auto,
            opening: Opening::default(),
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
        self.forget_crosses();
        self.typed_range = TypedRange::default();
        self.explode = 0.0;
        self.closer.open(&snapshot.frame);
        if let Some(scene) = &snapshot.scene {
            self.typed_range = TypedRange::of_scene(&scene.description.recording);
            // As `render` does: where the bodies are at the start, however far the scene has run by now.
            let start = snapshot.recording.moments().first().map_or(&snapshot.frame, |moment| &moment.frame);
            self.closer.look_as(&scene.description.recording, start);
        }
        self.opening = Opening::Waits;
    }

    /// Takes the colours' range from the next frame on anew.
    pub fn forget_range(&mut self) {
        (self.range, self.range_at_rest) = (None, None);
    }

    /// Measures stress crosses by the next frame anew.
    pub fn forget_crosses(&mut self) {
        self.crosses = CrossMeasure::default();
    }

    /// Stress crosses on or off. They are measured by what is seen from now on, as colours are from when they are chosen.
    pub fn toggle_crosses(&mut self) {
        self.closer.with_crosses = !self.closer.with_crosses;
        self.forget_crosses();
    }

    /// Opens the cut towards the camera, wherever that has been turned.
    pub fn follow_camera(&mut self) {
        self.closer.follow(&self.camera);
    }

    /// Makes the colours' range cover a frame.
    pub fn take_in(&mut self, frame: &Frame) {
        self.closer.take_in(frame);
        if !self.color_by.has_values() {
            return;
        }
        match Range::found_in(frame, self.color_by) {
            Some(now) => self.range = Some(self.range.map_or(now, |range| range.union(now))),
            None => self.range_at_rest = Some(Range::at_rest(frame, self.color_by)),
        }
    }

    /// Settles the room of stress crosses, before they are made of a frame.
    pub fn make_room_for_crosses(&mut self, frame: &Frame) {
        if self.closer.with_crosses && self.crosses.room_m.is_none() {
            self.crosses.room_m = Some(cross_room_m(frame));
        }
    }

    /// Makes the measure of stress crosses cover those of a frame.
    pub fn take_in_crosses(&mut self, seen: &Frame) {
        self.crosses.scale_pa =
            self.crosses.scale_pa.into_iter().chain(cross_scale_pa([seen])).reduce(f32::max);
    }

    /// Gives a newly opened scene its camera, now that the view's width over height is known, and another one when that
    /// changes before somebody has turned it.
    pub fn settle(&mut self, snapshot: &Snapshot, aspect: f32) {
        let Some(scene) = snapshot.scene.as_ref() else { return };
        if let Opening::Fitted { camera, aspect: known } = self.opening {
            if camera != self.camera {
                self.opening = Opening::Over;
            } else if known == aspect {
                return;
            }
        }
        if self.opening == Opening::Over {
            return;
        }
        let start = snapshot.recording.moments().first().map_or(&snapshot.frame, |moment| &moment.frame);
        self.camera = opening_camera(&scene.description, &Framing::of(start), aspect);
        self.opening = Opening::Fitted { camera: self.camera, aspect };
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
        self.range.or(self.range_at_rest)
    }

    /// What is done to frames before they are drawn.
    #[must_use]
    pub fn seeing(&self) -> Seeing {
        Seeing {
            explode: self.explode.max(0.0),
            cut: self.closer.cut(),
            with_crosses: self.closer.with_crosses,
            cross_room_m: self.crosses.room_m.filter(|_| self.closer.with_crosses),
        }
    }

    /// The view for the renderer.
    #[must_use]
    pub fn view(&self, pixels_per_point: f32) -> View {
        let typed = self.typed_range.range(self.color_by).ok().flatten();
        View {
            color_by: self.color_by,
            range: typed.or(self.found_range()),
            cross_scale_pa: self.crosses.scale_pa.filter(|_| self.closer.with_crosses),
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

    /// A frame with one body, pulled by a stress and as large as told, and stress crosses on it.
    fn stressed(stress_pa: f32, size_m: f32) -> Frame {
        let principal_pa = [stress_pa, 0.0, 0.0];
        let cross = crate::frame::StressCross {
            position_m: [0.0; 3],
            normal: [0.0, 0.0, 1.0],
            directions: glam::Mat3::IDENTITY.to_cols_array_2d(),
            principal_pa,
            room_m: 0.1,
        };
        let mut frame = frame_at(0.0, 0.0);
        frame.bodies[0].positions_m.push([size_m, 0.0, 0.0]);
        frame.bodies[0].fields.von_mises_pa = vec![stress_pa; 3];
        frame.bodies[0].scales.stiffness_pa = 1e9;
        Frame { crosses: vec![cross], ..frame }
    }

    #[test]
    fn colours_of_what_bears_nothing_do_not_magnify_round_off() {
        let mut look = Look { color_by: ColorBy::VonMises, ..Look::default() };
        look.take_in(&stressed(2e-9, 1.0));
        assert_eq!(look.view(1.0).range.unwrap().high, 1e3);
        // The first load sets the range, however small it is.
        look.take_in(&stressed(40.0, 1.0));
        assert_eq!(look.view(1.0).range.unwrap().high, 40.0);
        look.take_in(&stressed(2e-9, 1.0));
        assert_eq!(look.view(1.0).range.unwrap().high, 40.0);
    }

    #[test]
    fn stress_crosses_keep_their_measure() {
        let mut look = Look::default();
        look.closer.with_crosses = true;
        look.make_room_for_crosses(&stressed(1e6, 1.0));
        look.take_in_crosses(&stressed(1e6, 1.0));
        let room_m = look.seeing().cross_room_m;
        assert!(room_m.is_some());
        // Something flies apart, and bears less.
        look.make_room_for_crosses(&stressed(1e3, 2.0));
        look.take_in_crosses(&stressed(1e3, 2.0));
        assert_eq!((look.seeing().cross_room_m, look.view(1.0).cross_scale_pa), (room_m, Some(1e6)));
        look.forget_crosses();
        look.make_room_for_crosses(&stressed(1e3, 2.0));
        look.take_in_crosses(&stressed(1e3, 2.0));
        assert_ne!(look.seeing().cross_room_m, room_m);
        assert_eq!(look.view(1.0).cross_scale_pa, Some(1e3));
    }

    #[test]
    fn crosses_are_measured_from_when_they_are_switched_on() {
        let mut look = Look::default();
        for stress_pa in [1e6, 1e3] {
            look.toggle_crosses();
            look.make_room_for_crosses(&stressed(stress_pa, 1.0));
            look.take_in_crosses(&stressed(stress_pa, 1.0));
            assert_eq!(look.view(1.0).cross_scale_pa, Some(stress_pa));
            look.toggle_crosses();
            assert_eq!(look.view(1.0).cross_scale_pa, None);
        }
    }

    #[test]
    fn the_opening_camera_follows_the_views_shape_until_it_is_turned() {
        let scene = crate::scene::Scene::load("hammer-table", &[]).unwrap();
        let frame = crate::sim::World::new(scene.setup.clone()).unwrap().publish();
        let snapshot = Snapshot { frame: frame.into(), scene: Some(scene.into()), ..Default::default() };
        let mut look = Look::default();
        look.open(&snapshot);
        look.settle(&snapshot, 1.6);
        let wide = look.camera;
        look.settle(&snapshot, 0.8);
        let narrow = look.camera;
        assert!(narrow.distance_m > 1.05 * wide.distance_m, "{narrow:?}");
        look.settle(&snapshot, 1.6);
        assert_eq!(look.camera, wide);
        look.camera.orbit(0.1, 0.0);
        let turned = look.camera;
        look.settle(&snapshot, 0.8);
        assert_eq!(look.camera, turned);
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
