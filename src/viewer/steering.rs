//! How finely the scene is drawn while things move, steered by how long frames take.
//!
//! A fast machine never notices. On a slow one the scene is drawn less finely, and new moments of a large scene come
//! less often, so that the window goes on answering; as soon as everything stands still the picture is drawn again as
//! finely as files are. No clock is read here: times come in, so that tests can make them up.

use crate::render::Quality;
use std::time::Duration;

/// Frames that take longer than this are too slow: an answer takes up to one frame, and the layout of the next.
const SLOW: Duration = Duration::from_millis(36);
/// Frames that take less may be drawn more finely: levels differ by a factor of up to two and a half, and one that turns
/// out too slow is left again.
const QUICK: Duration = Duration::from_millis(20);
/// Slow frames in a row after which the level falls; a single one may be due to anything.
const SLOW_FRAMES: u32 = 2;
/// Quick frames in a row after which the level rises, at first ...
const PATIENCE: u32 = 40;
/// ... and at most: a level that turned out too slow is tried again ever less often.
const LONGEST_PATIENCE: u32 = 2560;
/// Frames that a level has to hold after a rise until what was too slow before is forgotten.
const HELD: u32 = 4 * PATIENCE;
/// How long the picture has to stand still before it is drawn finely, which may take a while ...
const REST: Duration = Duration::from_millis(250);
/// ... and how long while time runs, so that the next moment is about to come.
const REST_BETWEEN_MOMENTS: Duration = Duration::from_millis(1000);

/// From the finest to the quickest, and what they are called.
const LEVELS: [(Quality, &str); 4] = [
    (Quality::FULL, "full"),
    (Quality::draft([1, 1]), "draft"),
    (Quality::draft([2, 3]), "draft, 2/3"),
    (Quality::draft([1, 2]), "draft, 1/2"),
];

/// The level, and what it was found by.
#[derive(Clone, Debug)]
pub struct Steering {
    level: usize,
    slow: u32,
    quick: u32,
    patience: u32,
    /// Frames since the level rose, while it holds.
    since_rise: u32,
    moved_at: Duration,
    /// Before this, no new moment is drawn.
    next_moment_at: Duration,
}

impl Default for Steering {
    fn default() -> Self {
        Self {
            level: 0,
            slow: 0,
            quick: 0,
            patience: PATIENCE,
            since_rise: u32::MAX,
            moved_at: Duration::ZERO,
            next_moment_at: Duration::ZERO,
        }
    }
}

impl Steering {
    /// How finely to draw what moves.
    #[must_use]
    pub fn in_motion(&self) -> Quality {
        LEVELS[self.level].0
    }

    /// What that is called; `None` where it is the best.
    #[must_use]
    pub fn name(&self) -> Option<&'static str> {
        (self.level > 0).then_some(LEVELS[self.level].1)
    }

    /// Something else is to be seen, at this time.
    pub fn moved(&mut self, now: Duration) {
        self.moved_at = now;
    }

    /// What is drawn now says nothing about what was too slow before: another scene, another size.
    pub fn begin_anew(&mut self) {
        self.patience = PATIENCE;
    }

    /// How long everything has to stand still yet before it is drawn finely; `None` when it has stood so long.
    #[must_use]
    pub fn until_rest(&self, now: Duration, is_playing: bool) -> Option<Duration> {
        let rest = if is_playing { REST_BETWEEN_MOMENTS } else { REST };
        (self.moved_at + rest).checked_sub(now).filter(|left| !left.is_zero())
    }

    /// How long a new moment has to wait yet; `None` when it may be drawn.
    #[must_use]
    pub fn until_moment(&self, now: Duration) -> Option<Duration> {
        self.next_moment_at.checked_sub(now).filter(|left| !left.is_zero())
    }

    /// A frame in which the scene was drawn in motion took so long and ended now; `is_new` says whether it brought a
    /// new moment.
    pub fn took(&mut self, time: Duration, now: Duration, is_new: bool) {
        if is_new {
            // At least half of the time is left for frames that are quicker.
            let pause = if time > SLOW { time } else { Duration::ZERO };
            self.next_moment_at = now + pause;
        }
        self.since_rise = self.since_rise.saturating_add(1);
        if self.since_rise == HELD {
            self.patience = PATIENCE;
        }
        self.slow = if time > SLOW { self.slow + 1 } else { 0 };
        self.quick = if time < QUICK { self.quick + 1 } else { 0 };
        if self.slow >= SLOW_FRAMES && self.level + 1 < LEVELS.len() {
            if self.since_rise < PATIENCE {
                self.patience = (2 * self.patience).min(LONGEST_PATIENCE);
            }
            self.since_rise = u32::MAX;
            self.go_to(self.level + 1);
        } else if self.quick >= self.patience && self.level > 0 {
            self.go_to(self.level - 1);
            self.since_rise = 0;
        }
    }

    fn go_to(&mut self, level: usize) {
        self.level = level;
        self.slow = 0;
        self.quick = 0;
    }
}

/// The part of a frame's time that is work: not the wait for the screen's next refresh. What a frame waits longer than
/// `refresh` it waits for the device, which is busy with the one before.
#[must_use]
pub fn without_wait(time: Duration, waited: Duration, refresh: Duration) -> Duration {
    time.saturating_sub(waited.min(refresh))
}

#[cfg(test)]
mod tests {
    use super::*;

    const MS: Duration = Duration::from_millis(1);

    /// Frames that take so long each, at one level; returns the levels.
    fn run(steering: &mut Steering, frames: u32, time: impl Fn(Quality) -> Duration) -> Vec<usize> {
        let mut now = Duration::ZERO;
        let frame = |_| {
            let took = time(steering.in_motion());
            now += took;
            steering.took(took, now, false);
            steering.level
        };
        (0..frames).map(frame).collect()
    }

    #[test]
    fn a_fast_machine_draws_everything_finely() {
        let mut steering = Steering::default();
        assert!(run(&mut steering, 1000, |_| 15 * MS).iter().all(|level| *level == 0));
        assert_eq!((steering.in_motion(), steering.name()), (Quality::FULL, None));
        // One slow frame is no reason.
        steering.took(900 * MS, Duration::ZERO, false);
        assert_eq!(run(&mut steering, 1, |_| 15 * MS), [0]);
    }

    #[test]
    fn a_slow_machine_draws_less_finely_until_it_answers_and_stays_there() {
        let mut steering = Steering::default();
        let time = |quality: Quality| if quality.scale == [2, 3] { 30 * MS } else { 90 * MS };
        let levels = run(&mut steering, 500, time);
        assert_eq!(levels[..4], [0, 1, 1, 2]);
        assert!(levels[4..].iter().all(|level| *level == 2), "{levels:?}");
        assert_eq!(steering.name(), Some("draft, 2/3"));
        // Slower than all levels, it stays at the quickest.
        assert_eq!(run(&mut steering, 50, |_| 90 * MS).last(), Some(&(LEVELS.len() - 1)));
    }

    #[test]
    fn what_was_too_slow_is_tried_again_ever_less_often() {
        let mut steering = Steering::default();
        let time = |quality: Quality| if quality.is_draft { 10 * MS } else { 90 * MS };
        let levels = run(&mut steering, 8000, time);
        let rises: Vec<usize> = (1..levels.len()).filter(|i| levels[*i] < levels[i - 1]).collect();
        assert!((3..12).contains(&rises.len()), "{rises:?}");
        assert!(rises.windows(3).all(|r| r[2] - r[1] >= r[1] - r[0]), "{rises:?}");
    }

    #[test]
    fn a_machine_that_gets_free_draws_finely_again() {
        let mut steering = Steering::default();
        run(&mut steering, 20, |_| 90 * MS);
        assert_eq!(run(&mut steering, 4 * PATIENCE, |_| 5 * MS).last(), Some(&0));
    }

    #[test]
    fn a_level_that_holds_or_another_scene_make_what_was_too_slow_worth_a_try() {
        let slow_once_fine = |quality: Quality| if quality.is_draft { 10 * MS } else { 90 * MS };
        let impatient = || {
            let mut steering = Steering::default();
            run(&mut steering, 2000, slow_once_fine);
            assert!(steering.patience > 8 * PATIENCE);
            steering
        };
        let mut other_scene = impatient();
        other_scene.begin_anew();
        let levels = run(&mut other_scene, PATIENCE + 1, |_| 10 * MS);
        assert_eq!(levels.last(), Some(&0));
        let mut held = impatient();
        run(&mut held, LONGEST_PATIENCE + HELD, |_| 10 * MS);
        run(&mut held, 2, |_| 90 * MS);
        assert_eq!(run(&mut held, PATIENCE, |_| 10 * MS).last(), Some(&0));
    }

    #[test]
    fn waiting_for_the_screen_is_no_work_and_for_the_device_is() {
        assert_eq!(without_wait(43 * MS, 40 * MS, 42 * MS), 3 * MS);
        assert_eq!(without_wait(60 * MS, 57 * MS, 16 * MS), 44 * MS);
        assert_eq!(without_wait(5 * MS, 9 * MS, 16 * MS), Duration::ZERO);
    }

    #[test]
    fn rest_is_when_nothing_has_moved_for_a_while() {
        let mut steering = Steering::default();
        steering.moved(1000 * MS);
        assert_eq!(steering.until_rest(1000 * MS, false), Some(REST));
        assert_eq!(steering.until_rest(1100 * MS, false), Some(REST - 100 * MS));
        assert_eq!(steering.until_rest(1000 * MS + REST, false), None);
        steering.moved(1200 * MS);
        assert_eq!(steering.until_rest(1200 * MS, false), Some(REST));
        // While time runs, more is about to come.
        assert_eq!(steering.until_rest(1200 * MS + REST, true), Some(REST_BETWEEN_MOMENTS - REST));
    }

    #[test]
    fn slow_moments_leave_half_of_the_time_to_other_frames() {
        let mut steering = Steering::default();
        steering.took(20 * MS, 100 * MS, true);
        assert_eq!(steering.until_moment(100 * MS), None);
        steering.took(80 * MS, 200 * MS, true);
        assert_eq!(steering.until_moment(210 * MS), Some(70 * MS));
        // Frames without a new moment do not put it off further.
        steering.took(50 * MS, 260 * MS, false);
        assert_eq!(steering.until_moment(280 * MS), None);
    }
}
