//! The `[[bodies]]` entries.

use super::super::description::{Body, BodyMaterial, Boundary, Copies, Placement, Selection, Side};
use super::super::quantity::Quantity;
use super::super::reader::{Kind, Table};
use super::super::shape::Shape;
use super::{check_name, read_color};
use crate::sim::{BodyMotion, BoundaryAction, Kinematics, PrescribedMotion};
use glam::{DQuat, DVec3, EulerRot};

pub(super) fn read_body(mut table: Table) -> Body {
    let name = table.required_text("name");
    if table.has("name") {
        check_name(&table, &name);
    }
    let motion = read_motion(&mut table);
    let mass_scaling = Quantity::not_negative("share of the mass").up_to(1.0);
    let boundary = table.tables("boundary");
    let body = Body {
        name,
        shape: Shape::read(&mut table),
        material: read_body_material(&mut table),
        color_srgb: read_color(&mut table, "color"),
        placement: read_placement(&mut table),
        copies: read_copies(&mut table),
        velocity_m_s: table.vector("velocity", "m/s").unwrap_or_default(),
        spin_rad_s: table.vector("spin", "rad/s").unwrap_or_default(),
        boundary: boundary.into_iter().map(read_boundary).collect(),
        enters_s: table.number("enters", Quantity::not_negative("s")),
        mass_scaling_max_share: table.number("mass_scaling", mass_scaling).unwrap_or(0.0),
        motion,
    };
    check_motion_fits(&table, &body.motion);
    body
}

fn read_motion(table: &mut Table) -> BodyMotion {
    const OPTIONS: [(&str, u8); 3] = [("deformable", 0), ("fixed", 1), ("kinematic", 2)];
    let kinematics = table.choice("kinematics", &Kinematics::NAMED);
    let motion = table.choice("motion", &OPTIONS).unwrap_or(0);
    let prescribed = table.table("prescribed").map(read_prescribed);
    match motion {
        1 => BodyMotion::Fixed,
        2 => {
            table.require("prescribed", "the motion, as in `prescribed = { velocity = [0, 0, -1] }`");
            BodyMotion::Kinematic(prescribed.unwrap_or(PrescribedMotion {
                velocity_m_s: DVec3::ZERO,
                spin_rad_s: DVec3::ZERO,
                start_s: 0.0,
                stop_s: f64::INFINITY,
            }))
        }
        _ => BodyMotion::Deformable(kinematics.unwrap_or_default()),
    }
}

fn read_prescribed(mut table: Table) -> PrescribedMotion {
    let seconds = Quantity::not_negative("s");
    let start_s = table.number("start", seconds).unwrap_or(0.0);
    let stop_s = table.number("stop", seconds).unwrap_or(f64::INFINITY);
    if stop_s <= start_s {
        let message = format!("`{}` must come after `start`", table.name_of("stop"));
        table.problem("stop", message);
    }
    PrescribedMotion {
        velocity_m_s: table.vector("velocity", "m/s").unwrap_or_default(),
        spin_rad_s: table.vector("spin", "rad/s").unwrap_or_default(),
        start_s,
        stop_s,
    }
}

/// Keys that would be silently without effect for this motion.
fn check_motion_fits(table: &Table, motion: &BodyMotion) {
    let (word, idle): (&str, &[&str]) = match motion {
        BodyMotion::Deformable(_) => ("deformable", &["prescribed"]),
        BodyMotion::Fixed => {
            ("fixed", &["velocity", "spin", "boundary", "kinematics", "prescribed", "mass_scaling"])
        }
        BodyMotion::Kinematic(_) => {
            ("kinematic", &["velocity", "spin", "boundary", "kinematics", "mass_scaling"])
        }
    };
    for key in idle.iter().filter(|key| table.has(key)) {
        let message = format!(
            "`{}` has no effect, because the body's `motion` is \"{word}\"; leave it out",
            table.name_of(key)
        );
        table.problem(key, message);
    }
}

fn read_body_material(table: &mut Table) -> BodyMaterial {
    table.require("material", "a material's name, or one for each region");
    match table.kind_of("material") {
        Some(Kind::Table) => {
            let mut regions = table.table("material");
            let pairs = regions.as_mut().map(Table::named_texts).unwrap_or_default();
            BodyMaterial::ByRegion(pairs)
        }
        Some(Kind::Text) => BodyMaterial::One(table.text("material").unwrap_or_default()),
        _ => {
            let expected = "a material's name, or a table such as { head = \"steel\" }";
            table.report_type("material", expected);
            BodyMaterial::One(String::new())
        }
    }
}

fn read_placement(table: &mut Table) -> Placement {
    let on = table.text("on");
    let low = if on.is_some() { 2 } else { 3 };
    let numbers = table.numbers("position", low, 3, Quantity::any("m"));
    let numbers = numbers.unwrap_or_else(|| vec![0.0; low]);
    if on.is_some() && numbers.len() == 3 {
        let message = format!(
            "`{}` has a height, but `on` decides it; give [x, y], and a `gap` to hang above",
            table.name_of("position")
        );
        table.problem("position", message);
    }
    let gap = table.number("gap", Quantity::not_negative("m"));
    if gap.is_some() && !table.has("on") {
        let message = format!(
            "`{}` is the free height above what the body stands `on`; say `on = \"ground\"` or \
             the name of a body",
            table.name_of("gap")
        );
        table.problem("gap", message);
    }
    Placement {
        position_m: DVec3::new(numbers[0], numbers[1], numbers.get(2).copied().unwrap_or(0.0)),
        rotation: read_rotation(table),
        on,
        gap_m: gap.unwrap_or(0.0),
        axes_of: table.text("axes_of"),
    }
}

/// `[x, y, z]`: degrees about the fixed axes, one after the other; or an axis and an angle.
fn read_rotation(table: &mut Table) -> DQuat {
    match table.kind_of("rotation") {
        None => DQuat::IDENTITY,
        Some(Kind::Table) => table.table("rotation").map_or(DQuat::IDENTITY, read_axis_angle),
        Some(Kind::List) => {
            let degrees = table.vector("rotation", "degrees").unwrap_or_default();
            let [x, y, z] = degrees.to_array().map(f64::to_radians);
            DQuat::from_euler(EulerRot::ZYX, z, y, x)
        }
        Some(_) => {
            let expected = "[x, y, z] in degrees, or { axis = [0, 0, 1], degrees = 30 }";
            table.report_type("rotation", expected);
            DQuat::IDENTITY
        }
    }
}

fn read_axis_angle(mut table: Table) -> DQuat {
    table.require("axis", "a direction, as in `axis = [0, 0, 1]`");
    let axis = table.vector("axis", "").unwrap_or(DVec3::Z);
    let degrees = table.required_number("degrees", Quantity::any("degrees"));
    let Some(axis) = axis.try_normalize() else {
        let message = format!("`{}` must not be zero", table.name_of("axis"));
        table.problem("axis", message);
        return DQuat::IDENTITY;
    };
    DQuat::from_axis_angle(axis, degrees.to_radians())
}

fn read_copies(table: &mut Table) -> Copies {
    let mut copies = Copies { count: 1, offset_m: DVec3::ZERO, rotation: DQuat::IDENTITY };
    if let Some(mut table) = table.table("copies") {
        table.require("count", "how many bodies in all");
        copies.count = table.integer("count", 1, 10_000).unwrap_or(1);
        table.require("offset", "the step from one to the next, as in `offset = [0, 0, 0.1]`");
        copies.offset_m = table.vector("offset", "m").unwrap_or_default();
        copies.rotation = read_rotation(&mut table);
    }
    copies
}

fn read_boundary(mut table: Table) -> Boundary {
    table.require("at", "which nodes, as in `at = \"bottom\"`");
    let axes = read_axes(&mut table);
    let ramp_s = table.number("ramp", Quantity::not_negative("s"));
    let fixed = table.flag("fixed");
    let velocity = table.vector("velocity", "m/s");
    let force = table.vector("force", "N");
    let actions = ["fixed", "velocity", "force"].iter().filter(|key| table.has(key));
    if actions.count() != 1 || fixed == Some(false) {
        let message = format!(
            "`{}` must say one of `fixed = true`, `velocity = [x, y, z]` (m/s) or \
             `force = [x, y, z]` (N)",
            table.path()
        );
        table.problem("", message);
    }
    if table.has("ramp") && !table.has("force") {
        let message = format!("`{}` goes with a `force` only", table.name_of("ramp"));
        table.problem("ramp", message);
    }
    let action = match (velocity, force) {
        (Some(velocity_m_s), _) => BoundaryAction::Velocity { velocity_m_s, axes },
        (_, Some(total_n)) => BoundaryAction::Force { total_n, ramp_s: ramp_s.unwrap_or(0.0) },
        _ => BoundaryAction::Fixed { axes },
    };
    Boundary { at: read_selection(&mut table), action }
}

/// Letters of the axes that an action holds: `"xz"`.
fn read_axes(table: &mut Table) -> [bool; 3] {
    let Some(letters) = table.text("axes") else {
        return [true; 3];
    };
    let axes = ['x', 'y', 'z'].map(|axis| letters.contains(axis));
    if letters.is_empty() || !letters.chars().all(|letter| "xyz".contains(letter)) {
        table.report_type("axes", "some of the letters x, y and z, as in \"xy\"");
    }
    axes
}

/// Sides by name. Left, right, front and back are the shape's own, as the x and y ends are.
const SIDES: [(&str, Side); 12] = [
    ("bottom", Side::Bottom),
    ("top", Side::Top),
    ("x-min", Side::Own { axis: 0, largest: false }),
    ("x-max", Side::Own { axis: 0, largest: true }),
    ("y-min", Side::Own { axis: 1, largest: false }),
    ("y-max", Side::Own { axis: 1, largest: true }),
    ("z-min", Side::Own { axis: 2, largest: false }),
    ("z-max", Side::Own { axis: 2, largest: true }),
    ("left", Side::Own { axis: 0, largest: false }),
    ("right", Side::Own { axis: 0, largest: true }),
    ("front", Side::Own { axis: 1, largest: false }),
    ("back", Side::Own { axis: 1, largest: true }),
];

fn read_selection(table: &mut Table) -> Selection {
    match table.kind_of("at") {
        None => Selection::All,
        Some(Kind::Text) => {
            let all = [("all", None)];
            let sides = SIDES.map(|(name, side)| (name, Some(side)));
            let options: Vec<_> = all.into_iter().chain(sides).collect();
            match table.choice("at", &options).flatten() {
                Some(side) => Selection::Side { side, depth_m: 0.0 },
                None => Selection::All,
            }
        }
        Some(Kind::Table) => table.table("at").map_or(Selection::All, read_place),
        Some(_) => {
            table.report_type("at", "a side such as \"bottom\", or a table");
            Selection::All
        }
    }
}

fn read_place(mut table: Table) -> Selection {
    let region = table.text("region").map(Selection::Region);
    let side = table.choice("side", &SIDES);
    let depth_m = table.number("depth", Quantity::not_negative("m")).unwrap_or(0.0);
    let side = side.map(|side| Selection::Side { side, depth_m });
    let within_box = table.table("box").map(read_box);
    let sphere = table.table("sphere").map(read_sphere);
    let kinds = ["region", "side", "box", "sphere"];
    if kinds.iter().filter(|key| table.has(key)).count() != 1 {
        let message = format!("`{}` must have one of `region`, `side`, `box` and `sphere`", table.path());
        table.problem("", message);
    }
    region.or(side).or(within_box).or(sphere).unwrap_or(Selection::All)
}

fn read_box(mut table: Table) -> Selection {
    for key in ["min", "max"] {
        table.require(key, "a corner, as in `min = [0, 0, 0]` (m, in the world)");
    }
    let min_m = table.vector("min", "m").unwrap_or_default();
    let max_m = table.vector("max", "m").unwrap_or(min_m);
    if max_m.cmplt(min_m).any() {
        let message = format!("`{}` must not be below `min`", table.name_of("max"));
        table.problem("max", message);
    }
    Selection::Box { min_m, max_m }
}

fn read_sphere(mut table: Table) -> Selection {
    table.require("center", "a point, as in `center = [0, 0, 0]` (m, in the world)");
    Selection::Sphere {
        center_m: table.vector("center", "m").unwrap_or_default(),
        radius_m: table.required_number("radius", Quantity::positive("m")),
    }
}
