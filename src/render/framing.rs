//! What the camera and the floor must take in, over a whole animation.

use crate::frame::{BodyFrame, BodyRole, Frame};
use crate::render::camera::{Camera, NamedView};
use glam::Vec3;

/// Share of the picture left free at each side by the automatic camera.
const MARGIN: f32 = 0.1;
/// How far the automatic camera follows a long flight: multiples of the largest extent of what
/// is there in the last frame. A hammer that falls from ten metres enters from above instead of
/// being a dot.
const LONGEST_FLIGHT: f32 = 2.5;
/// Fixed bodies larger than this many times the moving ones do not widen the picture.
const LARGEST_FIXED: f32 = 2.0;

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
    fixed: Vec<FixedBody>,
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

    /// Takes in a further frame, later than all before.
    pub fn include(&mut self, frame: &Frame) {
        self.fixed = fixed_bodies(frame);
        let moving = frame
            .bodies
            .iter()
            .filter(|body| body.role != BodyRole::Fixed)
            .filter_map(bounds_of)
            .reduce(union);
        self.last_moving = moving.or(self.last_moving);
        self.moving = [self.moving, moving].into_iter().flatten().reduce(union);
    }

    /// The floor: in place of a large level fixed body below everything that moves, else under
    /// the lowest point of all; `None` when there is nothing to draw.
    #[must_use]
    pub fn floor(&self) -> Option<Floor> {
        let ground = self.fixed.iter().filter(|body| self.is_ground(body));
        let highest = ground.max_by(|a, b| a.bounds.1.z.total_cmp(&b.bounds.1.z));
        if let Some(body) = highest {
            return Some(Floor {
                height_m: body.bounds.1.z,
                replaces: Some(body.index),
            });
        }
        let fixed = self.fixed.iter().map(|body| body.bounds);
        let (low, _) = fixed.chain(self.moving).reduce(union)?;
        Some(Floor {
            height_m: low.z,
            replaces: None,
        })
    }

    fn is_ground(&self, body: &FixedBody) -> bool {
        let Some((low, high)) = self.moving else {
            return false;
        };
        let size = (high - low).max_element();
        let (fixed_low, fixed_high) = body.bounds;
        let reaches_under = fixed_low.x <= low.x
            && fixed_low.y <= low.y
            && fixed_high.x >= high.x
            && fixed_high.y >= high.y;
        body.is_level_slab && reaches_under && fixed_high.z <= low.z + 0.02 * size
    }

    /// The box the automatic camera shows, metres; `None` when there is nothing to draw.
    #[must_use]
    pub fn shown_m(&self) -> Option<Bounds> {
        let floor = self.floor();
        let is_floor = |body: &FixedBody| floor.and_then(|f| f.replaces) == Some(body.index);
        let Some(moving) = self.moving_shown() else {
            return self.fixed.iter().map(|body| body.bounds).reduce(union);
        };
        let mut shown = moving;
        for body in self.fixed.iter().filter(|body| !is_floor(body)) {
            shown = union(shown, clipped(body.bounds, widened(moving, LARGEST_FIXED)));
        }
        if let Some(floor) = floor {
            // The floor belongs to the picture if it is near.
            let near = moving.0.z - LARGEST_FIXED * longest_side(moving);
            shown.0.z = shown.0.z.min(floor.height_m.max(near));
        }
        Some(shown)
    }

    fn moving_shown(&self) -> Option<Bounds> {
        let (all, last) = (self.moving?, self.last_moving?);
        Some(clipped(all, widened(last, LONGEST_FLIGHT)))
    }

    /// The automatic camera: sees everything, from a named direction; `aspect` is the picture's
    /// width over its height. Without anything to see it is the default camera.
    #[must_use]
    pub fn camera(&self, view: NamedView, aspect: f32) -> Camera {
        match self.shown_m() {
            Some(bounds) => Camera::framing(bounds, view.angles_rad(), aspect, MARGIN),
            None => Camera::default(),
        }
    }
}

fn fixed_bodies(frame: &Frame) -> Vec<FixedBody> {
    let bodies = frame.bodies.iter().enumerate();
    bodies
        .filter(|(_, body)| body.role == BodyRole::Fixed)
        .filter_map(|(index, body)| {
            let bounds = bounds_of(body)?;
            Some(FixedBody {
                index,
                bounds,
                is_level_slab: is_level_slab(body, bounds),
            })
        })
        .collect()
}

/// Whether the body's top is level and as large as the body: its upward faces at the greatest
/// height cover the footprint.
fn is_level_slab(body: &BodyFrame, (low, high): Bounds) -> bool {
    let tolerance = 1e-4 * longest_side((low, high));
    let at = |corner: u32| {
        body.positions_m
            .get(corner as usize)
            .map(|p| Vec3::from(*p))
    };
    let mut covered_m2 = 0.0;
    for triangle in &body.surface.triangles {
        let [Some(a), Some(b), Some(c)] = triangle.map(at) else {
            return false;
        };
        if a.z.min(b.z).min(c.z) > high.z - tolerance {
            covered_m2 += (0.5 * (b - a).cross(c - a).z).max(0.0);
        }
    }
    let size = high - low;
    covered_m2 > 0.0 && covered_m2 > 0.95 * size.x * size.y
}

fn bounds_of(body: &BodyFrame) -> Option<Bounds> {
    let points = body.positions_m.iter().map(|p| Vec3::from(*p));
    points
        .filter(|p| p.is_finite())
        .map(|p| (p, p))
        .reduce(union)
}

fn union(a: Bounds, b: Bounds) -> Bounds {
    (a.0.min(b.0), a.1.max(b.1))
}

fn clipped(bounds: Bounds, limit: Bounds) -> Bounds {
    (
        bounds.0.clamp(limit.0, limit.1),
        bounds.1.clamp(limit.0, limit.1),
    )
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
        let corner = |i: usize| {
            let pick = |bit: usize, axis: usize| if i & bit == 0 { low[axis] } else { high[axis] };
            [pick(1, 0), pick(2, 1), pick(4, 2)]
        };
        BodyFrame {
            role,
            positions_m: (0..8).map(corner).collect(),
            surface: Arc::new(SurfaceTopology {
                triangles: vec![[4, 5, 7], [4, 7, 6], [0, 3, 1], [0, 2, 3]],
                ..Default::default()
            }),
            ..Default::default()
        }
    }

    fn frame(bodies: Vec<BodyFrame>) -> Frame {
        Frame {
            bodies,
            ..Default::default()
        }
    }

    #[test]
    fn large_level_body_below_becomes_the_floor() {
        let ground = slab(
            BodyRole::Fixed,
            Vec3::new(-5.0, -5.0, -0.2),
            Vec3::new(5.0, 5.0, 0.1),
        );
        let cube = slab(BodyRole::Deformable, Vec3::splat(0.5), Vec3::splat(1.5));
        let floor = Framing::of(&frame(vec![cube, ground])).floor().unwrap();
        assert_eq!((floor.height_m, floor.replaces), (0.1, Some(1)));
    }

    #[test]
    fn small_or_high_fixed_bodies_stay_bodies() {
        let anvil = slab(BodyRole::Fixed, Vec3::ZERO, Vec3::splat(0.4));
        let cube = slab(BodyRole::Deformable, Vec3::splat(-0.5), Vec3::splat(1.5));
        let floor = Framing::of(&frame(vec![anvil, cube])).floor().unwrap();
        assert_eq!((floor.height_m, floor.replaces), (-0.5, None));
    }

    #[test]
    fn body_that_falls_past_the_slab_unmakes_the_floor() {
        let table = slab(
            BodyRole::Fixed,
            Vec3::new(-2.0, -2.0, -0.2),
            Vec3::new(2.0, 2.0, 0.0),
        );
        let above = slab(BodyRole::Deformable, Vec3::splat(0.1), Vec3::splat(0.6));
        let below = slab(
            BodyRole::Deformable,
            Vec3::new(2.1, 0.0, -1.0),
            Vec3::new(2.6, 0.5, -0.5),
        );
        let mut framing = Framing::of(&frame(vec![table.clone(), above]));
        assert!(framing.floor().unwrap().replaces.is_some());
        framing.include(&frame(vec![table, below]));
        assert_eq!(framing.floor().unwrap().height_m, -1.0);
    }

    #[test]
    fn long_fall_does_not_shrink_the_body_to_a_dot() {
        let at = |z: f32| {
            let low = Vec3::new(0.0, 0.0, z);
            frame(vec![slab(BodyRole::Deformable, low, low + 0.2)])
        };
        let mut framing = Framing::of(&at(10.0));
        framing.include(&at(0.0));
        let (low, high) = framing.shown_m().unwrap();
        assert!(high.z - low.z < 1.0 && low.z == 0.0, "{low} {high}");
    }

    #[test]
    fn nothing_to_draw_gives_the_default_camera() {
        let framing = Framing::of(&Frame::default());
        assert_eq!(framing.floor(), None);
        assert_eq!(framing.camera(NamedView::Front, 1.5), Camera::default());
    }
}
