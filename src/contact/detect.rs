//! From candidates to constraints: which pairs touch, or would at the end of the step.

use super::atomic::{AtomicCase, Verdict};
use super::candidates::Candidates;
use super::constraint::{Constraint, Feature, Geometry};
use super::geometry::{closest_on_lines, unit_normal};
use super::impact::{ImpactStore, ImpactStores};
use super::surface::ContactSurface;
use super::time_of_impact::{BORDER, Moving, node_meets_triangle};
use glam::DVec3;

/// Gap, as a share of the local element size, within which a pair takes part in the response even
/// when the prediction does not close it: neighbours' impulses may.
const NEAR: f64 = 1e-3;
/// Penetration, as a share of the local element size, that a *new* pair may begin with: what a pair that was
/// left out as redundant may have gathered.
const NEW_PAIR_DEPTH: f64 = 4e-4;
/// Penetration that a node already held by the same body may carry when it slides on to the next patch.
const HELD_PAIR_DEPTH: f64 = 0.05;
/// How far a held node may stand out over the border of its patch, in the patch's own coordinates. Flush bodies
/// strain sideways by less; a node that had to let go of the face for that would be behind the face round the corner when
/// it comes back.
const HELD_BORDER: f64 = 0.02;
/// Cosine of the angle up to which a patch continues the one that held a node before.
const SAME_SIDE: f64 = 0.8;
/// Cosine of the angle up to which two patches at a node are one plane.
const SAME_PLANE: f64 = 0.9999;
/// Sine of the angle by which an edge's contact normal may lie outside the fan of its face normals. Generous: flush
/// bodies (two rods of the same width) tilt against each other by the strain at the contact, and a
/// node that has slipped off a flush border is held by nothing but these pairs.
const FAN_TOLERANCE: f64 = 0.1;

/// What detection sees of a body: all arrays are indexed by the body's nodes.
#[derive(Clone, Copy)]
pub struct BodyView<'a> {
    /// Surface.
    pub surface: &'a ContactSurface,
    /// Positions at the start of the step, m.
    pub positions_m: &'a [DVec3],
    /// Predicted velocities over the step, m/s.
    pub velocities_m_s: &'a [DVec3],
}

/// Two bodies (or one twice) and what may meet between them.
#[derive(Clone, Copy)]
pub struct PairView<'a> {
    /// Numbers of the bodies.
    pub bodies: [u32; 2],
    /// The bodies.
    pub views: [BodyView<'a>; 2],
    /// What may meet.
    pub candidates: &'a Candidates,
    /// Coulomb friction coefficient.
    pub friction_coefficient: f64,
}

type HeldNode = (u32, u32, u32);

/// Which pairs pressed in the last step ("as in the last step" in the atomic table).
#[derive(Clone, Debug, Default, PartialEq)]
pub struct CollisionList {
    /// (body of the node, node, body of the patch), sorted, and the normal.
    held_nodes: Vec<(HeldNode, DVec3)>,
    /// (first body, second body, first edge, second edge), sorted.
    held_edges: Vec<(u32, u32, u32, u32)>,
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
        kept.stores = kept.stores.keep(of);
        kept
    }

    /// Adds another list.
    pub fn merge(&mut self, other: Self) {
        self.held_nodes.extend(other.held_nodes);
        self.held_nodes.sort_by_key(|h| h.0);
        self.held_edges.extend(other.held_edges);
        self.held_edges.sort_unstable();
        self.held_edges.dedup();
        self.stores.merge(other.stores);
    }

    /// What impacts have stored.
    #[must_use]
    pub fn stores(&self) -> &ImpactStores {
        &self.stores
    }

    /// Whether the node was held by the body along about this normal.
    fn holds(&self, key: HeldNode, normal: DVec3) -> bool {
        let first = self.held_nodes.partition_point(|h| h.0 < key);
        let same = self.held_nodes[first..].iter().take_while(|h| h.0 == key);
        same.into_iter().any(|h| h.1.dot(normal) > SAME_SIDE)
    }

    /// Whether no pair pressed.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.held_nodes.is_empty() && self.held_edges.is_empty()
    }
}

/// Finds the constraints of a pair of bodies over a step of `step_s` and appends them.
pub fn detect(pair: &PairView, step_s: f64, list: &CollisionList, out: &mut Vec<Constraint>) {
    let swapped = [pair.bodies[1], pair.bodies[0]];
    let [first, second] = pair.views;
    let node_side = |bodies, views| NodeSide { bodies, views, step_s, list, pair };
    let side = node_side(pair.bodies, [first, second]);
    side.find(&pair.candidates.node_on_second, out);
    let side = node_side(swapped, [second, first]);
    side.find(&pair.candidates.node_on_first, out);
    let edges = pair.candidates.edge_pairs.iter();
    out.extend(edges.filter_map(|c| edge_constraint(pair, *c, step_s, list)));
}

/// Nodes of one body against patches of the other.
struct NodeSide<'a> {
    bodies: [u32; 2],
    views: [BodyView<'a>; 2],
    step_s: f64,
    list: &'a CollisionList,
    pair: &'a PairView<'a>,
}

impl NodeSide<'_> {
    /// Appends the constraints of all candidates, at most one per node where the patches are rivals.
    fn find(&self, candidates: &[(u32, u32)], out: &mut Vec<Constraint>) {
        let mut found: Vec<Constraint> = candidates.iter().filter_map(|c| self.constraint(*c)).collect();
        found.sort_by_key(|c| c.feature);
        for of_node in found.chunk_by(|a, b| a.nodes[0] == b.nodes[0]) {
            let loses = |c: &&Constraint| of_node.iter().any(|rival| self.beats(rival, c));
            out.extend(of_node.iter().filter(|c| !loses(c)));
        }
    }

    /// Whether of two patches that one node touches only `rival` counts: the same plane seen twice, or two
    /// faces of a convex edge, of which a node that comes from outside can be behind one only.
    fn beats(&self, rival: &Constraint, c: &Constraint) -> bool {
        let (Feature::NodeOnPatch { triangle: a, .. }, Feature::NodeOnPatch { triangle: b, .. }) =
            (rival.feature, c.feature)
        else {
            return false;
        };
        if a == b {
            return false;
        }
        let is_one_plane = rival.normal.dot(c.normal) > SAME_PLANE;
        if !is_one_plane && !self.is_convex_between(a, c) {
            return false;
        }
        let rank = |c: &Constraint, triangle: u32| {
            let key = (c.bodies[0], c.nodes[0].1, c.bodies[1]);
            let is_held = self.list.holds(key, c.normal);
            let inside = c.weights[1..].iter().map(|w| -w).fold(f64::INFINITY, f64::min);
            if is_one_plane {
                return (is_held, inside, 0.0, std::cmp::Reverse(triangle));
            }
            // Of two faces of an edge the one that holds already, is less deep, is closed faster.
            let depth = (c.gap_m / c.size_m / NEW_PAIR_DEPTH).round();
            (is_held, depth, c.closing_m_s, std::cmp::Reverse(triangle))
        };
        rank(rival, a).partial_cmp(&rank(c, b)) == Some(std::cmp::Ordering::Greater)
    }

    /// Whether the other patch lies below the plane of `c`'s.
    fn is_convex_between(&self, other_triangle: u32, c: &Constraint) -> bool {
        let view = &self.views[1];
        let corners = view.surface.corners_m(other_triangle, view.positions_m);
        let centre = (corners[0] + corners[1] + corners[2]) / 3.0;
        let on_plane = view.positions_m[c.nodes[1].1 as usize];
        (centre - on_plane).dot(c.normal) < 0.0
    }

    fn constraint(&self, (node, triangle): (u32, u32)) -> Option<Constraint> {
        let [own, other] = &self.views;
        let corners = other.surface.triangles[triangle as usize];
        let size_m =
            other.surface.triangle_size_m[triangle as usize].min(own.surface.node_size_m[node as usize]);
        let patch_m = corners.map(|n| other.positions_m[n as usize]);
        let patch_v = corners.map(|n| other.velocities_m_s[n as usize]);
        let (x, v) = (own.positions_m[node as usize], own.velocities_m_s[node as usize]);
        if is_out_of_reach((x, v), (patch_m, patch_v), size_m, self.step_s) {
            return None;
        }
        let geometry = Geometry::node_on_patch(x, patch_m)?;
        let gap = geometry.gap_m;
        if gap < -HELD_PAIR_DEPTH * size_m {
            return None;
        }
        let w = geometry.weights;
        let relative_v = v + patch_v[0] * w[1] + patch_v[1] * w[2] + patch_v[2] * w[3];
        if gap + self.step_s * relative_v.dot(geometry.normal) > NEAR * size_m {
            return None;
        }
        let path = Paths { x, v, patch_m, patch_v, step_s: self.step_s };
        let key = (self.bodies[0], node, self.bodies[1]);
        let is_held = self.list.holds(key, geometry.normal);
        self.touches(&geometry, &path, size_m, is_held).then(|| Constraint {
            bodies: self.bodies,
            feature: Feature::NodeOnPatch { node, triangle },
            nodes: [(0, node), (1, corners[0]), (1, corners[1]), (1, corners[2])],
            weights: geometry.weights,
            weight_shifts_per_m: geometry.weight_shifts_per_m,
            normal: geometry.normal,
            gap_m: gap,
            place_m: x,
            size_m,
            friction_coefficient: self.pair.friction_coefficient,
            closing_m_s: -relative_v.dot(geometry.normal),
            may_bounce: true,
            stored: ImpactStore::default(),
            target_m_s: 0.0,
            impulse_n_s: DVec3::ZERO,
        })
    }

    fn touches(&self, geometry: &Geometry, path: &Paths, size_m: f64, is_held: bool) -> bool {
        let depth = if is_held { HELD_PAIR_DEPTH } else { NEW_PAIR_DEPTH };
        if geometry.gap_m < -depth * size_m {
            return false;
        }
        let is_over_patch = geometry.is_inside(if is_held { HELD_BORDER } else { BORDER });
        // Away from the borders, or for a node on the patch, the meeting point is decided by the start.
        let foot = geometry.weights[1..].iter().map(|w| -w).fold(f64::INFINITY, f64::min);
        let is_clear = foot.abs() * size_m > 4.0 * path.tangential_m();
        if is_clear || geometry.gap_m <= 0.0 {
            return is_over_patch;
        }
        match path.atomic_case().verdict() {
            Verdict::Collides(_) => path.meets_patch() || (is_held && is_over_patch),
            _ => is_over_patch,
        }
    }
}

/// A cheap look before the geometry: whether the node is further from the patch's plane than it can come in the
/// step, or deeper than any contact.
fn is_out_of_reach(
    (x, v): (DVec3, DVec3),
    (patch_m, patch_v): ([DVec3; 3], [DVec3; 3]),
    size_m: f64,
    step_s: f64,
) -> bool {
    let normal = (patch_m[1] - patch_m[0]).cross(patch_m[2] - patch_m[0]);
    let height = (x - patch_m[0]).dot(normal);
    let patch_v2 = patch_v.iter().map(|u| u.length_squared()).fold(0.0, f64::max);
    let reach_m = if height > 0.0 {
        NEAR * size_m + step_s * (v.length_squared().sqrt() + patch_v2.sqrt())
    } else {
        HELD_PAIR_DEPTH * size_m
    };
    height * height > reach_m * reach_m * normal.length_squared()
}

/// The straight paths of a node and a patch over a step.
struct Paths {
    x: DVec3,
    v: DVec3,
    patch_m: [DVec3; 3],
    patch_v: [DVec3; 3],
    step_s: f64,
}

impl Paths {
    /// Bound on the way of the node along the patch in the step, m.
    fn tangential_m(&self) -> f64 {
        let relative = self.patch_v.iter().map(|u| (self.v - *u).length_squared()).fold(0.0, f64::max);
        relative.sqrt() * self.step_s
    }

    /// The case of the atomic table, relative to the patch's mean motion.
    fn atomic_case(&self) -> AtomicCase {
        let mean_v = (self.patch_v[0] + self.patch_v[1] + self.patch_v[2]) / 3.0;
        let h = self.step_s;
        AtomicCase {
            e: self.x,
            f: self.x + (self.v - mean_v) * h,
            patch_start: self.patch_m,
            patch_end: std::array::from_fn(|i| self.patch_m[i] + (self.patch_v[i] - mean_v) * h),
        }
    }

    fn meets_patch(&self) -> bool {
        let moving = |x: DVec3, v: DVec3| Moving { start_m: x, move_m: v * self.step_s };
        let patch = std::array::from_fn(|i| moving(self.patch_m[i], self.patch_v[i]));
        node_meets_triangle(moving(self.x, self.v), patch).is_some()
    }
}

fn edge_constraint(
    pair: &PairView,
    (first, second): (u32, u32),
    step_s: f64,
    list: &CollisionList,
) -> Option<Constraint> {
    let [view1, view2] = &pair.views;
    let (n1, n2) = (view1.surface.edges[first as usize].nodes, view2.surface.edges[second as usize].nodes);
    let at = |view: &BodyView, n: [u32; 2]| n.map(|n| view.positions_m[n as usize]);
    let speed = |view: &BodyView, n: [u32; 2]| n.map(|n| view.velocities_m_s[n as usize]);
    let (p, q) = (at(view1, n1), at(view2, n2));
    let (v, u) = (speed(view1, n1), speed(view2, n2));
    let size_m = (p[1] - p[0]).length().min((q[1] - q[0]).length());
    let fastest_m_s = v.iter().chain(&u).map(|v| v.length()).fold(0.0, f64::max);
    let reach_m = HELD_PAIR_DEPTH * size_m + 2.0 * fastest_m_s * step_s;
    if !edges_may_touch(p, q, reach_m) {
        return None;
    }
    let fans = [edge_fan(view1, first), edge_fan(view2, second)];
    let geometry = Geometry::edge_on_edge(p, q, fans[1].outward - fans[0].outward)?;
    let key = (pair.bodies[0], pair.bodies[1], first, second);
    let is_held = list.held_edges.binary_search(&key).is_ok();
    let depth = if is_held { HELD_PAIR_DEPTH } else { NEAR };
    let (w, n) = (geometry.weights, geometry.normal);
    let relative_v = v[0] * w[0] + v[1] * w[1] + u[0] * w[2] + u[1] * w[3];
    let touches = geometry.gap_m >= -depth * size_m
        && geometry.gap_m + step_s * relative_v.dot(n) <= NEAR * size_m
        && geometry.is_inside(-BORDER)
        && fans[1].contains(n)
        && fans[0].contains(-n);
    touches.then(|| Constraint {
        bodies: pair.bodies,
        feature: Feature::EdgeOnEdge { first, second },
        nodes: [(0, n1[0]), (0, n1[1]), (1, n2[0]), (1, n2[1])],
        weights: w,
        weight_shifts_per_m: geometry.weight_shifts_per_m,
        normal: n,
        gap_m: geometry.gap_m,
        place_m: p[0] * w[0] + p[1] * w[1],
        size_m,
        friction_coefficient: pair.friction_coefficient,
        closing_m_s: -relative_v.dot(n),
        may_bounce: true,
        stored: ImpactStore::default(),
        target_m_s: 0.0,
        impulse_n_s: DVec3::ZERO,
    })
}

/// A cheap look before the fans: whether the closest points of two edges lie on both and near each other.
fn edges_may_touch(p: [DVec3; 2], q: [DVec3; 2], reach_m: f64) -> bool {
    let Some((s, t)) = closest_on_lines(p, q) else { return false };
    let inside = 0.0..=1.0;
    let apart = p[0].lerp(p[1], s) - q[0].lerp(q[1], t);
    inside.contains(&s) && inside.contains(&t) && apart.length_squared() <= reach_m * reach_m
}

/// The fan of directions between the two face normals of an edge.
struct EdgeFan {
    /// Sum of the face normals.
    outward: DVec3,
    /// Unit vectors in each face, at right angles to the edge, pointing into the face.
    inward: [DVec3; 2],
}

impl EdgeFan {
    /// Whether the edge is the nearest feature of its faces for a point in this direction.
    fn contains(&self, direction: DVec3) -> bool {
        self.inward.iter().all(|into| direction.dot(*into) <= FAN_TOLERANCE)
    }
}

fn edge_fan(view: &BodyView, edge: u32) -> EdgeFan {
    let edge = view.surface.edges[edge as usize];
    let [a, b] = edge.nodes.map(|n| view.positions_m[n as usize]);
    let along = b - a;
    let sides = edge.triangles.map(|t| {
        let corners = view.surface.corners_m(t, view.positions_m);
        let normal = unit_normal(corners);
        let centre = (corners[0] + corners[1] + corners[2]) / 3.0;
        let into = normal.cross(along).normalize_or_zero();
        (normal, if into.dot(centre - a) < 0.0 { -into } else { into })
    });
    EdgeFan { outward: sides[0].0 + sides[1].0, inward: [sides[0].1, sides[1].1] }
}

#[cfg(test)]
mod tests {
    use super::super::candidates::{SurfaceBoxes, between};
    use super::*;
    use crate::mesh::Surface;

    fn tetrahedron(offset: DVec3) -> (ContactSurface, Vec<DVec3>) {
        let nodes: Vec<_> = [DVec3::ZERO, DVec3::X, DVec3::Y, DVec3::Z].map(|x| x + offset).into();
        (ContactSurface::new(&Surface::of(&[[0, 1, 2, 3]]), &nodes), nodes)
    }

    fn count(offset: DVec3, velocity: DVec3, step_s: f64) -> usize {
        let (s1, x1) = tetrahedron(DVec3::ZERO);
        let (s2, x2) = tetrahedron(offset);
        let boxes = [SurfaceBoxes::around(&s1, &x1, 0.3), SurfaceBoxes::around(&s2, &x2, 0.3)];
        let candidates = between((&s1, &boxes[0]), (&s2, &boxes[1]), false);
        let (still, moving) = (vec![DVec3::ZERO; 4], vec![velocity; 4]);
        let pair = PairView {
            bodies: [0, 1],
            views: [
                BodyView { surface: &s1, positions_m: &x1, velocities_m_s: &still },
                BodyView { surface: &s2, positions_m: &x2, velocities_m_s: &moving },
            ],
            candidates: &candidates,
            friction_coefficient: 0.0,
        };
        let mut out = Vec::new();
        detect(&pair, step_s, &CollisionList::default(), &mut out);
        out.len()
    }

    #[test]
    fn a_tetrahedron_that_falls_on_a_tip_is_detected_only_when_it_gets_there() {
        let above = DVec3::new(-0.2, -0.2, 1.1);
        assert_eq!(count(above, DVec3::NEG_Z, 0.05), 0);
        assert!(count(above, DVec3::NEG_Z, 0.15) > 0);
        assert_eq!(count(above, DVec3::Z, 0.15), 0);
    }
}
