//! Which bodies are near each other, and which of their features may meet.
//!
//! Boxes and candidates are kept between steps and renewed only when a body has moved further than its
//! boxes are fattened.

use super::body::{Body, Regime};
use super::own_boxes::OwnBoxes;
use crate::contact::candidates::{Candidates, between, within};
use crate::contact::{CloseList, OwnFeatures, SurfaceBoxes};
use crate::math::{DisjointSets, in_parts};
use crate::mesh::Renumbering;
use glam::DVec3;
use parry3d_f64::bounding_volume::{Aabb, BoundingVolume};
use rayon::prelude::*;

/// How far boxes are fattened, as a share of the body's mean surface element size.
const MARGIN: f64 = 0.2;
/// Boxes are also fattened by the way the fastest node makes in this many steps: at least,
const MARGIN_STEPS: f64 = 8.0;
/// and in so many while that is less than [`MARGIN`].
const MOST_MARGIN_STEPS: f64 = 32.0;

/// Candidates of a pair of bodies and the states of the boxes they come from.
#[derive(Clone)]
pub(super) struct NearPair {
    /// The bodies, the smaller number first; twice the same for self-collision.
    pub bodies: [usize; 2],
    pub candidates: Candidates,
    /// Those of the candidates that the next steps may need.
    pub close: CloseList,
    stamps: [u64; 2],
}

impl NearPair {
    /// Brings the candidates of a body with itself up to date after a cut or a move of some of its boxes.
    fn follow_within(&mut self, body: &Body, own: &OwnBoxes, numbers: &Renumbering) {
        self.close.follow_within(&mut self.candidates, (&own_features(body), &own.boxes), numbers);
    }
}

#[derive(Clone, Default)]
struct Entry {
    boxes: Option<SurfaceBoxes>,
    /// How far they are fattened, m.
    boxes_margin_m: f64,
    /// Counts the renewals; part of what a pair's candidates are valid for.
    stamp: u64,
    /// Box around the body as it is now, not fattened.
    bounds: Option<Aabb>,
    /// How far `bounds` is fattened, m.
    margin_m: f64,
    /// Whether another body may come near, so that the boxes are needed.
    is_close: bool,
}

/// Boxes of all bodies and candidates of near pairs.
#[derive(Clone, Default)]
pub(super) struct BroadPhase {
    entries: Vec<Entry>,
    /// By body: boxes for self-collision, valid in the body's own moving frame.
    own: Vec<Option<OwnBoxes>>,
    /// Ascending by their bodies.
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
        let mut found = Self { self_collision, ..Self::default() };
        (0..bodies).for_each(|_| found.add_body());
        found
    }

    /// Makes room for one more body.
    pub fn add_body(&mut self) {
        self.entries.push(Entry::default());
        self.own.push(None);
    }

    /// Forgets what is known of a body.
    pub fn forget(&mut self, body: usize) {
        self.pairs.retain(|pair| !pair.bodies.contains(&body));
        let entry = &mut self.entries[body];
        *entry = Entry { stamp: entry.stamp + 1, ..Entry::default() };
        self.own[body] = None;
    }

    /// Follows a cut of a body: see [`SurfaceBoxes::follow`].
    pub fn follow_cut(
        &mut self,
        bodies: &[Body],
        cut: usize,
        numbers: &Renumbering,
        parents: &[([u32; 2], f64)],
    ) {
        let surface = &bodies[cut].surface;
        let (boxes, own) = (&mut self.entries[cut].boxes, &mut self.own[cut]);
        in_parts::both(
            surface.triangles.len(),
            || boxes.iter_mut().for_each(|boxes| boxes.follow(surface, numbers, parents)),
            || own.iter_mut().for_each(|own| own.boxes.follow(surface, numbers, parents)),
        );
        let (entries, own) = (&self.entries, &self.own[cut]);
        let stays = |pair: &mut NearPair| {
            let [first, second] = pair.bodies;
            if first != cut && second != cut {
                return true;
            }
            if first == second {
                let Some(own) = own else { return false };
                pair.follow_within(&bodies[cut], own, numbers);
                return true;
            }
            let [Some(a), Some(b)] = pair.bodies.map(|body| entries[body].boxes.as_ref()) else {
                return false;
            };
            let boxed = [(&bodies[first].surface, a), (&bodies[second].surface, b)];
            let of_pair = pair.bodies.map(|body| (body == cut).then_some(numbers));
            let positions_m = pair.bodies.map(|body| bodies[body].position_m.as_slice());
            pair.close.follow_between(&mut pair.candidates, boxed, positions_m, of_pair);
            true
        };
        let mut stay = self.pairs.par_iter_mut().map(stays).collect::<Vec<bool>>().into_iter();
        self.pairs.retain(|_| stay.next() == Some(true));
    }

    /// First half of the update: bounds of all bodies, and which of them come near others. `step_s` is the length of
    /// the step to come.
    pub fn renew_bounds(&mut self, bodies: &[Body], step_s: f64) {
        for (entry, body) in self.entries.iter_mut().zip(bodies) {
            entry.renew_bounds(body, step_s);
        }
        for first in 0..bodies.len() {
            let mut others = (0..bodies.len()).filter(|second| *second != first);
            self.entries[first].is_close =
                others.any(|second| may_meet(&self.entries, bodies, [first, second]));
        }
    }

    /// Second half: renews what is out of date and finds the pairs of which at least one body is elastic, at `time_s`.
    pub fn update(&mut self, bodies: &[Body], time_s: f64, step_s: f64) {
        let (own_pairs, pairs): (Vec<_>, Vec<_>) =
            std::mem::take(&mut self.pairs).into_iter().partition(|pair| pair.bodies[0] == pair.bodies[1]);
        let is_on = self.self_collision;
        let Self { entries, own, .. } = self;
        let elastic = bodies.iter().filter(|body| body.regime == Regime::Elastic);
        let triangles = elastic.map(|body| body.surface.triangles.len()).sum();
        let of_themselves =
            || if is_on { renew_own(own, own_pairs, bodies, (time_s, step_s)) } else { Vec::new() };
        let among_them = || renew_among(entries, pairs, bodies, step_s);
        let (own_pairs, pairs) = in_parts::both(triangles, of_themselves, among_them);
        self.pairs.extend(own_pairs);
        self.pairs.extend(pairs);
        self.pairs.sort_by_key(|pair| pair.bodies);
    }

    /// Whether an elastic body may come near the body, by its bounds.
    pub fn is_close(&self, body: usize) -> bool {
        self.entries[body].is_close
    }

    /// Shortest time in which a body could outrun its boxes at its present speed, s.
    pub fn valid_for_s(&self, bodies: &[Body]) -> f64 {
        let entries = self.entries.iter().zip(bodies);
        entries
            .filter(|(_, body)| !matches!(body.regime, Regime::Fixed | Regime::Asleep))
            .map(|(entry, body)| {
                let has_boxes = entry.boxes.is_some() && entry.is_close;
                let margin_m = if has_boxes { entry.boxes_margin_m } else { entry.margin_m };
                0.25 * margin_m / fastest_m_s(body).max(1e-300)
            })
            .fold(f64::INFINITY, f64::min)
    }
}

/// Renews what is out of date of the elastic bodies' boxes around themselves, and the candidates with themselves that boxes
/// have moved away from or to.
fn renew_own(
    own: &mut [Option<OwnBoxes>],
    kept: Vec<NearPair>,
    bodies: &[Body],
    moment: (f64, f64),
) -> Vec<NearPair> {
    let mut kept = kept.into_iter().peekable();
    let mut of_body = |(index, (own, body)): (usize, (&mut Option<OwnBoxes>, &Body))| {
        let bodies = [index; 2];
        let kept = kept.next_if(|pair| pair.bodies == bodies);
        if body.regime != Regime::Elastic {
            return None;
        }
        let moved = OwnBoxes::renew(own, body, moment);
        let own = own.as_ref()?;
        let stamps = [own.stamp; 2];
        if let Some(mut pair) = kept.filter(|pair| pair.stamps == stamps) {
            if let Some(numbers) = moved {
                pair.follow_within(body, own, &numbers);
            }
            return Some(pair);
        }
        let candidates = within(&own_features(body), &own.boxes);
        Some(NearPair { bodies, candidates, close: CloseList::default(), stamps })
    };
    own.iter_mut().zip(bodies).enumerate().filter_map(&mut of_body).collect()
}

/// Renews what is out of date of the boxes for contact with others, and finds the pairs of bodies of which at least one is
/// elastic.
fn renew_among(entries: &mut [Entry], kept: Vec<NearPair>, bodies: &[Body], step_s: f64) -> Vec<NearPair> {
    for (entry, body) in entries.iter_mut().zip(bodies).filter(|(entry, _)| entry.is_close) {
        entry.renew(body, step_s);
    }
    let mut kept = kept.into_iter().peekable();
    let mut pairs = Vec::new();
    for first in 0..bodies.len() {
        for second in first + 1..bodies.len() {
            let key = [first, second];
            let kept = kept.next_if(|pair| pair.bodies == key);
            pairs.extend(pair_of(entries, bodies, key, kept));
        }
    }
    pairs
}

/// The pair of two bodies, if one of them is elastic and they are near each other.
fn pair_of(entries: &[Entry], bodies: &[Body], key: [usize; 2], kept: Option<NearPair>) -> Option<NearPair> {
    if !may_meet(entries, bodies, key) {
        return None;
    }
    let [a, b] = key.map(|body| &entries[body]);
    let (boxes_a, boxes_b) = (a.boxes.as_ref()?, b.boxes.as_ref()?);
    let stamps = [a.stamp, b.stamp];
    if let Some(pair) = kept.filter(|pair| pair.stamps == stamps) {
        return Some(pair);
    }
    if !bounds_overlap(boxes_a, boxes_b) {
        return None;
    }
    let [first, second] = key.map(|body| &bodies[body].surface);
    let candidates = between((first, boxes_a), (second, boxes_b), false);
    let close = CloseList::default();
    (!candidates.is_empty()).then_some(NearPair { bodies: key, candidates, close, stamps })
}

/// Whether one of the bodies is elastic and their bounds overlap.
fn may_meet(entries: &[Entry], bodies: &[Body], pair: [usize; 2]) -> bool {
    let bounds = |i: usize| entries[i].bounds.map(|b| b.loosened(entries[i].margin_m));
    let is_elastic = pair.iter().any(|i| bodies[*i].regime == Regime::Elastic);
    is_elastic
        && match pair.map(bounds) {
            [Some(a), Some(b)] => a.mins.cmple(b.maxs).all() && b.mins.cmple(a.maxs).all(),
            _ => false,
        }
}

impl Entry {
    /// Bounds of the body now; of one in free travel, whose nodes are not placed, around all its turns.
    fn renew_bounds(&mut self, body: &Body, step_s: f64) {
        if matches!(body.regime, Regime::Fixed | Regime::Asleep) && self.bounds.is_some() {
            return;
        }
        self.margin_m = MARGIN * body.mean_size_m + MARGIN_STEPS * step_s * fastest_m_s(body);
        self.bounds = Some(match body.regime {
            Regime::Free(motion) => Aabb::from_half_extents(motion.centre_m, DVec3::splat(body.radius_m)),
            _ => bounds_of(body),
        });
    }

    fn renew(&mut self, body: &Body, step_s: f64) {
        let margin_m = self.boxes_margin_m;
        let is_valid = self.boxes.as_ref().is_some_and(|boxes| !is_outrun(boxes, margin_m, body));
        if is_valid {
            return;
        }
        let (size_m, way_m) = (MARGIN * body.mean_size_m, step_s * fastest_m_s(body));
        let ahead_m = (MOST_MARGIN_STEPS * way_m).min(size_m.max(MARGIN_STEPS * way_m));
        self.boxes_margin_m = size_m + ahead_m;
        let (surface, positions_m) = (&body.surface, body.position_m.as_slice());
        let margin_m = self.boxes_margin_m;
        self.boxes = Some(SurfaceBoxes::moved_or_new(self.boxes.take(), surface, positions_m, |_| {
            DVec3::splat(margin_m)
        }));
        self.stamp += 1;
    }
}

fn own_features(body: &Body) -> OwnFeatures<'_> {
    OwnFeatures { surface: &body.surface, reference_m: &body.reference_m, positions_m: &body.position_m }
}

fn bounds_of(body: &Body) -> Aabb {
    let nodes = body.surface.nodes.iter().map(|n| body.position_m[*n as usize]);
    let (low, high) = nodes.fold((DVec3::INFINITY, DVec3::NEG_INFINITY), |(l, h), x| (l.min(x), h.max(x)));
    Aabb::new(low, high)
}

fn is_outrun(boxes: &SurfaceBoxes, margin_m: f64, body: &Body) -> bool {
    if body.regime == Regime::Fixed {
        return false;
    }
    let limit = (0.5 * margin_m).powi(2);
    let built = boxes.built_at_m();
    body.surface.nodes.iter().any(|n| {
        let n = *n as usize;
        (body.position_m[n] - built[n]).length_squared() > limit
    })
}

/// Speed of the fastest node of the surface, m/s; a bound on it in free travel.
fn fastest_m_s(body: &Body) -> f64 {
    if let Regime::Free(motion) = body.regime {
        return motion.velocity_m_s.length() + motion.spin_rad_s().length() * body.radius_m;
    }
    let speeds = body.surface.nodes.iter().map(|n| body.velocity_m_s[*n as usize].length_squared());
    speeds.fold(0.0, f64::max).sqrt()
}

/// Groups of bodies that may act on each other, each ascending, ordered by their first body: connected
/// by near pairs, through bodies that move by their own dynamics only.
pub(super) fn islands(bodies: &[Body], pairs: &[NearPair]) -> Vec<Vec<usize>> {
    let mut sets = DisjointSets::new(bodies.len());
    for pair in pairs {
        if pair.bodies.iter().all(|b| bodies[*b].is_deformable()) {
            let [a, b] = pair.bodies.map(|b| b as u32);
            sets.join(a, b);
        }
    }
    let mut groups: Vec<Vec<usize>> = vec![Vec::new(); bodies.len()];
    for body in 0..bodies.len() {
        if bodies[body].regime == Regime::Elastic {
            groups[sets.root(body as u32) as usize].push(body);
        }
    }
    groups.retain(|g| !g.is_empty());
    groups
}
