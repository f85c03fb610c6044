//! Where a body that comes in starts: at its place, or above what is there.

use crate::mesh::{TetMesh, bounds_m, overlap};
use glam::DVec3;

/// Free height above the body below, as a share of the newcomer's size.
const GAP_SHARE: f64 = 0.05;

/// Moves a mesh up until it is clear of bodies, given by nodes (m) and elements; not at all where none of them is in its space.
pub(super) fn start_clear(mesh: &mut TetMesh, bodies: &[(&[DVec3], &[[u32; 4]])]) {
    let Some(own) = bounds_m(&mesh.nodes_m) else { return };
    let near =
        bodies.iter().filter(|(nodes_m, _)| bounds_m(nodes_m).is_some_and(|bounds| cut(&own, &bounds)));
    let mut near = near.map(|(nodes_m, tets)| TetMesh {
        nodes_m: nodes_m.to_vec(),
        tets: tets.to_vec(),
        ..TetMesh::default()
    });
    if near.any(|body| overlap(mesh, &body).is_some()) {
        let boxes: Vec<_> = bodies.iter().filter_map(|(nodes_m, _)| bounds_m(nodes_m)).collect();
        raise_clear(&mut mesh.nodes_m, &boxes);
    }
}

/// Moves nodes up until the box around them is clear of all others, each from its lowest to its highest corner, m.
pub fn raise_clear(nodes_m: &mut [DVec3], boxes: &[(DVec3, DVec3)]) {
    // Each round clears one box for good, since the way only leads up.
    for _ in 0..boxes.len() {
        let Some(own) = bounds_m(nodes_m) else { return };
        let Some((_, top)) = boxes.iter().find(|other| cut(&own, other)) else { return };
        let lift_m = top.z - own.0.z + GAP_SHARE * (own.1 - own.0).max_element();
        nodes_m.iter_mut().for_each(|x| x.z += lift_m);
    }
}

fn cut(a: &(DVec3, DVec3), b: &(DVec3, DVec3)) -> bool {
    a.0.cmple(b.1).all() && b.0.cmple(a.1).all()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A body beside a long one that leans over it is in the box around that, but not in its space: it was thrown up over
    /// it once.
    #[test]
    fn a_body_starts_at_its_place_unless_somebody_is_there() {
        let tet = |corners: [[f64; 3]; 4]| {
            TetMesh::with_one_region(corners.map(DVec3::from).to_vec(), vec![[0, 1, 2, 3]])
        };
        let leaning = tet([[0.0, 0.0, 0.0], [0.2, 0.0, 0.0], [0.0, 0.2, 0.0], [4.0, 4.0, 4.0]]);
        let bodies = [(&leaning.nodes_m[..], &leaning.tets[..])];
        let small = |at_m: DVec3| {
            let corners = [DVec3::ZERO, DVec3::X, DVec3::Y, DVec3::Z].map(|x| (at_m + 0.2 * x).to_array());
            tet(corners)
        };
        let mut beside = small(DVec3::new(3.0, 0.5, 0.5));
        let before = beside.nodes_m.clone();
        start_clear(&mut beside, &bodies);
        assert_eq!(beside.nodes_m, before);
        let mut within = small(DVec3::splat(0.02));
        start_clear(&mut within, &bodies);
        assert!((within.nodes_m[0].z - 4.01).abs() < 1e-12, "{:?}", within.nodes_m);
    }
}
