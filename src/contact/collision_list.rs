//! Which pairs pressed in the last step: the memory of the atomic table.

use super::constraint::{Constraint, Feature};
use glam::DVec3;

/// Cosine of the angle up to which a patch continues the one that held a node before.
const SAME_SIDE: f64 = 0.8;

/// (body of the node, node, body of the patch).
pub(super) type HeldNode = (u32, u32, u32);

/// Which pairs pressed in the last step ("as in the last step" in the atomic table).
#[derive(Clone, Debug, Default, PartialEq)]
pub struct CollisionList {
    /// (body of the node, node, body of the patch), sorted, and the normal.
    held_nodes: Vec<(HeldNode, DVec3)>,
    /// (first body, second body, first edge, second edge), sorted.
    held_edges: Vec<(u32, u32, u32, u32)>,
}

impl CollisionList {
    /// The pairs that press with an impulse.
    #[must_use]
    pub fn of(constraints: &[Constraint]) -> Self {
        let mut list = Self::default();
        for c in constraints.iter().filter(|c| c.impulse_n_s != DVec3::ZERO) {
            match c.feature {
                Feature::NodeOnPatch { node, .. } => {
                    list.held_nodes.push(((c.bodies[0], node, c.bodies[1]), c.normal));
                }
                Feature::EdgeOnEdge { first, second } => {
                    list.held_edges.push((c.bodies[0], c.bodies[1], first, second));
                }
            }
        }
        list.held_nodes.sort_by_key(|h| h.0);
        list.held_edges.sort_unstable();
        list
    }

    /// The pairs of which at least one body passes.
    #[must_use]
    pub fn keep(&self, of: impl Fn(u32) -> bool) -> Self {
        let mut kept = self.clone();
        kept.held_nodes.retain(|((a, _, b), _)| of(*a) || of(*b));
        kept.held_edges.retain(|(a, b, _, _)| of(*a) || of(*b));
        kept
    }

    /// Adds another list.
    pub fn merge(&mut self, other: Self) {
        self.held_nodes.extend(other.held_nodes);
        self.held_nodes.sort_by_key(|h| h.0);
        self.held_edges.extend(other.held_edges);
        self.held_edges.sort_unstable();
        self.held_edges.dedup();
    }

    /// Whether the node was held by the body along about this normal.
    pub(super) fn holds(&self, key: HeldNode, normal: DVec3) -> bool {
        let first = self.held_nodes.partition_point(|h| h.0 < key);
        let same = self.held_nodes[first..].iter().take_while(|h| h.0 == key);
        same.into_iter().any(|h| h.1.dot(normal) > SAME_SIDE)
    }

    /// Whether the two edges pressed.
    pub(super) fn holds_edges(&self, bodies: [u32; 2], edges: [u32; 2]) -> bool {
        self.held_edges.binary_search(&(bodies[0], bodies[1], edges[0], edges[1])).is_ok()
    }

    /// Whether no pair pressed.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.held_nodes.is_empty() && self.held_edges.is_empty()
    }
}
