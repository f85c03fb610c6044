//! What holds for every built-in shape at every resolution.

use super::*;
use crate::mesh::{ElementShape, MeshReport};
use glam::DVec3;

fn all_shapes() -> Vec<(&'static str, Shape)> {
    vec![
        ("box", Shape::Box(BoxShape::default())),
        ("rod", Shape::Rod(Rod::default())),
        ("plate", Shape::Plate(Plate::default())),
        ("pile", Shape::Pile(Pile::default())),
        ("beam", Shape::Beam(Beam::default())),
        ("table", Shape::Table(Table::default())),
        ("ball", Shape::Ball(Ball::default())),
        ("cup", Shape::Cup(Cup::default())),
        ("lamp", Shape::Lamp(Lamp::default())),
        ("hammer", Shape::Hammer(Hammer::default())),
    ]
}

fn build(shape: &Shape, refinement: u32, split: HexSplit) -> TetMesh {
    let resolution = Resolution::Refinement(refinement);
    shape.build(&Meshing { resolution, split }).expect("sound")
}

#[test]
fn every_shape_is_one_closed_sound_piece() {
    for (name, shape) in all_shapes() {
        for refinement in [1, 2, 3, 4, 6] {
            for split in [HexSplit::Six, HexSplit::Five] {
                let report = MeshReport::of(&build(&shape, refinement, split));
                let what = format!("{name} refinement {refinement} {split:?}\n{report}");
                println!("{what}\n");
                assert!(report.is_sound(), "{what}");
                assert_eq!(report.parts, 1, "{what}");
                assert_eq!(report.non_manifold_edges, 0, "{what}");
                assert!(report.regions.iter().all(|r| r.1 > 0), "{what}");
            }
        }
    }
}
