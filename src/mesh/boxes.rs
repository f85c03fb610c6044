//! Bounding boxes and the hierarchy over them.

use super::TetMesh;
use glam::DVec3;
use parry3d_f64::bounding_volume::Aabb;
use parry3d_f64::partitioning::{Bvh, BvhBuildStrategy};

/// Box around points, of which there must be at least one.
pub fn of_points(points: &[DVec3]) -> Aabb {
    let (low, high) = points.iter().fold((points[0], points[0]), |(low, high), &x| (low.min(x), high.max(x)));
    Aabb::new(low, high)
}

/// Box around a mesh; `None` without nodes.
pub fn of_mesh(mesh: &TetMesh) -> Option<Aabb> {
    mesh.bounds_m().map(|(low, high)| Aabb::new(low, high))
}

/// The hierarchy over boxes; `None` without any.
pub fn tree(boxes: &[Aabb]) -> Option<Bvh> {
    (!boxes.is_empty()).then(|| Bvh::from_leaves(BvhBuildStrategy::Binned, boxes))
}
