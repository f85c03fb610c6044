//! From candidates to constraints: which pairs touch, or would at the end of the step.

use super::atomic::{AtomicCase, Verdict};
use super::candidates::Candidates;
use super::constraint::{Constraint, Feature, Geometry};
use super::geometry::unit_normal;
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
/// Sine of the angle by which an edge's contact normal may lie outside the fan of its face normals.
const FAN_TOLERANCE: f64 = 1e-6;

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

/// Which pairs pressed in the last step ("as in the last step" in the atomic table).
#[derive(Clone, Debug, Default, PartialEq)]
pub struct CollisionList {
    /// (body of the node, node, body of the patch), sorted.
    held_nodes: Vec<(u32, u32, u32)>,
    /// (first body, second body, first edge, second edge), sorted.
    held_edges: Vec<(u32, u32, u32, u32)>,
}

impl CollisionList {
    /// The pairs that press with an impulse.
    #[must_use]
    pub fn of(constraints: &[Constraint]) -> Self {
        let mut list = Self::default();
        for c in constraints.iter().filter(|c| c.impulse_n_s != DVec3::ZERO) {
            match c.feature {
                Feature::NodeOnPatch { node, .. } => {
                    list.held_nodes.push((c.bodies[0], node, c.bodies[1]));
                }
                Feature::EdgeOnEdge { first, second } => {
                    list.held_edges.push((c.bodies[0], c.bodies[1], first, second));
                }
            }
        }
        list.held_nodes.sort_unstable();
        list.held_nodes.dedup();
        list.held_edges.sort_unstable();
        list
    }

    /// The pairs of which at least one body passes.
    #[must_use]
    pub fn keep(&self, of: impl Fn(u32) -> bool) -> Self {
        let mut kept = self.clone();
        kept.held_nodes.retain(|(a, _, b)| of(*a) || of(*b));
        kept.held_edges.retain(|(a, b, _, _)| of(*a) || of(*b));
        kept
    }

    /// Adds another list.
    pub fn merge(&mut self, other: Self) {
        self.held_nodes.extend(other.held_nodes);
        self.held_nodes.sort_unstable();
        self.held_nodes.dedup();
        self.held_edges.extend(other.held_edges);
        self.held_edges.sort_unstable();
        self.held_edges.dedup();
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
    out.extend(pair.candidates.node_on_second.iter().filter_map(|c| side.constraint(*c)));
    let side = node_side(swapped, [second, first]);
    out.extend(pair.candidates.node_on_first.iter().filter_map(|c| side.constraint(*c)));
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
    fn constraint(&self, (node, triangle): (u32, u32)) -> Option<Constraint> {
        let [own, other] = &self.views;
        let corners = other.surface.triangles[triangle as usize];
        let size_m = other.surface.triangle_size_m[triangle as usize];
        let patch_m = corners.map(|n| other.positions_m[n as usize]);
        let patch_v = corners.map(|n| other.velocities_m_s[n as usize]);
        let (x, v) = (own.positions_m[node as usize], own.velocities_m_s[node as usize]);
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
        let is_held = self.list.held_nodes.binary_search(&key).is_ok();
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
            may_bounce: true,
            target_m_s: 0.0,
            impulse_n_s: DVec3::ZERO,
        })
    }

    fn touches(&self, geometry: &Geometry, path: &Paths, size_m: f64, is_held: bool) -> bool {
        let depth = if is_held { HELD_PAIR_DEPTH } else { NEW_PAIR_DEPTH };
        if geometry.gap_m < -depth * size_m {
            return false;
        }
        let is_over_patch = geometry.is_inside(BORDER);
        match path.atomic_case().verdict() {
            Verdict::Collides(_) if geometry.gap_m > 0.0 => path.meets_patch() || (is_held && is_over_patch),
            _ => is_over_patch,
        }
    }
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
    let fans = [edge_fan(view1, first), edge_fan(view2, second)];
    let geometry = Geometry::edge_on_edge(p, q, fans[1].outward - fans[0].outward)?;
    let size_m = (p[1] - p[0]).length().min((q[1] - q[0]).length());
    let key = (pair.bodies[0], pair.bodies[1], first, second);
    let is_held = list.held_edges.binary_search(&key).is_ok();
    let depth = if is_held { HELD_PAIR_DEPTH } else { NEAR };
    let (w, n) = (geometry.weights, geometry.normal);
    let (v, u) = (speed(view1, n1), speed(view2, n2));
    let relative_v = v[0] * w[0] + v[1] * w[1] + u[0] * w[2] + u[1] * w[3];
    let touches = geometry.gap_m >= -depth * size_m
        && geometry.gap_m + step_s * relative_v.dot(n) <= NEAR * size_m
        && geometry.is_inside(0.0)
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
        may_bounce: true,
        target_m_s: 0.0,
        impulse_n_s: DVec3::ZERO,
    })
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
