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
    /// Time of the first impulse, s. An impulse acts at the start of its step.
    pub begin_s: f64,
    /// Time of the last impulse so far, s.
    pub end_s: f64,
    /// When the impulse was complete but for a thousandth, s: the end of the collision proper. Bodies that
    /// shake after it may graze each other once more, which says nothing about its length.
    pub impulse_end_s: f64,
    /// Length of the pulse of constant force with the same standard deviation in time, `sqrt(12)` times that, s. For
    /// the rectangular pulse of wave theory it is the length of the collision, and unlike the time of the last
    /// impulse it does not hang on one step.
    pub pulse_length_s: f64,
    /// Impulse on the first body, N s.
    pub impulse_n_s: DVec3,
    /// Sum of the lengths of the pairs' impulses, N s.
    pub impulse_length_n_s: f64,
}

/// All contacts so far.
#[derive(Clone, Debug, Default)]
pub(super) struct ContactLog {
    pub episodes: Vec<ContactEpisode>,
    /// Of each episode (time, sum of impulse lengths so far), without what came before the last thousandth.
    tails: Vec<VecDeque<(f64, f64)>>,
    /// Of each episode the first and second moment of the impulses' lengths about its begin, N s2 and N s3.
    moments: Vec<[f64; 2]>,
}

/// Share of the impulse that may be missing at `impulse_end_s`.
const IMPULSE_MISSING: f64 = 1e-3;

impl ContactLog {
    pub fn record(&mut self, c: &Constraint, start_s: f64, step_s: f64) {
        let [a, b] = c.bodies.map(|b| b as usize);
        let (bodies, sign) = if a <= b { ([a, b], 1.0) } else { ([b, a], -1.0) };
        let is_current = |e: &ContactEpisode| e.bodies == bodies && start_s - e.end_s <= GAP_STEPS * step_s;
        let index = self.episodes.iter().rposition(is_current).unwrap_or_else(|| self.open(bodies, start_s));
        let length_n_s = c.impulse_n_s.length();
        let episode = &mut self.episodes[index];
        episode.end_s = start_s;
        episode.impulse_n_s += c.impulse_n_s * sign;
        episode.impulse_length_n_s += length_n_s;
        let sum = episode.impulse_length_n_s;
        let (since_s, [first, second]) = (start_s - episode.begin_s, &mut self.moments[index]);
        *first += length_n_s * since_s;
        *second += length_n_s * since_s * since_s;
        let variance_s2 = (*second / sum - (*first / sum).powi(2)).max(0.0);
        episode.pulse_length_s = (12.0 * variance_s2).sqrt();
        let tail = &mut self.tails[index];
        tail.push_back((start_s, sum));
        while tail.front().is_some_and(|(_, so_far)| *so_far < (1.0 - IMPULSE_MISSING) * sum) {
            tail.pop_front();
        }
        episode.impulse_end_s = tail.front().map_or(start_s, |(time_s, _)| *time_s);
    }

    /// A new episode; returns its number.
    fn open(&mut self, bodies: [usize; 2], start_s: f64) -> usize {
        self.episodes.push(ContactEpisode {
            bodies,
            begin_s: start_s,
            end_s: start_s,
            impulse_end_s: start_s,
            pulse_length_s: 0.0,
            impulse_n_s: DVec3::ZERO,
            impulse_length_n_s: 0.0,
        });
        self.tails.push(VecDeque::new());
        self.moments.push([0.0; 2]);
        self.episodes.len() - 1
    }
}
