//! No crack runs faster than it may: an element that took part in a cut waits until a crack of the
//! given speed could have crossed the ring of that cut.
//!
//! Cracks in brittle solids stay below the Rayleigh wave speed (L. B. Freund, *Dynamic Fracture
//! Mechanics*, section 7), about 0.9 of the shear wave speed; half of it is often measured.

use super::changes::Changes;

/// When each element may take part in a cut again.
#[derive(Clone, Debug, PartialEq)]
pub struct CrackPace {
    /// Fastest crack, m/s; infinite for no limit.
    speed_m_s: f64,
    ready_s: Vec<f64>,
}

impl CrackPace {
    /// For a body of so many elements, none of which waits. The speed, m/s, must be positive.
    #[must_use]
    pub fn new(speed_m_s: f64, elements: usize) -> Self {
        Self { speed_m_s, ready_s: vec![f64::NEG_INFINITY; elements] }
    }

    /// Whether an element may take part in a cut.
    #[must_use]
    pub fn may_crack(&self, element: u32, time_s: f64) -> bool {
        self.ready_s[element as usize] <= time_s
    }

    /// Takes note of what was cut at a time: to be called with every [`Changes`] of the body.
    pub fn record(&mut self, changes: &Changes, time_s: f64) {
        for new in &changes.new_elements {
            self.ready_s.push(self.ready_s[new.cut_from as usize]);
        }
        for cut in &changes.cuts {
            let ready_s = time_s + cut.reach_m / self.speed_m_s;
            for &element in &cut.elements {
                let ready = &mut self.ready_s[element as usize];
                *ready = ready.max(ready_s);
            }
        }
    }
}
