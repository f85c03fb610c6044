//! The candidates that are close at present: a second, shorter list.
//!
//! The boxes of the search are wide, so that they last; most of what they find is far from touching. What is out of
//! reach for the next steps is left out here until the bodies have moved by as much as was allowed for.

use super::candidates::Candidates;
use super::detect::{BodyView, PairDepths};
use super::geometry::{barycentric, closest_on_lines};
use glam::DVec3;

/// Reach of the list over the mean local size, beyond what the present step needs.
const REACH: f64 = 0.05;
/// Ways count by this factor: contact may speed them up within the steps to come.
const SPEED_UP: f64 = 2.0;
/// Shift of a foot in its plane, over the way of the points, up to which pairs stay: a patch may turn.
const SHIFT: f64 = 2.0;
/// Squared sine of the angle between edges below which their closest points move too fast to say anything.
const NEARLY_PARALLEL: f64 = 0.04;

/// The close ones of a pair's candidates.
#[derive(Clone, Debug, Default)]
pub struct CloseList {
    candidates: Candidates,
    /// Way that points may make relative to each other until the next renewal, m.
    spare_m: f64,
    /// The same for the present step, m.
    way_m: f64,
}

impl CloseList {
    /// The close candidates.
    #[must_use]
    pub fn candidates(&self) -> &Candidates {
        &self.candidates
    }

    /// Way by which points may come nearer to each other in the step that the list was last made ready for, m.
    #[must_use]
    pub fn way_m(&self) -> f64 {
        self.way_m
    }

    /// Gets ready for a step in which points come nearer to each other by `way_m` at most, plus a slack by the
    /// response. `all` are the candidates of the search, `mean_size_m` the mean local size of the finer surface.
    pub fn renew(&mut self, views: &[BodyView; 2], all: &Candidates, ways_m: [f64; 2], mean_size_m: f64) {
        let [way_m, slack_m] = ways_m;
        self.way_m = way_m;
        self.spare_m -= SPEED_UP * way_m;
        if self.spare_m >= 0.0 {
            return;
        }
        self.spare_m = (REACH * mean_size_m).max(SPEED_UP * way_m);
        let reach_m = self.spare_m + SPEED_UP * way_m + slack_m;
        let nodes = |views: [&BodyView; 2], of: &[(u32, u32)]| {
            let mut close: Vec<(u32, u32)> =
                of.iter().copied().filter(|c| is_node_close(views, *c, reach_m)).collect();
            close.sort_unstable();
            close
        };
        let [first, second] = views;
        let edges = all.edge_pairs.iter().copied().filter(|c| are_edges_close(views, *c, reach_m));
        self.candidates = Candidates {
            node_on_second: nodes([first, second], &all.node_on_second),
            node_on_first: nodes([second, first], &all.node_on_first),
            edge_pairs: edges.collect(),
        };
    }
}

fn is_node_close([own, other]: [&BodyView; 2], (node, triangle): (u32, u32), reach_m: f64) -> bool {
    let x = own.positions_m[node as usize];
    let patch_m = other.surface.corners_m(triangle, other.positions_m);
    let size_m = other.surface.triangle_size_m[triangle as usize];
    let area_normal = (patch_m[1] - patch_m[0]).cross(patch_m[2] - patch_m[0]);
    let height = (x - patch_m[0]).dot(area_normal);
    let reach_down_m = reach_m + PairDepths::LARGEST * size_m;
    let reach2 = if height > 0.0 { reach_m * reach_m } else { reach_down_m * reach_down_m };
    if height * height > reach2 * area_normal.length_squared() {
        return false;
    }
    let Some(weights) = barycentric(x, patch_m) else { return true };
    let foot = weights.into_iter().fold(f64::INFINITY, f64::min);
    -foot * size_m <= SHIFT * reach_m + PairDepths::LARGEST * size_m
}

fn are_edges_close(views: &[BodyView; 2], (first, second): (u32, u32), reach_m: f64) -> bool {
    let ends = |view: &BodyView, edge: u32| {
        view.surface.edges[edge as usize].nodes.map(|n| view.positions_m[n as usize])
    };
    let (p, q) = (ends(&views[0], first), ends(&views[1], second));
    let (along_p, along_q) = (p[1] - p[0], q[1] - q[0]);
    let lengths2 = along_p.length_squared() * along_q.length_squared();
    if along_p.cross(along_q).length_squared() < NEARLY_PARALLEL * lengths2 {
        return true;
    }
    let Some((s, t)) = closest_on_lines(p, q) else { return true };
    let shortest_m = along_p.length().min(along_q.length());
    let (beyond, apart_m) = (SHIFT * reach_m / shortest_m, reach_m + PairDepths::LARGEST * shortest_m);
    let is_inside = |share: f64| (-beyond..=1.0 + beyond).contains(&share);
    let apart: DVec3 = p[0].lerp(p[1], s) - q[0].lerp(q[1], t);
    is_inside(s) && is_inside(t) && apart.length_squared() <= apart_m * apart_m
}
