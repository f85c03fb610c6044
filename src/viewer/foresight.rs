//! What a throw under way would bring in, before it is let go: the very body, built by the same words, and where it
//! would have to start.

use crate::frame::{BodyFrame, Frame};
use crate::mesh::{Surface, TetMesh};
use crate::sim::raise_clear;
use glam::{DVec3, Vec3};

/// A body that would be thrown in.
#[derive(Clone, Debug, PartialEq)]
pub struct Foreseen {
    /// Number of the drag that it was built for.
    pub number: u64,
    /// Where its middle was asked to be, m.
    position_m: DVec3,
    /// Its nodes there, m.
    nodes_m: Vec<DVec3>,
    /// Its skin.
    surface: Surface,
}

/// The body at the place where it would start.
#[derive(Clone, Debug)]
pub struct Ghost<'a> {
    /// Its nodes, m.
    pub nodes_m: Vec<Vec3>,
    /// Its skin.
    pub surface: &'a Surface,
    /// How much higher than asked for it starts, clear of what is there, m.
    pub lift_m: f32,
}

impl Foreseen {
    /// Of a mesh with its middle at a place.
    #[must_use]
    pub fn new(number: u64, position_m: DVec3, mesh: &TetMesh) -> Self {
        Self { number, position_m, nodes_m: mesh.nodes_m.clone(), surface: Surface::of(&mesh.tets) }
    }

    /// Where it would start among what a frame shows, if its middle were asked to be at a place.
    #[must_use]
    pub fn at(&self, position_m: Vec3, frame: &Frame) -> Ghost<'_> {
        let way_m = position_m.as_dvec3() - self.position_m;
        let mut nodes_m: Vec<DVec3> = self.nodes_m.iter().map(|x| x + way_m).collect();
        let asked_m = nodes_m.first().map_or(0.0, |x| x.z);
        raise_clear(&mut nodes_m, &boxes_m(frame));
        let lift_m = nodes_m.first().map_or(0.0, |x| x.z - asked_m) as f32;
        Ghost { nodes_m: nodes_m.iter().map(|x| x.as_vec3()).collect(), surface: &self.surface, lift_m }
    }
}

/// The boxes around the bodies that are seen, m.
fn boxes_m(frame: &Frame) -> Vec<(DVec3, DVec3)> {
    let exact = |corner_m: [f32; 3]| Vec3::from(corner_m).as_dvec3();
    let bounds = frame.bodies.iter().filter_map(BodyFrame::bounds_m);
    bounds.map(|(low, high)| (exact(low), exact(high))).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn foreseen() -> Foreseen {
        let nodes_m = vec![DVec3::ZERO, DVec3::X, DVec3::Y, DVec3::Z];
        let mesh = TetMesh { nodes_m, tets: vec![[0, 1, 2, 3]], ..TetMesh::default() };
        Foreseen::new(1, DVec3::splat(0.25), &mesh)
    }

    #[test]
    fn it_starts_where_it_is_asked_for_or_above_what_is_there() {
        let table = vec![[-1.0, -1.0, -0.5], [1.0, 1.0, 0.75]];
        let frame = Frame {
            bodies: vec![BodyFrame { positions_m: table, ..Default::default() }],
            ..Default::default()
        };
        let foreseen = foreseen();
        let free = foreseen.at(Vec3::new(0.25, 0.25, 2.25), &frame);
        assert_eq!((free.lift_m, free.nodes_m[3]), (0.0, Vec3::new(0.0, 0.0, 3.0)));
        let moved = foreseen.at(Vec3::splat(0.25), &frame);
        assert!((moved.lift_m - 0.8).abs() < 1e-6 && moved.nodes_m[0].z == moved.lift_m, "{moved:?}");
        assert_eq!(moved.surface.triangles.len(), 4);
    }
}
