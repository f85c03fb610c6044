//! From candidates to constraints: which pairs touch, or would at the end of the step.
//!
//! A step asks more than once, with other velocities each time, since the response to some pairs may close
//! others. What depends on positions alone is worked out once, in [`super::Near`]; the looks that follow are cheap.

use super::atomic::{AtomicCase, Verdict};
use super::collision_list::CollisionList;
use super::constraint::{Constraint, Feature, Geometry};
use super::geometry::{closest_on_lines, unit_normal};
use super::impact::ImpactStore;
use super::near::NEAR_AT_ONCE;
use super::own::OwnFeatures;
use super::surface::ContactSurface;
use super::time_of_impact::{BORDER, Moving, node_meets_triangle};
use super::twins::TwinState;
use crate::math::in_parts;
use glam::DVec3;

/// Gap, as a share of the local element size, within which a pair takes part in the response even
/// when the prediction does not close it: neighbours' impulses may.
pub(super) const NEAR: f64 = 1e-3;
/// The same within a body, whose crack faces are all near each other.
pub(super) const OWN_NEAR: f64 = 1e-4;
/// Penetration, as a share of the local element size, that a *new* pair may begin with: what a pair that was
/// left out as redundant may have gathered.
const NEW_PAIR_DEPTH: f64 = 4e-4;
/// How far beyond its border, in barycentric coordinates, a crack face still carries the nodes that it was one with. The
/// faces of a crack fit each other: a node that slips over the edge of one and dips behind it would get stuck there.
const SKIRT: f64 = 0.05;
/// Share of an edge at its ends that does not touch edges of the same body: nodes and patches do there, and a crack face has
/// edges everywhere.
const OWN_EDGE_END: f64 = 0.05;
/// Cosine of the angle up to which two patches at a node are one plane.
const SAME_PLANE: f64 = 0.9999;
/// Mean of the cosines between the edges at a node and a patch's normal down to which the node's body counts as lying
/// in front of the patch.
const IN_FRONT: f64 = 0.1;
/// Sine of the angle by which an edge's contact normal may lie outside the fan of its face normals. Generous: flush
/// bodies (two rods of the same width) tilt against each other by the strain at the contact, and a
/// node that has slipped off a flush border is held by nothing but these pairs.
const FAN_TOLERANCE: f64 = 0.1;

/// What detection sees of a body: all arrays are indexed by the body's nodes.
#[derive(Clone, Copy)]
pub struct BodyView<'a> {
    /// Surface.
    pub surface: &'a ContactSurface,
    /// Reference positions, m.
    pub reference_m: &'a [DVec3],
    /// Positions at the start of the step, m.
    pub positions_m: &'a [DVec3],
    /// Predicted velocities over the step, m/s.
    pub velocities_m_s: &'a [DVec3],
}

impl BodyView<'_> {
    fn features(&self) -> OwnFeatures<'_> {
        OwnFeatures { surface: self.surface, reference_m: self.reference_m, positions_m: self.positions_m }
    }

    fn velocity(&self, node: u32) -> DVec3 {
        self.velocities_m_s[node as usize]
    }
}

/// Two bodies (or one twice).
#[derive(Clone, Copy)]
pub struct PairView<'a> {
    /// Numbers of the bodies.
    pub bodies: [u32; 2],
    /// The bodies.
    pub views: [BodyView<'a>; 2],
    /// Coulomb friction coefficient.
    pub friction_coefficient: f64,
    /// Length of the step, s.
    pub step_s: f64,
    /// Which pairs pressed in the last step.
    pub list: &'a CollisionList,
    /// How deep pairs may be and still count.
    pub depths: PairDepths,
}

impl PairView<'_> {
    /// Whether the two are one body.
    pub(super) fn is_own(&self) -> bool {
        self.bodies[0] == self.bodies[1]
    }

    /// Share of an edge at each end that does not touch other edges.
    pub(super) fn edge_ends(&self) -> f64 {
        if self.is_own() { OWN_EDGE_END } else { 0.0 }
    }

    /// Whether the two are one body that has cracked.
    pub(super) fn is_own_and_cracked(&self) -> bool {
        self.is_own() && self.views[0].surface.has_cracked()
    }

    /// Of a body with itself: how its twins lie.
    pub(super) fn twin_states(&self, slack_m: f64) -> Vec<TwinState> {
        let view = &self.views[0];
        if self.is_own() { view.surface.twins.states(view, self.step_s, slack_m) } else { Vec::new() }
    }
}

/// Penetrations up to which pairs count, as shares of the local size. Deeper ones are features of the far side.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PairDepths {
    /// Of a node and a patch that did not press in the last step.
    pub new: f64,
    /// Of two edges that did not press in the last step.
    pub new_edges: f64,
    /// Of a pair that pressed, also when it has moved on to the next patch.
    pub held: f64,
}

impl PairDepths {
    /// Where constraints keep the bodies apart.
    pub const CONSTRAINED: Self = Self { new: NEW_PAIR_DEPTH, new_edges: NEAR, held: 0.05 };
    /// Depth of pairs that are held by constraints.
    pub(super) const LARGEST: f64 = Self::CONSTRAINED.held;
    /// Where springs let the bodies into each other, and steps begin with a penetration: half an element,
    /// since beyond that a node may belong to the other side of a thin body.
    pub const SPRINGS: Self = Self { new: 0.5, new_edges: 0.5, held: 0.5 };
}

/// Two features so near that they may touch within the step, and how they lie at its start.
#[derive(Clone, Copy, Debug)]
pub(super) struct NearPair {
    pub feature: Feature,
    pub nodes: [(u8, u32); 4],
    geometry: Geometry,
    pub size_m: f64,
    /// Whether a crack of the body parted the node and the patch.
    were_one: bool,
}

impl NearPair {
    /// Relative velocity along the normal, m/s; negative when they close in.
    fn opening_m_s(&self, views: &[BodyView; 2]) -> f64 {
        let nodes = self.nodes.iter().zip(self.geometry.weights);
        nodes.map(|((side, n), w)| views[*side as usize].velocity(*n).dot(self.geometry.normal) * w).sum()
    }

    /// Gap at the end of the step, m.
    pub(super) fn gap_after_m(&self, views: &[BodyView; 2], step_s: f64) -> f64 {
        self.geometry.gap_m + step_s * self.opening_m_s(views)
    }

    fn constraint(&self, bodies: [u32; 2], views: &[BodyView; 2], pair: &PairView) -> Constraint {
        let g = &self.geometry;
        let points_m = self.nodes.map(|(side, n)| views[side as usize].positions_m[n as usize]);
        let place_m = match self.feature {
            Feature::NodeOnPatch { .. } => points_m[0],
            Feature::EdgeOnEdge { .. } => points_m[0] * g.weights[0] + points_m[1] * g.weights[1],
        };
        Constraint {
            bodies,
            feature: self.feature,
            nodes: self.nodes,
            weights: g.weights,
            weight_shifts_per_m: self.feature.weight_shifts_per_m(points_m, g.normal),
            normal: g.normal,
            gap_m: g.gap_m,
            place_m,
            size_m: self.size_m,
            friction_coefficient: pair.friction_coefficient,
            closing_m_s: -self.opening_m_s(views),
            may_bounce: bodies[0] != bodies[1],
            stored: ImpactStore::default(),
            target_m_s: 0.0,
            is_settled: false,
            impulse_n_s: DVec3::ZERO,
        }
    }
}

/// Nodes of one body against patches of the other.
pub(super) struct NodeSide<'a> {
    pub bodies: [u32; 2],
    pub views: [BodyView<'a>; 2],
    pair: &'a PairView<'a>,
}

impl<'a> NodeSide<'a> {
    /// Nodes of the first body (`side` 0) or of the second.
    pub(super) fn new(pair: &'a PairView<'a>, side: usize) -> Self {
        let ([a, b], [first, second]) = (pair.bodies, pair.views);
        let (bodies, views) = if side == 0 { ([a, b], [first, second]) } else { ([b, a], [second, first]) };
        Self { bodies, views, pair }
    }

    /// Appends the constraints of one node: one only where its patches are rivals.
    pub(super) fn find(&self, of_node: &[NearPair], out: &mut Vec<Constraint>) {
        let found: Vec<Constraint> = of_node.iter().filter_map(|n| self.constraint(n)).collect();
        let loses = |c: &&Constraint| found.iter().any(|rival| self.beats(rival, c));
        out.extend(found.iter().filter(|c| !loses(c)));
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
        let is_in_front =
            |c: &Constraint| self.were_one(c.feature) || self.is_in_front(c.nodes[0].1, c.normal);
        if !is_one_plane && !self.is_convex_between(a, c) {
            return false;
        }
        let rank = |c: &Constraint, triangle: u32| {
            let key = (c.bodies[0], c.nodes[0].1, c.bodies[1]);
            let is_held = self.pair.list.holds(key, c.normal);
            let inside = c.weights[1..].iter().map(|w| -w).fold(f64::INFINITY, f64::min);
            if is_one_plane {
                return (u8::from(is_held), inside, 0.0, std::cmp::Reverse(triangle));
            }
            // Of two faces of an edge the one that the node's own body lies in front of, that holds already,
            // is less deep, is closed faster. Where flush corners meet, a node is on the top and on the side face.
            let depth = (c.gap_m / c.size_m / NEW_PAIR_DEPTH).round();
            (
                4 * u8::from(is_in_front(c)) + u8::from(is_held),
                depth,
                c.closing_m_s,
                std::cmp::Reverse(triangle),
            )
        };
        rank(rival, a).partial_cmp(&rank(c, b)) == Some(std::cmp::Ordering::Greater)
    }

    /// Whether a crack of the body parted a node and a patch of it.
    fn were_one(&self, feature: Feature) -> bool {
        let Feature::NodeOnPatch { node, triangle } = feature else { return false };
        self.pair.is_own() && self.views[1].surface.were_one(node, triangle)
    }

    /// Whether the node's own body lies in front of a patch with this normal.
    fn is_in_front(&self, node: u32, normal: DVec3) -> bool {
        let own = &self.views[0];
        own.surface.inward(node, own.positions_m).dot(normal) > -IN_FRONT
    }

    /// Whether the other patch lies below the plane of `c`'s.
    fn is_convex_between(&self, other_triangle: u32, c: &Constraint) -> bool {
        let view = &self.views[1];
        let corners = view.surface.corners_m(other_triangle, view.positions_m);
        let centre = (corners[0] + corners[1] + corners[2]) / 3.0;
        let on_plane = view.positions_m[c.nodes[1].1 as usize];
        (centre - on_plane).dot(c.normal) < 0.0
    }

    /// The node and the patch if they may touch.
    pub(super) fn near(
        &self,
        (node, triangle): (u32, u32),
        were_one: bool,
        [way_m, slack_m]: [f64; 2],
    ) -> Option<NearPair> {
        let [own, other] = &self.views;
        let corners = other.surface.triangles[triangle as usize];
        let size_m =
            other.surface.triangle_size_m[triangle as usize].min(own.surface.node_size_m[node as usize]);
        let is_own = self.pair.is_own();
        let x = own.positions_m[node as usize];
        let patch_m = corners.map(|n| other.positions_m[n as usize]);
        let far = if is_own { OWN_NEAR } else { NEAR };
        let above_m = far * size_m + way_m + slack_m;
        let height = Height::of(x, patch_m);
        if height.is_beyond([above_m, self.pair.depths.held * size_m]) {
            return None;
        }
        // Deep down among cracks lies much that never pressed.
        if self.pair.is_own_and_cracked()
            && height.is_beyond([above_m, self.pair.depths.new * size_m])
            && !self.holds_on(Feature::NodeOnPatch { node, triangle })
        {
            return None;
        }
        let path = self.paths(node, corners);
        if is_own && height.is_beyond([far * size_m + path.relative_m() + slack_m, f64::INFINITY]) {
            return None;
        }
        let geometry = Geometry::node_on_patch(x, patch_m)?;
        let foot = foot(&geometry);
        let border = if were_one { SKIRT } else { BORDER };
        let is_beside = foot < -border && (geometry.gap_m <= 0.0 || -foot * size_m > 4.0 * (way_m + slack_m));
        if is_beside || geometry.gap_m < -self.pair.depths.held * size_m {
            return None;
        }
        Some(NearPair {
            feature: Feature::NodeOnPatch { node, triangle },
            nodes: [(0, node), (1, corners[0]), (1, corners[1]), (1, corners[2])],
            geometry,
            size_m,
            were_one,
        })
    }

    fn paths(&self, node: u32, corners: [u32; 3]) -> Paths {
        let [own, other] = &self.views;
        Paths {
            x: own.positions_m[node as usize],
            v: own.velocity(node),
            patch_m: corners.map(|n| other.positions_m[n as usize]),
            patch_v: corners.map(|n| other.velocity(n)),
            step_s: self.pair.step_s,
        }
    }

    fn constraint(&self, near: &NearPair) -> Option<Constraint> {
        let far = if self.pair.is_own() { OWN_NEAR } else { NEAR };
        if near.gap_after_m(&self.views, self.pair.step_s) > far * near.size_m {
            return None;
        }
        let [node, a, b, c] = near.nodes.map(|n| n.1);
        let key = (self.bodies[0], node, self.bodies[1]);
        let is_held = self.pair.list.holds(key, near.geometry.normal);
        let is_own = self.pair.is_own();
        let path = self.paths(node, [a, b, c]);
        let depths = &self.pair.depths;
        let were_one = near.were_one;
        // Among the edges of cracks, a node that came in from the side may be deep without belonging there.
        let is_known = if self.is_cracked() { self.holds_on(near.feature) } else { is_held };
        let is_too_deep =
            near.geometry.gap_m < -near.size_m * if is_known { depths.held } else { depths.new };
        let border = if were_one { SKIRT } else { BORDER };
        let touches = !is_too_deep
            && path.touches(&near.geometry, near.size_m, (is_held || is_own, border))
            && !(is_own && self.is_beside(near.feature));
        touches.then(|| near.constraint(self.bodies, &self.views, self.pair))
    }

    fn is_cracked(&self) -> bool {
        self.views.iter().any(|view| view.surface.has_cracked())
    }

    fn holds_on(&self, feature: Feature) -> bool {
        let Feature::NodeOnPatch { node, triangle } = feature else { return false };
        self.pair.list.holds_on((self.bodies[0], node, self.bodies[1]), triangle)
    }

    fn is_beside(&self, feature: Feature) -> bool {
        let Feature::NodeOnPatch { node, triangle } = feature else { return false };
        self.views[1].features().is_beside(node, triangle)
    }
}

/// Smallest barycentric coordinate of the foot of the node on the patch: negative beside it.
fn foot(geometry: &Geometry) -> f64 {
    geometry.weights[1..].iter().map(|w| -w).fold(f64::INFINITY, f64::min)
}

/// Height of a node above a patch's plane: a cheap look before the geometry.
struct Height {
    /// Times the length of the normal.
    scaled: f64,
    normal_squared: f64,
}

impl Height {
    fn of(x: DVec3, patch_m: [DVec3; 3]) -> Self {
        let normal = (patch_m[1] - patch_m[0]).cross(patch_m[2] - patch_m[0]);
        Self { scaled: (x - patch_m[0]).dot(normal), normal_squared: normal.length_squared() }
    }

    /// Whether the node is further above the plane or deeper below it than the two ways, m.
    fn is_beyond(&self, [above_m, below_m]: [f64; 2]) -> bool {
        let reach_m = if self.scaled > 0.0 { above_m } else { below_m };
        self.scaled * self.scaled > reach_m * reach_m * self.normal_squared
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
    /// Whether they touch, unless they lie too deep.
    fn touches(&self, geometry: &Geometry, size_m: f64, (is_held, border): (bool, f64)) -> bool {
        let is_over_patch = geometry.is_inside(border);
        // Away from the borders, or for a node on the patch, the meeting point is decided by the start.
        let is_clear = foot(geometry).abs() * size_m > 4.0 * self.relative_m();
        if is_clear || geometry.gap_m <= 0.0 {
            return is_over_patch;
        }
        match self.atomic_case().verdict() {
            Verdict::Collides(_) => (is_held && is_over_patch) || self.meets_patch(),
            _ => is_over_patch,
        }
    }

    /// Bound on the way of the node relative to the patch in the step, m.
    fn relative_m(&self) -> f64 {
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

/// The contacts of twins that are together.
pub(super) fn near_twins(pair: &PairView, states: &[TwinState], reach_m: f64) -> Vec<NearPair> {
    let view = &pair.views[0];
    let near = |(node, triangle): (u32, u32)| {
        let corners = view.surface.triangles[triangle as usize];
        let patch_m = view.surface.corners_m(triangle, view.positions_m);
        let size_m =
            view.surface.triangle_size_m[triangle as usize].min(view.surface.node_size_m[node as usize]);
        let geometry = Geometry::node_on_patch(view.positions_m[node as usize], patch_m)?;
        let [a, b, c] = corners;
        (geometry.gap_m <= OWN_NEAR * size_m + reach_m).then_some(NearPair {
            feature: Feature::NodeOnPatch { node, triangle },
            nodes: [(0, node), (1, a), (1, b), (1, c)],
            geometry,
            size_m,
            were_one: true,
        })
    };
    let pairs = (0_u32..).zip(states).filter(|(_, state)| **state == TwinState::Together);
    let contacts: Vec<_> = pairs.flat_map(|(twins, _)| view.surface.twins.contacts(twins)).collect();
    in_parts::filter_map(&contacts, NEAR_AT_ONCE, |_, contact| near(*contact))
}

pub(super) fn twin_constraint(pair: &PairView, near: &NearPair) -> Option<Constraint> {
    let touches = near.gap_after_m(&pair.views, pair.step_s) <= OWN_NEAR * near.size_m;
    touches.then(|| near.constraint(pair.bodies, &pair.views, pair))
}

/// Two edges if they may touch.
pub(super) fn near_edges(pair: &PairView, (first, second): (u32, u32), way_m: f64) -> Option<NearPair> {
    let [view1, view2] = &pair.views;
    let (n1, n2) = (view1.surface.edges[first as usize].nodes, view2.surface.edges[second as usize].nodes);
    let at = |view: &BodyView, n: [u32; 2]| n.map(|n| view.positions_m[n as usize]);
    let (p, q) = (at(view1, n1), at(view2, n2));
    let size_m = (p[1] - p[0]).length().min((q[1] - q[0]).length());
    let is_held = pair.list.holds_edges(pair.bodies, [first, second]);
    let depth = if is_held { pair.depths.held } else { pair.depths.new_edges };
    let reach_m = depth * size_m + way_m;
    let is_own = pair.is_own();
    if !edges_may_touch(p, q, (reach_m, pair.edge_ends())) {
        return None;
    }
    let fans = [edge_fan(view1, first), edge_fan(view2, second)];
    let geometry = Geometry::edge_on_edge(p, q, fans[1].outward - fans[0].outward)?;
    let border = if is_own { OWN_EDGE_END } else { BORDER };
    let is_near = geometry.gap_m >= -pair.depths.held * size_m
        && geometry.is_inside(-border)
        && fans[1].contains(geometry.normal)
        && fans[0].contains(-geometry.normal);
    is_near.then_some(NearPair {
        feature: Feature::EdgeOnEdge { first, second },
        nodes: [(0, n1[0]), (0, n1[1]), (1, n2[0]), (1, n2[1])],
        geometry,
        size_m,
        were_one: false,
    })
}

pub(super) fn edge_constraint(pair: &PairView, near: &NearPair) -> Option<Constraint> {
    let Feature::EdgeOnEdge { first, second } = near.feature else { return None };
    let is_held = pair.list.holds_edges(pair.bodies, [first, second]);
    let is_own = pair.is_own();
    let new_depth = if is_own { pair.depths.new } else { pair.depths.new_edges };
    let depth = if is_held { pair.depths.held } else { new_depth };
    let far = if is_own { OWN_NEAR } else { NEAR };
    let touches = near.geometry.gap_m >= -depth * near.size_m
        && near.gap_after_m(&pair.views, pair.step_s) <= far * near.size_m
        && !(is_own && pair.views[0].features().edges_are_beside(first, second));
    touches.then(|| near.constraint(pair.bodies, &pair.views, pair))
}

/// A cheap look before the fans: whether the closest points of two edges lie on both and near each other.
fn edges_may_touch(p: [DVec3; 2], q: [DVec3; 2], (reach_m, ends): (f64, f64)) -> bool {
    let Some((s, t)) = closest_on_lines(p, q) else { return false };
    let inside = ends..=1.0 - ends;
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
    use super::super::{CloseList, Near, SurfaceBoxes, ThrownNodes, candidates::between};
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
                BodyView { surface: &s1, reference_m: &x1, positions_m: &x1, velocities_m_s: &still },
                BodyView { surface: &s2, reference_m: &x2, positions_m: &x2, velocities_m_s: &moving },
            ],
            friction_coefficient: 0.0,
            step_s,
            list: &CollisionList::default(),
            depths: PairDepths::CONSTRAINED,
        };
        let mut out = Vec::new();
        let mut close = CloseList::default();
        close.renew(&pair, &candidates, 0.0);
        Near::of_close(&pair, &close, &ThrownNodes::none(0.0)).find(&pair, &mut out);
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
