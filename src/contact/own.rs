//! Which features of one body may touch each other.
//!
//! In a body without cracks, features that are neighbours in the reference shape could only meet by turning an element
//! inside out: they are no candidates. Where it has cracked, the faces of a crack lie on each other in the reference
//! shape, and fresh ones do so in the world, too, where geometry cannot tell sides. Topology does: as long as a node
//! is still where it lay on a patch, it can touch that patch only if the two were one face once.

use super::surface::ContactSurface;
use super::time_of_impact::BORDER;
use super::twins::TOGETHER;
use super::{constraint::Geometry, geometry::closest_on_lines};
use glam::DVec3;

/// Reference distance, in local element sizes, up to which features of one body are neighbours.
const NEIGHBOUR: f64 = 2.0;
/// Distance in the reference shape, over the local size, up to which features lie on each other there.
const COINCIDENT: f64 = 1e-6;
/// Way of features from where they lay on each other, over the local size, up to which topology decides: what penetration may be.
const STILL_THERE: f64 = TOGETHER;

/// The features of one body, as far as they may touch each other.
pub struct OwnFeatures<'a> {
    /// Surface of the body.
    pub surface: &'a ContactSurface,
    /// Reference positions of its nodes, m.
    pub reference_m: &'a [DVec3],
    /// Positions of its nodes, m.
    pub positions_m: &'a [DVec3],
}

impl OwnFeatures<'_> {
    /// Whether a node and a patch of which it is no corner may touch at some time.
    #[must_use]
    pub fn node_may_touch(&self, node: u32, triangle: u32) -> bool {
        let s = self.surface;
        let corners = s.triangles[triangle as usize];
        let is_cracked = s.is_at_crack(node) || s.crack_sides[triangle as usize].is_some();
        is_cracked || corners.iter().all(|c| !self.are_near(node, *c))
    }

    /// Whether a node is still where it lay on a patch that it was never one with.
    #[must_use]
    pub fn is_beside(&self, node: u32, triangle: u32) -> bool {
        let s = self.surface;
        let size_m = s.triangle_size_m[triangle as usize].min(s.node_size_m[node as usize]);
        if s.were_one(node, triangle) {
            return false;
        }
        let way_m = self.way_from_patch_m(node, s.triangles[triangle as usize], size_m);
        way_m.is_some_and(|way_m| way_m <= STILL_THERE * size_m)
    }

    /// Whether two edges without common ends may touch at some time.
    #[must_use]
    pub fn edges_may_touch(&self, first: u32, second: u32) -> bool {
        let s = self.surface;
        let (p, q) = (s.edges[first as usize].nodes, s.edges[second as usize].nodes);
        let is_cracked = p.iter().chain(&q).any(|n| s.is_at_crack(*n));
        is_cracked || p.iter().all(|n| q.iter().all(|m| !self.are_near(*n, *m)))
    }

    /// Whether two edges are still where they lay on each other: nodes and patches hold them apart there.
    #[must_use]
    pub fn edges_are_beside(&self, first: u32, second: u32) -> bool {
        let s = self.surface;
        let (p, q) = (s.edges[first as usize].nodes, s.edges[second as usize].nodes);
        let at = |e: [u32; 2]| e.map(|n| self.reference_m[n as usize]);
        let (at_p, at_q) = (at(p), at(q));
        let size_m = (at_p[1] - at_p[0]).length().min((at_q[1] - at_q[0]).length());
        let Some([on_p, on_q]) = common_point(at_p, at_q, COINCIDENT * size_m) else { return false };
        let now = |e: [u32; 2], share: f64| {
            let [a, b] = e.map(|n| self.positions_m[n as usize]);
            a.lerp(b, share)
        };
        (now(p, on_p) - now(q, on_q)).length() <= STILL_THERE * size_m
    }

    fn are_near(&self, n: u32, m: u32) -> bool {
        let [size_n, size_m] = [n, m].map(|node| self.surface.node_size_m[node as usize]);
        self.reference_m[n as usize].distance(self.reference_m[m as usize]) <= NEIGHBOUR * size_n.max(size_m)
    }

    /// Distance of a node from where it lay on a patch in the reference shape, m; `None` if it did not.
    fn way_from_patch_m(&self, node: u32, corners: [u32; 3], size_m: f64) -> Option<f64> {
        let of = |values: &[DVec3]| corners.map(|c| values[c as usize]);
        let then = Geometry::node_on_patch(self.reference_m[node as usize], of(self.reference_m))?;
        if then.gap_m.abs() > COINCIDENT * size_m || !then.is_inside(BORDER) {
            return None;
        }
        let [_, w0, w1, w2] = then.weights;
        let [a, b, c] = of(self.positions_m);
        Some((self.positions_m[node as usize] + a * w0 + b * w1 + c * w2).length())
    }
}

/// Shares along two edges at which they have a point in common, within a tolerance in m.
fn common_point(p: [DVec3; 2], q: [DVec3; 2], tolerance_m: f64) -> Option<[f64; 2]> {
    let on_edge = |x: DVec3, [a, b]: [DVec3; 2]| {
        let share = ((x - a).dot(b - a) / (b - a).length_squared()).clamp(0.0, 1.0);
        (a.lerp(b, share).distance(x) <= tolerance_m).then_some(share)
    };
    for end in [0, 1] {
        if let Some(share) = on_edge(p[end], q) {
            return Some([end as f64, share]);
        }
        if let Some(share) = on_edge(q[end], p) {
            return Some([share, end as f64]);
        }
    }
    let (s, t) = closest_on_lines(p, q)?;
    let is_inside = |share: f64| (0.0..=1.0).contains(&share);
    let meets = p[0].lerp(p[1], s).distance(q[0].lerp(q[1], t)) <= tolerance_m;
    (is_inside(s) && is_inside(t) && meets).then_some([s, t])
}

#[cfg(test)]
mod tests {
    use super::super::surface::CrackSide;
    use super::*;
    use crate::mesh::Surface;

    /// Two tetrahedra that were one body along the plane x = 0, doubled nodes and all: 0, 1, 2 with 3 on the left, 4, 5, 6 with 7
    /// on the right.
    fn cracked() -> (ContactSurface, Vec<DVec3>) {
        let face = [DVec3::ZERO, DVec3::Y, DVec3::Z];
        let nodes: Vec<DVec3> =
            face.into_iter().chain([DVec3::NEG_X]).chain(face).chain([DVec3::X]).collect();
        let boundary = Surface::of(&[[0, 2, 1, 3], [4, 5, 6, 7]]);
        let is_crack = |t: &[u32; 3]| t.iter().all(|n| nodes[*n as usize].x == 0.0);
        let side = |t: &[u32; 3]| is_crack(t).then(|| CrackSide { pair: 0, above: t[0] >= 4 });
        let sides = boundary.triangles.iter().map(side).collect();
        (ContactSurface::new(&boundary, &nodes).with_cracks(sides, &nodes), nodes)
    }

    fn triangle_of(surface: &ContactSurface, mut nodes: [u32; 3]) -> u32 {
        nodes.sort_unstable();
        let sorted = |t: &[u32; 3]| {
            let mut t = *t;
            t.sort_unstable();
            t
        };
        surface.triangles.iter().position(|t| sorted(t) == nodes).unwrap() as u32
    }

    #[test]
    fn a_fresh_crack_face_touches_the_face_it_was_one_with_and_no_other() {
        let (surface, nodes) = cracked();
        let own = OwnFeatures { surface: &surface, reference_m: &nodes, positions_m: &nodes };
        assert!(!own.is_beside(0, triangle_of(&surface, [4, 5, 6])));
        // An outer face of the other part begins at the twin.
        assert!(own.is_beside(0, triangle_of(&surface, [4, 5, 7])));
        let edge = |n: [u32; 2]| surface.edges.iter().position(|e| e.nodes == n).map(|e| e as u32).unwrap();
        assert!(own.edges_are_beside(edge([0, 1]), edge([4, 5])));
        assert!(own.edges_are_beside(edge([0, 1]), edge([4, 7])));
    }

    #[test]
    fn what_has_slid_away_may_touch_anything() {
        let (surface, nodes) = cracked();
        let slid: Vec<DVec3> =
            (0..8).map(|n| nodes[n] + if n < 4 { DVec3::ZERO } else { DVec3::Y * 0.5 }).collect();
        let own = OwnFeatures { surface: &surface, reference_m: &nodes, positions_m: &slid };
        assert!(!own.is_beside(0, triangle_of(&surface, [4, 5, 7])));
    }
}
