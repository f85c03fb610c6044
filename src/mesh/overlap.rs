//! Whether two meshes occupy the same space.
//!
//! Exact for tetrahedral meshes: two bodies overlap when a tetrahedron of one and a tetrahedron of the
//! other do, and two tetrahedra are apart when one of the 8 face normals or 36 products of edges
//! separates them (separating axis theorem). Bounding boxes in a hierarchy choose which pairs are
//! looked at.

use super::{TetMesh, boxes};
use glam::DVec3;
use parry3d_f64::bounding_volume::{Aabb, BoundingVolume};

/// Bodies may touch: they may even overlap by this share of the smaller one's size, which is round-off
/// of placing one on the other and far below what contact treats as a penetration.
pub const TOUCHING_SHARE: f64 = 1e-6;

/// Two bodies in the same space.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Overlap {
    /// How far at least one has to be moved, m.
    pub depth_m: f64,
    /// A point inside both, m.
    pub near_m: DVec3,
}

/// The deepest overlap of any two tetrahedra of the two meshes; `None` when they at most touch.
#[must_use]
pub fn overlap(a: &TetMesh, b: &TetMesh) -> Option<Overlap> {
    let (box_a, box_b) = (boxes::of_mesh(a)?, boxes::of_mesh(b)?);
    let size_m = box_a.extents().length().min(box_b.extents().length());
    let touching_m = TOUCHING_SHARE * size_m;
    let common = box_a.intersection(&box_b)?;
    let tets_a = tets_within(a, &common);
    let tets_b = tets_within(b, &common);
    let tree = boxes::tree(&tets_b.iter().map(|&(_, bounds)| bounds).collect::<Vec<_>>())?;
    let mut deepest: Option<Overlap> = None;
    for (corners_a, bounds_a) in &tets_a {
        for other in tree.intersect_aabb(bounds_a) {
            let corners_b = &tets_b[other as usize].0;
            let least_m = deepest.map_or(touching_m, |found| found.depth_m);
            if let Some(depth_m) = tet_overlap_m(corners_a, corners_b, least_m) {
                let near_m = centre_of_common_box(bounds_a, &tets_b[other as usize].1);
                deepest = Some(Overlap { depth_m, near_m });
            }
        }
    }
    deepest
}

fn tets_within(mesh: &TetMesh, region: &Aabb) -> Vec<([DVec3; 4], Aabb)> {
    (0..mesh.tets.len())
        .map(|index| mesh.corners_m(index))
        .map(|corners| (corners, boxes::of_points(&corners)))
        .filter(|(_, bounds)| bounds.intersects(region))
        .collect()
}

fn centre_of_common_box(a: &Aabb, b: &Aabb) -> DVec3 {
    (a.mins.max(b.mins) + a.maxs.min(b.maxs)) / 2.0
}

/// The smallest overlap along any separating-axis candidate, when it is above `least_m`, m.
fn tet_overlap_m(a: &[DVec3; 4], b: &[DVec3; 4], least_m: f64) -> Option<f64> {
    let mut depth_m = f64::INFINITY;
    for axis in candidate_axes(a, b) {
        let Some(axis) = axis.try_normalize() else {
            continue;
        };
        let (low_a, high_a) = extent(a, axis);
        let (low_b, high_b) = extent(b, axis);
        depth_m = depth_m.min((high_a - low_b).min(high_b - low_a));
        if depth_m <= least_m {
            return None;
        }
    }
    depth_m.is_finite().then_some(depth_m)
}

/// Face normals of both, then the products of every edge of one with every edge of the other. A
/// product of nearly parallel edges is noise and comes out as zero.
fn candidate_axes(a: &[DVec3; 4], b: &[DVec3; 4]) -> impl Iterator<Item = DVec3> {
    let (edges_a, edges_b) = (edges(a), edges(b));
    let normals = normals(a).into_iter().chain(normals(b));
    let products = edges_a.into_iter().flat_map(move |edge_a| {
        edges_b.into_iter().map(move |edge_b| {
            let product = edge_a.cross(edge_b);
            let parallel = product.length() <= 1e-8 * edge_a.length() * edge_b.length();
            if parallel { DVec3::ZERO } else { product }
        })
    });
    normals.chain(products)
}

fn normals(corners: &[DVec3; 4]) -> [DVec3; 4] {
    let [a, b, c, d] = *corners;
    [(b - a).cross(c - a), (b - a).cross(d - a), (c - a).cross(d - a), (c - b).cross(d - b)]
}

fn edges(corners: &[DVec3; 4]) -> [DVec3; 6] {
    let [a, b, c, d] = *corners;
    [b - a, c - a, d - a, c - b, d - b, d - c]
}

fn extent(corners: &[DVec3; 4], axis: DVec3) -> (f64, f64) {
    let along = corners.map(|corner| corner.dot(axis));
    let low = along.into_iter().fold(f64::INFINITY, f64::min);
    let high = along.into_iter().fold(f64::NEG_INFINITY, f64::max);
    (low, high)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn tet_at(origin_m: DVec3, size_m: f64) -> TetMesh {
        let corners = [DVec3::ZERO, DVec3::X, DVec3::Y, DVec3::Z];
        let nodes_m = corners.map(|corner| origin_m + size_m * corner).to_vec();
        TetMesh::with_one_region(nodes_m, vec![[0, 1, 2, 3]])
    }

    #[test]
    fn touching_is_allowed_and_overlapping_is_measured() {
        let a = tet_at(DVec3::ZERO, 1.0);
        assert_eq!(overlap(&a, &tet_at(DVec3::X, 1.0)), None);
        assert_eq!(overlap(&a, &tet_at(DVec3::splat(0.4), 1.0)), None);
        let found = overlap(&a, &tet_at(DVec3::new(0.0, 0.0, 0.9), 1.0)).unwrap();
        assert!((found.depth_m - 0.1 / 3f64.sqrt()).abs() < 1e-12, "{found:?}");
    }

    #[test]
    fn one_body_inside_another_overlaps() {
        let inner = tet_at(DVec3::splat(0.1), 0.05);
        assert!(overlap(&tet_at(DVec3::ZERO, 1.0), &inner).is_some());
    }

    #[test]
    fn crossing_edges_are_found() {
        let nodes = |points: [[f64; 3]; 4]| {
            TetMesh::with_one_region(points.map(DVec3::from).to_vec(), vec![[0, 1, 2, 3]])
        };
        let lower = nodes([[-1.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.2, -1.0], [0.0, -0.2, -1.0]]);
        let upper =
            |z: f64| nodes([[0.0, -1.0, z], [0.0, 1.0, z], [0.2, 0.0, z + 1.0], [-0.2, 0.0, z + 1.0]]);
        assert_eq!(overlap(&lower, &upper(1e-9)), None);
        let found = overlap(&lower, &upper(-0.01)).unwrap();
        assert!((found.depth_m - 0.01).abs() < 1e-12, "{found:?}");
    }
}
