//! Fattened boxes around the triangles of a surface, in a bounding-volume hierarchy.
//!
//! They are put around the positions of one moment and stay valid until a node has moved further than the margin, so
//! that they are not touched in most steps (a Verlet list). Cuts are followed: boxes of triangles that are still
//! there stay, those of new ones are put into the hierarchy beside them.

use super::surface::ContactSurface;
use crate::math::in_parts;
use crate::mesh::Renumbering;
use glam::DVec3;
use parry3d_f64::bounding_volume::Aabb;
use parry3d_f64::partitioning::{Bvh, BvhBuildStrategy, BvhWorkspace};

/// Fattened boxes of one surface.
#[derive(Clone)]
pub struct SurfaceBoxes {
    bvh: Bvh,
    /// Triangle of each leaf; `None` for one that is gone.
    triangle_of_leaf: Vec<Option<u32>>,
    /// By triangle.
    boxes: Vec<Aabb>,
    /// Around all of them.
    bounds: Aabb,
    positions_m: Vec<DVec3>,
    /// By node, along each axis.
    margins_m: Vec<DVec3>,
}

/// A box around points, each fattened by its margin.
fn box_around(points: impl IntoIterator<Item = (DVec3, DVec3)>) -> Aabb {
    let (mut low, mut high) = (DVec3::INFINITY, DVec3::NEG_INFINITY);
    for (p, margin_m) in points {
        low = low.min(p - margin_m);
        high = high.max(p + margin_m);
    }
    Aabb::new(low, high)
}

pub(super) fn overlap(a: &Aabb, b: &Aabb) -> bool {
    a.mins.cmple(b.maxs).all() && b.mins.cmple(a.maxs).all()
}

impl SurfaceBoxes {
    /// Boxes around the surface at `positions_m` (all nodes of the body), fattened by `margin_m`.
    #[must_use]
    pub fn around(surface: &ContactSurface, positions_m: &[DVec3], margin_m: f64) -> Self {
        Self::swept(surface, positions_m, positions_m, margin_m)
    }

    /// Boxes around the straight paths of the surface from `start_m` to `end_m`, fattened.
    #[must_use]
    pub fn swept(surface: &ContactSurface, start_m: &[DVec3], end_m: &[DVec3], margin_m: f64) -> Self {
        let mut found = Self {
            bvh: Bvh::new(),
            triangle_of_leaf: Vec::new(),
            boxes: Vec::new(),
            bounds: Aabb::new_invalid(),
            positions_m: start_m.to_vec(),
            margins_m: vec![DVec3::splat(margin_m); start_m.len()],
        };
        found.put_around(surface, [start_m, end_m]);
        found.bvh = Bvh::from_leaves(BvhBuildStrategy::Binned, &found.boxes);
        found.triangle_of_leaf = (0..found.boxes.len() as u32).map(Some).collect();
        found
    }

    /// Boxes around the surface where it is now, fattened by node and along each axis: the ones that there are already, moved,
    /// or new ones.
    #[must_use]
    pub fn moved_or_new(
        before: Option<Self>,
        surface: &ContactSurface,
        positions_m: &[DVec3],
        margin_m: impl Fn(u32) -> DVec3,
    ) -> Self {
        let mut boxes = before.unwrap_or_else(|| Self::around(surface, positions_m, 0.0));
        boxes.move_to(surface, positions_m, margin_m);
        boxes
    }

    /// The same boxes around the surface where it is by now, fattened by node. The hierarchy stays: neighbours are neighbours
    /// still.
    pub fn move_to(
        &mut self,
        surface: &ContactSurface,
        positions_m: &[DVec3],
        margin_m: impl Fn(u32) -> DVec3,
    ) {
        self.positions_m.clear();
        self.positions_m.extend_from_slice(positions_m);
        self.margins_m = (0..positions_m.len() as u32).map(margin_m).collect();
        self.put_around(surface, [positions_m; 2]);
        self.refit(|_| true);
    }

    /// The same boxes but for those of the affected nodes; `at_m` tells their places and margins by now.
    pub fn move_affected(
        &mut self,
        surface: &ContactSurface,
        numbers: &Renumbering,
        at_m: impl Fn(u32) -> (DVec3, DVec3),
    ) {
        for node in (0..self.positions_m.len()).filter(|node| numbers.is_affected(*node as u32)) {
            (self.positions_m[node], self.margins_m[node]) = at_m(node as u32);
        }
        let mut is_affected = vec![false; self.boxes.len()];
        for triangle in numbers.affected_triangles() {
            self.boxes[*triangle as usize] = self.box_of(surface.triangles[*triangle as usize]);
            is_affected[*triangle as usize] = true;
        }
        self.enclose_all();
        self.refit(|triangle| is_affected[triangle as usize]);
    }

    /// Takes the boxes of such triangles over into the hierarchy.
    fn refit(&mut self, has_changed: impl Fn(u32) -> bool) {
        let mut leaves = Vec::new();
        for (leaf, triangle) in (0_u32..).zip(&self.triangle_of_leaf) {
            if let Some(triangle) = triangle.filter(|triangle| has_changed(*triangle)) {
                self.bvh.insert_or_update_partially(self.boxes[triangle as usize], leaf, 0.0);
                leaves.push(leaf);
            }
        }
        if leaves.len() < self.triangle_of_leaf.len() / REFIT_WHOLE {
            self.bvh.refit_partial(&[], &leaves);
        } else {
            self.bvh.refit(&mut BvhWorkspace::default());
        }
    }

    fn put_around(&mut self, surface: &ContactSurface, ends_m: [&[DVec3]; 2]) {
        let box_of = |t: &[u32; 3]| {
            let ends = t.iter().flat_map(|n| ends_m.map(|end_m| (end_m[*n as usize], self.margin_m(*n))));
            box_around(ends)
        };
        self.boxes = in_parts::map(&surface.triangles, BOXES_AT_ONCE, box_of);
        self.enclose_all();
    }

    fn enclose_all(&mut self) {
        let around = |all: Aabb, one: &Aabb| Aabb::new(all.mins.min(one.mins), all.maxs.max(one.maxs));
        self.bounds = self.boxes.iter().fold(Aabb::new_invalid(), around);
    }

    /// Follows a cut: `surface` is the one after it. Each new node lies between two parents, at a weight of the second
    /// one; later ones may have earlier ones as parents.
    pub fn follow(&mut self, surface: &ContactSurface, numbers: &Renumbering, parents: &[([u32; 2], f64)]) {
        for ([a, b], weight) in parents {
            let [x, y] = [a, b].map(|parent| self.positions_m[*parent as usize]);
            self.positions_m.push(x.lerp(y, *weight));
            self.margins_m.push(self.margin_m(*a).max(self.margin_m(*b)));
        }
        let mut boxes = vec![Aabb::new_invalid(); numbers.triangle_count()];
        for (old, kept) in (0_u32..).zip(&self.boxes) {
            if let Some(now) = numbers.triangle_now(old) {
                boxes[now as usize] = *kept;
            }
        }
        for triangle in numbers.new_triangles() {
            boxes[*triangle as usize] = self.box_of(surface.triangles[*triangle as usize]);
        }
        self.boxes = boxes;
        let mut free_leaves = Vec::new();
        for (leaf, triangle) in (0_u32..).zip(&mut self.triangle_of_leaf) {
            let now = triangle.and_then(|old| numbers.triangle_now(old));
            if triangle.is_some() && now.is_none() {
                self.bvh.remove(leaf);
            }
            if now.is_none() {
                free_leaves.push(leaf);
            }
            *triangle = now;
        }
        for new in numbers.new_triangles() {
            let leaf = free_leaves.pop().unwrap_or_else(|| {
                self.triangle_of_leaf.push(None);
                self.triangle_of_leaf.len() as u32 - 1
            });
            self.triangle_of_leaf[leaf as usize] = Some(*new);
            self.bvh.insert(self.boxes[*new as usize], leaf);
        }
    }

    /// Triangles whose boxes overlap a box.
    pub(super) fn overlapping(&self, wanted: Aabb) -> impl Iterator<Item = u32> {
        let leaves = self.bvh.leaves(move |node| overlap(&node.aabb(), &wanted));
        let triangles = leaves.filter_map(|leaf| self.triangle_of_leaf[leaf as usize]);
        triangles.filter(move |triangle| overlap(&self.boxes[*triangle as usize], &wanted))
    }

    /// Pairs of triangles of this surface and another whose boxes overlap.
    pub(super) fn pairs_with(&self, other: &Self) -> Vec<(u32, u32)> {
        let leaf_pairs = self.bvh.leaf_pairs(&other.bvh, |x, y| x.intersects(y));
        let of_leaves = |(a, b): (u32, u32)| {
            Some((self.triangle_of_leaf[a as usize]?, other.triangle_of_leaf[b as usize]?))
        };
        let mut pairs: Vec<(u32, u32)> = leaf_pairs.filter_map(of_leaves).collect();
        pairs.retain(|(a, b)| overlap(&self.boxes[*a as usize], &other.boxes[*b as usize]));
        pairs
    }

    /// Pairs of different triangles of this surface whose boxes overlap.
    pub(super) fn own_pairs(&self) -> Vec<(u32, u32)> {
        let mut pairs = Vec::new();
        self.bvh.traverse_bvtt_single_tree::<false>(&mut BvhWorkspace::default(), &mut |a, b| {
            let triangles = [a, b].map(|leaf| self.triangle_of_leaf[leaf as usize]);
            if let [Some(a), Some(b)] = triangles {
                pairs.push((a, b));
            }
        });
        pairs
    }

    /// How far the box of a node is fattened along each axis, and those of its triangles there, m. The node may go anywhere within
    /// the ellipsoid with these half axes: that far along a unit normal `n`: `|margin * n|`.
    #[must_use]
    pub fn margin_m(&self, node: u32) -> DVec3 {
        self.margins_m[node as usize]
    }

    /// The largest margins of some nodes, m.
    pub(super) fn most_margin_m(&self, nodes: &[u32]) -> DVec3 {
        nodes.iter().map(|node| self.margin_m(*node)).fold(DVec3::ZERO, DVec3::max)
    }

    /// Positions at which the boxes were built, all nodes of the body, m.
    #[must_use]
    pub fn built_at_m(&self) -> &[DVec3] {
        &self.positions_m
    }

    /// Box of a triangle.
    pub(super) fn of_triangle(&self, triangle: u32) -> &Aabb {
        &self.boxes[triangle as usize]
    }

    /// Box around everything.
    #[must_use]
    pub fn bounds(&self) -> Aabb {
        self.bounds
    }

    /// Box of one node.
    pub(super) fn node_box(&self, node: u32) -> Aabb {
        self.box_of([node])
    }

    fn box_of<const N: usize>(&self, nodes: [u32; N]) -> Aabb {
        box_around(nodes.map(|node| (self.positions_m[node as usize], self.margin_m(node))))
    }
}

/// The whole hierarchy is refitted where more of its leaves have changed than this share, as its inverse: going up from each of
/// them costs about so many boxes.
const REFIT_WHOLE: usize = 16;
/// Triangles whose boxes one task makes.
const BOXES_AT_ONCE: usize = 4096;

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mesh::Surface;
    use crate::mesh::shapes::block;

    #[test]
    fn boxes_that_were_moved_alone_are_found_where_they_are() {
        let mesh = block([12, 9, 6]);
        let surface = ContactSurface::new(&Surface::of(&mesh.tets), &mesh.nodes_m);
        let mut boxes = SurfaceBoxes::around(&surface, &mesh.nodes_m, 0.01);
        let moved = surface.nodes[surface.nodes.len() / 2];
        let is_moved = (0..mesh.nodes_m.len() as u32).map(|node| node == moved).collect();
        let edges = surface.edges.iter().map(|edge| edge.nodes);
        let numbers = Renumbering::unchanged(&surface.triangles, edges, is_moved);
        let affected = numbers.affected_triangles().len();
        assert!(affected > 0 && affected < surface.triangles.len() / REFIT_WHOLE);
        let there_m = mesh.nodes_m[moved as usize] + DVec3::new(50.0, 60.0, 70.0);
        boxes.move_affected(&surface, &numbers, |_| (there_m, DVec3::splat(0.02)));
        for middle_m in mesh.nodes_m.iter().copied().step_by(5).chain([there_m]) {
            let wanted = Aabb::from_half_extents(middle_m, DVec3::splat(0.1));
            let mut found: Vec<u32> = boxes.overlapping(wanted).collect();
            found.sort_unstable();
            let all = 0..surface.triangles.len() as u32;
            let overlapping: Vec<u32> = all.filter(|t| overlap(boxes.of_triangle(*t), &wanted)).collect();
            assert_eq!(found, overlapping);
        }
        assert_eq!(boxes.overlapping(boxes.node_box(moved)).count(), affected);
    }
}
