//! Twins: nodes of one body that were one node before a crack parted them.
//!
//! The two sides of a crack that has not opened or slid touch at their twins. While a pair of twins is together, topology
//! says all there is to know about its contact: one constraint for each direction in which crack faces meet at it. No search,
//! no rivals, and a body full of closed cracks costs little more than its twins. What has slid away goes the usual way.

use super::detect::{BodyView, OWN_NEAR};
use super::geometry::unit_normal;
use super::surface::{CrackSide, NodeLists};
use crate::math::in_parts;
use glam::DVec3;

/// Distance of twins, over the local size, up to which they are together: what penetration may be.
pub(super) const TOGETHER: f64 = 1e-3;
/// Cosine of the angle between crack faces (8 degrees) up to which one stands for both: between twins that are together
/// they differ by a seventh of [`TOGETHER`] at most.
const ONE_FACE: f64 = 0.990;

/// Pairs of twins that one task looks at.
const TWINS_AT_ONCE: usize = 1024;

/// How two twins lie.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum TwinState {
    /// Where they were one.
    Together,
    /// Further in front of each other's crack faces than they can come back in the step.
    Open,
    /// Anywhere else.
    Apart,
}

/// The twins of a surface.
#[derive(Clone, Debug, Default)]
pub(super) struct Twins {
    /// Nodes of each pair, the smaller number first.
    pairs: Vec<[u32; 2]>,
    /// Squared distance up to which each pair is together, m2.
    together_m2: Vec<f64>,
    /// For each pair, the crack faces at its second node that were one with faces at its first; one for each direction.
    faces: NodeLists,
    /// For each node, the pairs that it belongs to.
    pairs_of: NodeLists,
}

/// What the twins of a surface are found from.
pub(super) struct CrackFaces<'a> {
    pub triangles: &'a [[u32; 3]],
    pub surface_nodes: &'a [u32],
    pub sides: &'a [Option<CrackSide>],
    /// Crack faces at each node.
    pub at_nodes: &'a NodeLists,
    pub node_size_m: &'a [f64],
    pub reference_m: &'a [DVec3],
}

impl Twins {
    pub fn of(cracks: &CrackFaces) -> Self {
        let count = cracks.reference_m.len();
        let place = |node: u32| cracks.reference_m[node as usize].to_array().map(f64::to_bits);
        let is_at_crack = |node: &u32| !cracks.at_nodes.of(*node).is_empty();
        let mut nodes: Vec<u32> = cracks.surface_nodes.iter().copied().filter(is_at_crack).collect();
        nodes.sort_by_cached_key(|node| (place(*node), *node));
        let mut pairs = Vec::new();
        for together in nodes.chunk_by(|a, b| place(*a) == place(*b)) {
            for (i, a) in together.iter().enumerate() {
                pairs.extend(together[i + 1..].iter().map(|b| [*a, *b]));
            }
        }
        pairs.sort_unstable();
        let size_m = |[a, b]: &[u32; 2]| cracks.node_size_m[*a as usize].min(cracks.node_size_m[*b as usize]);
        let faces = (0_u32..)
            .zip(&pairs)
            .flat_map(|(index, pair)| cracks.faces_between(*pair).into_iter().map(move |face| (index, face)));
        let members = (0_u32..).zip(&pairs).flat_map(|(index, pair)| pair.map(|node| (node, index)));
        Self {
            together_m2: pairs.iter().map(|pair| (TOGETHER * size_m(pair)).powi(2)).collect(),
            faces: NodeLists::new(faces.collect(), pairs.len()),
            pairs_of: NodeLists::new(members.collect(), count),
            pairs,
        }
    }

    /// How each pair lies.
    pub fn states(&self, view: &BodyView, step_s: f64, slack_m: f64) -> Vec<TwinState> {
        let state = |pair: usize, _: &[u32; 2]| Some(self.state(pair as u32, view, step_s, slack_m));
        in_parts::filter_map(&self.pairs, TWINS_AT_ONCE, state)
    }

    fn state(&self, pair: u32, view: &BodyView, step_s: f64, slack_m: f64) -> TwinState {
        let [a, b] = self.pairs[pair as usize].map(|node| node as usize);
        let apart_m = view.positions_m[a] - view.positions_m[b];
        let together_m2 = self.together_m2[pair as usize];
        if apart_m.length_squared() <= together_m2 {
            return TwinState::Together;
        }
        let way_m = (view.velocities_m_s[a] - view.velocities_m_s[b]).length() * step_s;
        let reach_m = OWN_NEAR / TOGETHER * together_m2.sqrt() + way_m + slack_m;
        let faces = self.faces.of(pair);
        let is_open = |face: &u32| {
            let [p, q, r] = view.surface.corners_m(*face, view.positions_m);
            let normal = (q - p).cross(r - p);
            let height = apart_m.dot(normal);
            height > 0.0 && height * height > reach_m * reach_m * normal.length_squared()
        };
        if !faces.is_empty() && faces.iter().all(is_open) { TwinState::Open } else { TwinState::Apart }
    }

    /// Number of a pair of nodes, if they are twins.
    pub fn pair(&self, a: u32, b: u32) -> Option<u32> {
        if self.pairs.is_empty() {
            return None;
        }
        let wanted = [a.min(b), a.max(b)];
        self.pairs_of.of(a).iter().copied().find(|pair| self.pairs[*pair as usize] == wanted)
    }

    /// Node and crack face of every contact of a pair.
    pub fn contacts(&self, pair: u32) -> impl Iterator<Item = (u32, u32)> + '_ {
        let node = self.pairs[pair as usize][0];
        self.faces.of(pair).iter().map(move |face| (node, *face))
    }
}

impl CrackFaces<'_> {
    /// The faces at the second node that were one with faces at the first; one for each direction.
    fn faces_between(&self, [first, second]: [u32; 2]) -> Vec<u32> {
        let side = |triangle: u32| self.sides[triangle as usize];
        let others: Vec<_> = self.at_nodes.of(first).iter().filter_map(|t| side(*t)).collect();
        let mut found: Vec<(u32, DVec3)> = Vec::new();
        for &face in self.at_nodes.of(second) {
            let Some(CrackSide { pair, above }) = side(face) else { continue };
            if !others.contains(&CrackSide { pair, above: !above }) {
                continue;
            }
            let corners_m = self.triangles[face as usize].map(|n| self.reference_m[n as usize]);
            let normal = unit_normal(corners_m);
            if found.iter().all(|(_, known)| known.dot(normal) < ONE_FACE) {
                found.push((face, normal));
            }
        }
        found.into_iter().map(|(face, _)| face).collect()
    }
}
