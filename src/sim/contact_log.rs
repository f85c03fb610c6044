//! When which bodies were in contact, and how hard.

use crate::contact::Constraint;
use glam::DVec3;
use std::collections::VecDeque;

/// Contacts further apart in time than this many steps count as two.
const GAP_STEPS: f64 = 50.0;

/// One contact of two bodies, from first touch to separation.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ContactEpisode {
    /// The bodies, the smaller number first.
    pub bodies: [usize; 2],
    /// Begin of the first step in which they pressed, s.
    pub begin_s: f64,
    /// End of the last step in which they pressed, s.
    pub end_s: f64,
    /// When the impulse was complete but for a thousandth, s: the end of the collision proper. Bodies that
    /// shake after it may graze each other once more, which says nothing about its length.
    pub impulse_end_s: f64,
    /// Impulse on the first body, N s.
    pub impulse_n_s: DVec3,
    /// Sum of the lengths of the pairs' impulses, N s.
    pub impulse_length_n_s: f64,
}

/// All contacts so far.
#[derive(Clone, Debug, Default)]
pub(super) struct ContactLog {
    pub episodes: Vec<ContactEpisode>,
    /// Of each episode (end of step, sum of impulse lengths so far), without what came before the last thousandth.
    tails: Vec<VecDeque<(f64, f64)>>,
}

/// Share of the impulse that may be missing at `impulse_end_s`.
const IMPULSE_MISSING: f64 = 1e-3;

impl ContactLog {
    pub fn record(&mut self, c: &Constraint, time_s: f64, step_s: f64) {
        let [a, b] = c.bodies.map(|b| b as usize);
        let (bodies, sign) = if a <= b { ([a, b], 1.0) } else { ([b, a], -1.0) };
        let is_current = |e: &ContactEpisode| e.bodies == bodies && time_s - e.end_s <= GAP_STEPS * step_s;
        let index = self.episodes.iter().rposition(is_current).unwrap_or_else(|| {
            self.episodes.push(ContactEpisode {
                bodies,
                begin_s: time_s - step_s,
                end_s: time_s,
                impulse_end_s: time_s,
                impulse_n_s: DVec3::ZERO,
                impulse_length_n_s: 0.0,
            });
            self.tails.push(VecDeque::new());
            self.episodes.len() - 1
        });
        let (episode, tail) = (&mut self.episodes[index], &mut self.tails[index]);
        episode.end_s = time_s;
        episode.impulse_n_s += c.impulse_n_s * sign;
        episode.impulse_length_n_s += c.impulse_n_s.length();
        tail.push_back((time_s, episode.impulse_length_n_s));
        let complete = (1.0 - IMPULSE_MISSING) * episode.impulse_length_n_s;
        while tail.front().is_some_and(|(_, sum)| *sum < complete) {
            tail.pop_front();
        }
        episode.impulse_end_s = tail.front().map_or(time_s, |(time_s, _)| *time_s);
    }
}
