//! Which features may meet soon, by the boxes of their triangles.
//!
//! Pairs are enumerated by triangles; every node and edge is spoken for by one triangle only, so that none
//! comes twice and no set of pairs is needed. What is found is sorted, so that nothing depends on how it was searched.

use super::boxes::{SurfaceBoxes, overlap};
use super::own::OwnFeatures;
use super::surface::ContactSurface;
use super::twins::TwinState;
use crate::math::in_parts;
use glam::DVec3;
use rayon::prelude::*;

/// Pairs of features of two bodies (or of one with itself) that may meet.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Candidates {
    /// Node of the first body, triangle of the second, ascending.
    pub node_on_second: Vec<(u32, u32)>,
    /// Node of the second body, triangle of the first, ascending; empty for a body with itself.
    pub node_on_first: Vec<(u32, u32)>,
    /// Edges of the first and of the second body, ascending; for a body with itself the smaller number first.
    pub edge_pairs: Vec<(u32, u32)>,
    /// Of a body with itself: what is known of twins.
    pub(super) twins: EntryTwins,
}

/// What cracks have to do with the entries of candidates of a body with itself.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct EntryTwins {
    /// The twins that speak for an entry of `node_on_second` while they are together, or [`NO_TWINS`].
    pub of_nodes: Vec<u32>,
    /// The same for `edge_pairs`, at up to two ends.
    pub of_edges: Vec<[u32; 2]>,
    /// Whether a crack parted the node and the triangle of an entry of `node_on_second`.
    pub were_one: Vec<bool>,
}

impl EntryTwins {
    pub fn of(candidates: &Candidates, surface: &ContactSurface) -> Self {
        let twin =
            |node: u32, others: &[u32]| others.iter().find_map(|other| surface.twins.pair(node, *other));
        let at_node = |(node, triangle): &(u32, u32)| {
            twin(*node, &surface.triangles[*triangle as usize]).unwrap_or(NO_TWINS)
        };
        let at_ends = |(first, second): &(u32, u32)| {
            let [p, q] = [first, second].map(|edge| surface.edges[*edge as usize].nodes);
            p.map(|node| twin(node, &q).unwrap_or(NO_TWINS))
        };
        let were_one = |(node, triangle): &(u32, u32)| surface.were_one(*node, *triangle);
        Self {
            of_nodes: in_parts::map(&candidates.node_on_second, PAIRS_AT_ONCE, at_node),
            were_one: in_parts::map(&candidates.node_on_second, PAIRS_AT_ONCE, were_one),
            of_edges: in_parts::map(&candidates.edge_pairs, PAIRS_AT_ONCE, at_ends),
        }
    }
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

    /// How many there are.
    pub(super) fn count(&self) -> usize {
        self.node_on_second.len() + self.node_on_first.len() + self.edge_pairs.len()
    }

    /// Forgets all.
    pub(super) fn clear(&mut self) {
        self.node_on_second.clear();
        self.node_on_first.clear();
        self.edge_pairs.clear();
        self.twins.were_one.clear();
    }

    /// Whether twins leave it to an entry of `node_on_second` itself to tell contact.
    pub(super) fn is_left_by_twins(&self, entry: usize, states: &[TwinState]) -> bool {
        match self.twins.of_nodes.get(entry).map_or(TwinState::Apart, |twins| state_of(*twins, states)) {
            TwinState::Together => false,
            TwinState::Open => !self.twins.were_one[entry],
            TwinState::Apart => true,
        }
    }

    /// Whether twins leave it to an entry of `edge_pairs` itself to tell contact.
    pub(super) fn edges_are_left_by_twins(&self, entry: usize, states: &[TwinState]) -> bool {
        let mut ends = self.twins.of_edges.get(entry).into_iter().flatten();
        ends.all(|twins| state_of(*twins, states) != TwinState::Together)
    }
}

/// A surface and its boxes.
pub type Boxed<'a> = (&'a ContactSurface, &'a SurfaceBoxes);

/// Candidates between two bodies. With `swept` boxes pass boxes built by [`SurfaceBoxes::swept`]; node
/// boxes are then not used to sharpen the search.
#[must_use]
pub fn between(first: Boxed, second: Boxed, is_swept: bool) -> Candidates {
    between_triangles(first, second, &first.1.pairs_with(second.1), is_swept)
}

/// The same, of pairs of triangles whose boxes overlap.
pub(super) fn between_triangles(
    first: Boxed,
    second: Boxed,
    pairs: &[(u32, u32)],
    is_swept: bool,
) -> Candidates {
    let mut found = Candidates::default();
    let ((s1, b1), (s2, b2)) = (first, second);
    for (t1, t2) in pairs.iter().copied() {
        push_nodes(&mut found.node_on_second, (s1, b1, t1), (s2, b2, t2), is_swept);
        push_nodes(&mut found.node_on_first, (s2, b2, t2), (s1, b1, t1), is_swept);
        push_edges(&mut found.edge_pairs, (s1, b1, t1), (s2, b2, t2), is_swept);
    }
    found.node_on_second.sort_unstable();
    found.node_on_first.sort_unstable();
    found.edge_pairs.sort_unstable();
    found
}

/// Candidates of a body with itself.
#[must_use]
pub fn within(own: &OwnFeatures, boxes: &SurfaceBoxes) -> Candidates {
    let search = OwnSearch::new(own, boxes);
    let mut found = found_in_parts(&boxes.own_pairs(), PAIRS_AT_ONCE, |pairs| search.of_pairs(pairs));
    found.twins = EntryTwins::of(&found, own.surface);
    found
}

/// Looks for candidates of a body with itself.
pub(super) struct OwnSearch<'a> {
    own: &'a OwnFeatures<'a>,
    boxes: &'a SurfaceBoxes,
    /// By triangle: whether a crack ends at one of its nodes.
    is_cracked: Vec<bool>,
}

impl<'a> OwnSearch<'a> {
    pub(super) fn new(own: &'a OwnFeatures<'a>, boxes: &'a SurfaceBoxes) -> Self {
        let surface = own.surface;
        let is_at_crack = |nodes: &[u32; 3]| nodes.iter().any(|node| surface.is_at_crack(*node));
        Self { own, boxes, is_cracked: surface.triangles.iter().map(is_at_crack).collect() }
    }

    /// Candidates of pairs of triangles, in any order and without what is known of twins.
    pub(super) fn of_pairs(&self, pairs: &[(u32, u32)]) -> Candidates {
        let Self { own, boxes, is_cracked } = self;
        let surface = own.surface;
        let mut found = Candidates::default();
        for (t1, t2) in pairs.iter().copied() {
            let is_whole = !is_cracked[t1 as usize] && !is_cracked[t2 as usize];
            if (is_whole && share_a_node(surface, t1, t2))
                || !overlap(boxes.of_triangle(t1), boxes.of_triangle(t2))
            {
                continue;
            }
            push_nodes(&mut found.node_on_second, (surface, boxes, t1), (surface, boxes, t2), false);
            push_nodes(&mut found.node_on_second, (surface, boxes, t2), (surface, boxes, t1), false);
            push_edges(&mut found.edge_pairs, (surface, boxes, t1), (surface, boxes, t2), false);
        }
        found.node_on_second.retain(|(node, triangle)| {
            !surface.triangles[*triangle as usize].contains(node) && own.node_may_touch(*node, *triangle)
        });
        found.edge_pairs.retain_mut(|pair| {
            let (e1, e2) = *pair;
            *pair = (e1.min(e2), e1.max(e2));
            let [p, q] = [e1, e2].map(|e| surface.edges[e as usize].nodes);
            p.iter().all(|n| !q.contains(n)) && own.edges_may_touch(e1, e2)
        });
        found
    }
}

/// What `of_part` finds for parts of a list, all together and sorted. A thread takes `part` items at a time.
pub(super) fn found_in_parts<T: Sync>(
    items: &[T],
    part: usize,
    of_part: impl Fn(&[T]) -> Candidates + Sync,
) -> Candidates {
    let parts: Vec<Candidates> = if items.len() <= part {
        vec![of_part(items)]
    } else {
        items.par_chunks(part).map(&of_part).collect()
    };
    let mut found = Candidates::default();
    for part in parts {
        found.node_on_second.extend(part.node_on_second);
        found.edge_pairs.extend(part.edge_pairs);
    }
    let count = found.count();
    let Candidates { node_on_second, edge_pairs, .. } = &mut found;
    in_parts::both(count, || node_on_second.par_sort_unstable(), || edge_pairs.par_sort_unstable());
    found
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
    if owns == [false; 3] {
        return;
    }
    let corners = patch_surface.corners_m(triangle, patch_boxes.built_at_m());
    let normal = (corners[1] - corners[0]).cross(corners[2] - corners[0]);
    let patch_margin_m = patch_boxes.most_margin_m(&patch_surface.triangles[triangle as usize]);
    let depth_m = DEPTH * patch_surface.triangle_size_m[triangle as usize];
    // The distance from the plane bounds the one from the patch, which no motion within the margins changes by more.
    let depth = depth_m * normal.length();
    let is_in_reach = |node: u32| {
        let margins_m = boxes.margin_m(node) + patch_margin_m;
        let height = (boxes.built_at_m()[node as usize] - corners[0]).dot(normal);
        height.abs() <= MARGIN_USED * (margins_m * normal).length() + depth
            && overlap(&boxes.node_box(node), patch_boxes.of_triangle(triangle))
    };
    for (node, _) in nodes.into_iter().zip(owns).filter(|(_, owns)| *owns) {
        if is_swept || is_in_reach(node) {
            out.push((node, triangle));
        }
    }
}

type Speaker<'a> = (&'a ContactSurface, &'a SurfaceBoxes, u32);

fn push_edges(out: &mut Vec<(u32, u32)>, first: Speaker, second: Speaker, is_swept: bool) {
    let owns_none = |(surface, _, t): Speaker| surface.owned_edges[t as usize] == [None; 3];
    if owns_none(first) || owns_none(second) {
        return;
    }
    let sharp = |(surface, boxes, t): Speaker| {
        surface.owned_edges[t as usize].map(|edge| {
            let edge = edge?;
            let ends = surface.edges[edge as usize].nodes;
            Some((edge, ends.map(|n| boxes.built_at_m()[n as usize]), boxes.most_margin_m(&ends)))
        })
    };
    let others = sharp(second);
    for (e1, p, p_margin_m) in sharp(first).into_iter().flatten() {
        for (e2, q, q_margin_m) in others.iter().flatten() {
            let margins_m = p_margin_m + q_margin_m;
            if is_swept || (are_boxes_near(p, *q, margins_m) && are_lines_near(p, *q, margins_m)) {
                out.push((e1, *e2));
            }
        }
    }
}

/// Whether the boxes around two edges come as near as the margins allow.
fn are_boxes_near(p: [DVec3; 2], q: [DVec3; 2], margins_m: DVec3) -> bool {
    let between = p[0].min(p[1]).max(q[0].min(q[1])) - p[0].max(p[1]).min(q[0].max(q[1]));
    between.cmple(margins_m).all()
}

/// Whether the lines through two edges come as near as the margins allow.
fn are_lines_near(p: [DVec3; 2], q: [DVec3; 2], margins_m: DVec3) -> bool {
    let (e1, e2) = (p[1] - p[0], q[1] - q[0]);
    let across = e1.cross(e2);
    let depth_m = DEPTH * e1.length_squared().min(e2.length_squared()).sqrt();
    (q[0] - p[0]).dot(across).abs() <= MARGIN_USED * (margins_m * across).length() + depth_m * across.length()
}
