//! Throwing with the mouse: where the body starts, where it is aimed, how fast.

use super::foresight::Foreseen;
use super::pick;
use super::snapshot::Snapshot;
use super::thrown::{Placing, TOOL, Throw, ThrowKind, typical_size_in};
use crate::frame::{BodyFrame, Frame};
use crate::render::Camera;
use glam::{DVec3, Vec2, Vec3};

/// Points of the drawn path.
const PATH_POINTS: usize = 24;
/// Gravity of the drawn path, m/s2: scenes that have another are few, and the line is only an aim.
const GRAVITY_M_S2: f32 = 9.81;
/// What falls begins so far below the upper edge of the picture, as a share of its height: legends hide what is above.
const TOP_MARGIN: f32 = 0.04;
/// Shortest drag that throws, as a share of the picture's height.
const SHORTEST_DRAG: f32 = 0.01;

/// What would be thrown, and a drag under way.
#[derive(Clone, Debug)]
pub struct Aim {
    /// Whether dragging throws instead of turning the camera.
    pub is_armed: bool,
    /// What.
    pub kind: ThrowKind,
    /// Of which material.
    pub material: String,
    /// Size over the usual one.
    pub scale: f64,
    /// m/s.
    pub speed_m_s: f64,
    /// Spin about the axis across the throw, rad/s.
    pub spin_rad_s: f64,
    /// Start and present place of the drag, as shares of the picture.
    pub drag: Option<[Vec2; 2]>,
    /// Whether the drag has ended, and only the place of its start is still to be found.
    pub is_let_go: bool,
    /// Whether the mouse was pressed last without a way to throw along.
    pub was_too_short: bool,
    /// Counts the questions for what would be thrown.
    pub asks: u64,
    /// What was asked for last, and in which scene.
    asked_for: Option<(Throw, [u64; 3])>,
    /// Whether the button still is down that drew a line before aiming ended: it turns no camera.
    pub is_spent: bool,
}

impl Default for Aim {
    fn default() -> Self {
        Self {
            is_armed: false,
            kind: ThrowKind::Hammer,
            material: TOOL.to_owned(),
            scale: 1.0,
            speed_m_s: 8.0,
            spin_rad_s: 0.0,
            drag: None,
            is_let_go: false,
            was_too_short: false,
            asks: 0,
            asked_for: None,
            is_spent: false,
        }
    }
}

/// A line in the world that shows a throw.
#[derive(Clone, Debug, PartialEq)]
pub struct Path {
    /// From where the body starts to what it is aimed at, m.
    pub points_m: Vec<Vec3>,
    start_m: Vec3,
    velocity_m_s: Vec3,
}

impl Path {
    /// The velocity at its start, m/s.
    #[must_use]
    pub fn velocity_m_s(&self) -> DVec3 {
        self.velocity_m_s.as_dvec3()
    }
}

impl Aim {
    /// Dragging throws, or turns the camera again.
    pub fn arm(&mut self, is_armed: bool) {
        self.is_armed = is_armed;
        self.is_spent |= self.drag.take().is_some();
        (self.is_let_go, self.was_too_short) = (false, false);
    }

    /// A speed that suits the size of a scene: that of a fall over some lengths of its bodies.
    pub fn suit(&mut self, frame: &Frame) {
        let size_m = typical_size_in(frame);
        let speed_m_s = (2.0 * 9.81 * 6.0 * size_m).sqrt();
        self.speed_m_s = (speed_m_s * 2.0).round().max(1.0) / 2.0;
    }

    /// Where the drag asks the body to start, m: free in the air, as far away as what the camera looks at.
    #[must_use]
    pub fn start_m(&self, camera: &Camera, aspect: f32) -> Option<Vec3> {
        self.drag.map(|[from, _]| pick::in_focus(camera, &camera.ray_in_world(from, aspect)))
    }

    /// A throw of the body that was chosen, from nowhere in particular.
    #[must_use]
    pub fn foresight(&self) -> Throw {
        let placing =
            Placing::From { position_m: DVec3::ZERO, velocity_m_s: DVec3::ZERO, spin_rad_s: DVec3::ZERO };
        self.of(self.kind.clone(), placing)
    }

    /// The same, where it is not known yet what that comes to in this scene; asks once.
    pub fn next_foresight(&mut self, snapshot: &Snapshot) -> Option<Throw> {
        let bodies = snapshot.body_names.len() as u64;
        let wanted = (self.foresight(), [snapshot.opened, snapshot.built, bodies]);
        let is_new =
            snapshot.scene.is_some() && self.drag.is_none() && self.asked_for.as_ref() != Some(&wanted);
        is_new.then(|| {
            let throw = wanted.0.clone();
            self.asked_for = Some(wanted);
            throw
        })
    }

    /// What of the scene is the chosen body, if that is what was foreseen.
    #[must_use]
    pub fn chosen<'a>(&self, snapshot: &'a Snapshot) -> Option<&'a Foreseen> {
        let foreseen = snapshot.foreseen.as_deref()?;
        (foreseen.throw == self.foresight()).then_some(foreseen)
    }

    /// A throw of this kind, of the material and the size that were chosen.
    fn of(&self, kind: ThrowKind, placing: Placing) -> Throw {
        Throw { kind, material: self.material.clone(), scale: self.scale, placing }
    }

    /// The path of the throw that the drag stands for, of a body that starts at a place, m; `None` when the drag is too short.
    #[must_use]
    pub fn path(&self, frame: &Frame, camera: &Camera, aspect: f32, start_m: Vec3) -> Option<Path> {
        let [from, to] = self.drag?;
        let way = (to - from) * Vec2::new(aspect, 1.0);
        if way.length() < SHORTEST_DRAG {
            return None;
        }
        let aim_m = pick::point_under(frame, camera, to, aspect);
        let gravity = if frame.is_weightless { 0.0 } else { GRAVITY_M_S2 };
        let (velocity_m_s, time_s) = flight(aim_m - start_m, self.speed_m_s as f32, gravity)?;
        let at = |index: usize| {
            let t = time_s * index as f32 / (PATH_POINTS - 1) as f32;
            start_m + velocity_m_s * t - Vec3::Z * (0.5 * gravity * t * t)
        };
        Some(Path { points_m: (0..PATH_POINTS).map(at).collect(), start_m, velocity_m_s })
    }

    /// The throw along a path.
    #[must_use]
    pub fn throw(&self, path: &Path) -> Throw {
        let placing = Placing::From {
            position_m: path.start_m.as_dvec3(),
            velocity_m_s: path.velocity_m_s.as_dvec3(),
            spin_rad_s: self.spin_rad_s(path),
        };
        self.of(self.kind.clone(), placing)
    }

    /// The spin along a path, rad/s: rolling forwards.
    #[must_use]
    pub fn spin_rad_s(&self, path: &Path) -> DVec3 {
        let across = path.velocity_m_s.cross(Vec3::Z).try_normalize().unwrap_or(Vec3::X);
        -across.as_dvec3() * self.spin_rad_s
    }

    /// The same body, dropped from above what a frame shows, in the picture if there is room.
    #[must_use]
    pub fn drop(&self, kind: ThrowKind, frame: &Frame, camera: &Camera, aspect: f32) -> Throw {
        let room_m = kind.room_m(self.scale, frame) as f32;
        self.of(kind, Placing::Above { top_m: top_m(frame, camera, aspect, room_m) })
    }
}

/// Up to what height the picture shows the whole of a body that reaches so far from its middle (m), above the bodies that
/// move, m; `None` where it shows nothing of that.
fn top_m(frame: &Frame, camera: &Camera, aspect: f32, room_m: f32) -> Option<f64> {
    let bounds = frame.moving().filter_map(BodyFrame::bounds_m);
    let bounds = bounds.map(|(low, high)| (Vec3::from(low), Vec3::from(high)));
    let (low, high) = bounds.reduce(|a, b| (a.0.min(b.0), a.1.max(b.1)))?;
    let is_seen = |z_m: f32| {
        // What is seen highest of it is no top, but its side that is turned away.
        let middle_m = low.midpoint(high).with_z(z_m - room_m);
        let at = camera.picture_position(middle_m + camera.axes()[1] * room_m, aspect);
        at.is_some_and(|at| at.y > TOP_MARGIN && (0.0..=1.0).contains(&at.x))
    };
    let (mut seen_m, mut unseen_m) = (high.z, high.z + camera.distance_m);
    for _ in 0..20 {
        let middle_m = 0.5 * (seen_m + unseen_m);
        *(if is_seen(middle_m) { &mut seen_m } else { &mut unseen_m }) = middle_m;
    }
    is_seen(high.z).then_some(f64::from(seen_m))
}

/// The velocity (m/s) of this length with which something flies over `way_m` by the lower arc, and the time (s) that it takes;
/// straight ahead, and past its target, where it is too slow for any arc. `None` without a way or a speed.
fn flight(way_m: Vec3, speed_m_s: f32, gravity_m_s2: f32) -> Option<(Vec3, f32)> {
    let direction = way_m.try_normalize().filter(|_| speed_m_s > 0.0)?;
    // |way + g t^2/2 e_z| = v t, of which the smaller t.
    let reach = speed_m_s * speed_m_s - gravity_m_s2 * way_m.z;
    let spare = reach * reach - gravity_m_s2 * gravity_m_s2 * way_m.length_squared();
    if reach <= 0.0 || spare < 0.0 {
        return Some((direction * speed_m_s, way_m.length() / speed_m_s));
    }
    let time_s = (2.0 * way_m.length_squared() / (reach + spare.sqrt())).sqrt();
    Some((way_m / time_s + Vec3::Z * (0.5 * gravity_m_s2 * time_s), time_s))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_thrown_hits_what_it_is_aimed_at_with_the_speed_asked_for() {
        for way_m in [Vec3::new(1.0, 0.5, -0.3), Vec3::new(2.0, -1.0, 1.0), Vec3::Z, -Vec3::Z] {
            for gravity in [0.0, GRAVITY_M_S2] {
                let (velocity_m_s, time_s) = flight(way_m, 9.0, gravity).unwrap();
                let end_m = velocity_m_s * time_s - Vec3::Z * (0.5 * gravity * time_s * time_s);
                assert!((end_m - way_m).length() < 1e-4, "{way_m}: {end_m}");
                assert!((velocity_m_s.length() - 9.0).abs() < 1e-4, "{way_m}: {velocity_m_s}");
            }
        }
        // Too far for this speed: straight ahead.
        let (velocity_m_s, _) = flight(Vec3::X * 10.0, 2.0, GRAVITY_M_S2).unwrap();
        assert_eq!(velocity_m_s, Vec3::X * 2.0);
        assert_eq!(flight(Vec3::ZERO, 2.0, 0.0), None);
    }

    #[test]
    fn a_drag_throws_along_itself_with_the_speed_asked_for() {
        let camera = Camera::default();
        let mut aim = Aim { speed_m_s: 5.0, spin_rad_s: 2.0, ..Aim::default() };
        let frame = Frame { is_weightless: true, ..Frame::default() };
        assert!(aim.path(&frame, &camera, 1.5, Vec3::ZERO).is_none());
        aim.drag = Some([Vec2::new(0.3, 0.5), Vec2::new(0.301, 0.5)]);
        assert!(aim.path(&frame, &camera, 1.5, Vec3::ZERO).is_none(), "a click is no throw");
        aim.drag = Some([Vec2::new(0.3, 0.5), Vec2::new(0.7, 0.5)]);
        let start_m = aim.start_m(&camera, 1.5).unwrap();
        let path = aim.path(&frame, &camera, 1.5, start_m).unwrap();
        // From nearer to the eye it flies to the same place.
        let nearer_m = start_m.lerp(camera.eye_m(), 0.3);
        let nearer = aim.path(&frame, &camera, 1.5, nearer_m).unwrap();
        let ends = [&path, &nearer].map(|path| *path.points_m.last().unwrap());
        assert!((ends[0] - ends[1]).length() < 1e-4 && nearer.points_m[0] == nearer_m, "{ends:?}");
        let Placing::From { velocity_m_s, spin_rad_s, position_m } = aim.throw(&path).placing else {
            panic!("it is aimed")
        };
        assert!((velocity_m_s.length() - 5.0).abs() < 1e-4 && (spin_rad_s.length() - 2.0).abs() < 1e-4);
        let [right, _, _] = camera.axes();
        assert!(velocity_m_s.as_vec3().normalize().dot(right) > 0.999);
        let start = camera.picture_position(position_m.as_vec3(), 1.5).unwrap();
        assert!((start - Vec2::new(0.3, 0.5)).length() < 1e-4, "{start}");
    }
}
