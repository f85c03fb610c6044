//! Shapes swept along z: a disc of quadrilaterals, repeated level by level.
//!
//! The disc has a core, a square lattice bent to a circle, and rings of cells around it:
//!
//! ```text
//!     core 2, ring 1          core cells belong to ring 0,
//!       .--+--.               ring k lies between circles k-1 and k
//!      / \ | / \
//!     |   +-+   |
//!     +--+-+-+--+
//! ```

use super::hex_mesh::HexMesh;
use super::lattice::{disc_from_square, odd_count};
use glam::{DVec2, DVec3};

/// A node of the disc.
#[derive(Clone, Copy, Debug)]
pub(super) struct DiscNode {
    /// Place in the unit disc for the core; on a ring, the unit vector outward.
    pub unit: DVec2,
    /// 0 in the core and on its rim, `k` on circle `k` outside it.
    pub ring: u32,
    odd: u8,
}

/// A quadrilateral of the disc: node indices by the bits of `x + 2 y`, and its ring.
#[derive(Clone, Copy, Debug)]
struct DiscQuad {
    corners: [usize; 4],
    ring: u32,
}

/// How many cells a disc has.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct DiscSize {
    /// Cells along a side of the core; even, or 1.
    pub core: u32,
    /// Rings around the core.
    pub rings: u32,
}

impl DiscSize {
    /// Cells around the rim.
    pub fn around(self) -> u32 {
        4 * self.core
    }

    /// Cells of the core and of all rings, a level.
    pub fn core_and_ring_cells(self) -> [f64; 2] {
        let core = f64::from(self.core);
        [core * core, f64::from(self.rings) * 4.0 * core]
    }
}

/// Quadrilaterals that fill a disc.
#[derive(Clone, Debug, Default)]
pub(super) struct Disc {
    pub nodes: Vec<DiscNode>,
    quads: Vec<DiscQuad>,
    size: DiscSize,
}

impl Disc {
    pub fn new(size: DiscSize) -> Self {
        let mut disc = Self { size, ..Self::default() };
        disc.add_core();
        let mut inner = disc.core_rim();
        for ring in 1..=size.rings {
            inner = disc.add_ring(&inner, ring);
        }
        disc
    }

    fn add_core(&mut self) {
        let n = self.size.core;
        for j in 0..=n {
            for i in 0..=n {
                let [u, v] = [i, j].map(|at| 2.0 * f64::from(at) / f64::from(n) - 1.0);
                self.nodes.push(DiscNode {
                    unit: DVec2::from_array(disc_from_square(u, v)),
                    ring: 0,
                    odd: odd_count([i, j, 0]),
                });
            }
        }
        for j in 0..n {
            for i in 0..n {
                let corners = [[i, j], [i + 1, j], [i, j + 1], [i + 1, j + 1]];
                self.quads.push(DiscQuad { corners: corners.map(|at| self.core_node(at)), ring: 0 });
            }
        }
    }

    fn core_node(&self, [i, j]: [u32; 2]) -> usize {
        (j * (self.size.core + 1) + i) as usize
    }

    /// The core's rim, counter-clockwise from the lowest left corner.
    fn core_rim(&self) -> Vec<usize> {
        let n = self.size.core;
        let sides = (0..n)
            .map(|s| [s, 0])
            .chain((0..n).map(|s| [n, s]))
            .chain((0..n).map(|s| [n - s, n]))
            .chain((0..n).map(|s| [0, n - s]));
        sides.map(|at| self.core_node(at)).collect()
    }

    fn add_ring(&mut self, inner: &[usize], ring: u32) -> Vec<usize> {
        let first = self.nodes.len();
        let count = inner.len();
        for &below in inner {
            let DiscNode { unit, odd, .. } = self.nodes[below];
            let along_rim = odd - odd_count([ring - 1, 0, 0]);
            self.nodes.push(DiscNode { unit, ring, odd: along_rim + odd_count([ring, 0, 0]) });
        }
        for c in 0..count {
            let next = (c + 1) % count;
            self.quads.push(DiscQuad { corners: [inner[c], first + c, inner[next], first + next], ring });
        }
        (first..first + count).collect()
    }

    /// Cells around the rim.
    pub fn around(&self) -> u32 {
        self.size.around()
    }

    /// Index of node `step` (modulo [`Self::around`]) of the outermost circle, which must be a
    /// ring.
    pub fn outer_node(&self, step: u32) -> usize {
        debug_assert!(self.size.rings > 0);
        self.nodes.len() - (self.around() - step % self.around()) as usize
    }
}

/// A swept shape under construction.
pub(super) struct Sweep {
    pub mesh: HexMesh,
    node_at: Vec<u32>,
    disc_nodes: usize,
}

impl Sweep {
    /// Repeats `disc` over `levels` layers of cells. `region_of(ring, level)` names the region of
    /// a cell or says that there is none; `position_m(node, level)` places the nodes.
    pub fn new(
        disc: &Disc,
        levels: u32,
        region_of: impl Fn(u32, u32) -> Option<u32>,
        position_m: impl Fn(&DiscNode, u32) -> DVec3,
    ) -> Self {
        let disc_nodes = disc.nodes.len();
        let mut sweep = Self {
            mesh: HexMesh::default(),
            node_at: vec![u32::MAX; disc_nodes * (levels as usize + 1)],
            disc_nodes,
        };
        for level in 0..levels {
            for quad in &disc.quads {
                let Some(region) = region_of(quad.ring, level) else {
                    continue;
                };
                let corners = std::array::from_fn(|corner| {
                    let at = level + u32::from(corner >= 4);
                    let node = quad.corners[corner % 4];
                    sweep.node(disc, node, at, &position_m)
                });
                sweep.mesh.add_hex(corners, region);
            }
        }
        sweep
    }

    fn node(
        &mut self,
        disc: &Disc,
        node: usize,
        level: u32,
        position_m: impl Fn(&DiscNode, u32) -> DVec3,
    ) -> u32 {
        let slot = level as usize * self.disc_nodes + node;
        if self.node_at[slot] == u32::MAX {
            let disc_node = &disc.nodes[node];
            let odd = disc_node.odd + odd_count([level, 0, 0]);
            self.node_at[slot] = self.mesh.add_node(position_m(disc_node, level), odd);
        }
        self.node_at[slot]
    }

    /// The mesh node of a disc node on a level where there is solid.
    pub fn node_on(&self, disc_node: usize, level: u32) -> u32 {
        self.node_at[level as usize * self.disc_nodes + disc_node]
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mesh::{MeshReport, shapes::HexSplit};

    #[test]
    fn a_swept_disc_fills_its_polygon() {
        for (core, rings) in [(1, 0), (1, 2), (2, 1), (4, 0), (6, 3)] {
            let disc = Disc::new(DiscSize { core, rings });
            let radius = |ring: u32| 1.0 + f64::from(ring);
            let sweep = Sweep::new(
                &disc,
                2,
                |_, _| Some(0),
                |node, level| (node.unit * radius(node.ring)).extend(f64::from(level)),
            );
            for split in [HexSplit::Six, HexSplit::Five] {
                let mesh = sweep.mesh.clone().split(split, &["all"]);
                let sides = f64::from(disc.around());
                let polygon = 0.5 * sides * (std::f64::consts::TAU / sides).sin();
                let expected = polygon * radius(rings).powi(2) * 2.0;
                assert!((mesh.volume_m3() / expected - 1.0).abs() < 1e-12);
                let report = MeshReport::of(&mesh);
                assert!(report.is_sound() && report.non_manifold_edges == 0);
                assert!(report.slivers == 0, "{core} {rings} {report}");
            }
        }
    }
}
