//! When which bodies were in contact, and how hard.

use crate::contact::Constraint;
use glam::DVec3;

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
    /// Impulse on the first body, N s.
    pub impulse_n_s: DVec3,
    /// Sum of the lengths of the pairs' impulses, N s.
    pub impulse_length_n_s: f64,
}

/// All contacts so far.
#[derive(Clone, Debug, Default)]
pub(super) struct ContactLog {
    pub episodes: Vec<ContactEpisode>,
}

impl ContactLog {
    pub fn record(&mut self, c: &Constraint, time_s: f64, step_s: f64) {
        let [a, b] = c.bodies.map(|b| b as usize);
        let (bodies, sign) = if a <= b { ([a, b], 1.0) } else { ([b, a], -1.0) };
        let current = self
            .episodes
            .iter_mut()
            .rev()
            .find(|e| e.bodies == bodies)
            .filter(|e| time_s - e.end_s <= GAP_STEPS * step_s);
        let episode = match current {
            Some(episode) => episode,
            None => {
                self.episodes.push(ContactEpisode {
                    bodies,
                    begin_s: time_s - step_s,
                    end_s: time_s,
                    impulse_n_s: DVec3::ZERO,
                    impulse_length_n_s: 0.0,
                });
                self.episodes.last_mut().expect("just pushed")
            }
        };
        episode.end_s = time_s;
        episode.impulse_n_s += c.impulse_n_s * sign;
        episode.impulse_length_n_s += c.impulse_n_s.length();
    }
}
