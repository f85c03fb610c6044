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

/// Lowest quality a shape may reach, and the refinement from which that holds: the coarsest
/// lamp and table are a few long, thin cells on purpose.
const WORST_QUALITY: [(&str, u32, f64); 10] = [
    ("box", 1, 0.27),
    ("rod", 1, 0.27),
    ("plate", 1, 0.27),
    ("pile", 1, 0.26),
    ("beam", 1, 0.13),
    ("table", 2, 0.06),
    ("ball", 1, 0.1),
    ("cup", 1, 0.08),
    ("lamp", 2, 0.025),
    ("hammer", 1, 0.04),
];

#[test]
fn every_shape_is_one_closed_sound_piece_of_good_elements() {
    for ((name, shape), (_, from, bound)) in all_shapes().into_iter().zip(WORST_QUALITY) {
        for refinement in [1, 2, 3, 4, 6] {
            for split in [HexSplit::Six, HexSplit::Five] {
                let report = MeshReport::of(&build(&shape, refinement, split));
                let what = format!("{name} refinement {refinement} {split:?}\n{report}");
                assert!(report.is_sound(), "{what}");
                assert_eq!(report.parts, 1, "{what}");
                assert_eq!(report.non_manifold_edges, 0, "{what}");
                assert!(report.regions.iter().all(|r| r.1 > 0), "{what}");
                let worst = report.worst_quality.expect("elements").value;
                assert!(refinement < from || worst > bound, "{what}");
            }
        }
    }
}

#[test]
fn odd_proportions_are_sound_too() {
    let shapes = [
        Shape::Hammer(Hammer {
            head_length_m: 0.2,
            head_width_m: 0.1,
            handle_length_m: 0.9,
            handle_width_m: 0.02,
        }),
        Shape::Hammer(Hammer {
            head_length_m: 1.0,
            head_width_m: 0.5,
            handle_length_m: 0.6,
            handle_width_m: 0.37,
        }),
        Shape::Cup(Cup { radius_m: 0.1, height_m: 0.05, wall_m: 0.01 }),
        Shape::Cup(Cup { radius_m: 0.02, height_m: 0.3, wall_m: 0.009 }),
        Shape::Lamp(Lamp {
            height_m: 2.0,
            foot_radius_m: 0.1,
            stem_radius_m: 0.08,
            shade_radius_m: 0.6,
            shade_height_m: 0.2,
        }),
        Shape::Table(Table {
            length_m: 0.3,
            width_m: 2.0,
            height_m: 0.4,
            top_thickness_m: 0.3,
            leg_width_m: 0.14,
        }),
    ];
    for shape in shapes {
        for refinement in 1..=4 {
            let report = MeshReport::of(&build(&shape, refinement, HexSplit::Six));
            assert!(report.is_sound(), "{shape:?} {refinement}\n{report}");
            assert_eq!((report.parts, report.non_manifold_edges), (1, 0), "{shape:?}");
        }
    }
}

#[test]
fn flat_sided_volumes_are_exact() {
    let (table, beam) = (Table::default(), Beam::default());
    let end = Table::LEG_TAPER;
    let leg_m = table.height_m - table.top_thickness_m;
    let leg_m3 = table.leg_width_m.powi(2) * leg_m * (1.0 + end + end * end) / 3.0;
    let cases = [
        (Shape::Box(BoxShape::default()), 1e-3),
        (Shape::Rod(Rod::default()), 0.254 * 0.0254 * 0.0254),
        (Shape::Plate(Plate::default()), 0.1),
        (Shape::Pile(Pile::default()), 0.16),
        (Shape::Beam(beam), 1.0 * 0.2 * 0.3 - 0.1 * 0.2 * 0.15),
        (Shape::Table(table), table.length_m * table.width_m * table.top_thickness_m + 4.0 * leg_m3),
    ];
    for (shape, expected_m3) in cases {
        for refinement in [1, 3] {
            let volume_m3 = build(&shape, refinement, HexSplit::Six).volume_m3();
            assert!((volume_m3 / expected_m3 - 1.0).abs() < 1e-12, "{shape:?}");
        }
    }
}

#[test]
fn round_volumes_converge_with_the_square_of_the_element_size() {
    let expected_m3 = std::f64::consts::PI * 4.0 / 3.0 * Ball::default().radius_m.powi(3);
    let error = |refinement| {
        let ball = build(&Shape::Ball(Ball::default()), refinement, HexSplit::Six);
        1.0 - ball.volume_m3() / expected_m3
    };
    let (coarse, fine) = (error(3), error(6));
    assert!(fine < 0.03 && (3.5..4.5).contains(&(coarse / fine)), "{coarse} {fine}");
}

#[test]
fn the_bowl_of_a_cup_has_the_volume_of_its_profile() {
    let cup = Cup::default();
    let mesh = build(&Shape::Cup(cup), 6, HexSplit::Six);
    let outer_m = |z_m: f64| {
        let down = 1.0 - z_m / cup.height_m;
        cup.radius_m * (1.0 - 0.24 * down * down)
    };
    let steps = 1000;
    let expected_m3: f64 = (0..steps)
        .map(|step| {
            let dz_m = cup.height_m / f64::from(steps);
            let z_m = dz_m * (f64::from(step) + 0.5);
            let solid_bottom = z_m < 1.4 * cup.wall_m;
            let inner_m = if solid_bottom { 0.0 } else { outer_m(z_m) - cup.wall_m };
            std::f64::consts::PI * (outer_m(z_m).powi(2) - inner_m.powi(2)) * dz_m
        })
        .sum();
    let bowl_m3 = region_volume_m3(&mesh, 0);
    assert!((bowl_m3 / expected_m3 - 1.0).abs() < 0.015, "{bowl_m3} {expected_m3}");
}

fn region_volume_m3(mesh: &TetMesh, region: u32) -> f64 {
    (0..mesh.tets.len())
        .filter(|&tet| mesh.regions[tet] == region)
        .map(|tet| ElementShape::of(&mesh.corners_m(tet)).volume_m3)
        .sum()
}

#[test]
fn shapes_stand_where_they_are_said_to() {
    let bounds = |shape| build(&shape, 2, HexSplit::Six).bounds_m().expect("nodes");
    for shape in [
        Shape::Table(Table::default()),
        Shape::Lamp(Lamp::default()),
        Shape::Pile(Pile::default()),
        Shape::Cup(Cup::default()),
    ] {
        assert_eq!(bounds(shape).0.z, 0.0, "{shape:?}");
    }
    let (low, high) = bounds(Shape::Plate(Plate::default()));
    assert!((low + high).length() < 1e-15);
    let (low, high) = bounds(Shape::Hammer(Hammer::default()));
    assert!(low.x < -0.2 && high.x < 0.12, "the tail lies at -x: {low} {high}");
    assert!((high.z - low.z - 0.13).abs() < 1e-12);
}

#[test]
fn a_hammer_balances_on_its_origin() {
    let mesh = build(&Shape::Hammer(Hammer::default()), 2, HexSplit::Six);
    let moment_m4: DVec3 = (0..mesh.tets.len())
        .map(|tet| {
            let corners_m = mesh.corners_m(tet);
            ElementShape::of(&corners_m).volume_m3 * corners_m.iter().sum::<DVec3>()
        })
        .sum();
    assert!(moment_m4.length() < 1e-15);
}

/// The counts of the published experiments, where hexahedra were cut in five.
#[test]
fn published_sizes_are_reached() {
    let counts = |shape: &Shape, resolution| {
        let split = HexSplit::Five;
        let mesh = shape.build(&Meshing { resolution, split }).expect("sound");
        (mesh.nodes_m.len(), mesh.tets.len())
    };
    let coarse = Resolution::Refinement(1);
    assert_eq!(counts(&Shape::Beam(Beam::default()), coarse), (24, 25));
    let pile = Resolution::Cells([2, 2, 3]);
    assert_eq!(counts(&Shape::Pile(Pile::default()), pile), (36, 60));
    let plate = Resolution::Cells([4, 4, 1]);
    assert_eq!(counts(&Shape::Plate(Plate::default()), plate), (50, 80));
    assert_eq!(counts(&Shape::Box(BoxShape::default()), coarse), (8, 5));
    assert_eq!(counts(&Shape::Hammer(Hammer::default()), coarse), (52, 70));
    assert_eq!(counts(&Shape::Cup(Cup::default()), coarse), (326, 900));
}

#[test]
fn impossible_arguments_are_named() {
    let message = |shape: Shape, resolution| {
        let meshing = Meshing { resolution, ..Meshing::default() };
        shape.build(&meshing).expect_err("refused").to_string()
    };
    let coarse = Resolution::Refinement(1);
    let ball = |radius_m| Shape::Ball(Ball { radius_m });
    assert_eq!(
        message(ball(-1.0), coarse),
        "ball: `radius_m` is -1, but it must be a length in metres from 1e-9 to 1e9"
    );
    assert!(message(ball(f64::NAN), coarse).contains("`radius_m` is NaN"));
    let text = message(ball(1.0), Resolution::Refinement(0));
    assert!(text.contains("`refinement` is 0"), "{text}");
    let text = message(ball(1.0), Resolution::Cells([1, 1, 1]));
    assert!(text.contains("box, rod, plate and pile"), "{text}");
    let text = message(Shape::Rod(Rod::default()), Resolution::Cells([10, 0, 1]));
    assert!(text.contains("`cells[1]` is 0"), "{text}");
    let thick = Cup { wall_m: 0.03, ..Cup::default() };
    let text = message(Shape::Cup(thick), coarse);
    assert!(text.contains("`wall_m`") && text.contains("`radius_m`"), "{text}");
}

#[test]
fn far_too_fine_is_refused_at_once() {
    for (name, shape) in all_shapes() {
        for resolution in
            [Resolution::ElementSize(1e-9), Resolution::ElementSize(1e-4), Resolution::Refinement(u32::MAX)]
        {
            let meshing = Meshing { resolution, ..Meshing::default() };
            if matches!((name, resolution), ("rod" | "hammer", Resolution::ElementSize(1e-4))) {
                continue;
            }
            let error = shape.build(&meshing).expect_err("refused");
            assert!(matches!(error, ShapeError::TooManyElements { .. }), "{name} {resolution:?}: {error}");
        }
    }
}
