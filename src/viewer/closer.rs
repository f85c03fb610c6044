//! Looking closer: the cutting plane, stress crosses, fragments apart, and a colour range of one's own.

use super::exploded::exploded;
use crate::frame::{ColorBy, Frame};
use crate::render::{
    Camera, Cut, Range, cross_room_m, look_inside, parse_with_unit, what_to_type, with_unit,
};
use crate::scene::description::Recording;
use glam::Vec3;
use std::borrow::Cow;

/// Smallest and largest coordinates, m.
type Bounds = ([f32; 3], [f32; 3]);

/// How the cutting plane stands.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum CutDirection {
    /// Across the x axis.
    X,
    /// Across the y axis.
    #[default]
    Y,
    /// Across the z axis: level.
    Z,
    /// Across a direction given by two angles.
    Free,
}

impl CutDirection {
    /// All of them with their labels.
    pub const ALL: [(Self, &'static str); 4] =
        [(Self::X, "x"), (Self::Y, "y"), (Self::Z, "z"), (Self::Free, "Free")];
}

/// What the user chose about the inside of bodies.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Closer {
    /// Whether bodies are cut open.
    pub is_cut: bool,
    /// How the plane stands.
    pub direction: CutDirection,
    /// Of a free direction: angle around the vertical, from the x axis, degrees.
    pub azimuth_deg: f32,
    /// Of a free direction: angle above the horizontal, degrees.
    pub elevation_deg: f32,
    /// Where the plane is along its direction, m.
    pub position_m: f32,
    /// Whether the other side is left out.
    pub is_flipped: bool,
    /// Which side was left out by whoever chose one, for each way the plane stands.
    own_sides: [Option<bool>; 4],
    /// Whether principal stresses are drawn.
    pub with_crosses: bool,
    /// What bodies have reached so far: the way of the slider.
    extent_m: Option<Bounds>,
}

impl Closer {
    /// Forgets the extent of an earlier scene, and looks at nothing inside.
    pub fn open(&mut self, frame: &Frame) {
        *self = Self::default();
        self.take_in(frame);
    }

    /// Looks inside as a scene is recorded.
    pub fn look_as(&mut self, recording: &Recording, now: &Frame) {
        self.with_crosses = recording.crosses;
        let Some(plane) = &recording.cut else { return };
        let Some(across) = plane.normal() else { return };
        let along = [(CutDirection::X, Vec3::X), (CutDirection::Y, Vec3::Y), (CutDirection::Z, Vec3::Z)];
        let axis = along.into_iter().find(|(_, axis)| across.dot(*axis).abs() > 1.0 - 1e-6);
        let is_flipped = axis.is_some_and(|(_, axis)| across.dot(axis) < 0.0);
        (self.direction, self.is_flipped) =
            (axis.map_or(CutDirection::Free, |(direction, _)| direction), is_flipped);
        self.azimuth_deg = across.y.atan2(across.x).to_degrees();
        self.elevation_deg = across.z.clamp(-1.0, 1.0).asin().to_degrees();
        self.keep_side();
        self.is_cut = true;
        self.go_through_middle(now);
        if let Some(at_m) = plane.at_m {
            self.position_m = if is_flipped { -at_m as f32 } else { at_m as f32 };
        }
    }

    /// Makes the slider reach all of a frame.
    pub fn take_in(&mut self, frame: &Frame) {
        let Some((low, high)) =
            frame.near_bounds_m().filter(|(low, high)| low.iter().chain(high).all(|x| x.is_finite()))
        else {
            return;
        };
        let (known_low, known_high) = self.extent_m.unwrap_or((low, high));
        self.extent_m = Some((
            std::array::from_fn(|i| low[i].min(known_low[i])),
            std::array::from_fn(|i| high[i].max(known_high[i])),
        ));
    }

    /// The direction across which the plane stands; a unit vector.
    #[must_use]
    pub fn normal(&self) -> Vec3 {
        match self.direction {
            CutDirection::X => Vec3::X,
            CutDirection::Y => Vec3::Y,
            CutDirection::Z => Vec3::Z,
            CutDirection::Free => {
                let (sin, cos) = self.azimuth_deg.to_radians().sin_cos();
                let (up, flat) = self.elevation_deg.to_radians().sin_cos();
                Vec3::new(flat * cos, flat * sin, up)
            }
        }
    }

    /// The positions between which the plane meets the scene, m.
    #[must_use]
    pub fn span_m(&self) -> [f32; 2] {
        Cut::span_m(self.normal(), self.extent_m.unwrap_or_default())
    }

    /// Puts the plane through the middle of the scene.
    pub fn center(&mut self) {
        self.position_m = Cut::middle_m(self.normal(), self.extent_m.unwrap_or_default());
    }

    /// Cuts the bodies open through their middle so that the camera looks into them, or closes them again.
    pub fn toggle_cut(&mut self, now: &Frame, camera: &Camera) {
        self.is_cut = !self.is_cut;
        if self.is_cut {
            self.go_through_middle(now);
            self.face(camera);
        }
    }

    fn go_through_middle(&mut self, now: &Frame) {
        self.position_m = Cut::middle_m(self.normal(), now.near_bounds_m().unwrap_or_default());
    }

    /// Leaves out the side that hides the section from the camera, unless somebody has chosen one.
    pub fn face(&mut self, camera: &Camera) {
        let own = self.own_sides[self.direction as usize];
        self.is_flipped = own.unwrap_or_else(|| !Cut::is_looked_into(self.normal(), camera));
    }

    /// Leaves out the other side once the camera has come to look at the back of what is left, unless somebody has chosen one.
    /// Not before it is clearly there: edge-on the cut would turn to and fro.
    pub fn follow(&mut self, camera: &Camera) {
        /// Sine of the angle behind the plane from which on it turns.
        const CLEARLY_BEHIND: f32 = 0.17;
        let Some(cut) = self.cut() else { return };
        let is_free = self.own_sides[self.direction as usize].is_none();
        if is_free && cut.normal.dot(camera.axes()[2]) < -CLEARLY_BEHIND {
            self.is_flipped = !self.is_flipped;
        }
    }

    /// The side that is left out was chosen, and stays.
    pub fn keep_side(&mut self) {
        self.own_sides[self.direction as usize] = Some(self.is_flipped);
    }

    /// The plane, where there is one.
    #[must_use]
    pub fn cut(&self) -> Option<Cut> {
        let sign = if self.is_flipped { -1.0 } else { 1.0 };
        Cut::new(sign * self.normal(), sign * self.position_m).filter(|_| self.is_cut)
    }
}

/// What is done to a frame before it is drawn. Only for the eye: nothing of it reaches the simulation.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Seeing {
    /// How far fragments are moved apart, as a share of their distance from the middle.
    pub explode: f32,
    /// Where bodies are cut open.
    pub cut: Option<Cut>,
    /// Whether principal stresses are drawn.
    pub with_crosses: bool,
    /// Room of their crosses, m, so that a length is the same stress at every moment; `None` takes each moment's own.
    pub cross_room_m: Option<f32>,
}

impl Seeing {
    /// Whether frames are drawn as they are.
    #[must_use]
    pub fn is_plain(&self) -> bool {
        *self == Self::default()
    }

    /// Whether what is inside bodies is needed for it.
    #[must_use]
    pub fn needs_interior(&self) -> bool {
        self.cut.is_some() || self.with_crosses
    }

    /// A frame with its fragments where they are drawn.
    #[must_use]
    pub fn apart<'a>(&self, frame: &'a Frame) -> Cow<'a, Frame> {
        if self.explode > 0.0 { Cow::Owned(exploded(frame, self.explode)) } else { Cow::Borrowed(frame) }
    }

    /// Between which distances beyond the plane everything is of a frame whose fragments are where they are drawn that could be
    /// cut, m, if the plane is beside all of it.
    #[must_use]
    pub fn beside_m(&self, apart: &Frame) -> Option<[f32; 2]> {
        let cut = self.cut?;
        let reaches = apart.moving().filter_map(|body| cut.reach_m(body));
        let reaches: Vec<[f32; 2]> = reaches.collect();
        let is_met = reaches.iter().any(|[low, high]| *low <= 0.0 && *high >= 0.0);
        reaches.into_iter().filter(|_| !is_met).reduce(|[a, b], [c, d]| [a.min(c), b.max(d)])
    }

    /// What pictures of these frames lack, in words after their number: some may have been recorded without what is inside.
    #[must_use]
    pub fn lacks<'a>(&self, frames: impl Iterator<Item = &'a Frame>) -> Option<String> {
        let lacks = frames.map(|frame| self.needs_interior() && !has_interior(frame));
        let [count, all] = lacks.fold([0, 0], |[count, all], lacks| [count + usize::from(lacks), all + 1]);
        let what = match (self.cut.is_some(), self.with_crosses) {
            (true, true) => "a section and stress crosses",
            (true, false) => "a section, only open",
            _ => "stress crosses",
        };
        let how_many = if count == all { "all".to_owned() } else { count.to_string() };
        let why =
            "recorded while neither cut nor crosses were on. Reset or Rerun, and play, to record them anew";
        (count > 0).then(|| format!("{how_many} of them without {what}: {why}"))
    }

    /// The frame as it is drawn.
    #[must_use]
    pub fn of(&self, frame: &Frame) -> Frame {
        self.of_apart(self.apart(frame))
    }

    /// The same of one whose fragments are where they are drawn.
    #[must_use]
    pub fn of_apart(&self, apart: Cow<'_, Frame>) -> Frame {
        if !self.needs_interior() {
            return apart.into_owned();
        }
        let room_m = || self.cross_room_m.unwrap_or_else(|| cross_room_m(&apart));
        look_inside(&apart, self.cut.as_ref(), self.with_crosses.then(room_m))
    }
}

/// Whether a frame can be looked into.
#[must_use]
pub fn has_interior(frame: &Frame) -> bool {
    frame.bodies.iter().any(|body| body.interior.is_some())
}

/// A colour range as it is typed.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct TypedRange {
    /// Whether it counts.
    pub is_on: bool,
    /// The lower end.
    pub low: String,
    /// The upper end.
    pub high: String,
    /// What the scene says: it has more digits than its text, and holds until that is edited.
    given: Option<GivenRange>,
}

#[derive(Clone, Debug, PartialEq)]
struct GivenRange {
    color_by: ColorBy,
    /// How an end is written, and its value.
    ends: [(String, f64); 2],
}

impl TypedRange {
    /// Starts from the range that colours have now.
    pub fn start_from(&mut self, range: Option<Range>, color_by: ColorBy) {
        let range = range.unwrap_or(Range { low: 0.0, high: 1.0 });
        let text = |value: f32| with_unit(f64::from(value), color_by.unit());
        *self = Self { is_on: true, low: text(range.low), high: text(range.high), given: None };
    }

    /// As a scene is recorded.
    #[must_use]
    pub fn of_scene(recording: &Recording) -> Self {
        let color_by = recording.color_by;
        let Some(ends) = recording.color_range else { return Self::default() };
        let ends = ends.map(|value| (with_unit(value, color_by.unit()), value));
        let [low, high] = ends.each_ref().map(|(text, _)| text.clone());
        Self { is_on: true, low, high, given: Some(GivenRange { color_by, ends }) }
    }

    /// The range; `None` when colours find their own.
    ///
    /// # Errors
    /// What is wrong with what was typed.
    pub fn range(&self, color_by: ColorBy) -> Result<Option<Range>, String> {
        let Some([low, high]) = self.ends(color_by)? else { return Ok(None) };
        Range::chosen(low, high)
            .map(Some)
            .map_err(|reason| format!("Until this is mended colours find their own range: {reason}"))
    }

    /// Its ends with all their digits.
    ///
    /// # Errors
    /// What is wrong with what was typed.
    pub fn ends(&self, color_by: ColorBy) -> Result<Option<[f64; 2]>, String> {
        if !self.is_on || !color_by.has_values() {
            return Ok(None);
        }
        let given = self.given.as_ref().filter(|given| given.color_by == color_by);
        let given = |end: usize| given.map(|given| &given.ends[end]);
        let end = |text: &str, given: Option<&(String, f64)>| {
            let given = given.filter(|(written, _)| written == text).map(|(_, value)| *value);
            given.or_else(|| parse_with_unit(text, color_by.unit())).ok_or_else(|| match color_by.unit() {
                "" => format!("“{}” is no number", text.trim()),
                unit => format!("“{}” is no value in {unit}: {}", text.trim(), what_to_type(unit)),
            })
        };
        Ok(Some([end(&self.low, given(0))?, end(&self.high, given(1))?]))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::frame::BodyFrame;
    use crate::scene::description::CutPlane;
    use glam::DVec3;

    #[test]
    fn the_plane_goes_through_the_middle_and_flips() {
        let positions_m = vec![[0.0, -1.0, 0.0], [2.0, 3.0, 1.0]];
        let frame =
            Frame { bodies: vec![BodyFrame { positions_m, ..Default::default() }], ..Default::default() };
        let mut closer = Closer::default();
        closer.open(&frame);
        assert!(closer.cut().is_none());
        let behind = Camera { yaw_rad: std::f32::consts::PI, ..Camera::default() };
        closer.toggle_cut(&frame, &behind);
        assert_eq!(closer.cut(), Cut::new(Vec3::Y, 1.0));
        closer.is_flipped = true;
        let flipped = closer.cut().unwrap();
        assert!(flipped.beyond_m([0.0, 0.5, 0.0]) > 0.0 && flipped.beyond_m([0.0, 1.5, 0.0]) < 0.0);
        (closer.direction, closer.azimuth_deg, closer.elevation_deg) = (CutDirection::Free, 90.0, 90.0);
        assert!((closer.normal() - Vec3::Z).length() < 1e-6);
        closer.center();
        assert!((closer.position_m - 0.5).abs() < 1e-6);
    }

    #[test]
    fn the_camera_looks_into_the_section_unless_a_side_was_chosen() {
        let frame = Frame::default();
        let looked_into =
            |closer: &Closer, camera: &Camera| closer.cut().unwrap().normal.dot(camera.axes()[2]) > 0.0;
        for yaw_deg in [30.0_f32, 120.0, 210.0, 300.0] {
            let camera = Camera { yaw_rad: yaw_deg.to_radians(), pitch_rad: 0.3, ..Camera::default() };
            let mut closer = Closer::default();
            closer.toggle_cut(&frame, &camera);
            assert!(looked_into(&closer, &camera), "{yaw_deg}");
            closer.direction = CutDirection::X;
            closer.face(&camera);
            assert!(looked_into(&closer, &camera), "{yaw_deg}");
            // Chosen by hand, it stays: closed and opened again, and beside another direction.
            closer.is_flipped = !closer.is_flipped;
            closer.keep_side();
            closer.toggle_cut(&frame, &camera);
            closer.toggle_cut(&frame, &camera);
            assert!(!looked_into(&closer, &camera), "{yaw_deg}");
            closer.direction = CutDirection::Z;
            closer.face(&camera);
            assert!(looked_into(&closer, &camera), "from above");
            closer.direction = CutDirection::X;
            closer.face(&camera);
            assert!(!looked_into(&closer, &camera), "{yaw_deg}");
        }
        // Edge-on, either side would do: the one beyond goes, as ever.
        let front = Camera { yaw_rad: 0.0, ..Camera::default() };
        let mut closer = Closer { direction: CutDirection::X, ..Closer::default() };
        closer.toggle_cut(&frame, &front);
        assert!(!closer.is_flipped);
    }

    #[test]
    fn the_cut_follows_the_camera_until_a_side_is_chosen() {
        let mut closer = Closer { direction: CutDirection::X, ..Closer::default() };
        let at = |yaw_deg: f32| Camera { yaw_rad: yaw_deg.to_radians(), pitch_rad: 0.2, ..Camera::default() };
        let faces = |closer: &Closer, camera: &Camera| closer.cut().unwrap().normal.dot(camera.axes()[2]);
        closer.toggle_cut(&Frame::default(), &at(0.0));
        let mut flips = 0;
        // Around it and back, in small steps.
        for yaw_deg in (0..=360).chain((0..360).rev()) {
            let (camera, before) = (at(yaw_deg as f32), closer.is_flipped);
            closer.follow(&camera);
            flips += u32::from(closer.is_flipped != before);
            assert!(faces(&closer, &camera) > -0.2, "{yaw_deg}");
        }
        assert!((2..=4).contains(&flips), "{flips}");
        // A hand that trembles where the plane is edge-on turns nothing.
        let edge_on = (0..360).map(|yaw| at(yaw as f32)).find(|camera| faces(&closer, camera).abs() < 0.03);
        let edge_on_deg = edge_on.unwrap().yaw_rad.to_degrees();
        let before = closer.is_flipped;
        for tremble_deg in [-5.0, 5.0, -4.0, 6.0] {
            closer.follow(&at(edge_on_deg + tremble_deg));
            assert_eq!(closer.is_flipped, before);
        }
        closer.keep_side();
        for yaw_deg in 0..360 {
            closer.follow(&at(yaw_deg as f32));
            assert_eq!(closer.is_flipped, before);
        }
    }

    #[test]
    fn a_plane_beside_everything_is_known_and_where_that_is() {
        let body = |x: f32| BodyFrame {
            positions_m: vec![[x, 0.0, 0.0], [x + 1.0, 0.0, 0.0]],
            ..Default::default()
        };
        let frame = Frame { bodies: vec![body(0.0), body(4.0)], ..Default::default() };
        let beside = |normal: Vec3, position_m: f32| {
            Seeing { cut: Cut::new(normal, position_m), ..Seeing::default() }.beside_m(&frame)
        };
        assert_eq!(beside(Vec3::X, 0.5), None);
        assert_eq!(beside(Vec3::X, 2.0), Some([-2.0, 3.0]), "between the bodies");
        assert_eq!(beside(Vec3::NEG_X, 1.0), Some([-6.0, -1.0]));
        assert_eq!(Seeing::default().beside_m(&frame), None);
    }

    #[test]
    fn a_plane_that_was_recorded_comes_back() {
        let positions_m = vec![[0.0, -1.0, 0.0], [2.0, 3.0, 1.0]];
        let frame =
            Frame { bodies: vec![BodyFrame { positions_m, ..Default::default() }], ..Default::default() };
        for across in [DVec3::X, DVec3::NEG_Y, DVec3::new(0.0, 0.0, 3.0), DVec3::new(1.0, -2.0, 0.5)] {
            let recording = Recording { cut: Some(CutPlane { across, at_m: Some(0.25) }), ..recording() };
            let mut closer = Closer::default();
            closer.open(&frame);
            closer.look_as(&recording, &frame);
            let cut = closer.cut().unwrap();
            let wanted = across.normalize().as_vec3();
            assert!((cut.normal - wanted).length() < 1e-5 && cut.position_m == 0.25, "{cut:?}");
            // Its side is chosen.
            let away = Camera { yaw_rad: across.x.atan2(-across.y) as f32 + 3.0, ..Camera::default() };
            closer.face(&away);
            assert_eq!(closer.cut(), Some(cut));
        }
        let middle = Recording { cut: Some(CutPlane { across: DVec3::Y, at_m: None }), ..recording() };
        let mut closer = Closer::default();
        closer.look_as(&middle, &frame);
        assert_eq!(closer.position_m, 1.0);
    }

    fn recording() -> Recording {
        crate::scene::Scene::load("bounce", &[]).unwrap().description.recording
    }

    #[test]
    fn typed_ranges_are_checked() {
        let mut typed = TypedRange::default();
        assert_eq!(typed.range(ColorBy::VonMises), Ok(None));
        typed.start_from(Some(Range { low: -2e6, high: 2e6 }), ColorBy::MeanStress);
        assert_eq!(typed.range(ColorBy::MeanStress), Ok(Some(Range { low: -2e6, high: 2e6 })));
        typed.high = "1 kPa".to_owned();
        assert_eq!(typed.range(ColorBy::MeanStress), Ok(Some(Range { low: -2e6, high: 1e3 })));
        typed.low = "5 kPa".to_owned();
        assert!(typed.range(ColorBy::MeanStress).unwrap_err().contains("below"));
        typed.low = "much".to_owned();
        assert!(typed.range(ColorBy::MeanStress).unwrap_err().contains("much"));
        assert_eq!(typed.range(ColorBy::Body), Ok(None));
    }

    #[test]
    fn a_recorded_range_keeps_its_digits_until_it_is_edited() {
        let ends = [1_234_567.891, 1_234_999.25];
        let recording = Recording { color_by: ColorBy::VonMises, color_range: Some(ends), ..recording() };
        let mut typed = TypedRange::of_scene(&recording);
        assert_eq!(typed.ends(ColorBy::VonMises), Ok(Some(ends)));
        typed.high = "3 MPa".to_owned();
        assert_eq!(typed.ends(ColorBy::VonMises), Ok(Some([ends[0], 3e6])));
        // For another field its text counts as if it had been typed.
        assert_eq!(typed.ends(ColorBy::MaxPrincipal).unwrap().unwrap()[1], 3e6);
        assert_ne!(typed.ends(ColorBy::MaxPrincipal).unwrap().unwrap()[0], ends[0]);
        assert!(typed.ends(ColorBy::Speed).is_err());
    }
}
