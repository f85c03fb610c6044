//! Shapes of bodies: read from a `shape` or `mesh` table, and turned into tetrahedra.
//!
//! A new size of a shape is one line in that shape's reading function; a new shape is one such function
//! and its word in [`Kind`].

use super::quantity::Quantity;
use super::reader::Table;
use crate::mesh::shapes::{self, HexSplit, Meshing, Resolution};
use glam::DVec3;

const METRES: Quantity = Quantity::positive("m");

/// Where a body's tetrahedra come from.
#[derive(Clone, Debug, PartialEq)]
pub enum Shape {
    /// A built-in shape.
    BuiltIn {
        /// The shape and its sizes.
        shape: shapes::Shape,
        /// How fine.
        meshing: Meshing,
    },
    /// A mesh file.
    File(MeshFile),
}

/// A mesh file and how it is taken.
#[derive(Clone, Debug, PartialEq)]
pub struct MeshFile {
    /// Path; a relative one starts at the scene's folder.
    pub file: String,
    /// Metres per unit of the file.
    pub scale: f64,
    /// Whether flat and inverted elements are left out rather than refused.
    pub drop_bad_elements: bool,
    /// Whether the file's own origin, rather than the middle of the mesh, goes to the body's position.
    pub keep_origin: bool,
}

/// Words for `type`.
#[derive(Clone, Copy)]
enum Kind {
    Box,
    Rod,
    Plate,
    Pile,
    Beam,
    Table,
    Ball,
    Cup,
    Lamp,
    Hammer,
}

const KINDS: [(&str, Kind); 10] = [
    ("box", Kind::Box),
    ("rod", Kind::Rod),
    ("plate", Kind::Plate),
    ("pile", Kind::Pile),
    ("beam", Kind::Beam),
    ("table", Kind::Table),
    ("ball", Kind::Ball),
    ("cup", Kind::Cup),
    ("lamp", Kind::Lamp),
    ("hammer", Kind::Hammer),
];

impl Shape {
    /// Reads `shape` or `mesh` of a body.
    pub(super) fn read(body: &mut Table) -> Self {
        let file = body.table("mesh").map(read_mesh_file);
        let shape = body.table("shape").and_then(read_built_in);
        body.refuse_rivals("shape");
        if !body.has("mesh") {
            body.require("shape", "a built-in shape, or `mesh` for a mesh file");
        }
        file.or(shape).unwrap_or(Self::BuiltIn {
            shape: shapes::Shape::Box(shapes::BoxShape::default()),
            meshing: Meshing::default(),
        })
    }
}

fn read_mesh_file(mut table: Table) -> Shape {
    Shape::File(MeshFile {
        file: table.required_text("file"),
        scale: table.number("scale", Quantity::positive("m per unit of the file")).unwrap_or(1.0),
        drop_bad_elements: table.flag("drop_bad_elements").unwrap_or(false),
        keep_origin: table.flag("keep_origin").unwrap_or(false),
    })
}

fn read_built_in(mut table: Table) -> Option<Shape> {
    table.require("type", "the shape's name, as in `type = \"box\"`");
    let Some(kind) = table.choice("type", &KINDS) else {
        table.forgive_the_rest();
        return None;
    };
    let shape = match kind {
        Kind::Box => shapes::Shape::Box(read_box(&mut table)),
        Kind::Rod => shapes::Shape::Rod(read_rod(&mut table)),
        Kind::Plate => shapes::Shape::Plate(read_plate(&mut table)),
        Kind::Pile => shapes::Shape::Pile(read_pile(&mut table)),
        Kind::Beam => shapes::Shape::Beam(read_beam(&mut table)),
        Kind::Table => shapes::Shape::Table(read_table(&mut table)),
        Kind::Ball => shapes::Shape::Ball(read_ball(&mut table)),
        Kind::Cup => shapes::Shape::Cup(read_cup(&mut table)),
        Kind::Lamp => shapes::Shape::Lamp(read_lamp(&mut table)),
        Kind::Hammer => shapes::Shape::Hammer(read_hammer(&mut table)),
    };
    Some(Shape::BuiltIn {
        shape,
        meshing: read_meshing(&mut table, matches!(kind, Kind::Box | Kind::Rod | Kind::Plate | Kind::Pile)),
    })
}

fn read_meshing(table: &mut Table, has_cells: bool) -> Meshing {
    let refinement = table.integer("refinement", 1, 1000).map(Resolution::Refinement);
    let element_size = table.number("element_size", METRES).map(Resolution::ElementSize);
    let cells = if has_cells { table.integers("cells", 1, 100_000).map(Resolution::Cells) } else { None };
    table.refuse_rivals("cells");
    let splits = [("six", HexSplit::Six), ("five", HexSplit::Five)];
    Meshing {
        resolution: cells.or(element_size).or(refinement).unwrap_or_default(),
        split: table.choice("split", &splits).unwrap_or_default(),
    }
}

fn size(table: &mut Table, key: &'static str, value_m: &mut f64) {
    *value_m = table.number(key, METRES).unwrap_or(*value_m);
}

fn read_box(table: &mut Table) -> shapes::BoxShape {
    let size = table.numbers("size", 3, 3, METRES);
    size.map_or_else(shapes::BoxShape::default, |size| shapes::BoxShape { size_m: DVec3::from_slice(&size) })
}

fn read_rod(table: &mut Table) -> shapes::Rod {
    let mut rod = shapes::Rod::default();
    size(table, "length", &mut rod.length_m);
    size(table, "width", &mut rod.width_m);
    size(table, "height", &mut rod.height_m);
    rod
}

fn read_plate(table: &mut Table) -> shapes::Plate {
    let mut plate = shapes::Plate::default();
    size(table, "length", &mut plate.length_m);
    size(table, "width", &mut plate.width_m);
    size(table, "thickness", &mut plate.thickness_m);
    plate
}

fn read_pile(table: &mut Table) -> shapes::Pile {
    let mut pile = shapes::Pile::default();
    size(table, "width", &mut pile.width_m);
    size(table, "depth", &mut pile.depth_m);
    size(table, "height", &mut pile.height_m);
    pile
}

fn read_beam(table: &mut Table) -> shapes::Beam {
    let mut beam = shapes::Beam::default();
    size(table, "length", &mut beam.length_m);
    size(table, "width", &mut beam.width_m);
    size(table, "height", &mut beam.height_m);
    size(table, "notch_width", &mut beam.notch_width_m);
    size(table, "notch_depth", &mut beam.notch_depth_m);
    let radius_m = table.number("notch_radius", Quantity::not_negative("m"));
    beam.notch_radius_m = radius_m.unwrap_or(beam.notch_radius_m);
    let sides = [("top", shapes::NotchSide::Top), ("bottom", shapes::NotchSide::Bottom)];
    beam.notch_side = table.choice("notch_side", &sides).unwrap_or(beam.notch_side);
    beam
}

fn read_table(table: &mut Table) -> shapes::Table {
    let mut shape = shapes::Table::default();
    size(table, "length", &mut shape.length_m);
    size(table, "width", &mut shape.width_m);
    size(table, "height", &mut shape.height_m);
    size(table, "top_thickness", &mut shape.top_thickness_m);
    size(table, "leg_width", &mut shape.leg_width_m);
    shape
}

fn read_ball(table: &mut Table) -> shapes::Ball {
    let mut ball = shapes::Ball::default();
    size(table, "radius", &mut ball.radius_m);
    ball
}

fn read_cup(table: &mut Table) -> shapes::Cup {
    let mut cup = shapes::Cup::default();
    size(table, "radius", &mut cup.radius_m);
    size(table, "height", &mut cup.height_m);
    size(table, "wall", &mut cup.wall_m);
    cup
}

fn read_lamp(table: &mut Table) -> shapes::Lamp {
    let mut lamp = shapes::Lamp::default();
    size(table, "height", &mut lamp.height_m);
    size(table, "foot_radius", &mut lamp.foot_radius_m);
    size(table, "stem_radius", &mut lamp.stem_radius_m);
    size(table, "shade_radius", &mut lamp.shade_radius_m);
    size(table, "shade_height", &mut lamp.shade_height_m);
    lamp
}

fn read_hammer(table: &mut Table) -> shapes::Hammer {
    let mut hammer = shapes::Hammer::default();
    size(table, "head_length", &mut hammer.head_length_m);
    size(table, "head_width", &mut hammer.head_width_m);
    size(table, "handle_length", &mut hammer.handle_length_m);
    size(table, "handle_width", &mut hammer.handle_width_m);
    hammer
}
