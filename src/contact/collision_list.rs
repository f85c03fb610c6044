//! Which pairs pressed in the last step: the memory of the atomic table.

use super::constraint::{Constraint, Feature, SAME_SIDE};
use super::impact::ImpactStores;
use glam::DVec3;

/// (body of the node, node, body of the patch).
pub(super) type HeldNode = (u32, u32, u32);
/// (first body, second body, first edge, second edge).
type HeldEdges = (u32, u32, u32, u32);

/// Stands for a triangle whose number is no longer known.
const NO_TRIANGLE: u32 = u32::MAX;

/// What held a node.
#[derive(Clone, Copy, Debug, PartialEq)]
struct HeldPatch {
    triangle: u32,
    normal: DVec3,
    impulse_n_s: DVec3,
}

/// Which pairs pressed in the last step ("as in the last step" in the atomic table).
#[derive(Clone, Debug, Default, PartialEq)]
pub struct CollisionList {
    /// By (body of the node, node, body of the patch), sorted.
    held_nodes: Vec<(HeldNode, HeldPatch)>,
    /// (first body, second body, first edge, second edge), sorted, and the impulse, N s.
    held_edges: Vec<(HeldEdges, DVec3)>,
    /// Energy of their impacts.
    stores: ImpactStores,
}

impl CollisionList {
    /// The pairs that press with an impulse; a share `left` of what impacts stored remains.
    #[must_use]
    pub fn of(constraints: &[Constraint], left: f64) -> Self {
        let mut list = Self { stores: ImpactStores::of(constraints, left), ..Self::default() };
        for c in constraints.iter().filter(|c| c.impulse_n_s != DVec3::ZERO) {
            match c.feature {
                Feature::NodeOnPatch { node, triangle } => {
                    let patch = HeldPatch { triangle, normal: c.normal, impulse_n_s: c.impulse_n_s };
                    list.held_nodes.push(((c.bodies[0], node, c.bodies[1]), patch));
                }
                Feature::EdgeOnEdge { first, second } => {
                    let key = (c.bodies[0], c.bodies[1], first, second);
                    list.held_edges.push((key, c.impulse_n_s));
                }
            }
        }
        list.held_nodes.sort_by_key(|h| h.0);
        list.held_edges.sort_by_key(|h| h.0);
        list
    }

    /// The pairs of which at least one body passes.
    #[must_use]
    pub fn keep(&self, of: impl Fn(u32) -> bool) -> Self {
        let mut kept = self.clone();
        kept.held_nodes.retain(|((a, _, b), _)| of(*a) || of(*b));
        kept.held_edges.retain(|((a, b, _, _), _)| of(*a) || of(*b));
        kept.stores = kept.stores.keep(of);
        kept
    }

    /// The pairs that have nothing to do with a body that was taken out.
    #[must_use]
    pub fn without(&self, body: u32) -> Self {
        let mut kept = self.clone();
        kept.held_nodes.retain(|((a, _, b), _)| *a != body && *b != body);
        kept.held_edges.retain(|((a, b, _, _), _)| *a != body && *b != body);
        kept.stores = kept.stores.without(body);
        kept
    }

    /// Forgets the edges and triangles of a body whose surface has been numbered anew.
    pub fn forget_numbers_of(&mut self, body: u32) {
        let of_body = |held: &&mut (HeldNode, HeldPatch)| held.0.2 == body;
        self.held_nodes.iter_mut().filter(of_body).for_each(|held| held.1.triangle = NO_TRIANGLE);
        self.held_edges.retain(|((a, b, _, _), _)| *a != body && *b != body);
        self.stores.forget_edges_of(body);
    }

    /// Adds another list.
    pub fn merge(&mut self, other: Self) {
        self.held_nodes.extend(other.held_nodes);
        self.held_nodes.sort_by_key(|h| h.0);
        self.held_edges.extend(other.held_edges);
        self.held_edges.sort_by_key(|h| h.0);
        self.stores.merge(other.stores);
    }

    /// Whether the node was held by the body along about this normal.
    pub(super) fn holds(&self, key: HeldNode, normal: DVec3) -> bool {
        self.node_impulse_n_s(key, normal).is_some()
    }

    /// Whether the node was held by this patch.
    pub(super) fn holds_on(&self, key: HeldNode, triangle: u32) -> bool {
        self.patches_of(key).any(|patch| patch.triangle == triangle)
    }

    fn node_impulse_n_s(&self, key: HeldNode, normal: DVec3) -> Option<DVec3> {
        self.patches_of(key).find(|patch| patch.normal.dot(normal) > SAME_SIDE).map(|patch| patch.impulse_n_s)
    }

    fn patches_of(&self, key: HeldNode) -> impl Iterator<Item = &HeldPatch> {
        let first = self.held_nodes.partition_point(|h| h.0 < key);
        self.held_nodes[first..].iter().take_while(move |h| h.0 == key).map(|h| &h.1)
    }

    fn edge_impulse_n_s(&self, key: HeldEdges) -> Option<DVec3> {
        let at = self.held_edges.binary_search_by_key(&key, |h| h.0).ok()?;
        Some(self.held_edges[at].1)
    }

    /// Gives every pair that pressed in the last step its impulse of then, as a first guess.
    pub fn recall_impulses(&self, constraints: &mut [Constraint]) {
        for c in constraints {
            c.impulse_n_s = self.last_impulse_n_s(c).unwrap_or_default();
        }
    }

    /// What impacts have stored.
    #[must_use]
    pub fn stores(&self) -> &ImpactStores {
        &self.stores
    }

    fn last_impulse_n_s(&self, c: &Constraint) -> Option<DVec3> {
        match c.feature {
            Feature::NodeOnPatch { node, .. } => {
                self.node_impulse_n_s((c.bodies[0], node, c.bodies[1]), c.normal)
            }
            Feature::EdgeOnEdge { first, second } => {
                self.edge_impulse_n_s((c.bodies[0], c.bodies[1], first, second))
            }
        }
    }

    /// Whether the two edges pressed.
    pub(super) fn holds_edges(&self, bodies: [u32; 2], edges: [u32; 2]) -> bool {
        self.edge_impulse_n_s((bodies[0], bodies[1], edges[0], edges[1])).is_some()
    }

    /// Whether no pair pressed.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.held_nodes.is_empty() && self.held_edges.is_empty()
    }
}
