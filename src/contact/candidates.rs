//! Which features may meet soon: a bounding-volume hierarchy over fattened triangle boxes.
//!
//! Boxes are built around the positions of one moment and fattened by a margin; they stay valid until
//! a node has moved further than that, so the hierarchy is not touched in most steps (a Verlet list).
//! Pairs are enumerated by triangles; every node and edge is spoken for by one triangle only, so that none
//! comes twice and no set of pairs is needed.

use super::own::OwnFeatures;
use super::surface::ContactSurface;
use super::twins::TwinState;
use glam::DVec3;
use parry3d_f64::bounding_volume::Aabb;
use parry3d_f64::partitioning::{Bvh, BvhBuildStrategy, BvhWorkspace};
use rayon::prelude::*;

/// Fattened boxes of one surface.
pub struct SurfaceBoxes {
    bvh: Bvh,
    boxes: Vec<Aabb>,
    positions_m: Vec<DVec3>,
    margin_m: f64,
}

/// A box around points that may be anywhere between two moments, fattened.
fn box_around(points: impl IntoIterator<Item = DVec3>, margin_m: f64) -> Aabb {
    let (mut low, mut high) = (DVec3::INFINITY, DVec3::NEG_INFINITY);
    for p in points {
        low = low.min(p);
        high = high.max(p);
    }
    Aabb::new(low - DVec3::splat(margin_m), high + DVec3::splat(margin_m))
}

fn overlap(a: &Aabb, b: &Aabb) -> bool {
    a.mins.cmple(b.maxs).all() && b.mins.cmple(a.maxs).all()
}

impl SurfaceBoxes {
    /// Boxes around the surface at `positions_m` (all nodes of the body), fattened by `margin_m`.
    #[must_use]
    pub fn around(surface: &ContactSurface, positions_m: &[DVec3], margin_m: f64) -> Self {
        Self::swept(surface, positions_m, positions_m, margin_m)
    }

    /// Boxes around the straight paths of the surface from `start_m` to `end_m`, fattened.
    #[must_use]
    pub fn swept(surface: &ContactSurface, start_m: &[DVec3], end_m: &[DVec3], margin_m: f64) -> Self {
        let boxes: Vec<Aabb> = surface
            .triangles
            .iter()
            .map(|t| {
                let ends = t.iter().flat_map(|n| [start_m[*n as usize], end_m[*n as usize]]);
                box_around(ends, margin_m)
            })
            .collect();
        let bvh = Bvh::from_leaves(BvhBuildStrategy::Binned, &boxes);
        Self { bvh, boxes, positions_m: start_m.to_vec(), margin_m }
    }

    /// How far the boxes are fattened, m.
    #[must_use]
    pub fn margin_m(&self) -> f64 {
        self.margin_m
    }

    /// Positions at which the boxes were built, all nodes of the body, m.
    #[must_use]
    pub fn built_at_m(&self) -> &[DVec3] {
        &self.positions_m
    }

    /// Box around everything.
    #[must_use]
    pub fn bounds(&self) -> Aabb {
        self.bvh.root_aabb()
    }

    fn node_box(&self, node: u32) -> Aabb {
        box_around([self.positions_m[node as usize]], self.margin_m)
    }
}

/// Pairs of features of two bodies (or of one with itself) that may meet.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Candidates {
    /// Node of the first body, triangle of the second, ascending.
    pub node_on_second: Vec<(u32, u32)>,
    /// Node of the second body, triangle of the first, ascending; empty for a body with itself.
    pub node_on_first: Vec<(u32, u32)>,
    /// Edges of the first and of the second body.
    pub edge_pairs: Vec<(u32, u32)>,
    /// Of a body with itself: the twins that speak for an entry of `node_on_second` while they are together, or
    /// [`NO_TWINS`].
    pub(super) node_twins: Vec<u32>,
    /// The same for `edge_pairs`, at up to two ends.
    pub(super) edge_twins: Vec<[u32; 2]>,
    /// Of a body with itself: whether a crack parted the node and the triangle of an entry of `node_on_second`.
    pub(super) were_one: Vec<bool>,
}

fn state_of(twins: u32, states: &[TwinState]) -> TwinState {
    states.get(twins as usize).copied().unwrap_or(TwinState::Apart)
}

/// Stands for no pair of twins.
pub(super) const NO_TWINS: u32 = u32::MAX;

impl Candidates {
    /// Whether nothing can meet.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.node_on_second.is_empty() && self.node_on_first.is_empty() && self.edge_pairs.is_empty()
    }

    fn sort_nodes(&mut self) {
        self.node_on_second.sort_unstable();
        self.node_on_first.sort_unstable();
    }

    /// Forgets all.
    pub(super) fn clear(&mut self) {
        self.node_on_second.clear();
        self.node_on_first.clear();
        self.edge_pairs.clear();
        self.were_one.clear();
    }

    /// Whether twins leave it to an entry of `node_on_second` itself to tell contact.
    pub(super) fn is_left_by_twins(&self, entry: usize, states: &[TwinState]) -> bool {
        match self.node_twins.get(entry).map_or(TwinState::Apart, |twins| state_of(*twins, states)) {
            TwinState::Together => false,
            TwinState::Open => !self.were_one[entry],
            TwinState::Apart => true,
        }
    }

    /// The entries of a body with itself that twins leave; `None` where there are no twins.
    pub(super) fn left_by_twins(&self, states: &[TwinState]) -> Option<Self> {
        if states.is_empty() {
            return None;
        }
        let nodes: Vec<usize> =
            (0..self.node_on_second.len()).filter(|i| self.is_left_by_twins(*i, states)).collect();
        let edges = (0..self.edge_pairs.len()).filter(|i| self.edges_are_left_by_twins(*i, states));
        Some(Self {
            node_on_second: nodes.iter().map(|i| self.node_on_second[*i]).collect(),
            were_one: nodes.iter().map(|i| self.were_one[*i]).collect(),
            edge_pairs: edges.map(|i| self.edge_pairs[i]).collect(),
            ..Self::default()
        })
    }

    /// Whether twins leave it to an entry of `edge_pairs` itself to tell contact.
    pub(super) fn edges_are_left_by_twins(&self, entry: usize, states: &[TwinState]) -> bool {
        let mut ends = self.edge_twins.get(entry).into_iter().flatten();
        ends.all(|twins| state_of(*twins, states) != TwinState::Together)
    }

    /// The same candidates of a body with itself, with what is known of the twins of each entry.
    #[must_use]
    pub(super) fn with_twins(mut self, surface: &ContactSurface) -> Self {
        let twin =
            |node: u32, others: &[u32]| others.iter().find_map(|other| surface.twins.pair(node, *other));
        let at_node = |(node, triangle): &(u32, u32)| {
            twin(*node, &surface.triangles[*triangle as usize]).unwrap_or(NO_TWINS)
        };
        let at_ends = |(first, second): &(u32, u32)| {
            let [p, q] = [first, second].map(|edge| surface.edges[*edge as usize].nodes);
            p.map(|node| twin(node, &q).unwrap_or(NO_TWINS))
        };
        self.node_twins = self.node_on_second.iter().map(at_node).collect();
        self.were_one = self.node_on_second.iter().map(|(n, t)| surface.were_one(*n, *t)).collect();
        self.edge_twins = self.edge_pairs.iter().map(at_ends).collect();
        self
    }
}

/// A surface and its boxes.
pub type Boxed<'a> = (&'a ContactSurface, &'a SurfaceBoxes);

/// Candidates between two bodies. With `swept` boxes pass boxes built by [`SurfaceBoxes::swept`]; node
/// boxes are then not used to sharpen the search.
#[must_use]
pub fn between(first: Boxed, second: Boxed, is_swept: bool) -> Candidates {
    let mut found = Candidates::default();
    let ((s1, b1), (s2, b2)) = (first, second);
    for (t1, t2) in b1.bvh.leaf_pairs(&b2.bvh, |x, y| x.intersects(y)) {
        if !overlap(&b1.boxes[t1 as usize], &b2.boxes[t2 as usize]) {
            continue;
        }
        push_nodes(&mut found.node_on_second, (s1, b1, t1), (s2, b2, t2), is_swept);
        push_nodes(&mut found.node_on_first, (s2, b2, t2), (s1, b1, t1), is_swept);
        push_edges(&mut found.edge_pairs, (s1, b1, t1), (s2, b2, t2), is_swept);
    }
    found.sort_nodes();
    found
}

/// Candidates of a body with itself.
#[must_use]
pub fn within(own: &OwnFeatures, boxes: &SurfaceBoxes) -> Candidates {
    let surface = own.surface;
    let mut pairs = Vec::new();
    boxes.bvh.traverse_bvtt_single_tree::<false>(&mut BvhWorkspace::default(), &mut |t1, t2| {
        pairs.push((t1, t2));
    });
    let is_cracked: Vec<bool> =
        surface.triangles.iter().map(|t| t.iter().any(|node| surface.is_at_crack(*node))).collect();
    let of_pairs = |pairs: &[(u32, u32)]| {
        let mut found = Candidates::default();
        for (t1, t2) in pairs.iter().copied() {
            let has_cracked = is_cracked[t1 as usize] || is_cracked[t2 as usize];
            if (!has_cracked && share_a_node(surface, t1, t2))
                || !overlap(&boxes.boxes[t1 as usize], &boxes.boxes[t2 as usize])
            {
                continue;
            }
            push_nodes(&mut found.node_on_second, (surface, boxes, t1), (surface, boxes, t2), false);
            push_nodes(&mut found.node_on_second, (surface, boxes, t2), (surface, boxes, t1), false);
            push_edges(&mut found.edge_pairs, (surface, boxes, t1), (surface, boxes, t2), false);
        }
        found
    };
    let mut found = Candidates::default();
    for part in pairs.par_chunks(PAIRS_AT_ONCE).map(of_pairs).collect::<Vec<_>>() {
        found.node_on_second.extend(part.node_on_second);
        found.edge_pairs.extend(part.edge_pairs);
    }
    found.node_on_second.retain(|(node, triangle)| {
        !surface.triangles[*triangle as usize].contains(node) && own.node_may_touch(*node, *triangle)
    });
    found.edge_pairs.retain(|(e1, e2)| {
        let [p, q] = [e1, e2].map(|e| surface.edges[*e as usize].nodes);
        p.iter().all(|n| !q.contains(n)) && own.edges_may_touch(*e1, *e2)
    });
    found.sort_nodes();
    found.with_twins(surface)
}

/// Pairs of triangles that one task looks at.
const PAIRS_AT_ONCE: usize = 16_384;

fn share_a_node(surface: &ContactSurface, t1: u32, t2: u32) -> bool {
    let [n1, n2] = [t1, t2].map(|t| surface.triangles[t as usize]);
    n1.iter().any(|n| n2.contains(n))
}

/// Share of their margins that features may have moved by the end of a step for which their boxes still serve.
const MARGIN_USED: f64 = 0.75;
/// Depth, in local element sizes, down to which features that have gone through each other are kept.
const DEPTH: f64 = 0.05;

fn push_nodes(out: &mut Vec<(u32, u32)>, nodes_of: Speaker, patch: Speaker, is_swept: bool) {
    let (surface, boxes, speaker) = nodes_of;
    let (patch_surface, patch_boxes, triangle) = patch;
    let nodes = surface.triangles[speaker as usize];
    let owns = surface.owns_node[speaker as usize];
    let corners = patch_surface.corners_m(triangle, &patch_boxes.positions_m);
    let normal = (corners[1] - corners[0]).cross(corners[2] - corners[0]);
    let margins_m = boxes.margin_m + patch_boxes.margin_m;
    let reach_m = MARGIN_USED * margins_m + DEPTH * patch_surface.triangle_size_m[triangle as usize];
    // The distance from the plane bounds the one from the patch, which no motion within the margins changes by more.
    let is_in_reach = |node: u32| {
        let height = (boxes.positions_m[node as usize] - corners[0]).dot(normal);
        height * height <= reach_m * reach_m * normal.length_squared()
            && overlap(&boxes.node_box(node), &patch_boxes.boxes[triangle as usize])
    };
    for (node, _) in nodes.into_iter().zip(owns).filter(|(_, owns)| *owns) {
        if is_swept || is_in_reach(node) {
            out.push((node, triangle));
        }
    }
}

type Speaker<'a> = (&'a ContactSurface, &'a SurfaceBoxes, u32);

fn push_edges(out: &mut Vec<(u32, u32)>, first: Speaker, second: Speaker, is_swept: bool) {
    let sharp = |(surface, boxes, t): Speaker| {
        surface.owned_edges[t as usize].map(|e| {
            let edge = e.filter(|e| surface.edges[*e as usize].is_sharp)?;
            Some((edge, surface.edges[edge as usize].nodes.map(|n| boxes.positions_m[n as usize])))
        })
    };
    let margins_m = first.1.margin_m + second.1.margin_m;
    let others = sharp(second);
    if others.iter().all(Option::is_none) {
        return;
    }
    for (e1, p) in sharp(first).into_iter().flatten() {
        for (e2, q) in others.iter().flatten() {
            if is_swept || (are_boxes_near(p, *q, margins_m) && are_lines_near(p, *q, margins_m)) {
                out.push((e1, *e2));
            }
        }
    }
}

/// Whether the boxes around two edges come as near as the margins allow.
fn are_boxes_near(p: [DVec3; 2], q: [DVec3; 2], margins_m: f64) -> bool {
    let between = p[0].min(p[1]).max(q[0].min(q[1])) - p[0].max(p[1]).min(q[0].max(q[1]));
    between.max_element() <= margins_m
}

/// Whether the lines through two edges come as near as the margins allow.
fn are_lines_near(p: [DVec3; 2], q: [DVec3; 2], margins_m: f64) -> bool {
    let (e1, e2) = (p[1] - p[0], q[1] - q[0]);
    let across = e1.cross(e2);
    let reach_m = MARGIN_USED * margins_m + DEPTH * e1.length_squared().min(e2.length_squared()).sqrt();
    (q[0] - p[0]).dot(across).powi(2) <= reach_m * reach_m * across.length_squared()
}
