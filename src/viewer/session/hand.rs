//! Pulling at a body with the mouse: a spring from the grabbed point to where the mouse is.
//!
//! The path of the mouse is written down with the times of the simulation, each point before it is needed and never
//! changed afterwards. So the same path, read from a saved scene, gives the same bytes.

use super::course::Place;
use super::edit_tree::Done;
use super::{Run, Session};
use crate::math::{to_digits, vector_to_digits_of};
use crate::mesh::bounds_m;
use crate::sim::{PathPoint, Pull};
use glam::DVec3;

/// Time in which a pulled body follows, s of wall time.
const FOLLOW_S: f64 = 0.06;
/// Time in which the spring's end goes to where the mouse is, s of wall time.
const REACH_S: f64 = 0.03;
/// Digits of the size of a body to which its points are written down: the mouse is no finer.
const POINT_DIGITS: u32 = 5;
/// Most points of a path: nobody pulls for that long.
const MOST_POINTS: usize = 100_000;

/// The mouse that holds a body.
pub(super) struct Hand {
    /// Number of the edit that grabbed.
    edit: usize,
    /// Where the mouse is, m.
    to_m: DVec3,
    /// Size of the body that it holds, m.
    size_m: f64,
}

fn size_m(nodes_m: &[DVec3]) -> f64 {
    bounds_m(nodes_m).map_or(0.0, |(low, high)| (high - low).max_element())
}

impl Session {
    /// Grabs the point of an element, as it is now, and pulls it after the mouse. Time runs from then on.
    pub(super) fn grab(&mut self, (body, element): (usize, u32), point_m: DVec3, to_m: DVec3) {
        self.let_go();
        let speed = self.speed_now();
        let (Some(run), None) = (&mut self.course.run, &self.course.run_error) else { return };
        let Some(at_m) = run.world.grabbed_point_m(body, element, point_m) else { return };
        let Some(name) = run.world.setup().bodies.get(body).map(|body| body.name.clone()) else { return };
        let time_s = run.world.time_s();
        let size_m = size_m(run.world.positions_m(body));
        let [point_m, to_m] = [point_m, to_m].map(|x| vector_to_digits_of(x, size_m, POINT_DIGITS));
        let what = format!("{name} pulled");
        let pull = Pull {
            body: name,
            at_m,
            follow_s: to_digits(FOLLOW_S * speed, 4),
            path: vec![PathPoint { time_s, point_m }],
            until_s: f64::INFINITY,
        };
        let edit = self.course.edits.len();
        if self.edit(Done::Pull(pull), what) {
            self.hand = Some(Hand { edit, to_m, size_m });
            self.set_playing(true);
        }
    }

    /// The mouse has moved.
    pub(super) fn drag(&mut self, to_m: DVec3) {
        if let Some(hand) = self.hand.as_mut().filter(|_| to_m.is_finite()) {
            hand.to_m = vector_to_digits_of(to_m, hand.size_m, POINT_DIGITS);
        }
    }

    /// Before a step: the path goes on to where the mouse is.
    pub(super) fn lead_hand(&mut self) {
        let reach_s = REACH_S * self.speed_now();
        let (Some(hand), Some(Run { world, .. })) = (&self.hand, &mut self.course.run) else { return };
        let Some(pull) = self.course.edits.pull_mut(hand.edit) else { return };
        let (now_s, Some(last)) = (world.time_s(), pull.path.last().copied()) else { return };
        let next_s = now_s + reach_s;
        let is_waiting = now_s < last.time_s || next_s <= now_s;
        if is_waiting || hand.to_m == last.point_m || pull.path.len() >= MOST_POINTS {
            return;
        }
        if now_s > last.time_s {
            pull.path.push(PathPoint { time_s: now_s, ..last });
        }
        pull.path.push(PathPoint { time_s: next_s, point_m: hand.to_m });
        world.renew_pull(pull);
    }

    /// Lets go. A pull in which no time has passed never was.
    pub(super) fn let_go(&mut self) {
        let (Some(hand), Some(run)) = (self.hand.take(), &mut self.course.run) else { return };
        let now_s = run.world.time_s();
        let Some(pull) = self.course.edits.pull_mut(hand.edit) else { return };
        pull.until_s = now_s;
        run.world.renew_pull(pull);
        if now_s <= pull.begins_s() {
            // Not even woken.
            if self.go_back(Place { time_s: now_s, edits: hand.edit }) {
                self.course.edits.forget_next();
            }
        }
    }
}
