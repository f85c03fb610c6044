//! What may touch within a step: found once, and again where the response has thrown nodes about.

use super::candidates::Candidates;
use super::close::CloseList;
use super::constraint::{Constraint, Feature};
use super::detect::{NearPair, NodeSide, PairView, edge_constraint, near_edges, near_twins, twin_constraint};
use super::thrown::ThrownNodes;
use super::twins::TwinState;
use crate::math::in_parts;

/// All that may touch between two bodies within a step.
#[derive(Clone, Debug, Default)]
pub struct Near {
    /// Nodes of the first body and of the second one near patches of the other, by node and triangle.
    nodes: [Vec<NearPair>; 2],
    edges: Vec<NearPair>,
    /// Of twins that are together.
    twins: Vec<NearPair>,
}

impl Near {
    /// Of a list that has been made ready for the step: sorts out what cannot touch even if the response changes ways as
    /// far as `thrown` reckons with, which must be what the list was made ready for.
    #[must_use]
    pub fn of_close(pair: &PairView, close: &CloseList, thrown: &ThrownNodes) -> Self {
        Self::among(pair, (close.candidates(), close.twin_states()), close.way_m(), thrown)
    }

    /// Looks again at what the nodes may meet that the response has thrown further than was reckoned with. The rest stays as it
    /// was found.
    pub fn look_again_at(
        &mut self,
        thrown: &ThrownNodes,
        pair: &PairView,
        (candidates, close): (&Candidates, &CloseList),
    ) {
        let states = pair.twin_states(thrown.most_m());
        let reachable = close.thrown_within(candidates, (&states, thrown, pair));
        let found = Self::among(pair, (&reachable, &states), close.way_m(), thrown);
        let stays = |n: &NearPair| !n.nodes.iter().any(|(side, node)| thrown.is_due(*side as usize, *node));
        for (kept, found) in self.nodes.iter_mut().zip(found.nodes) {
            kept.retain(stays);
            kept.extend(found);
            kept.sort_by_key(|n| n.feature);
        }
        self.edges.retain(stays);
        self.edges.extend(found.edges);
        self.twins = found.twins;
    }

    fn among(
        pair: &PairView,
        (candidates, twin_states): (&Candidates, &[TwinState]),
        way_m: f64,
        thrown: &ThrownNodes,
    ) -> Self {
        let near_nodes = |side: usize, nodes: &[(u32, u32)], were_one: &[bool]| {
            let node_side = NodeSide::new(pair, side);
            let were_one = |i: usize| were_one.get(i) == Some(&true);
            let slack_m = |(node, triangle): (u32, u32)| {
                thrown.slack_m(side, &[node], &node_side.views[1].surface.triangles[triangle as usize])
            };
            let near = |i: usize, c: &(u32, u32)| node_side.near(*c, were_one(i), [way_m, slack_m(*c)]);
            in_parts::filter_map(nodes, NEAR_AT_ONCE, near)
        };
        let c = candidates;
        let ends = |side: usize, edge: u32| pair.views[side].surface.edges[edge as usize].nodes;
        let of_edges =
            |_, c: &(u32, u32)| near_edges(pair, *c, way_m + thrown.slack_m(0, &ends(0, c.0), &ends(1, c.1)));
        let count = c.node_on_second.len() + c.edge_pairs.len() + twin_states.len();
        let on_second = || near_nodes(0, &c.node_on_second, &c.twins.were_one);
        let edges = || in_parts::filter_map(&c.edge_pairs, NEAR_AT_ONCE, of_edges);
        let twins = || near_twins(pair, twin_states, way_m + thrown.most_m());
        let (on_second, (edges, twins)) = in_parts::both(count, on_second, || (edges(), twins()));
        Self { nodes: [on_second, near_nodes(1, &c.node_on_first, &[])], edges, twins }
    }

    fn count(&self) -> usize {
        self.nodes[0].len() + self.edges.len() + self.twins.len()
    }

    /// Appends the constraints of the pairs that touch.
    pub fn find(&self, pair: &PairView, out: &mut Vec<Constraint>) {
        let of_side = |side: usize| {
            let node_side = NodeSide::new(pair, side);
            self.of_nodes(side, |of_node, found| node_side.find(of_node, found))
        };
        let (first, edges) =
            in_parts::both(self.count(), || of_side(0), || self.of_edges_and_twins(pair, |_| true));
        out.extend(first);
        out.extend(of_side(1));
        out.extend(edges);
    }

    /// What `find` adds, node by node of a side.
    fn of_nodes(
        &self,
        side: usize,
        find: impl Fn(&[NearPair], &mut Vec<Constraint>) + Sync,
    ) -> Vec<Constraint> {
        let of_nodes: Vec<&[NearPair]> = self.nodes[side].chunk_by(|a, b| a.nodes[0] == b.nodes[0]).collect();
        in_parts::flat_map(&of_nodes, NODES_AT_ONCE, |_, of_node, found| find(of_node, found))
    }

    /// The constraints of edges that `is_wanted` and of twins.
    fn of_edges_and_twins(
        &self,
        pair: &PairView,
        is_wanted: impl Fn(&NearPair) -> bool + Sync,
    ) -> Vec<Constraint> {
        let of_edges = |_, e: &NearPair| is_wanted(e).then(|| edge_constraint(pair, e)).flatten();
        let mut found = in_parts::filter_map(&self.edges, NEAR_AT_ONCE, of_edges);
        found.extend(in_parts::filter_map(&self.twins, NEAR_AT_ONCE, |_, t| twin_constraint(pair, t)));
        found
    }

    /// Appends the constraints of the pairs that would penetrate by more than `depth` of the local size at the end
    /// of the step, but for those that are known.
    pub fn find_closing(
        &self,
        pair: &PairView,
        depth: f64,
        is_known: impl Fn(([u32; 2], Feature)) -> bool + Sync,
        out: &mut Vec<Constraint>,
    ) {
        let of_side = |side: usize| {
            let node_side = NodeSide::new(pair, side);
            let is_new = |n: &NearPair| {
                n.gap_after_m(&node_side.views, pair.step_s) < -depth * n.size_m
                    && !is_known((node_side.bodies, n.feature))
            };
            self.of_nodes(side, |of_node, found| {
                // The other patches at the node are its rivals, known or not.
                if of_node.iter().any(is_new) {
                    node_side.find(of_node, found);
                }
            })
        };
        let closes = |n: &NearPair| n.gap_after_m(&pair.views, pair.step_s) < -depth * n.size_m;
        let (first, edges) =
            in_parts::both(self.count(), || of_side(0), || self.of_edges_and_twins(pair, closes));
        let found = first.into_iter().chain(of_side(1)).chain(edges);
        let closes = |c: &Constraint| c.gap_m - pair.step_s * c.closing_m_s < -depth * c.size_m;
        out.extend(found.filter(|c| closes(c) && !is_known((c.bodies, c.feature))));
    }
}

/// Close candidates that one task looks at,
pub(super) const NEAR_AT_ONCE: usize = 1024;
/// and nodes with such.
const NODES_AT_ONCE: usize = 256;
