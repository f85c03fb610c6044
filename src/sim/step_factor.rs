//! The factor on a body's stable step for large strain, in few and lasting stages.
//!
//! A step that swings with the vibration of the body is a parametric excitation: central differences were seen to blow up at
//! half the stability limit when the step followed every change of the largest strain. So it shrinks at once and grows
//! only after a while, and each time it had grown too early that while is twice as long: a blow is over soon, a
//! vibration ends with one step for good.

/// Ratio between the stages.
const STAGE: f64 = 0.8;
/// Steps for which a longer step must have been possible before the step grows for the first time,
const FIRST_HOLD: u32 = 125;
/// and at most.
const LONGEST_HOLD: u32 = 2000;

/// A factor that follows what is needed, which is in (0, 1].
#[derive(Clone, Copy, Debug)]
pub(super) struct HeldStepFactor {
    factor: f64,
    /// The smallest stage that was needed since the factor was last looked at for growth, and the steps since.
    smallest: f64,
    steps: u32,
    hold: u32,
    has_grown: bool,
}

impl Default for HeldStepFactor {
    fn default() -> Self {
        Self { factor: 1.0, smallest: 1.0, steps: 0, hold: FIRST_HOLD, has_grown: false }
    }
}

impl HeldStepFactor {
    /// The factor, never above what was needed last.
    pub fn factor(&self) -> f64 {
        self.factor
    }

    /// Follows a step's need.
    pub fn follow(&mut self, needed: f64) {
        let wanted = STAGE.powf(needed.log(STAGE).ceil());
        if wanted < self.factor {
            if self.has_grown {
                self.hold = (2 * self.hold).min(LONGEST_HOLD);
            }
            *self = Self { factor: wanted, smallest: 1.0, steps: 0, hold: self.hold, has_grown: false };
            return;
        }
        self.smallest = self.smallest.min(wanted);
        self.steps += 1;
        if self.steps >= self.hold {
            self.has_grown |= self.smallest > self.factor;
            (self.factor, self.smallest, self.steps) = (self.smallest, 1.0, 0);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_blow_shortens_the_step_at_once_and_not_for_long() {
        let mut held = HeldStepFactor::default();
        held.follow(0.6);
        assert!(held.factor() <= 0.6 && held.factor() > 0.6 * STAGE, "{}", held.factor());
        for _ in 1..FIRST_HOLD {
            held.follow(0.95);
            assert!(held.factor() <= 0.6);
        }
        (0..FIRST_HOLD).for_each(|_| held.follow(0.95));
        assert!((held.factor() - STAGE).abs() < 1e-12, "{}", held.factor());
    }

    #[test]
    fn a_vibration_ends_with_one_step() {
        for period in [10, 100, 300, 1000, 1900] {
            let mut held = HeldStepFactor::default();
            let (mut changes, mut last_change) = (0, 0);
            for step in 0..100_000_u32 {
                let phase = f64::from(step) / f64::from(period) * std::f64::consts::TAU;
                let (needed, before) = (0.8 + 0.15 * phase.cos(), held.factor());
                held.follow(needed);
                assert!(held.factor() <= needed);
                if held.factor() != before {
                    (changes, last_change) = (changes + 1, step);
                }
            }
            assert!(changes < 40 && last_change < 20 * LONGEST_HOLD, "{period}: {changes}, {last_change}");
        }
    }
}
