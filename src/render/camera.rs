//! The orbit camera. The world's z axis points up.

use glam::camera::rh::proj::directx::perspective_infinite_reverse;
use glam::{Mat4, Vec2, Vec3};
use std::f32::consts::{FRAC_PI_2, TAU};
use std::str::FromStr;
use thiserror::Error;

/// Vertical field of view of a new camera, radians: that of a short telephoto lens, so that
/// shapes keep their proportions.
const DEFAULT_FOV_Y_RAD: f32 = 0.5;

/// A camera that looks at a target from a distance.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Camera {
    /// Point looked at, metres.
    pub target_m: Vec3,
    /// Distance of the eye from the target, metres, positive.
    pub distance_m: f32,
    /// Turn about the vertical: 0 looks along +y with x to the right; grows towards +x.
    pub yaw_rad: f32,
    /// Height of the eye over the target as an angle, from -pi/2 (below) to pi/2 (above).
    pub pitch_rad: f32,
    /// Vertical field of view, radians.
    pub fov_y_rad: f32,
}

/// Directions with a name.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum NamedView {
    /// From the front, a little from the right and above.
    #[default]
    ThreeQuarter,
    /// Along +y, x to the right.
    Front,
    /// Along -x.
    Right,
    /// Along -y.
    Back,
    /// Along +x.
    Left,
    /// From above, y up.
    Top,
    /// From behind, a little from the left and above.
    RearQuarter,
    /// As three-quarter, from near the floor.
    Low,
    /// As three-quarter, from high above.
    High,
}

/// A word that is no named view.
#[derive(Clone, Debug, Error, PartialEq, Eq)]
#[error("there is no camera '{given}'; choose one of {}", NamedView::ALL.map(NamedView::name).join(", "))]
pub struct UnknownView {
    /// The word.
    pub given: String,
}

impl NamedView {
    /// All of them, in the order of the keys 1 to 9.
    pub const ALL: [Self; 9] = [
        Self::ThreeQuarter,
        Self::Front,
        Self::Right,
        Self::Back,
        Self::Left,
        Self::Top,
        Self::RearQuarter,
        Self::Low,
        Self::High,
    ];

    /// The word on the command line and in scene files.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::ThreeQuarter => "three-quarter",
            Self::Front => "front",
            Self::Right => "right",
            Self::Back => "back",
            Self::Left => "left",
            Self::Top => "top",
            Self::RearQuarter => "rear-quarter",
            Self::Low => "low",
            Self::High => "high",
        }
    }

    /// Yaw and pitch, radians.
    #[must_use]
    pub fn angles_rad(self) -> (f32, f32) {
        let (yaw_deg, pitch_deg): (f32, f32) = match self {
            Self::ThreeQuarter => (30.0, 18.0),
            // A glimpse of the floor from above tells where things stand.
            Self::Front => (0.0, 4.0),
            Self::Right => (90.0, 4.0),
            Self::Back => (180.0, 4.0),
            Self::Left => (-90.0, 4.0),
            Self::Top => (0.0, 90.0),
            Self::RearQuarter => (210.0, 18.0),
            Self::Low => (30.0, 5.0),
            Self::High => (30.0, 45.0),
        };
        (yaw_deg.to_radians(), pitch_deg.to_radians())
    }
}

impl FromStr for NamedView {
    type Err = UnknownView;

    fn from_str(text: &str) -> Result<Self, UnknownView> {
        let wanted = text.trim().to_ascii_lowercase().replace(['_', ' '], "-");
        Self::ALL
            .into_iter()
            .find(|view| view.name() == wanted)
            .ok_or_else(|| UnknownView { given: text.to_owned() })
    }
}

impl Default for Camera {
    fn default() -> Self {
        let (yaw_rad, pitch_rad) = NamedView::default().angles_rad();
        Self { target_m: Vec3::ZERO, distance_m: 5.0, yaw_rad, pitch_rad, fov_y_rad: DEFAULT_FOV_Y_RAD }
    }
}

/// A half-line in the world.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Ray {
    /// Where it starts, metres.
    pub origin_m: Vec3,
    /// Direction, length 1.
    pub direction: Vec3,
}

impl Camera {
    /// A camera that sees all of the points, as large as the picture allows.
    ///
    /// `aspect` is width over height; `margin` is the share of the picture left free at each
    /// side, from 0 to below 0.5.
    #[must_use]
    pub fn framing(points_m: &[Vec3], (yaw_rad, pitch_rad): (f32, f32), aspect: f32, margin: f32) -> Self {
        let mut camera = Self { yaw_rad, pitch_rad, ..Self::default() };
        camera.fit(points_m, aspect, margin);
        camera
    }

    /// Moves and dollies, without turning, so that all points just fit into the picture; without
    /// points it stays.
    pub fn fit(&mut self, points_m: &[Vec3], aspect: f32, margin: f32) {
        let [right, up, back] = self.axes();
        let slope_y = (0.5 * self.fov_y_rad).tan() * (1.0 - 2.0 * margin.clamp(0.0, 0.45));
        let slope_x = slope_y * aspect.max(1e-3);
        let along = |axis: Vec3| points_m.iter().map(move |p| (p.dot(axis), p.dot(back)));
        let (Some((x, eye_x)), Some((y, eye_y))) =
            (fit_axis(along(right), slope_x), fit_axis(along(up), slope_y))
        else {
            return;
        };
        let nearest = points_m.iter().map(|p| p.dot(back));
        let (low, high) = nearest.fold((f32::MAX, f32::MIN), |(low, high), z| (low.min(z), high.max(z)));
        let middle = 0.5 * (low + high);
        self.target_m = right * x + up * y + back * middle;
        self.distance_m = (eye_x.max(eye_y) - middle).max(1e-3);
    }

    /// Unit vectors to the right, up, and back towards the viewer; well defined straight from
    /// above, too.
    #[must_use]
    pub fn axes(&self) -> [Vec3; 3] {
        let (sin_yaw, cos_yaw) = self.yaw_rad.sin_cos();
        let (sin_pitch, cos_pitch) = self.pitch_rad.sin_cos();
        let right = Vec3::new(cos_yaw, sin_yaw, 0.0);
        let back = Vec3::new(sin_yaw * cos_pitch, -cos_yaw * cos_pitch, sin_pitch);
        [right, back.cross(right), back]
    }

    /// Position of the eye, metres.
    #[must_use]
    pub fn eye_m(&self) -> Vec3 {
        self.target_m + self.axes()[2] * self.distance_m
    }

    /// View matrix: camera coordinates (x right, y up, z towards the viewer) from world ones.
    #[must_use]
    pub fn camera_from_world(&self) -> Mat4 {
        let [right, up, back] = self.axes();
        let eye = self.eye_m();
        Mat4::from_cols(right.extend(0.0), up.extend(0.0), back.extend(0.0), eye.extend(1.0)).inverse()
    }

    /// Clip coordinates from world ones; depth is 1 at the near plane and 0 at infinity, which
    /// keeps its precision at all distances.
    #[must_use]
    pub fn clip_from_world(&self, aspect: f32) -> Mat4 {
        let near_m = (self.distance_m * 0.01).max(1e-6);
        perspective_infinite_reverse(self.fov_y_rad, aspect.max(1e-3), near_m) * self.camera_from_world()
    }

    /// From the eye through the lower left corner of the picture at unit depth, and from there
    /// along its lower and left edges.
    pub(crate) fn picture_rays(&self, aspect: f32) -> [Vec3; 3] {
        let [right, up, back] = self.axes();
        let slope_y = (0.5 * self.fov_y_rad).tan();
        let (right, up) = (right * slope_y * aspect, up * slope_y);
        [-back - right - up, 2.0 * right, 2.0 * up]
    }

    /// The ray through a point of the picture: `position` from (0, 0), the upper left corner,
    /// to (1, 1).
    #[must_use]
    pub fn ray_in_world(&self, position: Vec2, aspect: f32) -> Ray {
        let [right, up, back] = self.axes();
        let slope_y = (0.5 * self.fov_y_rad).tan();
        let x = (2.0 * position.x - 1.0) * slope_y * aspect;
        let y = (1.0 - 2.0 * position.y) * slope_y;
        Ray { origin_m: self.eye_m(), direction: (right * x + up * y - back).normalize() }
    }

    /// Where a world point lies in the picture, (0, 0) to (1, 1) inside it; `None` behind the
    /// eye.
    #[must_use]
    pub fn picture_position(&self, point_m: Vec3, aspect: f32) -> Option<Vec2> {
        let clip = self.clip_from_world(aspect) * point_m.extend(1.0);
        (clip.w > 0.0).then(|| Vec2::new(0.5 + 0.5 * clip.x / clip.w, 0.5 - 0.5 * clip.y / clip.w))
    }

    /// Turns around the target by angles in radians.
    pub fn orbit(&mut self, yaw_rad: f32, pitch_rad: f32) {
        self.yaw_rad = (self.yaw_rad + yaw_rad).rem_euclid(TAU);
        self.pitch_rad = (self.pitch_rad + pitch_rad).clamp(-FRAC_PI_2, FRAC_PI_2);
    }

    /// Shifts the target by a share of the picture's height, so that what lies at the target's
    /// depth follows the pointer; y down as in windows.
    pub fn pan(&mut self, share_of_height: Vec2) {
        let [right, up, _] = self.axes();
        let height_m = 2.0 * self.distance_m * (0.5 * self.fov_y_rad).tan();
        self.target_m += (up * share_of_height.y - right * share_of_height.x) * height_m;
    }

    /// Multiplies the distance; below 1 comes closer.
    pub fn zoom(&mut self, factor: f32) {
        self.distance_m = (self.distance_m * factor).clamp(1e-4, 1e6);
    }

    /// Looks from a named direction, at the same target and distance.
    pub fn look_from(&mut self, view: NamedView) {
        (self.yaw_rad, self.pitch_rad) = view.angles_rad();
    }
}

/// Along one axis of the picture: where the eye must be, across and towards the viewer, to see
/// points `(across, towards)` between two planes of the given slope; `None` without points.
///
/// The eye at `(e, d)` sees a point `(a, t)` if `|a - e| <= slope (d - t)`; adding the tightest of
/// both sides gives `d`, subtracting gives `e`.
fn fit_axis(points: impl Iterator<Item = (f32, f32)>, slope: f32) -> Option<(f32, f32)> {
    let reach = points
        .map(|(across, towards)| (across + slope * towards, -across + slope * towards))
        .reduce(|a, b| (a.0.max(b.0), a.1.max(b.1)));
    reach.map(|(plus, minus)| (0.5 * (plus - minus), 0.5 * (plus + minus) / slope))
}

#[cfg(test)]
mod tests {
    use super::*;

    const ASPECT: f32 = 16.0 / 9.0;

    #[test]
    fn front_view_has_x_right_and_z_up() {
        let camera = Camera { yaw_rad: 0.0, pitch_rad: 0.0, ..Camera::default() };
        let at = |p| camera.picture_position(p, ASPECT).unwrap();
        assert!((at(Vec3::ZERO) - Vec2::splat(0.5)).length() < 1e-5);
        assert!(at(Vec3::X).x > 0.6);
        assert!(at(Vec3::Z).y < 0.4);
        assert!(camera.eye_m().y < -4.9);
    }

    #[test]
    fn fitted_box_touches_the_margin_from_every_view() {
        let corners: [Vec3; 8] = std::array::from_fn(|i| {
            let pick = |bit: usize, a: f32, b: f32| if i & bit == 0 { a } else { b };
            Vec3::new(pick(1, -0.2, 0.6), pick(2, 1.0, 1.5), pick(4, 0.0, 2.0))
        });
        for view in NamedView::ALL {
            let camera = Camera::framing(&corners, view.angles_rad(), ASPECT, 0.1);
            let seen = corners.map(|c| camera.picture_position(c, ASPECT).unwrap());
            let low_seen = seen.iter().copied().reduce(Vec2::min).unwrap();
            let high_seen = seen.iter().copied().reduce(Vec2::max).unwrap();
            let slack = (low_seen - 0.1).min(0.9 - high_seen);
            assert!(slack.min_element() > -1e-3, "{view:?} {slack}");
            assert!(slack.min_element() < 1e-3, "{view:?} {slack}");
        }
    }

    #[test]
    fn nothing_to_fit_leaves_the_camera_alone() {
        let mut camera = Camera::default();
        camera.fit(&[], ASPECT, 0.1);
        assert_eq!(camera, Camera::default());
    }

    #[test]
    fn ray_goes_back_through_its_point() {
        let camera = Camera::default();
        let point = Vec3::new(0.3, -0.4, 0.5);
        let position = camera.picture_position(point, ASPECT).unwrap();
        let ray = camera.ray_in_world(position, ASPECT);
        let off = (point - ray.origin_m).cross(ray.direction).length();
        assert!(off < 1e-4, "{off}");
    }

    #[test]
    fn straight_from_above_is_finite_and_y_is_up() {
        let mut camera = Camera::default();
        camera.look_from(NamedView::Top);
        assert!(camera.clip_from_world(ASPECT).is_finite());
        assert!(camera.picture_position(Vec3::Y, ASPECT).unwrap().y < 0.4);
    }

    #[test]
    fn panned_point_follows_the_pointer() {
        let mut camera = Camera::default();
        camera.pan(Vec2::new(0.1, 0.2));
        let moved = camera.picture_position(Vec3::ZERO, ASPECT).unwrap();
        assert!((moved.x - 0.5 - 0.1 / ASPECT).abs() < 0.01, "{moved}");
        assert!((moved.y - 0.7).abs() < 0.01, "{moved}");
    }

    #[test]
    fn names_read_back_and_unknown_ones_list_the_choices() {
        for view in NamedView::ALL {
            assert_eq!(view.name().parse(), Ok(view));
        }
        let text = "side".parse::<NamedView>().unwrap_err().to_string();
        assert!(text.contains("three-quarter"), "{text}");
    }
}
