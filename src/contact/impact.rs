//! The energy of impacts: stored when contact nodes are stopped, given back when they are let go.
//!
//! A plain constraint stops the contact nodes dead and loses their kinetic energy, with ten elements along
//! a rod a twentieth of it. Reversing their velocity instead (Cirak, West, IJNME 64, 2005) keeps the energy but lets
//! the nodes drum on each other for as long as the bodies are in contact, so that the force is a row of blows
//! and its end a matter of chance. Here contact nodes stay together, and what the stop takes is kept with the pair, as the
//! layer of half an element that the mesh does not resolve keeps it as strain. When the pair opens, it gets the
//! energy back as a blow: the stop, reversed in time. Momentum is exact in both.

use super::constraint::{Constraint, Feature, SAME_SIDE};
use crate::math::DisjointSets;
use glam::DVec3;

/// Energy that the impact of one pair has stored.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct ImpactStore {
    /// Energy, J; never negative.
    pub energy_j: f64,
    /// Closing speed that went into it, m/s.
    pub speed_m_s: f64,
}

impl ImpactStore {
    /// Whether there is something to give back.
    #[must_use]
    pub fn is_filled(&self) -> bool {
        self.energy_j > 0.0
    }

    /// The store after a step in which the pair's impulse took `loss_j` and brought the relative normal
    /// velocity at the start of the step from `-closing_m_s` to `after_m_s`. `share` in 0..=1 says how much of a *new*
    /// impact is kept.
    #[must_use]
    pub(super) fn after(self, loss_j: f64, [closing_m_s, after_m_s]: [f64; 2], share: f64) -> Self {
        let share = if self.is_filled() { 1.0 } else { share };
        let energy_j = (self.energy_j + share * loss_j).max(0.0);
        let stopped = share * share * (closing_m_s * closing_m_s - after_m_s * after_m_s).max(0.0);
        let speed_m_s = (self.speed_m_s * self.speed_m_s + stopped).sqrt();
        if energy_j > 0.0 { Self { energy_j, speed_m_s } } else { Self::default() }
    }

    /// Adds another store. The speed stays that of one blow.
    fn take_over(&mut self, other: Self) {
        self.energy_j += other.energy_j;
        self.speed_m_s = self.speed_m_s.max(other.speed_m_s);
    }

    /// The store when a share `left` of the energy has not leaked away.
    #[must_use]
    pub(super) fn leaked(self, left: f64) -> Self {
        Self { energy_j: self.energy_j * left, speed_m_s: self.speed_m_s * left.sqrt() }
    }
}

/// Distance over the local size up to which two pairs of the same bodies are at one place: a little more than from node
/// to node.
const REACH: f64 = 3.0;

/// What a store belongs to: a node on a body, or an edge on an edge.
type StoreKey = (u32, u32, u32, Option<u32>);

fn key_of(c: &Constraint) -> StoreKey {
    match c.feature {
        Feature::NodeOnPatch { node, .. } => (c.bodies[0], node, c.bodies[1], None),
        Feature::EdgeOnEdge { first, second } => (c.bodies[0], first, c.bodies[1], Some(second)),
    }
}

/// A store without its pair.
#[derive(Clone, Copy, Debug, PartialEq)]
struct KeptStore {
    key: StoreKey,
    bodies: [u32; 2],
    normal: DVec3,
    place_m: DVec3,
    store: ImpactStore,
}

impl KeptStore {
    /// Whether a pair could carry on this one's contact, and how near it is: distance over the local size.
    fn distance_to(&self, c: &Constraint) -> Option<f64> {
        let sign = orientation(self.bodies, c.bodies)?;
        let distance = (c.place_m - self.place_m).length() / c.size_m;
        (sign * c.normal.dot(self.normal) > SAME_SIDE && distance <= REACH).then_some(distance)
    }
}

/// 1 for the same bodies in the same order, -1 in the other order.
fn orientation(a: [u32; 2], b: [u32; 2]) -> Option<f64> {
    if a == b { Some(1.0) } else { (a == [b[1], b[0]]).then_some(-1.0) }
}

/// The stores between one step and the next.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ImpactStores {
    /// Sorted by key.
    stores: Vec<KeptStore>,
}

impl ImpactStores {
    /// The stores of the pairs after a step, of which a share `left` remains.
    #[must_use]
    pub fn of(constraints: &[Constraint], left: f64) -> Self {
        let filled = constraints.iter().filter(|c| c.stored.is_filled());
        debug_assert!(filled.clone().all(|c| !c.is_own()), "within a body nothing is stored");
        let mut stores: Vec<KeptStore> = filled
            .map(|c| KeptStore {
                key: key_of(c),
                bodies: c.bodies,
                normal: c.normal,
                place_m: c.place_m,
                store: c.stored.leaked(left),
            })
            .collect();
        stores.sort_by_key(|s| s.key);
        Self { stores }
    }

    /// Gives every store to the pair it belongs to: of the same features, with the nearest normal. When a contact
    /// has moved on to other features, the nearest pair there takes over; where there is none, the energy is lost.
    pub fn hand_over(&self, constraints: &mut [Constraint]) {
        constraints.iter_mut().for_each(|c| c.stored = ImpactStore::default());
        if self.stores.is_empty() {
            return;
        }
        // Within a body nothing is stored.
        let between = constraints.iter().enumerate().filter(|(_, c)| !c.is_own());
        let mut keys: Vec<(StoreKey, usize)> = between.map(|(i, c)| (key_of(c), i)).collect();
        keys.sort_unstable();
        for kept in &self.stores {
            let first = keys.partition_point(|k| k.0 < kept.key);
            let same = keys[first..].iter().take_while(|k| k.0 == kept.key).map(|k| k.1);
            let along = |i: usize| constraints[i].normal.dot(kept.normal);
            let heir = same
                .filter(|i| along(*i) > SAME_SIDE)
                .max_by(|a, b| along(*a).total_cmp(&along(*b)))
                .or_else(|| nearest(kept, constraints));
            if let Some(i) = heir {
                constraints[i].stored.take_over(kept.store);
            }
        }
    }

    /// The stores of pairs of which at least one body passes.
    #[must_use]
    pub fn keep(&self, of: impl Fn(u32) -> bool) -> Self {
        let kept = self.stores.iter().filter(|s| s.bodies.iter().any(|b| of(*b))).copied();
        Self { stores: kept.collect() }
    }

    /// The stores that have nothing to do with a body.
    #[must_use]
    pub fn without(&self, body: u32) -> Self {
        Self { stores: self.stores.iter().filter(|s| !s.bodies.contains(&body)).copied().collect() }
    }

    /// Forgets the stores of a body's edges; their energy is lost.
    pub fn forget_edges_of(&mut self, body: u32) {
        self.stores.retain(|s| s.key.3.is_none() || !s.bodies.contains(&body));
    }

    /// Adds other stores.
    pub fn merge(&mut self, other: Self) {
        self.stores.extend(other.stores);
        self.stores.sort_by_key(|s| s.key);
    }

    /// Energy in all stores, J.
    #[must_use]
    pub fn energy_j(&self) -> f64 {
        self.stores.iter().map(|s| s.store.energy_j).sum()
    }
}

/// The pair that is nearest to a store without one; of several the first.
fn nearest(kept: &KeptStore, constraints: &[Constraint]) -> Option<usize> {
    let near = constraints.iter().enumerate().filter_map(|(i, c)| Some((kept.distance_to(c)?, i)));
    near.min_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1))).map(|(_, i)| i)
}

/// For each pair the speed at which it should leave: the closing speed stored at its place if nothing there
/// presses any more, else 0, m/s.
///
/// A place is all pairs of two bodies that are linked by short distances. While one of them presses the contact goes on, however
/// the others take turns in carrying it.
pub(super) fn rebound_speeds_m_s(constraints: &[Constraint]) -> Vec<f64> {
    if constraints.iter().all(|c| !c.stored.is_filled()) {
        return vec![0.0; constraints.len()];
    }
    // Within a body nothing is stored, and nothing rebounds.
    let between: Vec<usize> = (0..constraints.len()).filter(|i| !constraints[*i].is_own()).collect();
    let places = places(constraints, between);
    let mut speeds_m_s = vec![0.0_f64; constraints.len()];
    let mut presses = vec![false; constraints.len()];
    for (c, place) in constraints.iter().zip(&places).filter(|(c, _)| !c.is_own()) {
        speeds_m_s[*place] = speeds_m_s[*place].max(c.stored.speed_m_s);
        presses[*place] |= c.impulse_n_s != DVec3::ZERO;
    }
    places.iter().map(|place| if presses[*place] { 0.0 } else { speeds_m_s[*place] }).collect()
}

/// The number of the place of each pair, which is the number of one of its pairs; those that are not listed are alone.
fn places(constraints: &[Constraint], mut order: Vec<usize>) -> Vec<usize> {
    order.sort_by(|a, b| constraints[*a].place_m.x.total_cmp(&constraints[*b].place_m.x).then(a.cmp(b)));
    let widest_m = constraints.iter().map(|c| REACH * c.size_m).fold(0.0, f64::max);
    let mut sets = DisjointSets::new(constraints.len());
    for (at, &i) in order.iter().enumerate() {
        let c = &constraints[i];
        let near = order[at + 1..]
            .iter()
            .take_while(|j| constraints[**j].place_m.x - c.place_m.x <= widest_m)
            .filter(|j| are_at_one_place(c, &constraints[**j]));
        near.for_each(|j| sets.join(i as u32, *j as u32));
    }
    (0..constraints.len()).map(|i| sets.root(i as u32) as usize).collect()
}

fn are_at_one_place(a: &Constraint, b: &Constraint) -> bool {
    let reach_m = REACH * a.size_m.max(b.size_m);
    (a.place_m - b.place_m).length_squared() <= reach_m * reach_m
        && orientation(a.bodies, b.bodies).is_some_and(|sign| sign * a.normal.dot(b.normal) > SAME_SIDE)
}

/// The part `s` in 0..=1 of a blow that gives just `stored_j`, when the whole blow does the work `work_j` of which
/// `square_j` is that of the velocities it makes itself (`s (work_j - square_j) + s^2 square_j = stored_j`).
#[must_use]
pub(super) fn share_of_blow(stored_j: f64, work_j: f64, square_j: f64) -> f64 {
    if work_j <= stored_j || square_j <= 0.0 {
        return 1.0;
    }
    let linear_j = work_j - square_j;
    let root = (linear_j * linear_j + 4.0 * square_j * stored_j).sqrt();
    ((root - linear_j) / (2.0 * square_j)).clamp(0.0, 1.0)
}

#[cfg(test)]
mod tests {
    use super::super::constraint::Geometry;
    use super::*;

    /// A node of body 0 at (x, 0.3) on the plane z = 0 of body 1.
    fn pair(node: u32, x: f64, energy_j: f64) -> Constraint {
        let place_m = DVec3::new(x, 0.3, 0.0);
        let g = Geometry::node_on_patch(place_m, [DVec3::ZERO, DVec3::X, DVec3::Y]).unwrap();
        let feature = Feature::NodeOnPatch { node, triangle: 0 };
        Constraint {
            nodes: [(0, node), (1, 0), (1, 1), (1, 2)],
            weights: g.weights,
            weight_shifts_per_m: feature
                .weight_shifts_per_m([place_m, DVec3::ZERO, DVec3::X, DVec3::Y], g.normal),
            normal: g.normal,
            place_m,
            size_m: 0.1,
            stored: ImpactStore { energy_j, speed_m_s: energy_j.sqrt() },
            ..Constraint::blank(feature)
        }
    }

    #[test]
    fn a_store_stays_with_its_node_and_passes_to_the_nearest_pair_when_that_is_gone() {
        let stores = ImpactStores::of(&[pair(3, 0.2, 4.0), pair(5, 0.4, 1.0)], 1.0);
        let mut next = [pair(7, 0.25, 0.0), pair(3, 0.41, 0.0)];
        stores.hand_over(&mut next);
        assert_eq!(next.map(|c| c.stored.energy_j), [0.0, 5.0]);
        let mut other_pair = [pair(7, 0.25, 0.0)];
        stores.hand_over(&mut other_pair);
        assert_eq!(other_pair[0].stored.energy_j, 5.0);
        let mut far = [pair(7, 0.95, 0.0)];
        stores.hand_over(&mut far);
        assert!(!far[0].stored.is_filled());
    }

    #[test]
    fn a_place_rebounds_only_when_none_of_its_pairs_presses() {
        let mut pairs = [pair(1, 0.2, 4.0), pair(2, 0.3, 0.0), pair(3, 0.9, 1.0)];
        assert_eq!(rebound_speeds_m_s(&pairs), [2.0, 2.0, 1.0]);
        pairs[1].impulse_n_s = DVec3::Z;
        assert_eq!(rebound_speeds_m_s(&pairs), [0.0, 0.0, 1.0]);
    }

    #[test]
    fn a_blow_is_cut_to_the_energy_there_is() {
        // s (5 - 3) + 3 s^2 = 1
        assert!((share_of_blow(1.0, 5.0, 3.0) - 1.0 / 3.0).abs() < 1e-15);
        assert_eq!(share_of_blow(6.0, 5.0, 3.0), 1.0);
        assert_eq!(share_of_blow(0.0, 5.0, 3.0), 0.0);
    }
}
