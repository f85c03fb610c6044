//! One contact: four nodes, their weights, a normal and a gap.
//!
//! A node against a patch has the weights `[1, -t0, -t1, -t2]`, two edges have `[1-s, s, -(1-t), -t]`: the
//! generic row block of METHOD 5 in one form for both. Weights, normal and gap are those of the start
//! of the step, so that the two contact points lie on one line along the normal and the pair of equal and
//! opposite forces has no moment (algorithmic moment arms, Zywicz and Puso, IJNME 44, 1999).

use super::geometry::{barycentric, closest_on_lines};
use super::impact::ImpactStore;
use glam::DVec3;

/// What meets what, in terms of the bodies' own nodes, triangles and edges.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Feature {
    /// Node of the first body on a triangle of the second.
    NodeOnPatch {
        /// Node.
        node: u32,
        /// Triangle.
        triangle: u32,
    },
    /// Edge of the first body on an edge of the second.
    EdgeOnEdge {
        /// Edge of the first body.
        first: u32,
        /// Edge of the second body.
        second: u32,
    },
}

impl Feature {
    /// See [`Constraint::weight_shifts_per_m`]: for nodes at `points_m` and the unit normal of their geometry.
    #[must_use]
    pub fn weight_shifts_per_m(&self, points_m: [DVec3; 4], normal: DVec3) -> [DVec3; 4] {
        let [p0, p1, q0, q1] = points_m;
        match self {
            Self::NodeOnPatch { .. } => {
                let (ab, ac) = (q0 - p1, q1 - p1);
                let area_normal = ab.cross(ac);
                let area2 = area_normal.length_squared();
                let (grad1, grad2) = (ac.cross(area_normal) / area2, area_normal.cross(ab) / area2);
                [DVec3::ZERO, -(grad1 + grad2), grad1, grad2]
            }
            Self::EdgeOnEdge { .. } => {
                let (e1, e2) = (p1 - p0, q1 - q0);
                let (d1, d2) = (e2.cross(normal), normal.cross(e1));
                let (d1, d2) = (d1 / d1.dot(e1), d2 / d2.dot(e2));
                [-d1, d1, -d2, d2]
            }
        }
    }
}

/// Cosine of the angle between the normals of two pairs up to which they may be one contact, a step apart or side by side.
pub(super) const SAME_SIDE: f64 = 0.8;

/// A contact constraint.
#[derive(Clone, Copy, Debug)]
pub struct Constraint {
    /// First body (node or edge) and second body (patch or edge).
    pub bodies: [u32; 2],
    /// What meets what.
    pub feature: Feature,
    /// For each of the four nodes: 0 when it belongs to the first body, 1 for the second, and its index.
    pub nodes: [(u8, u32); 4],
    /// Weights of the four nodes; they sum to zero.
    pub weights: [f64; 4],
    /// Change of the weights per metre that the foot of the force shifts in the tangent plane, 1/m.
    pub weight_shifts_per_m: [DVec3; 4],
    /// Unit normal, from the second body to the first.
    pub normal: DVec3,
    /// Gap along the normal at the start of the step, m; negative when they penetrate.
    pub gap_m: f64,
    /// Place at the start of the step, m.
    pub place_m: DVec3,
    /// Local element size, m.
    pub size_m: f64,
    /// Coulomb friction coefficient.
    pub friction_coefficient: f64,
    /// Speed at which the prediction closes the gap, m/s.
    pub closing_m_s: f64,
    /// Whether an impact of this pair keeps its energy; not where other pairs have taken most of the approach.
    pub may_bounce: bool,
    /// What an impact of this pair has stored and not yet given back.
    pub stored: ImpactStore,
    /// Relative normal velocity that must at least hold after the response, m/s (set by the response).
    pub target_m_s: f64,
    /// Impulse on the first body, N s (the response's result).
    pub impulse_n_s: DVec3,
    /// Whether the impulse solves the pair as long as no other acts on its nodes that did not when it was found.
    pub is_settled: bool,
}

/// Geometry of a constraint before it is known what to do with it.
#[derive(Clone, Copy, Debug)]
pub struct Geometry {
    /// See [`Constraint::weights`].
    pub weights: [f64; 4],
    /// See [`Constraint::normal`].
    pub normal: DVec3,
    /// See [`Constraint::gap_m`].
    pub gap_m: f64,
}

impl Geometry {
    /// A node against a triangle; `None` for a triangle without area.
    #[must_use]
    pub fn node_on_patch(node_m: DVec3, patch_m: [DVec3; 3]) -> Option<Self> {
        let [a, b, c] = patch_m;
        let (ab, ac) = (b - a, c - a);
        let area_normal = ab.cross(ac);
        let area2 = area_normal.length_squared();
        let [t0, t1, t2] = barycentric(node_m, patch_m)?;
        let normal = area_normal / area2.sqrt();
        Some(Self { weights: [1.0, -t0, -t1, -t2], normal, gap_m: (node_m - a).dot(normal) })
    }

    /// An edge against an edge; `outward` tells the side: it points from the second body to the first.
    /// `None` for parallel edges.
    #[must_use]
    pub fn edge_on_edge(p: [DVec3; 2], q: [DVec3; 2], outward: DVec3) -> Option<Self> {
        let (s, t) = closest_on_lines(p, q)?;
        let (e1, e2) = (p[1] - p[0], q[1] - q[0]);
        let cross = e1.cross(e2).normalize();
        let normal = if cross.dot(outward) < 0.0 { -cross } else { cross };
        Some(Self {
            weights: [1.0 - s, s, -(1.0 - t), -t],
            normal,
            gap_m: (p[0].lerp(p[1], s) - q[0].lerp(q[1], t)).dot(normal),
        })
    }

    /// Whether the contact point lies on both features, borders included.
    #[must_use]
    pub fn is_inside(&self, border: f64) -> bool {
        let [w0, w1, w2, w3] = self.weights;
        if w0 == 1.0 {
            [w1, w2, w3].iter().all(|w| *w <= border)
        } else {
            w0 >= -border && w1 >= -border && w2 <= border && w3 <= border
        }
    }
}

impl Constraint {
    /// Whether both features belong to one body.
    #[must_use]
    pub fn is_own(&self) -> bool {
        self.bodies[0] == self.bodies[1]
    }

    /// Whether an impulse pushes and lies in the friction cone.
    #[must_use]
    pub fn allows(&self, impulse_n_s: DVec3) -> bool {
        let normal_part = impulse_n_s.dot(self.normal);
        let tangential = impulse_n_s - self.normal * normal_part;
        normal_part >= 0.0 && tangential.length() <= self.friction_coefficient * normal_part + 1e-300
    }

    /// Weights with which the impulse acts so that it has no moment: the foot of the force on the
    /// second body is where the line of the force through the first body's contact point meets it.
    #[must_use]
    pub fn moment_free_weights(&self) -> [f64; 4] {
        let normal_part = self.impulse_n_s.dot(self.normal);
        if normal_part <= 0.0 || self.gap_m == 0.0 {
            return self.weights;
        }
        let tangential = self.impulse_n_s - self.normal * normal_part;
        let shift_m = tangential * (self.gap_m / normal_part);
        std::array::from_fn(|i| self.weights[i] + self.weight_shifts_per_m[i].dot(shift_m))
    }
}

#[cfg(test)]
impl Constraint {
    /// A pair of two bodies that has done nothing yet: its nodes and weights are for a test to say.
    pub(super) fn blank(feature: Feature) -> Self {
        Self {
            bodies: [0, 1],
            feature,
            nodes: [(0, 0); 4],
            weights: [0.0; 4],
            weight_shifts_per_m: [DVec3::ZERO; 4],
            normal: DVec3::Z,
            gap_m: 0.0,
            place_m: DVec3::ZERO,
            size_m: 1.0,
            friction_coefficient: 0.0,
            closing_m_s: 0.0,
            may_bounce: true,
            stored: ImpactStore::default(),
            target_m_s: 0.0,
            is_settled: false,
            impulse_n_s: DVec3::ZERO,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// `sum w_i x_i` must be parallel to the impulse, for both kinds and any friction.
    fn moment_arm(feature: Feature, g: &Geometry, points: [DVec3; 4], impulse: DVec3) -> DVec3 {
        let c = Constraint {
            weights: g.weights,
            weight_shifts_per_m: feature.weight_shifts_per_m(points, g.normal),
            normal: g.normal,
            gap_m: g.gap_m,
            impulse_n_s: impulse,
            ..Constraint::blank(feature)
        };
        let w = c.moment_free_weights();
        assert!(w.iter().sum::<f64>().abs() < 1e-14);
        (0..4).map(|i| points[i] * w[i]).sum::<DVec3>().cross(impulse)
    }

    #[test]
    fn forces_of_a_node_and_a_patch_have_no_moment() {
        let patch = [DVec3::new(0.1, 0.0, 0.0), DVec3::new(1.0, 0.2, 0.1), DVec3::new(0.0, 1.0, -0.1)];
        let node = DVec3::new(0.3, 0.4, 0.5);
        let g = Geometry::node_on_patch(node, patch).unwrap();
        let impulse = g.normal * 2.0 + g.normal.any_orthonormal_vector() * 0.7;
        let moment = moment_arm(
            Feature::NodeOnPatch { node: 0, triangle: 0 },
            &g,
            [node, patch[0], patch[1], patch[2]],
            impulse,
        );
        assert!(moment.length() < 1e-14, "{moment}");
        assert!(g.gap_m > 0.3);
    }

    #[test]
    fn forces_of_two_edges_have_no_moment() {
        let p = [DVec3::new(-1.0, 0.1, 1.0), DVec3::new(1.0, -0.1, 1.2)];
        let q = [DVec3::new(0.2, -1.0, 0.0), DVec3::new(0.0, 1.0, 0.1)];
        let g = Geometry::edge_on_edge(p, q, DVec3::Z).unwrap();
        assert!(g.gap_m > 0.5 && g.normal.z > 0.9);
        let impulse = g.normal + g.normal.any_orthonormal_vector() * 0.4;
        let moment =
            moment_arm(Feature::EdgeOnEdge { first: 0, second: 0 }, &g, [p[0], p[1], q[0], q[1]], impulse);
        assert!(moment.length() < 1e-14, "{moment}");
    }
}
