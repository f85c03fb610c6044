//! The candidates that are close at present: a short list for every step.
//!
//! The boxes of the search are wide, so that they last; most of what they find is far from touching. Each candidate that is
//! looked at and found out of reach sleeps until the clusters of its features (see `ways.rs`) have moved by as much as it lacks.

use super::boxes::SurfaceBoxes;
use super::candidates::{Boxed, Candidates, EntryTwins};
use super::detect::{NEAR, PairDepths, PairView};
use super::follow::Origins;
use super::geometry::{barycentric, closest_on_lines, distance_of_segments};
use super::own::OwnFeatures;
use super::surface::ContactSurface;
use super::thrown::ThrownNodes;
use super::twins::TwinState;
use super::ways::Ways;
use crate::math::in_parts;
use crate::mesh::Renumbering;
use glam::DVec3;
use rayon::prelude::*;

/// Ways to come count by this factor, so that what is found close is not looked at in every step.
const SPEED_UP: f64 = 2.0;
/// Shift of a foot in its plane, over the way of the points: a patch may turn.
const SHIFT: f64 = 2.0;
/// Squared sine of the angle between edges below which their closest points move too fast to say anything.
const NEARLY_PARALLEL: f64 = 0.04;

/// The close ones of a pair's candidates.
#[derive(Clone, Debug, Default)]
pub struct CloseList {
    candidates: Candidates,
    twin_states: Vec<TwinState>,
    ways: Ways,
    wake: Wake,
    /// Way that points may make in the present step, m.
    way_m: f64,
}

/// By candidate: the way of its clusters at which it must be looked at again, m; negative where it is close until then.
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

    /// Counts from now on in place of when the ways began.
    fn count_from_now(&mut self, ways: &Ways) {
        let before_m: Vec<f64> = ways.of_pairs().map(|(before_m, _)| before_m).collect();
        let count = |wakes_m: &mut [f64], pairs: &[u32]| {
            for (wake_m, pair) in wakes_m.iter_mut().zip(pairs) {
                let before_m = before_m[*pair as usize];
                *wake_m =
                    if *wake_m < 0.0 { (*wake_m + before_m).min(0.0) } else { (*wake_m - before_m).max(0.0) };
            }
        };
        count(&mut self.node_on_second_m, &ways.of_node_on_second);
        count(&mut self.node_on_first_m, &ways.of_node_on_first);
        count(&mut self.edge_pairs_m, &ways.of_edge_pair);
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
    /// Follows a cut of one of two bodies, whose nodes are at `positions_m` now; `all` are the candidates before it, and
    /// are brought up to date.
    pub fn follow_between(
        &mut self,
        all: &mut Candidates,
        [first, second]: [Boxed; 2],
        positions_m: [&[DVec3]; 2],
        numbers: [Option<&Renumbering>; 2],
    ) {
        let (now, origins) = all.follow_between(first, second, numbers);
        self.follow(&now, ([first.0, second.0], positions_m, false), &origins);
        *all = now;
    }

    /// Follows a cut of a body that is near itself; `all` are the candidates before it, and are brought up to date.
    pub fn follow_within(
        &mut self,
        all: &mut Candidates,
        (own, boxes): (&OwnFeatures, &SurfaceBoxes),
        numbers: &Renumbering,
    ) {
        let (now, origins) = all.follow_within(own, boxes, numbers);
        let of_body = ([own.surface; 2], [own.positions_m; 2], true);
        let twins = || EntryTwins::of(&now, own.surface);
        let (twins, ()) = in_parts::both(now.count(), twins, || self.follow(&now, of_body, &origins));
        *all = Candidates { twins, ..now };
    }

    fn follow(
        &mut self,
        all: &Candidates,
        (surfaces, positions_m, is_own): ([&ContactSurface; 2], [&[DVec3]; 2], bool),
        origins: &Origins,
    ) {
        self.ways.look(positions_m);
        self.wake.count_from_now(&self.ways);
        let Self { wake, ways, .. } = self;
        let ways_of = || Ways::of(all, surfaces, positions_m, is_own);
        let (now, ()) = in_parts::both(all.count(), ways_of, || wake.follow(origins));
        *ways = now;
    }

    /// Those of all candidates with nodes to be looked at again that may touch when ways change as far as `thrown` reckons with:
    /// more than the close ones when that is more than the list was made ready for.
    pub(super) fn thrown_within(
        &self,
        all: &Candidates,
        (states, thrown, pair): (&[TwinState], &ThrownNodes, &PairView),
    ) -> Candidates {
        // Up to which wakes of which clusters count.
        let flies = self.ways.most_of_nodes(|side, node| thrown.is_due(side, node));
        let changes_m = self.ways.most_of_nodes(|side, node| thrown.of_node_m(side, node));
        let ways_m = self.ways.of_pairs().zip(flies).zip(changes_m);
        let due_m = ways_m.map(|(((before_m, ahead_m), flies), changes_m)| {
            let change_m: f64 = changes_m.iter().sum();
            if flies.contains(&true) { before_m + SPEED_UP * ahead_m + change_m } else { f64::NEG_INFINITY }
        });
        let due_m: Vec<f64> = due_m.collect();
        let is_near = |wake_m: f64, pair: u32| {
            let due_m = due_m[pair as usize];
            wake_m <= due_m || (wake_m < 0.0 && due_m > f64::NEG_INFINITY)
        };
        let surface = |side: usize| pair.views[side].surface;
        let nodes_fly = |side: usize, nodes: &[u32]| nodes.iter().any(|n| thrown.is_due(side, *n));
        let node_flies = |side: usize, (node, triangle): (u32, u32)| {
            thrown.is_due(side, node) || nodes_fly(1 - side, &surface(1 - side).triangles[triangle as usize])
        };
        let edge_flies = |side: usize, edge: u32| nodes_fly(side, &surface(side).edges[edge as usize].nodes);
        let near_of = |wakes_m: &[f64], clusters: &[u32], flies: &(dyn Fn(usize) -> bool + Sync)| {
            in_parts::filter_map(wakes_m, CHUNK, |place, wake_m| {
                (is_near(*wake_m, clusters[place]) && flies(place)).then_some(place)
            })
        };
        let (wake, ways) = (&self.wake, &self.ways);
        let on_second = || {
            near_of(&wake.node_on_second_m, &ways.of_node_on_second, &|place| {
                node_flies(0, all.node_on_second[place]) && all.is_left_by_twins(place, states)
            })
        };
        let on_first = near_of(&wake.node_on_first_m, &ways.of_node_on_first, &|place| {
            node_flies(1, all.node_on_first[place])
        });
        let edges = || {
            near_of(&wake.edge_pairs_m, &ways.of_edge_pair, &|place| {
                let (first, second) = all.edge_pairs[place];
                (edge_flies(0, first) || edge_flies(1, second)) && all.edges_are_left_by_twins(place, states)
            })
        };
        let (on_second, edges) = in_parts::both(all.count(), on_second, edges);
        let were_one = on_second.iter().filter_map(|place| all.twins.were_one.get(*place).copied());
        Candidates {
            node_on_second: on_second.iter().map(|place| all.node_on_second[*place]).collect(),
            node_on_first: on_first.iter().map(|place| all.node_on_first[*place]).collect(),
            edge_pairs: edges.iter().map(|place| all.edge_pairs[*place]).collect(),
            twins: EntryTwins { were_one: were_one.collect(), ..EntryTwins::default() },
        }
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

    /// Gets ready for a step in which the response brings points nearer to each other than their velocities do by up to
    /// `slack_m`. `all` are the candidates of the search, always the same for one list.
    pub fn renew(&mut self, pair: &PairView, all: &Candidates, slack_m: f64) {
        let positions_m = pair.views.map(|view| view.positions_m);
        let ways = &mut self.ways;
        let look = || {
            if ways.fit(all) {
                ways.look(positions_m);
            } else {
                *ways = Ways::of(all, pair.views.map(|view| view.surface), positions_m, pair.is_own());
            }
            ways.look_ahead(pair.views.map(|view| view.velocities_m_s), pair.step_s);
        };
        ((), self.twin_states) = in_parts::both(all.count(), look, || pair.twin_states(slack_m));
        self.way_m = self.ways.most_ahead_m();
        self.wake.fit(all);
        let reach = |(before_m, ahead_m)| Reach { before_m, reach_m: SPEED_UP * ahead_m + slack_m };
        let look = Look {
            pair,
            all,
            twin_states: &self.twin_states,
            reaches: self.ways.of_pairs().map(reach).collect(),
        };
        look.over(&self.ways, &mut self.wake, &mut self.candidates);
    }
}

/// How far two clusters have come and may come.
struct Reach {
    /// Way until now, m.
    before_m: f64,
    /// Way to come up to which candidates are close, m.
    reach_m: f64,
}

impl Reach {
    /// Whether a candidate that is not asleep is close; asks for its clearance only when it is due.
    fn finds_close(&self, wake_m: &mut f64, clearance_m: impl FnOnce() -> f64) -> bool {
        let Self { before_m, reach_m } = *self;
        if *wake_m < -before_m {
            return true;
        }
        let clearance_m = clearance_m();
        let is_close = clearance_m <= reach_m;
        *wake_m = if is_close { -(before_m + reach_m) } else { before_m + clearance_m };
        is_close
    }
}

/// A look at the candidates that are due.
struct Look<'a> {
    pair: &'a PairView<'a>,
    all: &'a Candidates,
    twin_states: &'a [TwinState],
    /// By pair of clusters.
    reaches: Vec<Reach>,
}

impl Look<'_> {
    fn over(&self, ways: &Ways, wake: &mut Wake, close: &mut Candidates) {
        let (all, states) = (self.all, self.twin_states);
        close.clear();
        let of_node = |place: usize, wake_m: &mut f64, reach: &Reach| {
            all.is_left_by_twins(place, states)
                && reach.finds_close(wake_m, || node_clearance_m(self.pair, 0, all.node_on_second[place]))
        };
        let of_edges = |place: usize, wake_m: &mut f64, reach: &Reach| {
            all.edges_are_left_by_twins(place, states)
                && reach.finds_close(wake_m, || edge_clearance_m(self.pair, all.edge_pairs[place]))
        };
        let (places, edges) = in_parts::both(
            all.count(),
            || self.close_places(&mut wake.node_on_second_m, &ways.of_node_on_second, of_node),
            || self.close_places(&mut wake.edge_pairs_m, &ways.of_edge_pair, of_edges),
        );
        for place in places {
            close.node_on_second.push(all.node_on_second[place as usize]);
            close.twins.were_one.extend(all.twins.were_one.get(place as usize));
        }
        close.edge_pairs.extend(edges.into_iter().map(|place| all.edge_pairs[place as usize]));
        let of_node = |place: usize, wake_m: &mut f64, reach: &Reach| {
            reach.finds_close(wake_m, || node_clearance_m(self.pair, 1, all.node_on_first[place]))
        };
        let places = self.close_places(&mut wake.node_on_first_m, &ways.of_node_on_first, of_node);
        close.node_on_first.extend(places.into_iter().map(|place| all.node_on_first[place as usize]));
    }

    /// Places of the candidates of one kind, of which some sleep and the rest `is_close` judges.
    fn close_places(
        &self,
        wakes_m: &mut [f64],
        clusters: &[u32],
        is_close: impl Fn(usize, &mut f64, &Reach) -> bool + Sync,
    ) -> Vec<u32> {
        let of_chunk = |(chunk, (wakes_m, clusters)): (usize, (&mut [f64], &[u32]))| -> Vec<u32> {
            let mut found = Vec::new();
            for (place, (wake_m, pair)) in (chunk * CHUNK..).zip(wakes_m.iter_mut().zip(clusters)) {
                let reach = &self.reaches[*pair as usize];
                let sleeps = *wake_m > reach.before_m + reach.reach_m;
                if !sleeps && is_close(place, wake_m, reach) {
                    found.push(place as u32);
                }
            }
            found
        };
        if wakes_m.len() <= CHUNK {
            return of_chunk((0, (wakes_m, clusters)));
        }
        let chunks = wakes_m.par_chunks_mut(CHUNK).zip(clusters.par_chunks(CHUNK)).enumerate();
        let found: Vec<Vec<u32>> = chunks.map(of_chunk).collect();
        found.concat()
    }
}

/// Candidates that one task looks at.
const CHUNK: usize = 8192;

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
    // The plane of a patch turns: beside it, it moves by more than its corners do. Not a number for a triangle without area.
    let leverage: f64 = weights.into_iter().map(f64::abs).sum();
    (out_of_plane_m / leverage).max(beside_m / leverage).max(0.0)
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
