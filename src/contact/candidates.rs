//! Which features may meet soon: a bounding-volume hierarchy over fattened triangle boxes.
//!
//! Boxes are built around the positions of one moment and fattened by a margin; they stay valid until
//! a node has moved further than that, so the hierarchy is not touched in most steps (a Verlet list).
//! Pairs are enumerated by triangles; every node and edge is spoken for by one triangle only, so that none
//! comes twice and no set of pairs is needed.

use super::surface::ContactSurface;
use glam::DVec3;
use parry3d_f64::bounding_volume::Aabb;
use parry3d_f64::partitioning::{Bvh, BvhBuildStrategy, BvhWorkspace};

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
    /// Node of the first body, triangle of the second.
    pub node_on_second: Vec<(u32, u32)>,
    /// Node of the second body, triangle of the first; empty for a body with itself.
    pub node_on_first: Vec<(u32, u32)>,
    /// Edges of the first and of the second body.
    pub edge_pairs: Vec<(u32, u32)>,
}

impl Candidates {
    /// Whether nothing can meet.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.node_on_second.is_empty() && self.node_on_first.is_empty() && self.edge_pairs.is_empty()
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
        push_nodes(&mut found.node_on_second, (s1, b1, t1), (b2, t2), is_swept);
        push_nodes(&mut found.node_on_first, (s2, b2, t2), (b1, t1), is_swept);
        push_edges(&mut found.edge_pairs, (s1, b1, t1), (s2, b2, t2), is_swept);
    }
    found
}

/// Candidates of a body with itself. Features that are neighbours in the reference shape are left out: they could
/// only meet by turning an element inside out.
#[must_use]
pub fn within(body: Boxed, reference_m: &[DVec3]) -> Candidates {
    let mut found = Candidates::default();
    let (surface, boxes) = body;
    let mut pairs = Vec::new();
    boxes.bvh.traverse_bvtt_single_tree::<false>(&mut BvhWorkspace::default(), &mut |t1, t2| {
        pairs.push((t1, t2));
    });
    for (t1, t2) in pairs {
        let [n1, n2] = [t1, t2].map(|t| surface.triangles[t as usize]);
        if n1.iter().any(|n| n2.contains(n)) || !overlap(&boxes.boxes[t1 as usize], &boxes.boxes[t2 as usize])
        {
            continue;
        }
        push_nodes(&mut found.node_on_second, (surface, boxes, t1), (boxes, t2), false);
        push_nodes(&mut found.node_on_second, (surface, boxes, t2), (boxes, t1), false);
        push_edges(&mut found.edge_pairs, (surface, boxes, t1), (surface, boxes, t2), false);
    }
    let at = |n: u32| reference_m[n as usize];
    let size = |n: u32| surface.node_size_m[n as usize];
    found.node_on_second.retain(|(node, triangle)| {
        let corners = surface.triangles[*triangle as usize];
        corners.iter().all(|c| at(*node).distance(at(*c)) > NEIGHBOUR * size(*node).max(size(*c)))
    });
    found.edge_pairs.retain(|(e1, e2)| {
        let [a, b] = [e1, e2].map(|e| surface.edges[*e as usize].nodes);
        let far = |n: &u32, m: &u32| at(*n).distance(at(*m)) > NEIGHBOUR * size(*n).max(size(*m));
        a.iter().all(|n| b.iter().all(|m| far(n, m)))
    });
    found
}

/// Reference distance, in local element sizes, up to which features of one body are neighbours.
const NEIGHBOUR: f64 = 2.0;

fn push_nodes(
    out: &mut Vec<(u32, u32)>,
    (surface, boxes, speaker): (&ContactSurface, &SurfaceBoxes, u32),
    (patch_boxes, patch): (&SurfaceBoxes, u32),
    is_swept: bool,
) {
    let nodes = surface.triangles[speaker as usize];
    let owns = surface.owns_node[speaker as usize];
    for (node, _) in nodes.into_iter().zip(owns).filter(|(_, owns)| *owns) {
        if is_swept || overlap(&boxes.node_box(node), &patch_boxes.boxes[patch as usize]) {
            out.push((node, patch));
        }
    }
}

type Speaker<'a> = (&'a ContactSurface, &'a SurfaceBoxes, u32);

fn push_edges(out: &mut Vec<(u32, u32)>, first: Speaker, second: Speaker, is_swept: bool) {
    let sharp = |(surface, boxes, t): Speaker| {
        surface.owned_edges[t as usize].map(|e| {
            let edge = e.filter(|e| surface.edges[*e as usize].is_sharp)?;
            let ends = surface.edges[edge as usize].nodes.map(|n| boxes.positions_m[n as usize]);
            Some((edge, box_around(ends, boxes.margin_m)))
        })
    };
    let others = sharp(second);
    for (e1, box1) in sharp(first).into_iter().flatten() {
        for (e2, box2) in others.iter().flatten() {
            if is_swept || overlap(&box1, box2) {
                out.push((e1, *e2));
            }
        }
    }
}
