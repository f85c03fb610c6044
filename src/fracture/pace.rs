//! When a crack may go on, and where a new one may start.
//!
//! No crack runs faster than it may: an element that took part in a cut waits until a crack of the given speed could have
//! crossed the ring of that cut. Cracks in brittle solids stay below the Rayleigh wave speed (L. B. Freund, *Dynamic Fracture
//! Mechanics*, section 7), about 0.9 of the shear wave speed; half of it is often measured.
//!
//! A crack relieves what lies beside it, but not at once: the news travels as a wave. Until it has arrived no new crack
//! starts there. Without this, what is loaded several times beyond its strength would crack everywhere at once, element by
//! element, where one crack would have served a whole neighbourhood (its shielding zone; the distance between cracks in
//! coatings and in fragmenting rings comes from the same race: N. F. Mott, Proc. R. Soc. A 189, 1947).

use super::changes::{Changes, NodeCut};
use super::solid::{Face, Solid};
use glam::DVec3;

/// What a cut at a node is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Growth {
    /// A crack that ends there goes on.
    GoesOn,
    /// A new crack starts.
    Starts,
}

/// When each element may take part in a cut again.
#[derive(Clone, Debug, PartialEq)]
pub struct CrackPace {
    /// Fastest crack, m/s; infinite for no limit.
    speed_m_s: f64,
    /// Distance over the reach of a cut up to which it shields from new cracks.
    shield_reaches: f64,
    ready_s: Vec<f64>,
    start_ready_s: Vec<f64>,
    /// Scratch: the count of the search that last met an element.
    met_by: Vec<u32>,
    searches: u32,
}

impl CrackPace {
    /// For a body of so many elements, none of which waits. The speed, m/s, must be positive; `shield_reaches` says how far
    /// from a crack no other starts until the relief has arrived, in distances of neighbouring nodes.
    #[must_use]
    pub fn new(speed_m_s: f64, shield_reaches: f64, elements: usize) -> Self {
        Self {
            speed_m_s,
            shield_reaches,
            ready_s: vec![f64::NEG_INFINITY; elements],
            start_ready_s: vec![f64::NEG_INFINITY; elements],
            met_by: vec![0; elements],
            searches: 0,
        }
    }

    /// Whether an element may take part in a cut.
    #[must_use]
    pub fn may_crack(&self, element: u32, growth: Growth, time_s: f64) -> bool {
        let element = element as usize;
        let is_shielded = growth == Growth::Starts && self.start_ready_s[element] > time_s;
        self.ready_s[element] <= time_s && !is_shielded
    }

    /// Takes note of what was cut at a time: to be called with every [`Changes`] of the body.
    pub fn record(&mut self, solid: &Solid, changes: &Changes, time_s: f64) {
        for new in &changes.new_elements {
            let parent = new.cut_from as usize;
            self.ready_s.push(self.ready_s[parent]);
            self.start_ready_s.push(self.start_ready_s[parent]);
            self.met_by.push(0);
        }
        for cut in &changes.cuts {
            let ready_s = time_s + cut.reach_m / self.speed_m_s;
            for &element in &cut.elements {
                let ready = &mut self.ready_s[element as usize];
                *ready = ready.max(ready_s);
            }
            self.shield(solid, cut, time_s);
        }
    }

    /// The elements around a cut wait until the relief has reached them.
    fn shield(&mut self, solid: &Solid, cut: &NodeCut, time_s: f64) {
        let reach_m = self.shield_reaches * cut.reach_m;
        let centre_m = solid.reference_m()[cut.node as usize];
        self.searches += 1;
        let mut stack = cut.elements.clone();
        stack.iter().for_each(|element| self.met_by[*element as usize] = self.searches);
        while let Some(element) = stack.pop() {
            let middle_m = solid.corners_m(element).into_iter().sum::<DVec3>() / 4.0;
            let distance_m = middle_m.distance(centre_m);
            if distance_m > reach_m {
                continue;
            }
            let ready = &mut self.start_ready_s[element as usize];
            *ready = ready.max(time_s + distance_m / self.speed_m_s);
            for face in solid.faces()[element as usize] {
                let Face::Inner(next) = face else { continue };
                if std::mem::replace(&mut self.met_by[next as usize], self.searches) != self.searches {
                    stack.push(next);
                }
            }
        }
    }
}
