//! The candidates that are close at present: a short list for every step.
//!
//! The boxes of the search are wide, so that they last; most of what they find is far from touching. Each candidate that is
//! looked at and found out of reach sleeps until the bodies may have moved by as much as it lacks.

use super::boxes::SurfaceBoxes;
use super::candidates::{Boxed, Candidates};
use super::detect::{NEAR, PairDepths, PairView, ThrownNodes};
use super::follow::Origins;
use super::geometry::{barycentric, closest_on_lines, distance_of_segments};
use super::own::OwnFeatures;
use super::twins::TwinState;
use crate::mesh::Renumbering;

/// Ways count by this factor: contact may speed them up within the steps to come.
pub(super) const SPEED_UP: f64 = 2.0;
/// Shift of a foot in its plane, over the way of the points: a patch may turn.
const SHIFT: f64 = 2.0;
/// Squared sine of the angle between edges below which their closest points move too fast to say anything.
const NEARLY_PARALLEL: f64 = 0.04;

/// The close ones of a pair's candidates.
#[derive(Clone, Debug, Default)]
pub struct CloseList {
    candidates: Candidates,
    twin_states: Vec<TwinState>,
    /// Way that points may have made relative to each other since the search, m.
    travelled_m: f64,
    /// The same before the present step, m.
    before_m: f64,
    /// By candidate: the travelled way at which it must be looked at again, m; negative where it is close until then.
    wake: Wake,
    /// Way that points may make in the present step, m.
    way_m: f64,
}

#[derive(Clone, Debug, Default)]
struct Wake {
    node_on_second_m: Vec<f64>,
    node_on_first_m: Vec<f64>,
    edge_pairs_m: Vec<f64>,
}

impl Wake {
    fn fit(&mut self, all: &Candidates) {
        self.node_on_second_m.resize(all.node_on_second.len(), 0.0);
        self.node_on_first_m.resize(all.node_on_first.len(), 0.0);
        self.edge_pairs_m.resize(all.edge_pairs.len(), 0.0);
    }

    fn follow(&mut self, origins: &Origins) {
        let of = |wake_m: &[f64], origins: &[Option<u32>]| {
            let was =
                |origin: &Option<u32>| origin.and_then(|o| wake_m.get(o as usize)).copied().unwrap_or(0.0);
            origins.iter().map(was).collect()
        };
        self.node_on_second_m = of(&self.node_on_second_m, &origins.node_on_second);
        self.node_on_first_m = of(&self.node_on_first_m, &origins.node_on_first);
        self.edge_pairs_m = of(&self.edge_pairs_m, &origins.edge_pairs);
    }
}

impl CloseList {
    /// Follows a cut of one of two bodies; `all` are the candidates before it, and are brought up to date.
    pub fn follow_between(
        &mut self,
        all: &mut Candidates,
        [first, second]: [Boxed; 2],
        numbers: [Option<&Renumbering>; 2],
    ) {
        let (now, origins) = all.follow_between(first, second, numbers);
        *all = now;
        self.wake.follow(&origins);
    }

    /// Follows a cut of a body that is near itself; `all` are the candidates before it, and are brought up to date.
    pub fn follow_within(
        &mut self,
        all: &mut Candidates,
        (own, boxes): (&OwnFeatures, &SurfaceBoxes),
        numbers: &Renumbering,
    ) {
        let (now, origins) = all.follow_within(own, boxes, numbers);
        *all = now;
        self.wake.follow(&origins);
    }

    /// Those of all candidates with thrown nodes that ways of up to `reach_m`, counted from before the step, may make
    /// touch: more than the close ones when that is more than the list was made ready for.
    pub(super) fn thrown_within(
        &self,
        all: &Candidates,
        (states, thrown, pair): (&[TwinState], &ThrownNodes, &PairView),
        reach_m: f64,
    ) -> Candidates {
        let is_near = |wake_m: f64| wake_m < 0.0 || wake_m <= self.before_m + reach_m;
        let surface = |side: usize| pair.views[side].surface;
        let nodes_fly = |side: usize, nodes: &[u32]| nodes.iter().any(|n| thrown.contains(side, *n));
        let node_flies = |side: usize, (node, triangle): (u32, u32)| {
            thrown.contains(side, node)
                || nodes_fly(1 - side, &surface(1 - side).triangles[triangle as usize])
        };
        let edge_flies = |side: usize, edge: u32| nodes_fly(side, &surface(side).edges[edge as usize].nodes);
        let mut near = Candidates::default();
        for (i, pair) in all.node_on_second.iter().enumerate() {
            let is_wanted = is_near(self.wake.node_on_second_m[i]) && node_flies(0, *pair);
            if is_wanted && all.is_left_by_twins(i, states) {
                near.node_on_second.push(*pair);
                near.were_one.extend(all.were_one.get(i));
            }
        }
        for (wake_m, pair) in self.wake.node_on_first_m.iter().zip(&all.node_on_first) {
            if is_near(*wake_m) && node_flies(1, *pair) {
                near.node_on_first.push(*pair);
            }
        }
        for (i, (first, second)) in all.edge_pairs.iter().copied().enumerate() {
            let is_wanted =
                is_near(self.wake.edge_pairs_m[i]) && (edge_flies(0, first) || edge_flies(1, second));
            if is_wanted && all.edges_are_left_by_twins(i, states) {
                near.edge_pairs.push((first, second));
            }
        }
        near
    }

    /// The close candidates; of a body with itself only those that its twins leave.
    #[must_use]
    pub fn candidates(&self) -> &Candidates {
        &self.candidates
    }

    /// How the twins lie of a body that is near itself.
    pub(super) fn twin_states(&self) -> &[TwinState] {
        &self.twin_states
    }

    /// Way by which points may come nearer to each other in the step that the list was last made ready for, m.
    #[must_use]
    pub fn way_m(&self) -> f64 {
        self.way_m
    }

    /// Gets ready for a step in which points come nearer to each other by `way_m` at most, plus a slack by the
    /// response. `all` are the candidates of the search, always the same for one list.
    pub fn renew(&mut self, pair: &PairView, all: &Candidates, [way_m, slack_m]: [f64; 2]) {
        // The last step went as fast as the bodies are now: the response may have thrown them farther than was reckoned with.
        self.before_m = self.travelled_m + (way_m - SPEED_UP * self.way_m).max(0.0);
        self.way_m = way_m;
        self.twin_states = pair.twin_states(slack_m);
        self.wake.fit(all);
        let look = Look { pair, before_m: self.before_m, reach_m: SPEED_UP * way_m + slack_m };
        look.over((all, &self.twin_states), &mut self.wake, &mut self.candidates);
        self.travelled_m = self.before_m + SPEED_UP * way_m;
    }
}

/// A look at the candidates that are due.
struct Look<'a> {
    pair: &'a PairView<'a>,
    /// Way travelled before the step, m.
    before_m: f64,
    /// Way up to which candidates are close, m.
    reach_m: f64,
}

impl Look<'_> {
    /// Whether a candidate is close; asks for its clearance only when it is due.
    fn finds_close(&self, wake_m: &mut f64, clearance_m: impl FnOnce() -> f64) -> bool {
        let Self { before_m, reach_m, .. } = *self;
        if *wake_m > before_m + reach_m || *wake_m < -before_m {
            return *wake_m < 0.0;
        }
        let clearance_m = clearance_m();
        let is_close = clearance_m <= reach_m;
        *wake_m = if is_close { -(before_m + reach_m) } else { before_m + clearance_m };
        is_close
    }

    fn over(&self, (all, states): (&Candidates, &[TwinState]), wake: &mut Wake, close: &mut Candidates) {
        close.clear();
        for (i, wake_m) in wake.node_on_second_m.iter_mut().enumerate() {
            let pair = all.node_on_second[i];
            if all.is_left_by_twins(i, states)
                && self.finds_close(wake_m, || node_clearance_m(self.pair, 0, pair))
            {
                close.node_on_second.push(pair);
                close.were_one.extend(all.were_one.get(i));
            }
        }
        for (wake_m, pair) in wake.node_on_first_m.iter_mut().zip(&all.node_on_first) {
            if self.finds_close(wake_m, || node_clearance_m(self.pair, 1, *pair)) {
                close.node_on_first.push(*pair);
            }
        }
        for (i, wake_m) in wake.edge_pairs_m.iter_mut().enumerate() {
            let pair = all.edge_pairs[i];
            if all.edges_are_left_by_twins(i, states)
                && self.finds_close(wake_m, || edge_clearance_m(self.pair, pair))
            {
                close.edge_pairs.push(pair);
            }
        }
    }
}

/// Way that a node must make relative to a patch before they can touch, m: of the first body, or of the second (`side` 1).
fn node_clearance_m(pair: &PairView, side: usize, (node, triangle): (u32, u32)) -> f64 {
    let (own, other) = (&pair.views[side], &pair.views[1 - side]);
    let x = own.positions_m[node as usize];
    let patch_m = other.surface.corners_m(triangle, other.positions_m);
    let size_m = other.surface.triangle_size_m[triangle as usize];
    let area_normal = (patch_m[1] - patch_m[0]).cross(patch_m[2] - patch_m[0]);
    let height_m = (x - patch_m[0]).dot(area_normal) / area_normal.length();
    let out_of_plane_m = if height_m > 0.0 {
        height_m - NEAR * size_m
    } else {
        let is_new = pair.is_own_and_cracked()
            && -height_m > pair.depths.new * size_m
            && !pair.list.holds_on((pair.bodies[side], node, pair.bodies[1 - side]), triangle);
        let depth = if is_new { pair.depths.new } else { PairDepths::LARGEST.max(pair.depths.held) };
        -height_m - depth * size_m
    };
    let Some(weights) = barycentric(x, patch_m) else { return 0.0 };
    let foot = weights.into_iter().fold(f64::INFINITY, f64::min);
    let beside_m = (-foot - PairDepths::LARGEST) * size_m / SHIFT;
    // Not a number for a triangle without area.
    out_of_plane_m.max(beside_m).max(0.0)
}

fn edge_clearance_m(pair: &PairView, (first, second): (u32, u32)) -> f64 {
    let ends = |side: usize, edge: u32| {
        let view = &pair.views[side];
        view.surface.edges[edge as usize].nodes.map(|n| view.positions_m[n as usize])
    };
    let (p, q) = (ends(0, first), ends(1, second));
    let (along_p, along_q) = (p[1] - p[0], q[1] - q[0]);
    let lengths2 = along_p.length_squared() * along_q.length_squared();
    let sine2 = along_p.cross(along_q).length_squared() / lengths2;
    let shortest_m = along_p.length().min(along_q.length());
    let is_held = pair.list.holds_edges(pair.bodies, [first, second]);
    let depth = if is_held { pair.depths.held } else { pair.depths.new_edges };
    // Edges touch between their ends only, where the lines are no nearer to each other than the edges.
    let between_m = distance_of_segments(p, q) - depth * shortest_m;
    if sine2 < NEARLY_PARALLEL {
        return between_m.max(0.0);
    }
    let Some((s, t)) = closest_on_lines(p, q) else { return 0.0 };
    let beyond = |share: f64| (-share).max(share - 1.0) + pair.edge_ends();
    // Where two lines cross moves the faster the smaller their angle.
    let beside_m = beyond(s).max(beyond(t)) * shortest_m * (sine2.sqrt() / SHIFT);
    between_m.max(beside_m).max(0.0)
}
