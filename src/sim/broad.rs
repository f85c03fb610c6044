//! Which bodies are near each other, and which of their features may meet.
//!
//! Boxes and candidates are kept between steps and renewed only when a body has moved further than its
//! boxes are fattened.

use super::body::{Body, Regime};
use crate::contact::candidates::{Candidates, SurfaceBoxes, between, within};
use crate::math::best_fit_rotation;
use glam::{DMat3, DQuat, DVec3};

/// How far boxes are fattened, as a share of the body's mean surface element size.
const MARGIN: f64 = 0.2;
/// Boxes are also fattened by the way the fastest node makes in this many steps.
const MARGIN_STEPS: f64 = 8.0;

/// Candidates of a pair of bodies and the states of the boxes they come from.
pub(super) struct NearPair {
    /// The bodies, the smaller number first; twice the same for self-collision.
    pub bodies: [usize; 2],
    pub candidates: Candidates,
    stamps: [u64; 2],
}

#[derive(Default)]
struct Entry {
    boxes: Option<SurfaceBoxes>,
    /// Counts the renewals; part of what a pair's candidates are valid for.
    stamp: u64,
    /// Boxes for self-collision, valid in the body's own moving frame.
    own: Option<OwnBoxes>,
}

/// Boxes around a body's shape, kept while it moves on as a whole and changes its shape but little.
struct OwnBoxes {
    boxes: SurfaceBoxes,
    stamp: u64,
    orientation: DQuat,
}

impl OwnBoxes {
    fn around(body: &Body, stamp: u64) -> Self {
        let margin_m = MARGIN * body.mean_size_m;
        let boxes = SurfaceBoxes::around(&body.surface, &body.position_m, margin_m);
        Self { boxes, stamp, orientation: DQuat::IDENTITY }
    }

    /// Whether the shape has changed by more than the boxes allow, seen in the frame that fits it best.
    fn is_outrun(&mut self, body: &Body) -> bool {
        let nodes = || body.surface.nodes.iter().map(|n| *n as usize);
        let built = self.boxes.built_at_m();
        let count = body.surface.nodes.len().max(1) as f64;
        let centre_then: DVec3 = nodes().map(|n| built[n]).sum::<DVec3>() / count;
        let centre_now: DVec3 = nodes().map(|n| body.position_m[n]).sum::<DVec3>() / count;
        let mut moment = DMat3::ZERO;
        for n in nodes() {
            let (now, then) = (body.position_m[n] - centre_now, built[n] - centre_then);
            moment += DMat3::from_cols(now * then.x, now * then.y, now * then.z);
        }
        self.orientation = best_fit_rotation(&moment, self.orientation);
        let turn = DMat3::from_quat(self.orientation);
        let limit = (0.4 * self.boxes.margin_m()).powi(2);
        nodes().any(|n| {
            let moved = centre_now + turn * (built[n] - centre_then);
            (body.position_m[n] - moved).length_squared() > limit
        })
    }
}

/// Boxes of all bodies and candidates of near pairs.
#[derive(Default)]
pub(super) struct BroadPhase {
    entries: Vec<Entry>,
    pub pairs: Vec<NearPair>,
    pub self_collision: bool,
}

/// Bounds of a body that may be anywhere within its boxes.
fn bounds_overlap(a: &SurfaceBoxes, b: &SurfaceBoxes) -> bool {
    let (a, b) = (a.bounds(), b.bounds());
    a.mins.cmple(b.maxs).all() && b.mins.cmple(a.maxs).all()
}

impl BroadPhase {
    pub fn new(bodies: usize, self_collision: bool) -> Self {
        let entries = (0..bodies).map(|_| Entry::default()).collect();
        Self { entries, pairs: Vec::new(), self_collision }
    }

    /// Makes room for one more body.
    pub fn add_body(&mut self) {
        self.entries.push(Entry::default());
    }

    /// Renews what is out of date and finds the pairs of which at least one body is elastic.
    /// `step_s` is the length of the step to come.
    pub fn update(&mut self, bodies: &[Body], step_s: f64) {
        for (entry, body) in self.entries.iter_mut().zip(bodies) {
            entry.renew(body, step_s);
            if self.self_collision && body.regime == Regime::Elastic {
                entry.renew_own(body);
            }
        }
        let mut old = std::mem::take(&mut self.pairs).into_iter().peekable();
        for first in 0..bodies.len() {
            for second in first..bodies.len() {
                let key = [first, second];
                while old.peek().is_some_and(|p| p.bodies < key) {
                    old.next();
                }
                let kept = old.next_if(|p| p.bodies == key);
                if let Some(pair) = self.pair(bodies, key, kept) {
                    self.pairs.push(pair);
                }
            }
        }
    }

    fn pair(&self, bodies: &[Body], key: [usize; 2], kept: Option<NearPair>) -> Option<NearPair> {
        let [first, second] = key;
        let is_self = first == second;
        let is_elastic = key.map(|b| bodies[b].regime == Regime::Elastic);
        if !(is_elastic[0] || is_elastic[1]) || (is_self && !self.self_collision) {
            return None;
        }
        if is_self {
            let own = self.entries[first].own.as_ref()?;
            let stamps = [own.stamp; 2];
            if let Some(pair) = kept.filter(|p| p.stamps == stamps) {
                return Some(pair);
            }
            let candidates = within((&bodies[first].surface, &own.boxes), &bodies[first].reference_m);
            return Some(NearPair { bodies: key, candidates, stamps });
        }
        let (a, b) = (&self.entries[first], &self.entries[second]);
        let (boxes_a, boxes_b) = (a.boxes.as_ref()?, b.boxes.as_ref()?);
        let stamps = [a.stamp, b.stamp];
        if let Some(pair) = kept.filter(|p| p.stamps == stamps) {
            return Some(pair);
        }
        if !bounds_overlap(boxes_a, boxes_b) {
            return None;
        }
        let candidates =
            between((&bodies[first].surface, boxes_a), (&bodies[second].surface, boxes_b), false);
        (!candidates.is_empty()).then_some(NearPair { bodies: key, candidates, stamps })
    }

    /// Shortest time in which a body could outrun its boxes at its present speed, s.
    pub fn valid_for_s(&self, bodies: &[Body]) -> f64 {
        let entries = self.entries.iter().zip(bodies);
        entries
            .filter(|(_, body)| matches!(body.regime, Regime::Elastic | Regime::Kinematic))
            .filter_map(|(entry, body)| {
                let margin_m = entry.boxes.as_ref()?.margin_m();
                Some(0.25 * margin_m / fastest_m_s(body).max(1e-300))
            })
            .fold(f64::INFINITY, f64::min)
    }
}

impl Entry {
    fn renew_own(&mut self, body: &Body) {
        let stamp = self.own.as_ref().map_or(0, |own| own.stamp + 1);
        let is_valid = self.own.as_mut().is_some_and(|own| !own.is_outrun(body));
        if !is_valid {
            self.own = Some(OwnBoxes::around(body, stamp));
        }
    }

    fn renew(&mut self, body: &Body, step_s: f64) {
        let is_valid = self.boxes.as_ref().is_some_and(|boxes| !is_outrun(boxes, body));
        if is_valid {
            return;
        }
        let margin_m = MARGIN * body.mean_size_m + MARGIN_STEPS * step_s * fastest_m_s(body);
        self.boxes = Some(SurfaceBoxes::around(&body.surface, &body.position_m, margin_m));
        self.stamp += 1;
    }
}

fn is_outrun(boxes: &SurfaceBoxes, body: &Body) -> bool {
    if body.regime == Regime::Fixed {
        return false;
    }
    let limit = (0.5 * boxes.margin_m()).powi(2);
    let built = boxes.built_at_m();
    body.surface.nodes.iter().any(|n| {
        let n = *n as usize;
        (body.position_m[n] - built[n]).length_squared() > limit
    })
}

/// Speed of the fastest node of the surface, m/s.
pub(super) fn fastest_m_s(body: &Body) -> f64 {
    let speeds = body.surface.nodes.iter().map(|n| body.velocity_m_s[*n as usize].length_squared());
    speeds.fold(0.0, f64::max).sqrt()
}

/// Groups of bodies that may act on each other, each ascending, ordered by their first body: connected
/// by near pairs, through bodies that move by their own dynamics only.
pub(super) fn islands(bodies: &[Body], pairs: &[NearPair]) -> Vec<Vec<usize>> {
    let mut parent: Vec<usize> = (0..bodies.len()).collect();
    fn root(parent: &mut [usize], mut i: usize) -> usize {
        while parent[i] != i {
            parent[i] = parent[parent[i]];
            i = parent[i];
        }
        i
    }
    for pair in pairs {
        if pair.bodies.iter().all(|b| bodies[*b].is_deformable()) {
            let [a, b] = pair.bodies.map(|b| root(&mut parent, b));
            let (low, high) = (a.min(b), a.max(b));
            parent[high] = low;
        }
    }
    let mut groups: Vec<Vec<usize>> = vec![Vec::new(); bodies.len()];
    for body in 0..bodies.len() {
        if bodies[body].regime == Regime::Elastic {
            groups[root(&mut parent, body)].push(body);
        }
    }
    groups.retain(|g| !g.is_empty());
    groups
}
