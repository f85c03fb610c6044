//! What touches what in a tetrahedral mesh: boundary triangles and edges, elements at a node,
//! connected pieces.
//!
//! Everything is built by sorting, so the result depends on the numbering of the mesh alone.

use super::TetMesh;
use crate::math::{DisjointSets, in_parts, in_rows};
use rayon::slice::ParallelSliceMut as _;

/// Corners of the four faces of a right-handed tetrahedron, each counter-clockwise from outside;
/// face `f` lies opposite corner `f`.
pub const TET_FACES: [[usize; 3]; 4] = [[1, 2, 3], [0, 3, 2], [0, 1, 3], [0, 2, 1]];

/// The boundary of a tetrahedral mesh.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Surface {
    /// Boundary triangles, mesh node indices, counter-clockwise from outside, in the order of the
    /// tetrahedra behind them.
    pub triangles: Vec<[u32; 3]>,
    /// Tetrahedron behind each triangle.
    pub triangle_tet: Vec<u32>,
    /// Nodes on the boundary, ascending.
    pub nodes: Vec<u32>,
    /// Edges of the triangles, by their nodes; an edge where four triangles meet appears twice.
    pub edges: Vec<SurfaceEdge>,
    /// Number of edges of an odd number of triangles; zero when the boundary is closed.
    pub open_edges: usize,
    /// Number of edges where more than two triangles meet.
    pub non_manifold_edges: usize,
    /// Number of faces shared by more than two tetrahedra; zero in a sound mesh.
    pub overused_faces: usize,
}

/// An edge of the boundary and the two triangles that meet there with solid between them.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct SurfaceEdge {
    /// End nodes, smaller index first.
    pub nodes: [u32; 2],
    /// The two triangles, indices into [`Surface::triangles`], smaller first; the same twice
    /// where an open surface has but one.
    pub triangles: [u32; 2],
}

/// A face of a tetrahedron: sorted node indices and `4 * tet + face` packed into one number that
/// sorts equal faces together, in a fixed order.
type FaceKey = u128;

fn face_key(mut nodes: [u32; 3], tet_face: u32) -> FaceKey {
    nodes.sort_unstable();
    let [a, b, c] = nodes.map(u128::from);
    a << 96 | b << 64 | c << 32 | u128::from(tet_face)
}

/// Index of the tetrahedron of a packed face, and which of its faces it is.
#[expect(clippy::cast_possible_truncation, reason = "the low 32 bits are the packed index")]
fn tet_and_face(key: FaceKey) -> (u32, usize) {
    let tet_face = key as u32;
    (tet_face / 4, (tet_face % 4) as usize)
}

fn same_face(a: FaceKey, b: FaceKey) -> bool {
    a >> 32 == b >> 32
}

/// All faces of all tetrahedra, sorted so that shared faces stand side by side.
fn sorted_faces(tets: &[[u32; 4]]) -> Vec<FaceKey> {
    let mut faces: Vec<FaceKey> = (0_u32..)
        .zip(tets)
        .flat_map(|(t, tet)| {
            (0_u32..)
                .zip(TET_FACES)
                .map(move |(f, corners)| face_key(corners.map(|corner| tet[corner]), 4 * t + f))
        })
        .collect();
    faces.par_sort_unstable();
    faces
}

impl Surface {
    /// Finds the boundary: the faces that belong to one tetrahedron only.
    #[must_use]
    pub fn of(tets: &[[u32; 4]]) -> Self {
        let faces = sorted_faces(tets);
        let mut behind = vec![[None; 4]; tets.len()];
        let mut overused_faces = 0;
        for group in faces.chunk_by(|&a, &b| same_face(a, b)).filter(|group| group.len() > 1) {
            overused_faces += usize::from(group.len() > 2);
            for (place, key) in group.iter().enumerate() {
                let (tet, face) = tet_and_face(*key);
                behind[tet as usize][face] = Some(tet_and_face(group[usize::from(place == 0)]).0);
            }
        }
        Self { overused_faces, ..Self::of_neighbours(tets, |tet, face| behind[tet as usize][face]) }
    }

    /// The boundary of a mesh of which it is known which tetrahedron lies behind each face (of the tetrahedron, as in
    /// [`TET_FACES`]): the faces that have none behind them.
    #[must_use]
    pub fn of_neighbours(tets: &[[u32; 4]], neighbour: impl Fn(u32, usize) -> Option<u32> + Sync) -> Self {
        let outside = |tet: usize, corners: &[u32; 4], found: &mut Vec<([u32; 3], u32)>| {
            let tet = tet as u32;
            found.extend(outer_faces(tet, *corners, &neighbour).map(|triangle| (triangle, tet)));
        };
        let (triangles, triangle_tet): (Vec<_>, Vec<_>) =
            in_parts::flat_map(tets, TETS_AT_ONCE, outside).into_iter().unzip();
        let nodes = used_nodes(&triangles);
        let mut surface = Self { triangles, triangle_tet, nodes, ..Self::default() };
        let sides = sorted_sides(&surface.triangles, surface.nodes.last().map_or(0, |last| last + 1));
        for group in sides.chunk_by(|a, b| a.0 == b.0) {
            surface.push_edges_of(group, tets, &neighbour);
        }
        surface
    }

    /// This boundary after a cut of the mesh. `touched` are the tetrahedra, ascending, whose faces may have come to the boundary,
    /// gone from it or changed their corners; the faces of all others are as they were, and are not looked at.
    #[must_use]
    pub fn after_cut(
        &self,
        tets: &[[u32; 4]],
        touched: &[u32],
        neighbour: impl Fn(u32, usize) -> Option<u32> + Sync,
    ) -> Self {
        let mut now = Self::default();
        let mut triangle_now = vec![None; self.triangles.len()];
        let mut before = (0_u32..).zip(self.triangles.iter().zip(&self.triangle_tet)).peekable();
        let mut stay = |now: &mut Self, (index, (triangle, tet)): (u32, (&[u32; 3], &u32))| {
            triangle_now[index as usize] = Some(now.push_triangle(*triangle, *tet));
        };
        let mut new = Vec::new();
        for &tet in touched {
            while let Some(stays) = before.next_if(|(_, (_, behind))| **behind < tet) {
                stay(&mut now, stays);
            }
            while before.next_if(|(_, (_, behind))| **behind == tet).is_some() {}
            let faces = outer_faces(tet, tets[tet as usize], &neighbour);
            new.extend(faces.map(|triangle| now.push_triangle(triangle, tet)));
        }
        before.for_each(|stays| stay(&mut now, stays));
        now.nodes = used_nodes(&now.triangles);
        now.follow_edges(self, (&triangle_now, &new), (tets, &neighbour));
        now
    }

    fn push_triangle(&mut self, triangle: [u32; 3], tet: u32) -> u32 {
        self.triangles.push(triangle);
        self.triangle_tet.push(tet);
        self.triangles.len() as u32 - 1
    }

    /// Takes over the edges from before a cut, but for those of triangles that are gone or new.
    fn follow_edges(
        &mut self,
        before: &Self,
        (triangle_now, new): (&[Option<u32>], &[u32]),
        (tets, neighbour): (&[[u32; 4]], &impl Fn(u32, usize) -> Option<u32>),
    ) {
        let gone = before.triangles.iter().zip(triangle_now).filter(|(_, now)| now.is_none());
        let mut stale: Vec<[u32; 2]> = gone.flat_map(|(triangle, _)| sides_of(*triangle)).collect();
        let of_new =
            |triangle: &u32| sides_of(self.triangles[*triangle as usize]).map(|side| (side, *triangle));
        let mut sides: Vec<([u32; 2], u32)> = new.iter().flat_map(of_new).collect();
        stale.extend(sides.iter().map(|(nodes, _)| *nodes));
        stale.sort_unstable();
        stale.dedup();
        let mut kept = Vec::with_capacity(before.edges.len());
        (self.open_edges, self.non_manifold_edges) = (before.open_edges, before.non_manifold_edges);
        let mut next_stale = stale.into_iter().peekable();
        for edges in before.edges.chunk_by(|a, b| a.nodes == b.nodes) {
            let nodes = edges[0].nodes;
            let now = |triangle: &u32| triangle_now[*triangle as usize];
            while next_stale.next_if(|stale| *stale < nodes).is_some() {}
            if next_stale.peek() != Some(&nodes) {
                let triangles = |edge: &SurfaceEdge| edge.triangles.map(|t| now(&t).unwrap_or(t));
                kept.extend(edges.iter().map(|edge| SurfaceEdge { nodes, triangles: triangles(edge) }));
                continue;
            }
            let mut group: Vec<u32> = edges.iter().flat_map(|edge| edge.triangles).collect();
            group.sort_unstable();
            group.dedup();
            self.open_edges -= group.len() % 2;
            self.non_manifold_edges -= usize::from(group.len() > 2);
            sides.extend(group.iter().filter_map(now).map(|triangle| (nodes, triangle)));
        }
        sides.sort_unstable();
        let mut kept = kept.into_iter().peekable();
        for group in sides.chunk_by(|a, b| a.0 == b.0) {
            while let Some(edge) = kept.next_if(|edge| edge.nodes < group[0].0) {
                self.edges.push(edge);
            }
            self.push_edges_of(group, tets, neighbour);
        }
        self.edges.extend(kept);
    }

    /// Whether every edge belongs to an even number of triangles.
    #[must_use]
    pub fn is_closed(&self) -> bool {
        self.open_edges == 0
    }

    /// Pairs the triangles at the same two nodes.
    fn push_edges_of(
        &mut self,
        group: &[([u32; 2], u32)],
        tets: &[[u32; 4]],
        neighbour: &impl Fn(u32, usize) -> Option<u32>,
    ) {
        let nodes = group[0].0;
        self.open_edges += group.len() % 2;
        self.non_manifold_edges += usize::from(group.len() > 2);
        match *group {
            [(_, first)] => self.push_edge(nodes, [first, first]),
            [(_, first), (_, second)] => self.push_edge(nodes, [first, second]),
            _ => self.pair_through_solid(group, tets, neighbour),
        }
    }

    fn push_edge(&mut self, nodes: [u32; 2], triangles: [u32; 2]) {
        self.edges.push(SurfaceEdge { nodes, triangles });
    }

    /// Pairs the triangles of an edge with more than two of them: those at the two ends of one fan
    /// of tetrahedra around the edge belong together.
    fn pair_through_solid(
        &mut self,
        group: &[([u32; 2], u32)],
        tets: &[[u32; 4]],
        neighbour: &impl Fn(u32, usize) -> Option<u32>,
    ) {
        let nodes = group[0].0;
        for &(_, triangle) in group {
            let corners = self.triangles[triangle as usize];
            let tet = self.triangle_tet[triangle as usize];
            let end = other_end_of_fan((nodes, corners, tet), tets, neighbour);
            let partner = group
                .iter()
                .map(|side| side.1)
                .find(|&other| end.is_some_and(|end| same_nodes(self.triangles[other as usize], end)));
            match partner {
                Some(other) if other > triangle => self.push_edge(nodes, [triangle, other]),
                Some(other) if other < triangle => {}
                _ => self.push_edge(nodes, [triangle, triangle]),
            }
        }
    }
}

/// The faces of a tetrahedron that have nothing behind them.
fn outer_faces(
    tet: u32,
    corners: [u32; 4],
    neighbour: &impl Fn(u32, usize) -> Option<u32>,
) -> impl Iterator<Item = [u32; 3]> {
    let is_outer = move |(face, _): &(usize, _)| neighbour(tet, *face).is_none();
    TET_FACES.iter().enumerate().filter(is_outer).map(move |(_, places)| places.map(|place| corners[place]))
}

/// Walks from boundary triangle `triangle` of `tet` around `edge` through the solid; returns the boundary triangle
/// where the walk ends, or `None` in an unsound mesh.
fn other_end_of_fan(
    (edge, triangle, mut tet): ([u32; 2], [u32; 3], u32),
    tets: &[[u32; 4]],
    neighbour: &impl Fn(u32, usize) -> Option<u32>,
) -> Option<[u32; 3]> {
    let mut apex = triangle.into_iter().find(|n| !edge.contains(n))?;
    for _ in 0..tets.len() {
        let corners = tets[tet as usize];
        let left_behind = corners.iter().position(|n| *n == apex)?;
        apex = corners.into_iter().find(|n| !edge.contains(n) && *n != apex)?;
        match neighbour(tet, left_behind) {
            Some(next) => tet = next,
            None => return Some([edge[0], edge[1], apex]),
        }
    }
    None
}

fn same_nodes(mut a: [u32; 3], mut b: [u32; 3]) -> bool {
    a.sort_unstable();
    b.sort_unstable();
    a == b
}

/// Tetrahedra whose faces one task looks at.
const TETS_AT_ONCE: usize = 4096;

fn used_nodes(triangles: &[[u32; 3]]) -> Vec<u32> {
    let used = triangles.as_flattened();
    let mut is_used = vec![false; used.iter().max().map_or(0, |last| *last as usize + 1)];
    used.iter().for_each(|node| is_used[*node as usize] = true);
    (0_u32..).zip(is_used).filter_map(|(node, is_used)| is_used.then_some(node)).collect()
}

/// The sides of a triangle, smaller index first.
fn sides_of([a, b, c]: [u32; 3]) -> [[u32; 2]; 3] {
    [[a, b], [b, c], [c, a]].map(|[p, q]| [p.min(q), p.max(q)])
}

/// The sides of all triangles, ascending: end nodes, smaller index first, and the triangle. They are laid out by their first
/// nodes, so that little is left to be sorted.
fn sorted_sides(triangles: &[[u32; 3]], node_count: u32) -> Vec<([u32; 2], u32)> {
    let of_triangle =
        |(triangle, corners): (u32, &[u32; 3])| sides_of(*corners).map(|side| (side[0], (side, triangle)));
    let (_, mut sides) = in_rows((0_u32..).zip(triangles).flat_map(of_triangle), node_count as usize);
    sides.chunk_by_mut(|a, b| a.0[0] == b.0[0]).for_each(<[_]>::sort_unstable);
    sides
}

/// The pieces a mesh falls into.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Pieces {
    /// Number of pieces.
    pub count: usize,
    /// Piece of each tetrahedron, numbered by their first tetrahedra.
    pub of_tet: Vec<u32>,
}

impl Pieces {
    /// Pieces whose tetrahedra hang together by whole faces.
    #[must_use]
    pub fn by_faces(tets: &[[u32; 4]]) -> Self {
        let mut sets = DisjointSets::new(tets.len());
        for pair in sorted_faces(tets).windows(2) {
            if same_face(pair[0], pair[1]) {
                sets.join(tet_and_face(pair[0]).0, tet_and_face(pair[1]).0);
            }
        }
        Self::numbered(&mut sets, tets.len(), |tet| tet)
    }

    /// Pieces whose tetrahedra hang together by nodes, even by a single one.
    #[must_use]
    pub fn by_nodes(mesh: &TetMesh) -> Self {
        let mut sets = DisjointSets::new(mesh.nodes_m.len());
        for &[a, b, c, d] in &mesh.tets {
            sets.join(a, b);
            sets.join(a, c);
            sets.join(a, d);
        }
        Self::numbered(&mut sets, mesh.tets.len(), |tet| mesh.tets[tet as usize][0])
    }

    #[expect(clippy::cast_possible_truncation, reason = "meshes hold fewer than 2^32 tetrahedra")]
    fn numbered(sets: &mut DisjointSets, tet_count: usize, member_of: impl Fn(u32) -> u32) -> Self {
        let mut piece_of_root = vec![u32::MAX; sets.count()];
        let mut count = 0;
        let of_tet = (0..tet_count as u32)
            .map(|tet| {
                let piece = &mut piece_of_root[sets.root(member_of(tet)) as usize];
                if *piece == u32::MAX {
                    *piece = count;
                    count += 1;
                }
                *piece
            })
            .collect();
        Self { count: count as usize, of_tet }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::DVec3;

    const UNIT: [DVec3; 4] = [DVec3::ZERO, DVec3::X, DVec3::Y, DVec3::Z];

    /// Six tetrahedra around the edge 0-1; nodes 2..=7 form a ring about it.
    fn fan(segments: &[u32]) -> Vec<[u32; 4]> {
        segments.iter().map(|&s| [0, 1, 2 + s, 2 + (s + 1) % 6]).collect()
    }

    #[test]
    fn faces_of_a_tetrahedron_look_outward() {
        let surface = Surface::of(&[[0, 1, 2, 3]]);
        assert_eq!(surface.triangles.len(), 4);
        let centre = UNIT.iter().sum::<DVec3>() / 4.0;
        for &[a, b, c] in &surface.triangles {
            let [a, b, c] = [a, b, c].map(|n| UNIT[n as usize]);
            assert!((b - a).cross(c - a).dot(a - centre) > 0.0);
        }
        assert_eq!(surface.edges.len(), 6);
        assert!(surface.is_closed());
    }

    #[test]
    fn face_f_lies_opposite_corner_f() {
        for (f, face) in TET_FACES.iter().enumerate() {
            assert!(!face.contains(&f));
        }
    }

    #[test]
    fn a_shared_face_is_inside() {
        let surface = Surface::of(&[[0, 1, 2, 3], [1, 2, 3, 4]]);
        assert_eq!(surface.triangles.len(), 6);
        assert_eq!(surface.triangle_tet, [0, 0, 0, 1, 1, 1]);
        assert_eq!(surface.edges.len(), 9);
        assert_eq!(surface.nodes, [0, 1, 2, 3, 4]);
    }

    #[test]
    fn a_pinched_edge_pairs_the_triangles_of_each_wedge() {
        let tets = fan(&[0, 1, 3, 4]);
        let surface = Surface::of(&tets);
        assert_eq!(surface.non_manifold_edges, 1);
        assert!(surface.is_closed());
        let axis: Vec<_> = surface
            .edges
            .iter()
            .filter(|e| e.nodes == [0, 1])
            .map(|e| e.triangles.map(|t| surface.triangle_tet[t as usize]))
            .collect();
        assert_eq!(axis, [[0, 1], [2, 3]], "pairs bound one wedge of solid each");
    }

    #[test]
    fn a_face_of_three_tetrahedra_is_counted() {
        let surface = Surface::of(&[[0, 1, 2, 3], [0, 1, 2, 4], [0, 1, 2, 5]]);
        assert_eq!(surface.overused_faces, 1);
    }

    #[test]
    fn pieces_by_faces_and_by_nodes_differ_where_only_an_edge_is_shared() {
        let tets = fan(&[3, 0, 4]);
        let faces = Pieces::by_faces(&tets);
        assert_eq!((faces.count, faces.of_tet), (2, vec![0, 1, 0]));
        let mesh = TetMesh::with_one_region(vec![DVec3::ZERO; 8], tets);
        assert_eq!(Pieces::by_nodes(&mesh).count, 1);
    }

    #[test]
    fn node_rows_list_every_tetrahedron_once() {
        let tets = fan(&[0, 1, 2]);
        let at_nodes = (0_u32..).zip(&tets).flat_map(|(t, tet)| tet.map(|node| (node, t)));
        let (starts, rows) = in_rows(at_nodes, 8);
        let at = |node: usize| &rows[starts[node] as usize..starts[node + 1] as usize];
        assert_eq!(at(0), [0, 1, 2]);
        assert_eq!(at(3), [0, 1]);
        assert_eq!(at(7), [0_u32; 0]);
    }
}
