//! What the camera and the floor must take in, over a whole animation.

use crate::frame::{BodyFrame, BodyRole, Frame};
use crate::render::camera::{Camera, NamedView};
use crate::render::light::TOWARDS_KEY_LIGHT;
use glam::Vec3;

/// Share of the picture left free at each side by the automatic camera.
const MARGIN: f32 = 0.12;
/// How far the automatic camera follows a long flight: multiples of the largest extent of what
/// is there in the last frame. A hammer that falls from ten metres enters from above instead of
/// being a dot.
const LONGEST_FLIGHT: f32 = 2.5;
/// Fixed bodies larger than this many times the moving ones do not widen the picture.
const LARGEST_FIXED: f32 = 2.0;

/// Gap between a floor that is only for looks and the moving bodies, in sizes of these.
const FLOOR_GAP: f32 = 0.1;

/// Where the floor is drawn.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Floor {
    /// World z of its surface, metres.
    pub height_m: f32,
    /// The fixed body whose place it takes, an index into the frame's bodies.
    pub replaces: Option<usize>,
}

type Bounds = (Vec3, Vec3);

/// The space that a frame, or all frames of an animation, take up.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Framing {
    moving: Option<Bounds>,
    last_moving: Option<Bounds>,
    /// Longest side of what moved in the first frame, metres.
    first_size_m: Option<f32>,
    /// Of all moving points so far, the farthest along each of [`directions`]: much tighter than
    /// a box, and still a few numbers for a whole animation.
    extremes: Vec<Vec3>,
    fixed: Vec<FixedBody>,
    is_weightless: bool,
    /// Moving points outside of it are left out.
    limits: Option<Bounds>,
}

/// A fixed body and whether it can serve as the ground.
#[derive(Clone, Debug, PartialEq)]
struct FixedBody {
    index: usize,
    bounds: Bounds,
    is_level_slab: bool,
}

impl Framing {
    /// The space of one frame.
    #[must_use]
    pub fn of(frame: &Frame) -> Self {
        let mut framing = Self::default();
        framing.include(frame);
        framing
    }

    /// The space of what matters in one frame: without what has flown or fallen far off.
    #[must_use]
    pub fn of_near(frame: &Frame) -> Self {
        let limits = frame.near_limits_m().map(|(low, high)| (Vec3::from(low), Vec3::from(high)));
        let mut framing = Self { limits, ..Self::default() };
        framing.include(frame);
        framing
    }

    /// Takes in a further frame, later than all before.
    pub fn include(&mut self, frame: &Frame) {
        self.fixed = fixed_bodies(frame);
        self.is_weightless = frame.is_weightless;
        let moving = frame
            .moving()
            .flat_map(points_of)
            .filter(|point| self.is_within_limits(*point))
            .map(|point| (point, point))
            .reduce(union);
        self.last_moving = moving.or(self.last_moving);
        self.first_size_m = self.first_size_m.or(moving.map(longest_side));
        self.moving = [self.moving, moving].into_iter().flatten().reduce(union);
        self.include_extremes(frame);
    }

    fn is_within_limits(&self, point: Vec3) -> bool {
        self.limits.is_none_or(|(low, high)| point.cmpge(low).all() && point.cmple(high).all())
    }

    fn include_extremes(&mut self, frame: &Frame) {
        let bodies = frame.moving();
        let near = bodies.flat_map(points_of).filter(|point| self.is_within_limits(*point));
        let points = near.chain(self.extremes.clone());
        let mut best: Vec<(f32, Vec3)> = Vec::new();
        for point in points {
            if best.is_empty() {
                best = directions().map(|_| (f32::MIN, point)).collect();
            }
            for ((reach, extreme), direction) in best.iter_mut().zip(directions()) {
                let along = point.dot(direction);
                if along > *reach {
                    (*reach, *extreme) = (along, point);
                }
            }
        }
        self.extremes = best.into_iter().map(|(_, point)| point).collect();
    }

    /// The floor: in place of a large level fixed body below everything that moves, else at the
    /// foot of the fixed bodies or a little below the lowest point of the moving ones; `None`
    /// when there is nothing to draw, or nothing that would fall on a floor.
    #[must_use]
    pub fn floor(&self) -> Option<Floor> {
        let ground = self.fixed.iter().filter(|body| self.is_ground(body));
        // A plinth or a mat that happens to lie under everything stands on the ground itself.
        let lowest = ground.min_by(|a, b| a.bounds.1.z.total_cmp(&b.bounds.1.z));
        if let Some(body) = lowest {
            return Some(Floor { height_m: body.bounds.1.z, replaces: Some(body.index) });
        }
        if self.is_weightless {
            return None;
        }
        // Nothing moving really stands on this floor, so it leaves a gap.
        let gap_m = FLOOR_GAP * self.first_size_m.unwrap_or(0.0);
        let moving = self.moving.map(|(low, _)| low.z - gap_m);
        let fixed = self.fixed.iter().map(|body| body.bounds.0.z);
        Some(Floor { height_m: fixed.chain(moving).reduce(f32::min)?, replaces: None })
    }

    fn is_ground(&self, body: &FixedBody) -> bool {
        let Some((low, high)) = self.moving else {
            return false;
        };
        let size = (high - low).max_element();
        let (fixed_low, fixed_high) = body.bounds;
        let reaches_under =
            fixed_low.x <= low.x && fixed_low.y <= low.y && fixed_high.x >= high.x && fixed_high.y >= high.y;
        body.is_level_slab && reaches_under && fixed_high.z <= low.z + 0.02 * size
    }

    /// The points the automatic camera shows, metres; empty when there is nothing to draw.
    #[must_use]
    pub fn shown_points_m(&self) -> Vec<Vec3> {
        let floor = self.floor();
        let (Some(last), Some(_)) = (self.last_moving, self.moving) else {
            let fixed = self.fixed.iter().flat_map(|body| corners(body.bounds));
            return fixed.collect();
        };
        let limit = widened(last, LONGEST_FLIGHT);
        let mut shown: Vec<Vec3> = self.extremes.iter().map(|p| p.clamp(limit.0, limit.1)).collect();
        let is_floor = |body: &&FixedBody| floor.and_then(|f| f.replaces) == Some(body.index);
        let near = widened(last, LARGEST_FIXED);
        for body in self.fixed.iter().filter(|body| !is_floor(body)) {
            shown.extend(corners(clipped(body.bounds, near)));
        }
        if let Some(floor) = floor {
            // The floor and the shadow on it belong to the picture if they are near.
            let height = floor.height_m.clamp(near.0.z, near.1.z);
            let middle = 0.5 * (last.0 + last.1);
            let fall = (middle.z - height).max(0.0) / TOWARDS_KEY_LIGHT.z;
            let shadow = middle - TOWARDS_KEY_LIGHT * fall;
            for point in [middle, shadow] {
                let point = point.truncate().extend(height);
                shown.push(point.clamp(near.0, near.1));
            }
        }
        shown
    }

    /// The automatic camera: sees everything, from a named direction; `aspect` is the picture's
    /// width over its height. Without anything to see it is the default camera.
    #[must_use]
    pub fn camera(&self, view: NamedView, aspect: f32) -> Camera {
        let points = self.shown_points_m();
        if points.is_empty() {
            return Camera::default();
        }
        Camera::framing(&points, view.angles_rad(), aspect, MARGIN)
    }

    /// Moves a camera, without turning it, so that it sees everything.
    pub fn fit(&self, camera: &mut Camera, aspect: f32) {
        camera.fit(&self.shown_points_m(), aspect, MARGIN);
    }
}

/// Towards the sides, edges and corners of a cube: 26 directions.
fn directions() -> impl Iterator<Item = Vec3> {
    let third = |i: i32, n: i32| (i / n % 3 - 1) as f32;
    let all = (0..27).map(move |i| Vec3::new(third(i, 1), third(i, 3), third(i, 9)));
    all.filter_map(Vec3::try_normalize)
}

fn corners((low, high): Bounds) -> [Vec3; 8] {
    std::array::from_fn(|i| {
        let pick = |bit: usize, axis: usize| if i & bit == 0 { low[axis] } else { high[axis] };
        Vec3::new(pick(1, 0), pick(2, 1), pick(4, 2))
    })
}

fn fixed_bodies(frame: &Frame) -> Vec<FixedBody> {
    let bodies = frame.bodies.iter().enumerate();
    bodies
        .filter(|(_, body)| body.role == BodyRole::Fixed)
        .filter_map(|(index, body)| {
            let bounds = bounds_of(body)?;
            Some(FixedBody { index, bounds, is_level_slab: is_level_slab(body, bounds) })
        })
        .collect()
}

/// Whether the body's top and underside are level and as large as the body: the faces at its greatest and
/// its smallest height cover the footprint. A table, whose legs leave air below, is no slab.
fn is_level_slab(body: &BodyFrame, (low, high): Bounds) -> bool {
    let tolerance = 1e-4 * longest_side((low, high));
    let at = |corner: u32| body.positions_m.get(corner as usize).map(|p| Vec3::from(*p));
    let (mut top_m2, mut underside_m2) = (0.0, 0.0);
    for triangle in &body.surface.triangles {
        let [Some(a), Some(b), Some(c)] = triangle.map(at) else {
            return false;
        };
        let upward_m2 = 0.5 * (b - a).cross(c - a).z;
        if a.z.min(b.z).min(c.z) > high.z - tolerance {
            top_m2 += upward_m2.max(0.0);
        }
        if a.z.max(b.z).max(c.z) < low.z + tolerance {
            underside_m2 += (-upward_m2).max(0.0);
        }
    }
    let size = high - low;
    let covered_m2 = f32::min(top_m2, underside_m2);
    covered_m2 > 0.0 && covered_m2 > 0.95 * size.x * size.y
}

fn points_of(body: &BodyFrame) -> impl Iterator<Item = Vec3> + '_ {
    let points = body.positions_m.iter().map(|p| Vec3::from(*p));
    points.filter(|p| p.is_finite())
}

fn bounds_of(body: &BodyFrame) -> Option<Bounds> {
    points_of(body).map(|p| (p, p)).reduce(union)
}

fn union(a: Bounds, b: Bounds) -> Bounds {
    (a.0.min(b.0), a.1.max(b.1))
}

fn clipped(bounds: Bounds, limit: Bounds) -> Bounds {
    (bounds.0.clamp(limit.0, limit.1), bounds.1.clamp(limit.0, limit.1))
}

/// The box grown on every side by a multiple of its longest side.
fn widened(bounds: Bounds, times: f32) -> Bounds {
    let reach = Vec3::splat(times * longest_side(bounds));
    (bounds.0 - reach, bounds.1 + reach)
}

fn longest_side((low, high): Bounds) -> f32 {
    (high - low).max_element()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::frame::SurfaceTopology;
    use std::sync::Arc;

    /// Only the top and bottom of a box: enough for framing.
    fn slab(role: BodyRole, low: Vec3, high: Vec3) -> BodyFrame {
        BodyFrame {
            role,
            positions_m: corners((low, high)).map(Vec3::into).to_vec(),
            surface: Arc::new(SurfaceTopology {
                triangles: vec![[4, 5, 7], [4, 7, 6], [0, 3, 1], [0, 2, 3]],
                ..Default::default()
            }),
            ..Default::default()
        }
    }

    fn frame(bodies: Vec<BodyFrame>) -> Frame {
        Frame { bodies, ..Default::default() }
    }

    #[test]
    fn large_level_body_below_becomes_the_floor() {
        let ground = slab(BodyRole::Fixed, Vec3::new(-5.0, -5.0, -0.2), Vec3::new(5.0, 5.0, 0.1));
        let cube = slab(BodyRole::Deformable, Vec3::splat(0.5), Vec3::splat(1.5));
        let floor = Framing::of(&frame(vec![cube, ground])).floor().unwrap();
        assert_eq!((floor.height_m, floor.replaces), (0.1, Some(1)));
    }

    #[test]
    fn without_gravity_only_a_slab_is_a_floor() {
        let ground = slab(BodyRole::Fixed, Vec3::new(-5.0, -5.0, -0.2), Vec3::new(5.0, 5.0, 0.1));
        let cube = slab(BodyRole::Deformable, Vec3::splat(0.5), Vec3::splat(1.5));
        let floor = |bodies| Framing::of(&Frame { is_weightless: true, ..frame(bodies) }).floor();
        assert_eq!(floor(vec![cube.clone()]), None);
        assert_eq!(floor(vec![cube, ground]).unwrap().replaces, Some(1));
    }

    #[test]
    fn small_or_high_fixed_bodies_stay_bodies() {
        let anvil = slab(BodyRole::Fixed, Vec3::ZERO, Vec3::splat(0.4));
        let cube = slab(BodyRole::Deformable, Vec3::splat(-0.5), Vec3::splat(1.5));
        let floor = Framing::of(&frame(vec![anvil, cube])).floor().unwrap();
        assert_eq!((floor.height_m, floor.replaces), (-0.7, None));
    }

    #[test]
    fn what_stands_on_the_ground_is_no_floor() {
        let ground = slab(BodyRole::Fixed, Vec3::new(-5.0, -5.0, -0.2), Vec3::new(5.0, 5.0, 0.0));
        let plinth = slab(BodyRole::Fixed, Vec3::new(-2.0, -2.0, 0.0), Vec3::new(2.0, 2.0, 0.4));
        let cube = slab(BodyRole::Deformable, Vec3::splat(0.5), Vec3::splat(1.5));
        let floor = Framing::of(&frame(vec![plinth.clone(), ground, cube.clone()])).floor().unwrap();
        assert_eq!((floor.height_m, floor.replaces), (0.0, Some(1)));
        // Nothing but legs below: the top alone.
        let mut table = plinth;
        let surface = Arc::make_mut(&mut table.surface);
        surface.triangles.retain(|triangle| triangle.iter().all(|corner| *corner >= 4));
        let floor = Framing::of(&frame(vec![table, cube])).floor().unwrap();
        assert_eq!((floor.height_m, floor.replaces), (0.0, None));
    }

    #[test]
    fn body_that_falls_past_the_slab_unmakes_the_floor() {
        let table = slab(BodyRole::Fixed, Vec3::new(-2.0, -2.0, -0.2), Vec3::new(2.0, 2.0, 0.0));
        let above = slab(BodyRole::Deformable, Vec3::splat(0.1), Vec3::splat(0.6));
        let below = slab(BodyRole::Deformable, Vec3::new(2.1, 0.0, -1.0), Vec3::new(2.6, 0.5, -0.5));
        let mut framing = Framing::of(&frame(vec![table.clone(), above]));
        assert!(framing.floor().unwrap().replaces.is_some());
        framing.include(&frame(vec![table, below]));
        let floor = framing.floor().unwrap();
        assert_eq!((floor.height_m, floor.replaces), (-1.05, None));
    }

    #[test]
    fn long_fall_does_not_shrink_the_body_to_a_dot() {
        let at = |z: f32| {
            let low = Vec3::new(0.0, 0.0, z);
            frame(vec![slab(BodyRole::Deformable, low, low + 0.2)])
        };
        let mut framing = Framing::of(&at(10.0));
        framing.include(&at(0.0));
        let heights = framing.shown_points_m().into_iter().map(|p| p.z);
        let (low, high) = heights.fold((9.0, -9.0), |(l, h): (f32, f32), z| (l.min(z), h.max(z)));
        assert!(high - low < 1.0 && (-0.1..=0.0).contains(&low), "{low} {high}");
    }

    #[test]
    fn nothing_to_draw_gives_the_default_camera() {
        let framing = Framing::of(&Frame::default());
        assert_eq!(framing.floor(), None);
        assert_eq!(framing.camera(NamedView::Front, 1.5), Camera::default());
    }
}
