//! What contact needs of a body's surface: triangles, edges, nodes, local sizes.

use super::geometry::unit_normal;
use super::twins::{CrackFaces, Twins};
use super::ways::Clusters;
use crate::math::in_rows;
use crate::mesh::{Renumbering, Surface, SurfaceEdge};
use glam::DVec3;

/// Edges whose faces fold by less than this (cosine of the angle between the normals) are inner lines of
/// a flat face: node-triangle contact covers them.
const FLAT_EDGE_COSINE: f64 = 0.999;

/// A surface edge with the one or two triangles at it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct ContactEdge {
    /// End nodes, ascending.
    pub nodes: [u32; 2],
    /// Triangles at the edge; the same one twice at an open border.
    pub triangles: [u32; 2],
    /// Whether the edge is sharp and convex in the reference shape, so that it can meet other edges.
    pub is_sharp: bool,
}

/// What of a crack a triangle is: `pair` counts the faces that were two sides of one face, or parts of it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct CrackSide {
    /// Number of the pair.
    pub pair: u32,
    /// Which of its two sides.
    pub above: bool,
}

/// The surface of one body, in terms of its own node indices.
#[derive(Clone, Debug, Default)]
pub struct ContactSurface {
    /// Triangles, counter-clockwise from outside.
    pub triangles: Vec<[u32; 3]>,
    /// Edges, each once.
    pub edges: Vec<ContactEdge>,
    /// Nodes on the surface, ascending.
    pub nodes: Vec<u32>,
    /// Local element size of each triangle: square root of twice its area, m.
    pub triangle_size_m: Vec<f64>,
    /// Local element size at each node of the body: the smallest of the triangles at it, m; infinite inside.
    pub node_size_m: Vec<f64>,
    /// For each triangle, which of its corners it speaks for when pairs are enumerated by triangles,
    /// so that no node is met twice.
    pub owns_node: Vec<[bool; 3]>,
    /// For each triangle, the sharp edges it speaks for.
    pub owned_edges: Vec<[Option<u32>; 3]>,
    /// For each triangle, whether a crack opened there.
    pub crack_sides: Vec<Option<CrackSide>>,
    /// Nodes joined to each node of the body by an edge of the surface.
    neighbours: NodeLists,
    /// Triangles at each node of the body that are crack faces.
    crack_triangles: NodeLists,
    /// Nodes that were one before they cracked.
    pub(super) twins: Twins,
    /// Which triangles move about alike.
    pub(super) clusters: Clusters,
}

/// Lists of numbers, one per node (or whatever is counted), end to end.
#[derive(Clone, Debug, Default)]
pub(super) struct NodeLists {
    starts: Vec<u32>,
    entries: Vec<u32>,
}

impl NodeLists {
    /// From pairs of a node and an entry; ascending for each node.
    pub fn new(pairs: Vec<(u32, u32)>, node_count: usize) -> Self {
        let (starts, mut entries) = in_rows(pairs.into_iter(), node_count);
        for range in starts.windows(2) {
            entries[range[0] as usize..range[1] as usize].sort_unstable();
        }
        Self { starts, entries }
    }

    pub fn of(&self, node: u32) -> &[u32] {
        let [from, to] = [node, node + 1].map(|n| self.starts[n as usize] as usize);
        &self.entries[from..to]
    }
}

impl ContactSurface {
    /// Takes over a mesh's boundary; `reference_m` are the reference positions of all its nodes.
    #[must_use]
    pub fn new(boundary: &Surface, reference_m: &[DVec3]) -> Self {
        let sizes_m = boundary.triangles.iter().map(|triangle| size_m(*triangle, reference_m)).collect();
        let is_sharp = |edge: &SurfaceEdge| is_sharp(&boundary.triangles, edge.triangles, reference_m);
        Self::laid_out(boundary, reference_m.len(), sizes_m, boundary.edges.iter().map(is_sharp).collect())
    }

    /// This surface after a cut, which has made the boundary what it is now and given it the numbers; what is told of cracks is left
    /// out.
    #[must_use]
    pub fn after_cut(&self, boundary: &Surface, numbers: &Renumbering, reference_m: &[DVec3]) -> Self {
        let sizes_m =
            carried_over(&self.triangle_size_m, boundary.triangles.len(), |t| numbers.triangle_now(t));
        let sizes_m = boundary.triangles.iter().zip(sizes_m);
        let sizes_m =
            sizes_m.map(|(triangle, known)| known.unwrap_or_else(|| size_m(*triangle, reference_m)));
        let sharp: Vec<bool> = self.edges.iter().map(|edge| edge.is_sharp).collect();
        let sharp =
            boundary.edges.iter().zip(carried_over(&sharp, boundary.edges.len(), |e| numbers.edge_now(e)));
        let anew = |edge: &SurfaceEdge| is_sharp(&boundary.triangles, edge.triangles, reference_m);
        let sharp = sharp.map(|(edge, known)| known.unwrap_or_else(|| anew(edge)));
        Self::laid_out(boundary, reference_m.len(), sizes_m.collect(), sharp.collect())
    }

    /// Of a body with so many nodes, with the sizes of the triangles, m, and whether the edges are sharp.
    fn laid_out(
        boundary: &Surface,
        node_count: usize,
        triangle_size_m: Vec<f64>,
        is_sharp: Vec<bool>,
    ) -> Self {
        let triangles = boundary.triangles.clone();
        let contact_edge = |(edge, is_sharp): (&SurfaceEdge, bool)| ContactEdge {
            nodes: edge.nodes,
            triangles: edge.triangles,
            is_sharp,
        };
        let edges: Vec<ContactEdge> = boundary.edges.iter().zip(is_sharp).map(contact_edge).collect();
        let nodes = boundary.nodes.clone();
        let mut node_size_m = vec![f64::INFINITY; node_count];
        for (triangle, size_m) in triangles.iter().zip(&triangle_size_m) {
            for node in triangle {
                let smallest = &mut node_size_m[*node as usize];
                *smallest = smallest.min(*size_m);
            }
        }
        let owns_node = first_owner_of_nodes(&triangles, node_count);
        let mut owned_edges = vec![[None; 3]; triangles.len()];
        for (index, edge) in edges.iter().enumerate().filter(|(_, edge)| edge.is_sharp) {
            let slots = &mut owned_edges[edge.triangles[0] as usize];
            let free = slots.iter().position(Option::is_none).unwrap_or(2);
            slots[free] = Some(index as u32);
        }
        let joined = edges.iter().flat_map(|e| [(e.nodes[0], e.nodes[1]), (e.nodes[1], e.nodes[0])]);
        let neighbours = NodeLists::new(joined.collect(), node_count);
        let crack_triangles = NodeLists::new(Vec::new(), node_count);
        let crack_sides = vec![None; triangles.len()];
        let mut surface = Self {
            triangles,
            edges,
            nodes,
            triangle_size_m,
            node_size_m,
            owns_node,
            owned_edges,
            crack_sides,
            neighbours,
            crack_triangles,
            twins: Twins::default(),
            clusters: Clusters::default(),
        };
        surface.clusters = Clusters::of(&surface);
        surface
    }

    /// The same surface, of which these triangles are crack faces: one entry per triangle.
    #[must_use]
    pub fn with_cracks(mut self, sides: Vec<Option<CrackSide>>, reference_m: &[DVec3]) -> Self {
        let cracked = (0_u32..).zip(&self.triangles).zip(&sides).filter(|(_, side)| side.is_some());
        let at_nodes = cracked.flat_map(|((triangle, nodes), _)| nodes.map(|node| (node, triangle)));
        self.crack_triangles = NodeLists::new(at_nodes.collect(), self.node_size_m.len());
        self.twins = Twins::of(&CrackFaces {
            triangles: &self.triangles,
            surface_nodes: &self.nodes,
            sides: &sides,
            at_nodes: &self.crack_triangles,
            node_size_m: &self.node_size_m,
            reference_m,
        });
        self.crack_sides = sides;
        self
    }

    /// Mean local element size, m.
    #[must_use]
    pub fn mean_size_m(&self) -> f64 {
        let sizes = &self.triangle_size_m;
        sizes.iter().sum::<f64>() / sizes.len().max(1) as f64
    }

    /// Whether any triangle is a crack face.
    #[must_use]
    pub fn has_cracked(&self) -> bool {
        !self.crack_triangles.entries.is_empty()
    }

    /// Whether a crack face ends at the node.
    #[must_use]
    pub fn is_at_crack(&self, node: u32) -> bool {
        !self.crack_triangles.of(node).is_empty()
    }

    /// Whether a crack parted the node's side of the triangle from the triangle.
    #[must_use]
    pub fn were_one(&self, node: u32, triangle: u32) -> bool {
        let Some(CrackSide { pair, above }) = self.crack_sides[triangle as usize] else { return false };
        let other_side = Some(CrackSide { pair, above: !above });
        self.crack_triangles.of(node).iter().any(|t| self.crack_sides[*t as usize] == other_side)
    }

    /// Mean of the unit vectors along the surface edges at a node: points into the body at a convex corner,
    /// vanishes on a flat face.
    #[must_use]
    pub fn inward(&self, node: u32, positions_m: &[DVec3]) -> DVec3 {
        let neighbours = self.neighbours.of(node);
        let at = |n: u32| positions_m[n as usize];
        let sum: DVec3 = neighbours.iter().map(|n| (at(*n) - at(node)).normalize_or_zero()).sum();
        sum / neighbours.len().max(1) as f64
    }

    /// Corner positions of a triangle, m.
    #[must_use]
    pub fn corners_m(&self, triangle: u32, positions_m: &[DVec3]) -> [DVec3; 3] {
        self.triangles[triangle as usize].map(|n| positions_m[n as usize])
    }
}

fn first_owner_of_nodes(triangles: &[[u32; 3]], node_count: usize) -> Vec<[bool; 3]> {
    let mut is_taken = vec![false; node_count];
    triangles.iter().map(|t| t.map(|n| !std::mem::replace(&mut is_taken[n as usize], true))).collect()
}

/// What is known after a cut of `now_count` things, by what was known before of those that are still there.
fn carried_over<T: Copy>(before: &[T], now_count: usize, now: impl Fn(u32) -> Option<u32>) -> Vec<Option<T>> {
    let mut known = vec![None; now_count];
    for (index, value) in (0_u32..).zip(before) {
        if let Some(now) = now(index) {
            known[now as usize] = Some(*value);
        }
    }
    known
}

/// Local element size of a triangle, m.
fn size_m(triangle: [u32; 3], reference_m: &[DVec3]) -> f64 {
    let [a, b, c] = triangle.map(|n| reference_m[n as usize]);
    (b - a).cross(c - a).length().sqrt()
}

fn is_sharp(triangles: &[[u32; 3]], at: [u32; 2], reference_m: &[DVec3]) -> bool {
    if at[0] == at[1] {
        return true;
    }
    let corners = at.map(|t| triangles[t as usize].map(|n| reference_m[n as usize]));
    let normals = corners.map(unit_normal);
    let is_folded = normals[0].dot(normals[1]) < FLAT_EDGE_COSINE;
    // Convex: the other triangle lies below the first one's plane.
    let centre = (corners[1][0] + corners[1][1] + corners[1][2]) / 3.0;
    is_folded && (centre - corners[0][0]).dot(normals[0]) < 0.0
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_node_and_edge_has_exactly_one_speaker() {
        let nodes = [DVec3::ZERO, DVec3::X, DVec3::Y, DVec3::Z];
        let surface = ContactSurface::new(&Surface::of(&[[0, 1, 2, 3]]), &nodes);
        assert_eq!(surface.nodes, [0, 1, 2, 3]);
        assert_eq!(surface.edges.len(), 6);
        assert!(surface.edges.iter().all(|e| e.is_sharp && e.triangles[0] != e.triangles[1]));
        let spoken_nodes = surface.owns_node.iter().flatten().filter(|o| **o).count();
        let mut spoken: Vec<u32> = surface.owned_edges.iter().flatten().flatten().copied().collect();
        spoken.sort_unstable();
        assert_eq!((spoken_nodes, spoken), (4, vec![0, 1, 2, 3, 4, 5]));
    }

    #[test]
    fn a_line_inside_a_flat_face_is_not_sharp() {
        // Two tetrahedra side by side on the plane z = 0; their common bottom edge is 1-2.
        let nodes = [DVec3::ZERO, DVec3::X, DVec3::Y, DVec3::X + DVec3::Y, DVec3::new(0.5, 0.5, 1.0)];
        let surface = ContactSurface::new(&Surface::of(&[[0, 1, 2, 4], [1, 3, 2, 4]]), &nodes);
        let edge = |n: [u32; 2]| surface.edges.iter().find(|e| e.nodes == n).unwrap();
        assert!(!edge([1, 2]).is_sharp);
        assert!(edge([0, 1]).is_sharp);
    }
}
