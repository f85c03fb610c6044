//! Which nodes are to be cut, and by which planes.
//!
//! A crack that is there goes on before a new one starts: a failed element at the tip of a crack asks for
//! the tip alone. Else the elements beside a crack, not yet relieved, would line it with others.

use super::cut::ends_here;
use super::pace::Growth;
use super::plane::upward;
use super::propagate::{Failure, PropagationRule, sort_and_dedup};
use super::solid::{Solid, SurfaceFace};
use glam::DVec3;

/// Normals that differ by less than this (cosine; 45 degrees) belong to one crack and are averaged.
/// The mean of two families of conjugate planes would be a plane of neither.
const SAME_FAMILY: f64 = std::f64::consts::FRAC_1_SQRT_2;

/// Calls for which a node rests where nothing cracked when it was to be cut, unless an element
/// there has changed: the stress turns slowly, and the attempt is the dearest part of a call.
const VAIN_PAUSE: u32 = 20;

/// A node that is to be cut.
pub(super) struct Candidate {
    pub node: u32,
    pub normal: DVec3,
    /// Whether a crack ends there. Those go first: a crack that goes on relieves the nodes beside
    /// it, which would else start cracks of their own along it.
    is_tip: bool,
    /// Sum of the failure indices that ask for it.
    severity: f64,
}

impl Candidate {
    pub fn growth(&self) -> Growth {
        if self.is_tip { Growth::GoesOn } else { Growth::Starts }
    }
}

impl Solid {
    /// The nodes that failures ask to cut, tips first, then the worst.
    pub(super) fn candidates(
        &self,
        positions_m: &[DVec3],
        failures: &[Failure],
        rule: PropagationRule,
    ) -> Vec<Candidate> {
        let tips = self.tips(failures);
        let is_tip = |node: u32| tips.binary_search(&node).is_ok();
        let mut asked: Vec<(u32, u32, usize)> = Vec::new();
        for (index, failure) in failures.iter().enumerate().filter(|(_, f)| f.normal.is_finite()) {
            let mut corners = self.tets[failure.element as usize].to_vec();
            if corners.iter().any(|&node| is_tip(node)) {
                corners.retain(|&node| is_tip(node));
            }
            if rule == PropagationRule::SingleElement {
                corners = vec![self.nearest(positions_m, failure, &corners)];
            }
            asked.extend(corners.into_iter().map(|node| (node, failure.element, index)));
        }
        asked.sort_unstable();
        let needed = if rule == PropagationRule::TwoAtNode { 2 } else { 1 };
        let mut candidates: Vec<Candidate> = asked
            .chunk_by(|a, b| a.0 == b.0)
            .filter(|group| group.len() >= needed)
            .filter_map(|group| {
                let failures: Vec<Failure> = group.iter().map(|&(_, _, index)| failures[index]).collect();
                let severity = failures.iter().map(|failure| failure.index).sum();
                let node = group[0].0;
                Some(Candidate { node, normal: common_normal(&failures)?, is_tip: is_tip(node), severity })
            })
            .collect();
        candidates.sort_by(|a, b| {
            let by_severity = b.severity.total_cmp(&a.severity);
            b.is_tip.cmp(&a.is_tip).then(by_severity).then(a.node.cmp(&b.node))
        });
        candidates
    }

    /// The corners of the failures at which a crack ends and may go on, ascending.
    fn tips(&self, failures: &[Failure]) -> Vec<u32> {
        let corners = failures.iter().flat_map(|failure| self.tets[failure.element as usize]);
        let mut nodes: Vec<u32> = corners.collect();
        sort_and_dedup(&mut nodes);
        nodes.retain(|&node| self.is_tip(node) && !self.rests(node));
        nodes
    }

    /// Whether a crack ends at the node.
    pub(super) fn is_tip(&self, node: u32) -> bool {
        let faces: Vec<SurfaceFace> = self.crack_faces_at(node).collect();
        faces.iter().any(|face| ends_here(face, &faces))
    }

    /// Whether the node was cut in vain a short while ago.
    pub(super) fn rests(&self, node: u32) -> bool {
        let tried = self.vain_call[node as usize];
        let was_changed = |&element: &u32| self.touched_in_call[element as usize] > tried;
        tried > 0 && self.calls - tried < VAIN_PAUSE && !self.elements_at(node).iter().any(was_changed)
    }

    /// Of these corners the one nearest to the plane through the centroid; the lowest of equals.
    fn nearest(&self, positions_m: &[DVec3], failure: &Failure, corners: &[u32]) -> u32 {
        let at_m = |node: u32| positions_m[node as usize];
        let all = self.tets[failure.element as usize];
        let centroid_m = all.into_iter().map(at_m).sum::<DVec3>() / 4.0;
        let distance_m = |&node: &u32| (at_m(node) - centroid_m).dot(failure.normal).abs();
        let nearest_m = corners.iter().map(distance_m).fold(f64::INFINITY, f64::min);
        let is_nearest = |node: &&u32| distance_m(node) <= nearest_m * (1.0 + 1e-9);
        corners.iter().filter(is_nearest).min().copied().unwrap_or(all[0])
    }
}

/// Mean normal of the failures, signs aligned; of several families of normals the one of the
/// greatest sum of failure indices.
fn common_normal(failures: &[Failure]) -> Option<DVec3> {
    let is_close = |a: &Failure, b: &Failure| a.normal.dot(b.normal).abs() >= SAME_FAMILY;
    let support = |failure: &Failure| -> f64 {
        failures.iter().filter(|other| is_close(failure, other)).map(|other| other.index).sum()
    };
    let mut best: Option<(f64, &Failure)> = None;
    for failure in failures {
        let key = support(failure);
        // Round-off must not decide between families.
        let is_better = |(most, lead): (f64, &Failure)| {
            let tie = (key - most).abs() <= 1e-9 * most;
            if tie { failure.index > lead.index } else { key > most }
        };
        if best.is_none_or(is_better) {
            best = Some((key, failure));
        }
    }
    let lead = best?.1;
    let family = failures.iter().filter(|failure| is_close(failure, lead));
    let aligned = family.map(|f| if f.normal.dot(lead.normal) < 0.0 { -f.normal } else { f.normal });
    aligned.sum::<DVec3>().try_normalize().map(upward)
}
