//! A mesh of hexahedra and its cut into tetrahedra.
//!
//! Every quadrilateral face is cut along the diagonal through its corner of lowest rank, so two
//! hexahedra that share a face always agree and the result conforms. Ranks come from the parity
//! of the lattice coordinates, which gives two well-known patterns:
//!
//! - [`HexSplit::Six`]: rank = number of odd coordinates. Neighbouring hexahedra are mirror
//!   images (the "union jack" pattern), so no direction is preferred, as it would be if all
//!   diagonals ran the same way; six congruent tetrahedra a cube.
//! - [`HexSplit::Five`]: rank = parity of the sum. One large tetrahedron in the middle and four
//!   at the corners, alternating like a chess board.

use crate::mesh::TetMesh;
use glam::DVec3;

/// How a hexahedron is cut into tetrahedra.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum HexSplit {
    /// Six tetrahedra, mirrored from cell to cell: equal volumes, no preferred direction.
    #[default]
    Six,
    /// Five tetrahedra, alternating from cell to cell: fewer, rounder, of unequal volumes. Where
    /// cells are bent round (ball, cup, finer lamps and hammers) six are made all the same, since
    /// five would be flat there.
    Five,
}

/// A hexahedron; corner `c` sits at `x = c & 1`, `y = c >> 1 & 1`, `z = c >> 2` of its own
/// right-handed axes.
#[derive(Clone, Copy, Debug)]
pub(super) struct Hex {
    pub corners: [u32; 8],
    pub region: u32,
}

/// Hexahedra that share nodes.
#[derive(Clone, Debug, Default)]
pub(super) struct HexMesh {
    nodes_m: Vec<DVec3>,
    /// Number of odd lattice coordinates of each node.
    odd: Vec<u8>,
    hexes: Vec<Hex>,
}

impl HexMesh {
    /// Adds a node with the given number of odd lattice coordinates (0 to 3).
    pub fn add_node(&mut self, position_m: DVec3, odd: u8) -> u32 {
        let index = u32::try_from(self.nodes_m.len()).expect("the element limit bounds the nodes");
        self.nodes_m.push(position_m);
        self.odd.push(odd);
        index
    }

    pub fn add_hex(&mut self, corners: [u32; 8], region: u32) {
        self.hexes.push(Hex { corners, region });
    }

    pub fn position_m(&self, node: u32) -> DVec3 {
        self.nodes_m[node as usize]
    }

    /// Cuts all hexahedra and names the regions.
    pub fn split(self, split: HexSplit, region_names: &[&str]) -> TetMesh {
        let rank = |node: u32| {
            let odd = self.odd[node as usize];
            let class = match split {
                HexSplit::Six => odd,
                HexSplit::Five => odd % 2,
            };
            (class, node)
        };
        let mut mesh = TetMesh {
            region_names: region_names.iter().map(|&name| name.to_owned()).collect(),
            ..TetMesh::default()
        };
        for hex in &self.hexes {
            let tets = split_hex(hex.corners, rank);
            mesh.regions.extend(tets.iter().map(|_| hex.region));
            mesh.tets.extend(tets);
        }
        mesh.nodes_m = self.nodes_m;
        mesh
    }
}

/// Cuts one hexahedron: five tetrahedra when the corner opposite the lowest one has no diagonal,
/// else six, a cone from the lowest corner over the three faces that do not touch it.
fn split_hex<R: Ord>(corners: [u32; 8], rank: impl Fn(u32) -> R) -> Vec<[u32; 4]> {
    let lowest = (0..8).min_by_key(|&c| rank(corners[c])).expect("eight corners");
    // Relabelling by exclusive or mirrors the axes, so that the lowest corner becomes corner 0.
    let c: [u32; 8] = std::array::from_fn(|i| corners[i ^ lowest]);
    let mirrored = lowest.count_ones() % 2 == 1;
    // The three faces opposite corner 0, each as a cycle from its corner next to corner 0's
    // neighbour to corner 7, counter-clockwise from outside.
    let opposite_faces = [[1, 3, 7, 5], [2, 6, 7, 3], [4, 5, 7, 6]].map(|f| f.map(|i| c[i]));
    let through_far_corner = opposite_faces
        .map(|[near, side_a, far, side_b]| rank(near).min(rank(far)) < rank(side_a).min(rank(side_b)));
    let mut tets = if through_far_corner == [false; 3] {
        five(&c)
    } else {
        cone(c[0], opposite_faces, through_far_corner)
    };
    if mirrored {
        tets.iter_mut().for_each(|tet| tet.swap(2, 3));
    }
    tets
}

fn five(c: &[u32; 8]) -> Vec<[u32; 4]> {
    [[0, 3, 5, 6], [1, 3, 0, 5], [2, 0, 3, 6], [4, 5, 0, 6], [7, 3, 6, 5]]
        .map(|tet: [usize; 4]| right_handed_in_unit_cube(tet).map(|i| c[i]))
        .to_vec()
}

/// Orders the corners of a tetrahedron of cube corners so that it is right-handed.
fn right_handed_in_unit_cube(mut tet: [usize; 4]) -> [usize; 4] {
    let corner = |i: usize| {
        DVec3::new(f64::from((i & 1) as u8), f64::from((i >> 1 & 1) as u8), f64::from((i >> 2) as u8))
    };
    if crate::mesh::signed_volume_m3(&tet.map(corner)) < 0.0 {
        tet.swap(2, 3);
    }
    tet
}

fn cone(apex: u32, faces: [[u32; 4]; 3], through_far_corner: [bool; 3]) -> Vec<[u32; 4]> {
    let mut tets = Vec::with_capacity(6);
    for ([near, a, far, b], through) in faces.into_iter().zip(through_far_corner) {
        let triangles = if through { [[near, a, far], [near, far, b]] } else { [[near, a, b], [a, far, b]] };
        tets.extend(triangles.map(|[p, q, r]| [apex, p, q, r]));
    }
    tets
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mesh::{Surface, signed_volume_m3};

    fn unit_corner(i: u32) -> DVec3 {
        DVec3::new(f64::from(i & 1), f64::from(i >> 1 & 1), f64::from(i >> 2))
    }

    #[test]
    fn every_order_of_ranks_fills_the_cube_with_right_handed_tetrahedra() {
        let mut ranks: Vec<u32> = (0..8).collect();
        let mut seen = [0; 2];
        permute(&mut ranks, 0, &mut |ranks| {
            let tets = split_hex([0, 1, 2, 3, 4, 5, 6, 7], |c| ranks[c as usize]);
            let volumes: Vec<f64> = tets.iter().map(|tet| signed_volume_m3(&tet.map(unit_corner))).collect();
            assert!(volumes.iter().all(|&v| v > 0.1), "{ranks:?} {volumes:?}");
            assert!((volumes.iter().sum::<f64>() - 1.0).abs() < 1e-12);
            assert_eq!(Surface::of(&tets).triangles.len(), 12, "{ranks:?}");
            seen[tets.len() - 5] += 1;
        });
        assert!(seen[0] > 0 && seen[1] > 0);
    }

    fn permute(values: &mut Vec<u32>, from: usize, visit: &mut impl FnMut(&[u32])) {
        if from + 1 >= values.len() {
            return visit(values);
        }
        for i in from..values.len() {
            values.swap(from, i);
            permute(values, from + 1, visit);
            values.swap(from, i);
        }
    }
}
