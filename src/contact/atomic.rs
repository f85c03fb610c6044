//! The atomic case of collision detection: one node against one patch over one step.
//!
//! METHOD 4.2, Tables 4.1 and 4.2 of the source thesis. The node moves from `e` to `f`, the patch from
//! `a0 b0 c0` to `a b c`. The line through `e` and `f` meets the end patch's plane in `d` and the start
//! patch's plane in `d0`; where these lie on the line (`t3 < 0` beyond e, within [0, 1] between,
//! `t3 > 1` beyond f) and which way the node moves along the outward normal decides.
//!
//! The table is not invariant to a common motion of node and patch (a patch that overtakes a slower node
//! from behind falls under "as in the last step"), so callers give it the path *relative to the
//! patch*: see [`mod@super::detect`].

use super::geometry::unit_normal;
use glam::DVec3;

/// Where a point lies on the line from `e` (0) to `f` (1).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Place {
    /// `t3 < 0`.
    BeyondE,
    /// `0 <= t3 <= 1`.
    Between,
    /// `t3 > 1`.
    BeyondF,
}

/// How the beginning of the collision is found.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Pattern {
    /// The patch is fixed: one equation for the node's path.
    FixedPatch,
    /// The patch moves: coplanarity of four moving points.
    MovingPatch,
}

/// What the table says.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Verdict {
    /// A collision begins within the step.
    Collides(Pattern),
    /// The pair collides if it did in the last step.
    AsInLastStep,
    /// No collision.
    No,
}

/// One node and one patch over one step.
#[derive(Clone, Copy, Debug)]
pub struct AtomicCase {
    /// Node at the start, m.
    pub e: DVec3,
    /// Node at the end, m.
    pub f: DVec3,
    /// Patch corners at the start, counter-clockwise from outside, m.
    pub patch_start: [DVec3; 3],
    /// Patch corners at the end, m.
    pub patch_end: [DVec3; 3],
}

impl AtomicCase {
    /// Looks the case up in the table. Whether the meeting point lies within the patch is decided at
    /// the time of meeting, not here.
    #[must_use]
    pub fn verdict(&self) -> Verdict {
        let path = self.f - self.e;
        let is_patch_still = self.patch_start == self.patch_end;
        if path == DVec3::ZERO {
            return self.verdict_of_still_node(is_patch_still);
        }
        let along_normal = path.dot(unit_normal(self.patch_end));
        let d = place_on_path(self.e, path, self.patch_end);
        if along_normal < 0.0 {
            self.verdict_of_entering_node(d, is_patch_still)
        } else if along_normal > 0.0 && d != Some(Place::BeyondF) {
            Verdict::No
        } else {
            Verdict::AsInLastStep
        }
    }

    fn verdict_of_entering_node(&self, d: Option<Place>, is_patch_still: bool) -> Verdict {
        let d0 = || place_on_path(self.e, self.f - self.e, self.patch_start);
        match d {
            Some(Place::Between) if is_patch_still => Verdict::Collides(Pattern::FixedPatch),
            Some(Place::Between) => Verdict::Collides(Pattern::MovingPatch),
            Some(Place::BeyondF) => Verdict::No,
            Some(Place::BeyondE) => match d0() {
                Some(Place::Between | Place::BeyondF) => Verdict::Collides(Pattern::MovingPatch),
                _ => Verdict::AsInLastStep,
            },
            None => Verdict::AsInLastStep,
        }
    }

    fn verdict_of_still_node(&self, is_patch_still: bool) -> Verdict {
        if is_patch_still {
            return Verdict::AsInLastStep;
        }
        let before = signed_distance(self.e, self.patch_start);
        let after = signed_distance(self.e, self.patch_end);
        if before >= 0.0 && after < 0.0 { Verdict::Collides(Pattern::MovingPatch) } else { Verdict::No }
    }
}

fn signed_distance(p: DVec3, patch: [DVec3; 3]) -> f64 {
    (p - patch[0]).dot(unit_normal(patch))
}

/// Place at which the line meets the patch's plane; `None` when they are parallel.
fn place_on_path(e: DVec3, path: DVec3, patch: [DVec3; 3]) -> Option<Place> {
    let normal = unit_normal(patch);
    let denominator = path.dot(normal);
    if denominator == 0.0 {
        return None;
    }
    let t3 = (patch[0] - e).dot(normal) / denominator;
    Some(if t3 < 0.0 {
        Place::BeyondE
    } else if t3 <= 1.0 {
        Place::Between
    } else {
        Place::BeyondF
    })
}

#[cfg(test)]
mod tests {
    //! Each row of the table of METHOD 4.2.
    use super::*;

    fn patch(z: f64) -> [DVec3; 3] {
        [DVec3::new(-1.0, -1.0, z), DVec3::new(2.0, -1.0, z), DVec3::new(-1.0, 2.0, z)]
    }

    fn verdict(from_z: f64, to_z: f64, patch_from: f64, patch_to: f64) -> Verdict {
        AtomicCase {
            e: DVec3::new(0.0, 0.0, from_z),
            f: DVec3::new(0.0, 0.0, to_z),
            patch_start: patch(patch_from),
            patch_end: patch(patch_to),
        }
        .verdict()
    }

    #[test]
    fn entering_d_between_fixed_patch_collides_by_pattern_1() {
        assert_eq!(verdict(1.0, -1.0, 0.0, 0.0), Verdict::Collides(Pattern::FixedPatch));
    }

    #[test]
    fn entering_d_between_moving_patch_collides_by_pattern_2() {
        assert_eq!(verdict(1.0, -1.0, -0.5, 0.0), Verdict::Collides(Pattern::MovingPatch));
    }

    #[test]
    fn entering_d_beyond_e_d0_between_collides_by_pattern_2() {
        assert_eq!(verdict(1.0, -1.0, 0.0, 2.0), Verdict::Collides(Pattern::MovingPatch));
    }

    #[test]
    fn entering_d_beyond_e_d0_beyond_f_collides_by_pattern_2() {
        assert_eq!(verdict(1.0, -1.0, -2.0, 2.0), Verdict::Collides(Pattern::MovingPatch));
    }

    #[test]
    fn entering_d_beyond_e_d0_beyond_e_is_as_in_the_last_step() {
        assert_eq!(verdict(1.0, -1.0, 2.0, 3.0), Verdict::AsInLastStep);
    }

    #[test]
    fn entering_d_beyond_f_does_not_collide_whatever_d0() {
        for patch_from in [-3.0, 0.0, 3.0] {
            assert_eq!(verdict(1.0, -1.0, patch_from, -2.0), Verdict::No);
        }
    }

    #[test]
    fn moving_along_the_patch_is_as_in_the_last_step() {
        let case = AtomicCase {
            e: DVec3::new(0.0, 0.0, 0.5),
            f: DVec3::new(0.3, 0.1, 0.5),
            patch_start: patch(0.0),
            patch_end: patch(0.0),
        };
        assert_eq!(case.verdict(), Verdict::AsInLastStep);
    }

    #[test]
    fn leaving_d_between_does_not_collide() {
        assert_eq!(verdict(-1.0, 1.0, 0.0, 0.0), Verdict::No);
    }

    #[test]
    fn leaving_d_beyond_e_does_not_collide() {
        assert_eq!(verdict(1.0, 2.0, 0.0, 0.0), Verdict::No);
    }

    #[test]
    fn leaving_d_beyond_f_is_as_in_the_last_step() {
        assert_eq!(verdict(-2.0, -1.0, 0.0, 0.0), Verdict::AsInLastStep);
    }

    #[test]
    fn still_node_still_patch_is_as_in_the_last_step() {
        assert_eq!(verdict(0.5, 0.5, 0.0, 0.0), Verdict::AsInLastStep);
    }

    #[test]
    fn still_node_moving_patch_goes_by_the_sign_of_the_distance() {
        assert_eq!(verdict(0.5, 0.5, 0.0, 1.0), Verdict::Collides(Pattern::MovingPatch));
        assert_eq!(verdict(0.5, 0.5, 0.0, 0.2), Verdict::No);
        assert_eq!(verdict(0.5, 0.5, 1.0, 0.0), Verdict::No);
    }
}
