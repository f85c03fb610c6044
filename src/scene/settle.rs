//! How far a body can be lowered until it stands on another.

use crate::mesh::boxes;
use crate::mesh::{Surface, TetMesh};
use glam::{DVec2, DVec3};
use parry3d_f64::bounding_volume::Aabb;

/// Smallest free height between `upper` and `lower` along z, over every vertical line that meets both,
/// m; negative when `upper` has to be lifted to clear `lower`. `None` when no vertical line meets both.
///
/// Both are taken as seen from far above: what lies under an overhang of `lower` does not count.
#[must_use]
pub fn free_height_m(upper: &TetMesh, lower: &TetMesh) -> Option<f64> {
    let down_facing = facing(upper, -1.0);
    let up_facing = facing(lower, 1.0);
    let flat_boxes: Vec<Aabb> = up_facing.iter().map(flat_box).collect();
    let tree = boxes::tree(&flat_boxes)?;
    down_facing
        .iter()
        .flat_map(|triangle| {
            let bounds = flat_box(triangle);
            let near: Vec<u32> = tree.intersect_aabb(&bounds).collect();
            near.into_iter().map(move |index| (triangle, index))
        })
        .filter_map(|(triangle, index)| pair_height_m(triangle, &up_facing[index as usize]))
        .min_by(f64::total_cmp)
}

/// Surface triangles whose normal has the given sign along z. Upright ones are left out: their rims
/// belong to the others, too.
fn facing(mesh: &TetMesh, sign: f64) -> Vec<[DVec3; 3]> {
    let surface = Surface::of(&mesh.tets);
    surface
        .triangles
        .iter()
        .map(|triangle| triangle.map(|node| mesh.nodes_m[node as usize]))
        .filter(|corners| {
            let normal = normal_of(corners);
            sign * normal.z > 1e-9 * normal.length()
        })
        .collect()
}

fn normal_of([a, b, c]: &[DVec3; 3]) -> DVec3 {
    (b - a).cross(c - a)
}

fn flat_box(corners: &[DVec3; 3]) -> Aabb {
    boxes::of_points(&corners.map(|corner| corner.with_z(0.0)))
}

/// Smallest height of one triangle over another where their shadows overlap.
fn pair_height_m(upper: &[DVec3; 3], lower: &[DVec3; 3]) -> Option<f64> {
    let common = clip(&upper.map(DVec3::truncate), &lower.map(DVec3::truncate));
    // Shadows that only share a rim do not stand on each other.
    let smaller = area(&upper.map(DVec3::truncate)).min(area(&lower.map(DVec3::truncate)));
    if area(&common) <= 1e-9 * smaller {
        return None;
    }
    common.iter().map(|&at| height_at(upper, at) - height_at(lower, at)).min_by(f64::total_cmp)
}

/// The part of one triangle's shadow inside the other's (Sutherland and Hodgman 1974).
fn clip(subject: &[DVec2; 3], window: &[DVec2; 3]) -> Vec<DVec2> {
    let turn = (window[1] - window[0]).perp_dot(window[2] - window[0]).signum();
    let mut polygon = subject.to_vec();
    for side in 0..3 {
        let (from, to) = (window[side], window[(side + 1) % 3]);
        let inside = |at: DVec2| turn * (to - from).perp_dot(at - from);
        polygon = clip_by(&polygon, inside);
    }
    polygon
}

fn clip_by(polygon: &[DVec2], inside: impl Fn(DVec2) -> f64) -> Vec<DVec2> {
    let mut kept = Vec::with_capacity(polygon.len() + 1);
    for (index, &at) in polygon.iter().enumerate() {
        let next = polygon[(index + 1) % polygon.len()];
        let (here, there) = (inside(at), inside(next));
        if here >= 0.0 {
            kept.push(at);
        }
        if here * there < 0.0 {
            kept.push(at.lerp(next, here / (here - there)));
        }
    }
    kept
}

fn area(polygon: &[DVec2]) -> f64 {
    let Some(&origin) = polygon.first() else {
        return 0.0;
    };
    let fan = polygon.windows(2).map(|pair| (pair[0] - origin).perp_dot(pair[1] - origin));
    fan.sum::<f64>().abs() / 2.0
}

/// Height of a triangle's plane, which is not upright, above a point.
fn height_at(corners: &[DVec3; 3], at: DVec2) -> f64 {
    let normal = normal_of(corners);
    let along = at - corners[0].truncate();
    corners[0].z - normal.truncate().dot(along) / normal.z
}

#[cfg(test)]
mod tests {
    use super::*;

    fn tet(points: [[f64; 3]; 4]) -> TetMesh {
        TetMesh::with_one_region(points.map(DVec3::from).to_vec(), vec![[0, 1, 2, 3]])
    }

    fn lying(z: f64) -> TetMesh {
        tet([[0.0, 0.0, z], [2.0, 0.0, z], [0.0, 2.0, z], [0.5, 0.5, z + 1.0]])
    }

    #[test]
    fn a_tip_over_a_slope_is_measured_where_they_meet_first() {
        let hanging = tet([[0.6, 0.5, 3.0], [0.4, 0.7, 5.0], [0.4, 0.3, 5.0], [1.4, 0.5, 5.0]]);
        let slope = 1.0 - 0.1 / 1.0;
        let found = free_height_m(&hanging, &lying(0.0)).unwrap();
        assert!((found - (3.0 - slope)).abs() < 1e-9, "{found}");
    }

    #[test]
    fn a_body_beside_another_does_not_stand_on_it() {
        let beside = tet([[2.0, 0.0, 3.0], [4.0, 0.0, 3.0], [2.0, 2.0, 3.0], [2.5, 0.5, 4.0]]);
        assert_eq!(free_height_m(&beside, &lying(0.0)), None);
        assert!((free_height_m(&lying(3.0), &lying(0.5)).unwrap() - 1.5).abs() < 1e-12);
    }
}
