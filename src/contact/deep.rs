//! Pairs that would end a step too deep, and passes over their surroundings.
//!
//! In a heap of fragments a thousand pairs may hang together. When they have settled but for a few that are in each other's
//! way, further passes over all of them do next to nothing for those few: the few and what is around them get passes of
//! their own.

use super::nodes::ContactNode;
use super::passes::{PairRow, relax_forth_and_back};
use super::twins::TOGETHER;
use std::borrow::Borrow;

/// Penetration left by the passes, as a share of the local size, that asks for more of them.
const PENETRATION_LEFT: f64 = 1e-4;
/// Penetration within a body up to which no more passes are asked for, as a share of the local size.
const OWN_PENETRATION_LEFT: f64 = 3e-4;
/// Penetration within a body, as a share of the local size, that is too much.
pub(super) const OWN_TOO_DEEP: f64 = TOGETHER;
/// Passes without improvement after which a response gives up: within a body, where the deep ones have had passes of their own,
/// and some yield, if none is much too deep,
const OWN_STALLED: u32 = 3;
/// and elsewhere, where some may be in each other's way or one node much lighter than those that it holds apart.
const STALLED: u32 = 48;
/// What counts as improvement of the excess depth.
const IMPROVEMENT: f64 = 0.95;

/// How far from a deep pair its surroundings go: pairs that share a node with it, and pairs that share one with those.
const RINGS: u32 = 2;
/// Passes over the surroundings, at most.
const PASSES: u32 = 12;

/// How deep pairs may end a step.
#[derive(Clone, Copy)]
pub(super) struct DepthLimit {
    pub step_s: f64,
    /// Whether bodies touch themselves. There few passes are taken for granted, and small steps into each other would add up.
    pub is_own: bool,
}

impl DepthLimit {
    /// By how much the deepest pair would end the step too deep, as a share of the local size; 0 when none would.
    pub fn largest_excess(self, rows: &[impl Borrow<PairRow>], nodes: &[ContactNode]) -> f64 {
        rows.iter().map(|row| self.excess(row.borrow(), nodes)).fold(0.0, f64::max)
    }

    fn excess(self, row: &PairRow, nodes: &[ContactNode]) -> f64 {
        let depth_m = -row.gap_m - self.step_s * row.at.velocity(nodes).dot(row.normal);
        let allowed_m = if self.is_own {
            (OWN_PENETRATION_LEFT * row.size_m).max(-row.gap_m)
        } else {
            PENETRATION_LEFT * row.size_m - row.gap_m.min(0.0)
        };
        (depth_m - allowed_m) / row.size_m
    }

    /// Passes over the pairs around those that would end too deep, while it helps. Nothing where that is most of them.
    pub fn relax_around_deep(self, rows: &mut [PairRow], nodes: &mut [ContactNode]) {
        let is_near = self.is_around_deep(rows, nodes);
        let count = is_near.iter().filter(|near| **near).count();
        if count > rows.len() / 2 {
            return;
        }
        let near = rows.iter_mut().zip(is_near).filter_map(|(row, is_near)| is_near.then_some(row));
        let mut near: Vec<&mut PairRow> = near.collect();
        let mut last = f64::INFINITY;
        for _ in 0..PASSES {
            relax_forth_and_back(&mut near, nodes);
            let excess = self.largest_excess(&near, nodes);
            if excess <= 0.0 || excess > IMPROVEMENT * last {
                return;
            }
            last = excess;
        }
    }

    /// By pair: whether it is deep or within the rings around one that is.
    fn is_around_deep(self, rows: &[PairRow], nodes: &[ContactNode]) -> Vec<bool> {
        let mut is_near: Vec<bool> = rows.iter().map(|row| self.excess(row, nodes) > 0.0).collect();
        let mut is_node_near = vec![false; nodes.len()];
        for _ in 0..RINGS {
            let near = rows.iter().zip(&is_near).filter(|(_, is_near)| **is_near);
            near.flat_map(|(row, _)| row.at.nodes).for_each(|node| is_node_near[node as usize] = true);
            let has_near = |row: &PairRow| row.at.nodes.iter().any(|node| is_node_near[*node as usize]);
            is_near = rows.iter().map(has_near).collect();
        }
        is_near
    }
}

/// Whether passes still get anywhere.
#[derive(Default)]
pub(super) struct Progress {
    best: Option<f64>,
    passes_since: u32,
}

impl Progress {
    /// Takes note of the excess depth after a pass.
    pub fn has_stalled(&mut self, excess: f64, is_own: bool) -> bool {
        if self.best.is_none_or(|best| excess < IMPROVEMENT * best) {
            self.best = Some(excess);
            self.passes_since = 0;
        } else {
            self.passes_since += 1;
        }
        self.passes_since >= if is_own && excess < OWN_TOO_DEEP { OWN_STALLED } else { STALLED }
    }
}

#[cfg(test)]
mod tests {
    use super::super::constraint::{Constraint, Feature};
    use super::super::nodes::NodeTable;
    use super::super::passes::settle;
    use super::super::response::ResponseParameters;
    use super::*;
    use glam::DVec3;

    const STEP_S: f64 = 1e-3;
    const LIMIT: DepthLimit = DepthLimit { step_s: STEP_S, is_own: true };
    const COUNT: u32 = 200;
    const PARAMETERS: ResponseParameters = ResponseParameters {
        step_s: STEP_S,
        passes: 3,
        tolerance: 1e-4,
        conserve_impact_energy: false,
        rest_speed_m_s: 0.0,
    };

    /// Pairs of one body in a row: each node on a patch of the next three.
    fn in_a_row(count: u32) -> Vec<Constraint> {
        let third = -1.0 / 3.0;
        let pair = |node: u32| Constraint {
            bodies: [0, 0],
            nodes: std::array::from_fn(|i| (0, node + i as u32)),
            weights: [1.0, third, third, third],
            friction_coefficient: 0.3,
            ..Constraint::blank(Feature::NodeOnPatch { node, triangle: node })
        };
        (0..count).map(pair).collect()
    }

    /// So many pairs and their nodes, of which one comes down.
    fn with_a_falling_node(
        (count, falling): (u32, u32),
        mass_kg: impl Fn(u32) -> f64,
    ) -> (Vec<PairRow>, NodeTable) {
        let pairs = in_a_row(count);
        let table = NodeTable::new(&pairs, |id| {
            let velocity_m_s = if id.1 == falling { DVec3::NEG_Z * 2.0 } else { DVec3::ZERO };
            ContactNode::new(id, [velocity_m_s; 2], DVec3::splat(1.0 / mass_kg(id.1)))
        });
        let rows = pairs.iter().enumerate().filter_map(|(i, c)| PairRow::new(i, c, &table)).collect();
        (rows, table)
    }

    #[test]
    fn what_is_too_deep_is_mended_and_what_is_far_from_it_is_left_alone() {
        let (mut rows, mut table) = with_a_falling_node((COUNT, 100), |_| 2.0);
        let excess = LIMIT.largest_excess(&rows, &table.nodes);
        assert!((excess - (2.0 * STEP_S - 3e-4)).abs() < 1e-12, "{excess}");
        LIMIT.relax_around_deep(&mut rows, &mut table.nodes);
        assert_eq!(LIMIT.largest_excess(&rows, &table.nodes), 0.0);
        // Three pairs further share a node with the one at 100, and three more a node with those.
        for row in &rows {
            let is_near = row.index.abs_diff(100) <= 6;
            assert!(is_near || row.impulse_n_s == DVec3::ZERO, "{}", row.index);
        }
        let momentum: DVec3 = table.nodes.iter().map(|node| node.velocity_m_s * 2.0).sum();
        assert!((momentum - DVec3::NEG_Z * 4.0).length() < 1e-13, "{momentum}");
    }

    #[test]
    fn a_few_that_are_in_each_others_way_do_not_hold_up_the_rest() {
        // A heavy node on light ones: an impulse finds its way through them slowly.
        let heavy = |node: u32| if node == 100 { 1e3 } else { 1.0 };
        let (mut rows, mut table) = with_a_falling_node((COUNT, 100), heavy);
        let settling = settle(&mut rows, &mut table.nodes, (&PARAMETERS, 400));
        assert_eq!(LIMIT.largest_excess(&rows, &table.nodes), 0.0);
        assert!(settling.passes < 10, "{}", settling.passes);
    }

    #[test]
    fn light_nodes_between_heavy_ones_get_the_passes_that_they_need() {
        let light_between = |node: u32| if node % 2 == 1 { 1e-3 } else { 1.0 };
        let (mut rows, mut table) = with_a_falling_node((8, 2), light_between);
        settle(&mut rows, &mut table.nodes, (&PARAMETERS, 400));
        let excess = LIMIT.largest_excess(&rows, &table.nodes);
        // What is left is what pairs within a body yield.
        assert!(excess < 1.2 * OWN_TOO_DEEP, "{excess}");
    }

    #[test]
    fn passes_stall_when_they_improve_nothing() {
        let stalled_after = |excess: f64, is_own: bool| {
            let mut progress = Progress::default();
            assert!((0..4).all(|i| !progress.has_stalled(2.0 * excess * 0.8_f64.powi(i), is_own)));
            (1..100).find(|_| progress.has_stalled(1.1 * excess, is_own))
        };
        assert_eq!(stalled_after(0.5 * OWN_TOO_DEEP, true), Some(OWN_STALLED));
        assert_eq!(stalled_after(2.0 * OWN_TOO_DEEP, true), Some(STALLED));
        assert_eq!(stalled_after(0.5 * OWN_TOO_DEEP, false), Some(STALLED));
    }
}
