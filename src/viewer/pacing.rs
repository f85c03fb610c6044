//! How fast simulated time follows the clock on the wall.
//!
//! The moments at which the simulation stops for a picture depend on the speed and their number alone, never on
//! the clock: the clock only says when the next one is due. A slow machine falls behind; the debt is forgiven, so
//! that it never has to catch up.

use std::collections::VecDeque;

/// Wall time between pictures, s.
pub const FRAME_S: f64 = 1.0 / 60.0;

/// Slowest speed on offer, unless the scene asks for a slower one: simulated over wall time.
pub const SLOWEST: f64 = 1e-4;

/// Debt, in pictures, above which it is forgiven.
const LONGEST_DEBT: f64 = 3.0;

/// The moments to come, at one speed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Pace {
    speed: f64,
    from_time_s: f64,
    from_wall_s: f64,
    passed: u64,
}

impl Pace {
    /// Starts now, at `speed` simulated seconds a second.
    #[must_use]
    pub fn new(speed: f64, time_s: f64, wall_s: f64) -> Self {
        Self { speed, from_time_s: time_s, from_wall_s: wall_s, passed: 0 }
    }

    /// The next moment to stop at, s of simulated time.
    #[must_use]
    pub fn moment_s(&self) -> f64 {
        self.from_time_s + (self.passed + 1) as f64 * (self.speed * FRAME_S)
    }

    /// How long until the work for the next moment may begin, s of wall time; zero when it is due.
    #[must_use]
    pub fn wait_s(&self, wall_s: f64) -> f64 {
        (self.from_wall_s + self.passed as f64 * FRAME_S - wall_s).max(0.0)
    }

    /// The moment was reached; forgives a debt that has grown too large.
    pub fn pass(&mut self, wall_s: f64) {
        self.passed += 1;
        let debt_s = wall_s - self.from_wall_s - self.passed as f64 * FRAME_S;
        if debt_s > LONGEST_DEBT * FRAME_S {
            self.from_wall_s += debt_s;
        }
    }
}

/// Wall time over which the real-time factor is taken, s.
const METER_S: f64 = 1.0;

/// Measures simulated time over wall time.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct SpeedMeter {
    marks: VecDeque<(f64, f64)>,
}

impl SpeedMeter {
    /// Forgets everything, after a pause or a jump.
    pub fn clear(&mut self) {
        self.marks.clear();
    }

    /// Notes where simulated time stands.
    pub fn mark(&mut self, wall_s: f64, time_s: f64) {
        self.marks.push_back((wall_s, time_s));
        while self.marks.len() > 2 && wall_s - self.marks[1].0 > METER_S {
            self.marks.pop_front();
        }
    }

    /// Simulated seconds a second over the last moments; `None` before there is something to tell.
    #[must_use]
    pub fn factor(&self) -> Option<f64> {
        let ((wall_0, time_0), (wall_1, time_1)) = (self.marks.front()?, self.marks.back()?);
        let wall_s = wall_1 - wall_0;
        (wall_s > 0.1).then(|| (time_1 - time_0) / wall_s)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn moments_follow_the_speed_and_not_the_clock() {
        let mut punctual = Pace::new(0.5, 2.0, 100.0);
        let mut late = punctual;
        for frame in 1..=10 {
            assert_eq!(punctual.moment_s(), late.moment_s());
            punctual.pass(100.0 + f64::from(frame) * FRAME_S);
            late.pass(100.0 + f64::from(frame) * 3.7);
        }
        assert!((punctual.moment_s() - (2.0 + 11.0 * 0.5 * FRAME_S)).abs() < 1e-12);
    }

    #[test]
    fn a_slow_machine_does_not_have_to_catch_up() {
        let mut pace = Pace::new(1.0, 0.0, 0.0);
        // Every picture takes a second; after the last one the next is due at once, not sixty of them.
        for second in 1..=5 {
            pace.pass(f64::from(second));
        }
        assert_eq!(pace.wait_s(5.0), 0.0);
        pace.pass(5.0);
        assert!(pace.wait_s(5.0) > 0.5 * FRAME_S);
    }

    #[test]
    fn a_fast_machine_waits_for_the_clock() {
        let mut pace = Pace::new(1.0, 0.0, 0.0);
        assert_eq!(pace.wait_s(0.0), 0.0);
        pace.pass(0.001);
        assert!((pace.wait_s(0.001) - (FRAME_S - 0.001)).abs() < 1e-12);
    }

    #[test]
    fn the_meter_tells_the_recent_speed() {
        let mut meter = SpeedMeter::default();
        assert_eq!(meter.factor(), None);
        for tenth in 0..20 {
            meter.mark(f64::from(tenth) * 0.1, 0.0);
        }
        for tenth in 20..40 {
            meter.mark(f64::from(tenth) * 0.1, f64::from(tenth - 20) * 0.05);
        }
        assert!((meter.factor().unwrap() - 0.5).abs() < 1e-9);
    }
}
