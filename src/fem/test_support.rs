//! Meshes for the tests of this module.
use crate::mesh::TetMesh;
use glam::DVec3;

/// The unit cube, cut into boxes of six tetrahedra each (Kuhn's subdivision, conforming), its interior
/// nodes moved by up to `jitter` of a box side.
pub(crate) fn box_mesh(cells: [usize; 3], jitter: f64) -> TetMesh {
    let [nx, ny, nz] = cells;
    let index = |i: usize, j: usize, k: usize| ((i * (ny + 1) + j) * (nz + 1) + k) as u32;
    let mut random = Random(1);
    let mut nodes_m = Vec::new();
    for i in 0..=nx {
        for j in 0..=ny {
            for k in 0..=nz {
                let place = DVec3::new(i as f64, j as f64, k as f64);
                let inside = |at: usize, n: usize| f64::from(u8::from(at > 0 && at < n));
                let free = DVec3::new(inside(i, nx), inside(j, ny), inside(k, nz));
                let shift = jitter * free * free.min_element() * random.vector();
                nodes_m.push((place + shift) / DVec3::new(nx as f64, ny as f64, nz as f64));
            }
        }
    }
    let mut tets = Vec::new();
    for i in 0..nx {
        for j in 0..ny {
            for k in 0..nz {
                for (order, even) in KUHN {
                    let mut at = [i, j, k];
                    let mut tet = [index(i, j, k); 4];
                    for (corner, &axis) in order.iter().enumerate() {
                        at[axis] += 1;
                        tet[corner + 1] = index(at[0], at[1], at[2]);
                    }
                    if !even {
                        tet.swap(2, 3);
                    }
                    tets.push(tet);
                }
            }
        }
    }
    TetMesh::with_one_region(nodes_m, tets)
}

/// The six ways from a corner of a box to the opposite one along the axes, and whether the order is an
/// even permutation (then the tetrahedron is right-handed).
const KUHN: [([usize; 3], bool); 6] = [
    ([0, 1, 2], true),
    ([1, 2, 0], true),
    ([2, 0, 1], true),
    ([0, 2, 1], false),
    ([2, 1, 0], false),
    ([1, 0, 2], false),
];

/// A small seeded generator (SplitMix64).
pub(crate) struct Random(pub u64);

impl Random {
    /// Uniform in -1..1.
    pub(crate) fn number(&mut self) -> f64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        ((z ^ (z >> 31)) >> 11) as f64 / (1_u64 << 52) as f64 - 1.0
    }

    /// Uniform in the cube of half side 1.
    pub(crate) fn vector(&mut self) -> DVec3 {
        DVec3::new(self.number(), self.number(), self.number())
    }
}
