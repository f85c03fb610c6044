//! What becomes of the numbers of a surface when the mesh behind it is cut, or when some of it has to be looked at anew.

use super::Surface;

/// Old and new numbers of the triangles and edges of a surface before and after a cut. Nodes keep theirs.
///
/// A node is *affected* when one of its triangles came or went, or where nothing was cut, when it is said to be; triangles and
/// edges are when one of their nodes is. Around all others nothing changed but the numbers.
#[derive(Clone, Debug, Default)]
pub struct Renumbering {
    triangle_now: Vec<Option<u32>>,
    edge_now: Vec<Option<u32>>,
    unaffected_triangle_now: Vec<Option<u32>>,
    unaffected_edge_now: Vec<Option<u32>>,
    is_affected: Vec<bool>,
    new_triangles: Vec<u32>,
    affected_triangles: Vec<u32>,
    triangle_count: usize,
}

impl Renumbering {
    /// Compares the surfaces of a mesh before and after a cut, after which it has `node_count` nodes.
    #[must_use]
    pub fn between(old: &Surface, new: &Surface, node_count: usize) -> Self {
        let mut found = Self {
            triangle_now: vec![None; old.triangles.len()],
            edge_now: vec![None; old.edges.len()],
            is_affected: vec![false; node_count],
            triangle_count: new.triangles.len(),
            ..Self::default()
        };
        found.match_triangles(old, new);
        let is_gone = |(triangle, now): (&[u32; 3], &Option<u32>)| now.is_none().then_some(*triangle);
        let gone = old.triangles.iter().zip(&found.triangle_now).filter_map(is_gone);
        let come = found.new_triangles.iter().map(|t| new.triangles[*t as usize]);
        for node in gone.chain(come).flatten() {
            found.is_affected[node as usize] = true;
        }
        found.match_edges(old, new);
        found.tell_affected((&old.triangles, old.edges.iter().map(|edge| edge.nodes)), &new.triangles);
        found
    }

    /// Of a surface that stays as it is, of whose nodes some are affected.
    #[must_use]
    pub fn unchanged(
        triangles: &[[u32; 3]],
        edges: impl ExactSizeIterator<Item = [u32; 2]>,
        is_affected: Vec<bool>,
    ) -> Self {
        let mut found = Self {
            triangle_now: (0..triangles.len() as u32).map(Some).collect(),
            edge_now: (0..edges.len() as u32).map(Some).collect(),
            is_affected,
            triangle_count: triangles.len(),
            ..Self::default()
        };
        found.tell_affected((triangles, edges), triangles);
        found
    }

    /// Takes note of which triangles and edges (before) and triangles (now) are affected, by what is known of their nodes.
    fn tell_affected(
        &mut self,
        (triangles, edges): (&[[u32; 3]], impl Iterator<Item = [u32; 2]>),
        triangles_now: &[[u32; 3]],
    ) {
        let is_whole = |nodes: &[u32]| nodes.iter().all(|n| !self.is_affected[*n as usize]);
        let affected =
            (0_u32..).zip(triangles_now).filter(|(_, nodes)| !is_whole(*nodes)).map(|(t, _)| t).collect();
        let triangles = self.triangle_now.iter().zip(triangles);
        let triangles = triangles.map(|(now, nodes)| now.filter(|_| is_whole(nodes))).collect();
        let edges = self.edge_now.iter().zip(edges);
        let edges = edges.map(|(now, nodes)| now.filter(|_| is_whole(&nodes))).collect();
        (self.affected_triangles, self.unaffected_triangle_now, self.unaffected_edge_now) =
            (affected, triangles, edges);
    }

    /// A triangle is the same when it has the same corners in the same order and belongs to the same tetrahedron. Both
    /// lists are in the order of the tetrahedra.
    fn match_triangles(&mut self, old: &Surface, new: &Surface) {
        let mut first = 0;
        let mut is_known = vec![false; new.triangles.len()];
        for (index, (nodes, tet)) in old.triangles.iter().zip(&old.triangle_tet).enumerate() {
            while new.triangle_tet.get(first).is_some_and(|t| t < tet) {
                first += 1;
            }
            let of_tet = (first..new.triangles.len()).take_while(|t| new.triangle_tet[*t] == *tet);
            let same = of_tet.into_iter().find(|t| new.triangles[*t] == *nodes);
            if let Some(same) = same {
                is_known[same] = true;
                self.triangle_now[index] = Some(same as u32);
            }
        }
        self.new_triangles = (0_u32..).zip(is_known).filter(|(_, known)| !known).map(|(t, _)| t).collect();
    }

    /// An edge is the same when it has the same nodes and triangles. Both lists are in the order of the nodes.
    fn match_edges(&mut self, old: &Surface, new: &Surface) {
        let mut first = 0;
        for (index, edge) in old.edges.iter().enumerate() {
            while new.edges.get(first).is_some_and(|e| e.nodes < edge.nodes) {
                first += 1;
            }
            let [Some(a), Some(b)] = edge.triangles.map(|t| self.triangle_now[t as usize]) else { continue };
            let mut of_nodes = (first..new.edges.len()).take_while(|e| new.edges[*e].nodes == edge.nodes);
            let same = of_nodes.find(|e| new.edges[*e].triangles == [a.min(b), a.max(b)]);
            self.edge_now[index] = same.map(|e| e as u32);
        }
    }

    /// Present number of a triangle; `None` when it is gone.
    #[must_use]
    pub fn triangle_now(&self, old: u32) -> Option<u32> {
        self.triangle_now.get(old as usize).copied().flatten()
    }

    /// Present number of an edge; `None` when it is gone.
    #[must_use]
    pub fn edge_now(&self, old: u32) -> Option<u32> {
        self.edge_now.get(old as usize).copied().flatten()
    }

    /// Present number of a triangle without affected nodes; `None` for others.
    #[must_use]
    pub fn unaffected_triangle_now(&self, old: u32) -> Option<u32> {
        self.unaffected_triangle_now.get(old as usize).copied().flatten()
    }

    /// Present number of an edge without affected nodes; `None` for others.
    #[must_use]
    pub fn unaffected_edge_now(&self, old: u32) -> Option<u32> {
        self.unaffected_edge_now.get(old as usize).copied().flatten()
    }

    /// Whether a triangle at the node came or went.
    #[must_use]
    pub fn is_affected(&self, node: u32) -> bool {
        self.is_affected[node as usize]
    }

    /// Present numbers of the triangles that were not there before, ascending.
    #[must_use]
    pub fn new_triangles(&self) -> &[u32] {
        &self.new_triangles
    }

    /// Present numbers of the triangles with an affected node, ascending; all new ones are among them.
    #[must_use]
    pub fn affected_triangles(&self) -> &[u32] {
        &self.affected_triangles
    }

    /// Number of triangles after the cut.
    #[must_use]
    pub fn triangle_count(&self) -> usize {
        self.triangle_count
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_tetrahedron_that_parts_from_its_neighbour_leaves_the_rest_as_it_was() {
        // Three tetrahedra in a row; the last one gets its own three nodes.
        let old = Surface::of(&[[0, 1, 2, 3], [1, 2, 3, 4], [2, 3, 4, 5]]);
        let new = Surface::of(&[[0, 1, 2, 3], [1, 2, 3, 4], [6, 7, 8, 5]]);
        let found = Renumbering::between(&old, &new, 9);
        let affected: Vec<u32> = (0..9).filter(|n| found.is_affected(*n)).collect();
        assert_eq!(affected, [2, 3, 4, 5, 6, 7, 8]);
        for (index, triangle) in (0_u32..).zip(&old.triangles) {
            let now = found.triangle_now(index).map(|t| new.triangles[t as usize]);
            let stays = old.triangle_tet[index as usize] < 2;
            assert_eq!(now, stays.then_some(*triangle));
        }
        let edge =
            |s: &Surface, nodes: [u32; 2]| s.edges.iter().position(|e| e.nodes == nodes).unwrap() as u32;
        assert_eq!(found.edge_now(edge(&old, [0, 1])), Some(edge(&new, [0, 1])));
        // One of its triangles was the last tetrahedron's.
        assert_eq!(found.edge_now(edge(&old, [2, 4])), None);
        assert_eq!(found.new_triangles().len(), 5);
    }
}
