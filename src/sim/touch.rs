//! The exact first touch of bodies in free travel: the transition interval D_rc (METHOD 3).
//!
//! Rigid motion is curved, so a time interval is split until straight paths between its ends miss the true ones
//! by less than a tolerance; the deviation (`r (omega dt)^2 / 8` for rotation, `g dt^2 / 8` for the
//! parabola) fattens the swept boxes on the way, so that nothing is missed.

use super::body::{Body, Regime, prescribed_pose};
use super::rigid::RigidMotion;
use super::{BodyMotion, PrescribedMotion};
use crate::contact::SurfaceBoxes;
use crate::contact::candidates::{Candidates, between};
use crate::contact::constraint::Geometry;
use crate::contact::time_of_impact::{BORDER, Moving, edge_meets_edge, node_meets_triangle};
use glam::{DMat3, DVec3};

/// Deviation of straight from true paths, as a share of the local size, at which a touch is accepted.
const PATH_TOLERANCE: f64 = 1e-7;
/// Gap, as a share of the local size, at which bodies count as touching already.
const TOUCHING: f64 = 1e-6;
/// Deviation, as a share of the body's radius, above which features are not looked at yet.
const COARSE: f64 = 0.02;
/// Halvings after which the present bracket is accepted.
const MOST_HALVINGS: u32 = 48;

/// First touch within an interval.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Touch {
    pub time_s: f64,
    pub bodies: [usize; 2],
}

/// A body's motion within the interval.
struct Mover<'a> {
    body: &'a Body,
    path: Path<'a>,
    start_s: f64,
    gravity_m_s2: DVec3,
}

enum Path<'a> {
    Still,
    Rigid(RigidMotion),
    Prescribed(&'a PrescribedMotion),
}

impl<'a> Mover<'a> {
    fn new(body: &'a Body, start_s: f64, gravity_m_s2: DVec3) -> Self {
        let path = match (&body.regime, &body.motion) {
            (Regime::Free(motion), _) => Path::Rigid(*motion),
            (Regime::Kinematic, BodyMotion::Kinematic(motion)) => Path::Prescribed(motion),
            _ => Path::Still,
        };
        Self { body, path, start_s, gravity_m_s2 }
    }

    fn positions_at(&self, time_s: f64) -> Vec<DVec3> {
        match &self.path {
            Path::Still => self.body.position_m.clone(),
            Path::Rigid(motion) => {
                let moved = motion.after(time_s - self.start_s, self.gravity_m_s2);
                let turn = DMat3::from_quat(moved.orientation);
                self.body.arms_m.iter().map(|arm| moved.centre_m + turn * *arm).collect()
            }
            Path::Prescribed(motion) => prescribed_positions(self.body, motion, time_s),
        }
    }

    fn centre_at(&self, time_s: f64) -> DVec3 {
        match &self.path {
            Path::Rigid(motion) => {
                let t = time_s - self.start_s;
                motion.centre_m + motion.velocity_m_s * t + self.gravity_m_s2 * (0.5 * t * t)
            }
            Path::Prescribed(motion) => self.body.reference.centre_m + prescribed_pose(motion, time_s).0,
            Path::Still => self.body.reference.centre_m,
        }
    }

    /// Bound on how far straight paths of points miss the true ones over `duration_s`, m.
    fn path_deviation_m(&self, duration_s: f64, with_gravity: bool) -> f64 {
        let spin = match &self.path {
            Path::Rigid(motion) => motion.spin_rad_s().length() * 1.5,
            Path::Prescribed(motion) => motion.spin_rad_s.length(),
            Path::Still => 0.0,
        };
        let falls = with_gravity && matches!(self.path, Path::Rigid(_));
        let gravity = if falls { self.gravity_m_s2.length() } else { 0.0 };
        let radius_m = 2.0 * self.body.radius_m;
        (radius_m * (spin * duration_s).powi(2) + gravity * duration_s.powi(2)) / 8.0
    }

    /// Low and high corner of a box that holds the body throughout the interval, m.
    fn coarse_box(&self, from_s: f64, to_s: f64) -> (DVec3, DVec3) {
        if matches!(self.path, Path::Still) {
            let nodes = &self.body.position_m;
            return nodes
                .iter()
                .fold((DVec3::INFINITY, DVec3::NEG_INFINITY), |(l, h), x| (l.min(*x), h.max(*x)));
        }
        let (a, b) = (self.centre_at(from_s), self.centre_at(to_s));
        let sag = self.gravity_m_s2.length() * (to_s - from_s).powi(2) / 8.0;
        let reach = match &self.path {
            Path::Prescribed(_) => 2.0 * self.body.radius_m,
            _ => self.body.radius_m,
        };
        let r = DVec3::splat(reach + sag);
        (a.min(b) - r, a.max(b) + r)
    }
}

/// Positions of a kinematic body's nodes, m: prescribed about the centre of its bounding box.
pub(super) fn prescribed_positions(body: &Body, motion: &PrescribedMotion, time_s: f64) -> Vec<DVec3> {
    let nodes = &body.reference_m;
    let first = nodes.first().copied().unwrap_or_default();
    let (low, high) = nodes.iter().fold((first, first), |(l, h), x| (l.min(*x), h.max(*x)));
    let centre = 0.5 * (low + high);
    let (moved, turned) = prescribed_pose(motion, time_s);
    let turn = DMat3::from_quat(turned);
    nodes.iter().map(|x| centre + moved + turn * (*x - centre)).collect()
}

/// Finds the first touch in `[from_s, to_s]` between bodies in free or prescribed motion and everything that
/// does not deform at present.
pub(super) fn first_touch(bodies: &[Body], from_s: f64, to_s: f64, gravity: DVec3) -> Option<Touch> {
    let movers: Vec<Mover> = bodies.iter().map(|b| Mover::new(b, from_s, gravity)).collect();
    let boxes: Vec<_> = movers.iter().map(|m| m.coarse_box(from_s, to_s)).collect();
    let mut first: Option<Touch> = None;
    for i in 0..movers.len() {
        for j in i + 1..movers.len() {
            if !can_touch(&movers[i], &movers[j]) || !boxes_overlap(&boxes[i], &boxes[j]) {
                continue;
            }
            let until = first.map_or(to_s, |t| t.time_s);
            let found = pair_touch(&movers[i], &movers[j], [from_s, until], MOST_HALVINGS);
            if let Some(time_s) = found.filter(|t| first.is_none_or(|f| *t < f.time_s)) {
                first = Some(Touch { time_s, bodies: [i, j] });
            }
        }
    }
    first
}

fn can_touch(a: &Mover, b: &Mover) -> bool {
    let elastic = [a, b].iter().any(|m| m.body.regime == Regime::Elastic);
    let moves = [a, b].iter().any(|m| !matches!(m.path, Path::Still));
    let deformable = a.body.is_deformable() || b.body.is_deformable();
    !elastic && moves && deformable
}

fn boxes_overlap(a: &(DVec3, DVec3), b: &(DVec3, DVec3)) -> bool {
    a.0.cmple(b.1).all() && b.0.cmple(a.1).all()
}

fn pair_touch(a: &Mover, b: &Mover, span: [f64; 2], halvings: u32) -> Option<f64> {
    let [from_s, to_s] = span;
    if !boxes_overlap(&a.coarse_box(from_s, to_s), &b.coarse_box(from_s, to_s)) {
        return None;
    }
    // A common parabola cancels from the relative motion.
    let both_fall = [a, b].iter().all(|m| matches!(m.path, Path::Rigid(_)));
    let duration_s = to_s - from_s;
    let deviation_m = a.path_deviation_m(duration_s, !both_fall) + b.path_deviation_m(duration_s, !both_fall);
    let size_m = a.body.mean_size_m.min(b.body.mean_size_m);
    let is_coarse = deviation_m > COARSE * a.body.radius_m.min(b.body.radius_m);
    if !is_coarse || halvings == 0 {
        let fine = Fine::new(a, b, span, deviation_m);
        if fine.candidates.is_empty() {
            return None;
        }
        if deviation_m <= PATH_TOLERANCE * size_m || halvings == 0 {
            return fine.first_fraction().map(|tau| from_s + tau * duration_s);
        }
    }
    let middle_s = 0.5 * (from_s + to_s);
    pair_touch(a, b, [from_s, middle_s], halvings - 1)
        .or_else(|| pair_touch(a, b, [middle_s, to_s], halvings - 1))
}

/// Straight paths over a short interval and the features that may meet on them.
struct Fine<'a> {
    bodies: [&'a Body; 2],
    start: [Vec<DVec3>; 2],
    end: [Vec<DVec3>; 2],
    candidates: Candidates,
}

impl<'a> Fine<'a> {
    fn new(a: &Mover<'a>, b: &Mover<'a>, [from_s, to_s]: [f64; 2], deviation_m: f64) -> Self {
        let bodies = [a.body, b.body];
        let start = [a.positions_at(from_s), b.positions_at(from_s)];
        let end = [a.positions_at(to_s), b.positions_at(to_s)];
        let boxes: [SurfaceBoxes; 2] = std::array::from_fn(|i| {
            let margin_m = deviation_m + TOUCHING * bodies[i].mean_size_m;
            SurfaceBoxes::swept(&bodies[i].surface, &start[i], &end[i], margin_m)
        });
        let candidates = between((&bodies[0].surface, &boxes[0]), (&bodies[1].surface, &boxes[1]), true);
        Self { bodies, start, end, candidates }
    }

    fn moving(&self, side: usize, node: u32) -> Moving {
        Moving::between(self.start[side][node as usize], self.end[side][node as usize])
    }

    fn first_fraction(&self) -> Option<f64> {
        let c = &self.candidates;
        let on_second = c.node_on_second.iter().filter_map(|(n, t)| self.node_fraction([0, 1], *n, *t));
        let on_first = c.node_on_first.iter().filter_map(|(n, t)| self.node_fraction([1, 0], *n, *t));
        let edges = c.edge_pairs.iter().filter_map(|(e, f)| self.edge_fraction(*e, *f));
        on_second.chain(on_first).chain(edges).reduce(f64::min)
    }

    fn node_fraction(&self, [own, other]: [usize; 2], node: u32, triangle: u32) -> Option<f64> {
        let corners = self.bodies[other].surface.triangles[triangle as usize];
        let patch = corners.map(|n| self.moving(other, n));
        let moving = self.moving(own, node);
        let size_m = self.bodies[other].surface.triangle_size_m[triangle as usize];
        if is_touching(&moving, &patch, size_m) {
            return Some(0.0);
        }
        node_meets_triangle(moving, patch).map(|(tau, _)| tau)
    }

    fn edge_fraction(&self, first: u32, second: u32) -> Option<f64> {
        let ends = |side: usize, edge: u32| {
            self.bodies[side].surface.edges[edge as usize].nodes.map(|n| self.moving(side, n))
        };
        edge_meets_edge(ends(0, first), ends(1, second)).map(|(tau, _, _)| tau)
    }
}

/// Whether a node lies on a patch at the start and moves into it.
fn is_touching(node: &Moving, patch: &[Moving; 3], size_m: f64) -> bool {
    let Some(g) = Geometry::node_on_patch(node.start_m, patch.map(|m| m.start_m)) else { return false };
    let [_, w0, w1, w2] = g.weights;
    let moves = node.move_m + patch[0].move_m * w0 + patch[1].move_m * w1 + patch[2].move_m * w2;
    g.gap_m.abs() <= TOUCHING * size_m && g.is_inside(BORDER) && moves.dot(g.normal) < -1e-9 * size_m
}
