//! From the tree of a scene's text to its description, with every problem on the way collected.

mod bodies;
mod cross_checks;
mod fracture;
mod late;
mod settings;

pub(super) use fracture::{CRITERION_PREFIX, parse_criterion};

use super::description::{GROUND, Ground, SceneDescription};
use super::findings::Findings;
use super::presets::{self, PRESETS};
use super::quantity::Quantity;
use super::reader::Table;
use super::tree::Node;
use crate::sim::Material;
use glam::DVec3;

/// Reads the parts of a scene one by one. The description is only meaningful when nothing was found.
pub(super) fn read_scene(root: &Node, findings: &Findings) -> SceneDescription {
    let mut table = Table::root(root, findings);
    let title = table.required_text("title");
    let description = table.text("description").unwrap_or_default();
    let gravity = table.vector("gravity", "m/s2");
    let materials = read_materials(&mut table);
    let ground = table.table("ground").map(read_ground);
    table.require("bodies", "the scene needs at least one `[[bodies]]`");
    let bodies: Vec<_> = table.tables("bodies").into_iter().map(bodies::read_body).collect();
    if table.has("bodies") && bodies.is_empty() {
        table.problem("bodies", "the scene needs at least one `[[bodies]]`".to_owned());
    }
    let contact = settings::read_contact(table.table_or_empty("contact"));
    let (duration_s, time) = settings::read_time(table.table_or_empty("time"));
    let fracture = fracture::read_fracture(table.table_or_empty("fracture"));
    let cameras = table.named_tables("cameras");
    SceneDescription {
        title,
        description,
        gravity_m_s2: gravity.unwrap_or(DVec3::new(0.0, 0.0, -9.81)),
        materials,
        ground,
        bodies,
        contact,
        duration_s,
        time,
        fracture,
        cameras: cameras.into_iter().map(settings::read_camera).collect(),
        recording: settings::read_recording(table.table_or_empty("recording"), duration_s),
        removals: table.tables("removals").into_iter().map(late::read_removal).collect(),
        contact_changes: table.tables("contact_changes").into_iter().map(late::read_contact_change).collect(),
        pulls: table.tables("pulls").into_iter().map(late::read_pull).collect(),
    }
}

/// Checks what the parts say about each other and adds what they take from the library.
pub(super) fn check_whole(scene: &mut SceneDescription, root: &Node, findings: &Findings) {
    cross_checks::check(scene, root, findings);
    add_library_materials(scene);
}

fn read_materials(table: &mut Table) -> Vec<Material> {
    let tables = table.named_tables("materials");
    tables.into_iter().map(|(name, table)| read_material(name, table)).collect()
}

/// A material starts from the library's entry that `preset` names, or that has its own name.
fn read_material(name: String, mut table: Table) -> Material {
    check_name(&table, &name);
    let options: Vec<_> = PRESETS.iter().map(|preset| (preset.name, preset)).collect();
    let preset = table.choice("preset", &options);
    let preset = preset.or_else(|| presets::find(&name));
    if preset.is_none() && !table.has("preset") {
        let hint = "a number, or `preset` for a material of the library";
        for key in ["density", "youngs_modulus", "poisson_ratio"] {
            table.require(key, hint);
        }
    }
    let density = table.number("density", Quantity::positive("kg/m3"));
    let youngs_modulus = table.number("youngs_modulus", Quantity::positive("Pa"));
    let poisson_ratio = table.number("poisson_ratio", Quantity::strictly_between(-1.0, 0.5, ""));
    let damping = table.number("damping", Quantity::not_negative("1/s"));
    let stiffness_damping = table.number("stiffness_damping", Quantity::not_negative("s"));
    let color = read_color(&mut table, "color");
    let fracture = fracture::read_criterion(&mut table);
    let base = preset.copied().unwrap_or(PRESETS[0]);
    Material {
        name,
        density_kg_m3: density.unwrap_or(base.density_kg_m3),
        youngs_modulus_pa: youngs_modulus.unwrap_or(base.youngs_modulus_pa),
        poisson_ratio: poisson_ratio.unwrap_or(base.poisson_ratio),
        damping_per_s: damping.unwrap_or(preset.map_or(0.0, |base| base.damping_per_s)),
        stiffness_damping_s: stiffness_damping.unwrap_or(0.0),
        color_srgb: color.unwrap_or(base.color_srgb),
        fracture,
    }
}

/// Adds the materials of the library that bodies name without a `[materials]` entry.
fn add_library_materials(scene: &mut SceneDescription) {
    let ground = scene.ground.iter().map(|ground| ground.material.clone());
    let bodies = scene.bodies.iter().flat_map(|body| body.material.names());
    let used: Vec<String> = bodies.map(str::to_owned).chain(ground).collect();
    for name in used {
        let known = scene.materials.iter().any(|material| material.name == name);
        if !known && let Some(preset) = presets::find(&name) {
            scene.materials.push(Material {
                name,
                density_kg_m3: preset.density_kg_m3,
                youngs_modulus_pa: preset.youngs_modulus_pa,
                poisson_ratio: preset.poisson_ratio,
                damping_per_s: preset.damping_per_s,
                stiffness_damping_s: 0.0,
                color_srgb: preset.color_srgb,
                fracture: None,
            });
        }
    }
}

fn read_ground(mut table: Table) -> Ground {
    let size_m = table.number("size", Quantity::positive("m")).unwrap_or(10.0);
    let thickness = table.number("thickness", Quantity::positive("m"));
    let center = table.numbers("center", 2, 2, Quantity::any("m"));
    Ground {
        height_m: table.number("height", Quantity::any("m")).unwrap_or(0.0),
        center_m: center.map_or([0.0; 2], |xy| [xy[0], xy[1]]),
        size_m,
        thickness_m: thickness.unwrap_or(0.05 * size_m),
        material: table.text("material").unwrap_or_else(|| "concrete".to_owned()),
        friction_coefficient: read_friction(&mut table),
        color_srgb: read_color(&mut table, "color"),
    }
}

/// Friction as a coefficient (`friction`) or as an angle in degrees (`friction_angle`).
fn read_friction(table: &mut Table) -> Option<f64> {
    let coefficient = table.number("friction", Quantity::not_negative("coefficient"));
    let right_angle = Quantity::not_negative("degrees").up_to(89.0);
    let angle = table.number("friction_angle", right_angle);
    table.refuse_rivals("friction");
    coefficient.or(angle.map(|degrees| degrees.to_radians().tan()))
}

/// A colour: `"#rrggbb"` or three numbers from 0 to 1.
fn read_color(table: &mut Table, key: &'static str) -> Option<[f32; 3]> {
    use super::reader::Kind;
    match table.kind_of(key)? {
        Kind::Text => {
            let text = table.text(key)?;
            let color = parse_hex_color(&text);
            if color.is_none() {
                table.report_type(key, "a colour such as \"#c04030\" or [0.75, 0.25, 0.2]");
            }
            color
        }
        _ => {
            let numbers = table.numbers(key, 3, 3, Quantity::not_negative("").up_to(1.0))?;
            Some([numbers[0] as f32, numbers[1] as f32, numbers[2] as f32])
        }
    }
}

fn parse_hex_color(text: &str) -> Option<[f32; 3]> {
    let digits = text.strip_prefix('#')?;
    if digits.len() != 6 || !digits.bytes().all(|byte| byte.is_ascii_hexdigit()) {
        return None;
    }
    let number = u32::from_str_radix(digits, 16).ok()?;
    let [_, red, green, blue] = number.to_be_bytes();
    Some([red, green, blue].map(|part| f32::from(part) / 255.0))
}

/// Names are used in paths, columns and file names: letters, digits, `-` and `_`.
fn check_name(table: &Table, name: &str) {
    let sound = name.chars().all(|c| c.is_alphanumeric() || c == '-' || c == '_');
    if name.is_empty() || !sound || name.parse::<usize>().is_ok() {
        let message =
            format!("\"{name}\" is no name: use letters, digits, `-` and `_`, and not digits alone");
        table.problem("name", message);
    }
}

/// Names that stand for a body: the bodies' own and the ground's.
fn is_ground(name: &str) -> bool {
    name == GROUND
}

#[cfg(test)]
mod tests {
    use super::super::document::SceneDocument;
    use super::super::{BUILTIN_SCENES, PRESETS};
    use super::*;

    const REFERENCE: &str = include_str!("../../assets/scene-reference.md");

    /// Uses a table of every kind, so that every key is asked for.
    const EVERYTHING: &str = r#"
        title = "t"
        materials.m = { preset = "steel", fracture.any_of = [
            { criterion = "tensile", tensile_strength = 1 }, { criterion = "tresca", shear_strength = 1 },
            { criterion = "mohr-coulomb", cohesion = 1, friction_angle = 1 },
            { criterion = "formula", formula = "s1 - a", parameters = { a = 1 } } ] }
        ground = {}
        contact.pairs = [{ bodies = ["a", "ground"], friction = 1 }]
        time.duration = 1
        cameras.c = {}
        removals = [{ body = "a", at = 1 }]
        contact_changes = [{ at = 1 }]
        pulls = [{ body = "b", at = [0, 0, 0], path = [{ time = 0, point = [0, 0, 0] }], until = 1 }]
        bodies = [
            { name = "a", material = "m", mesh.file = "f", rotation = { axis = [0, 0, 1], degrees = 1 },
              motion = "kinematic", prescribed = {},
              copies = { count = 1, offset = [0, 0, 0], rotation = { axis = [0, 0, 1], degrees = 1 } } },
            { name = "b", material = "m", shape.type = "box", boundary = [
                { at.box = { min = [0, 0, 0], max = [1, 1, 1] }, fixed = true },
                { at.sphere = { center = [0, 0, 0], radius = 1 }, force = [0, 0, 1] } ] },
        ]"#;

    fn keys_of(text: &str) -> Vec<&'static str> {
        let document = SceneDocument::parse("test", text).unwrap();
        let findings = Findings::default();
        read_scene(document.root(), &findings);
        let keys = findings.asked().into_iter().map(|(_, key)| key).collect();
        let problems = findings.into_problems();
        assert!(problems.is_empty(), "{problems:?}");
        keys
    }

    #[test]
    fn the_reference_names_every_key() {
        let mut keys = keys_of(EVERYTHING);
        for builtin in BUILTIN_SCENES {
            keys.extend(keys_of(builtin.text));
        }
        for shape in ["rod", "plate", "pile", "beam", "ball", "table", "cup", "lamp", "hammer"] {
            keys.extend(keys_of(&EVERYTHING.replace(r#"= "box""#, &format!("= {shape:?}"))));
        }
        let words: Vec<&str> = REFERENCE.split(|c: char| !c.is_ascii_alphanumeric() && c != '_').collect();
        for key in keys {
            assert!(words.contains(&key), "the scene reference lacks `{key}`");
        }
    }

    #[test]
    fn the_reference_lists_the_library() {
        for preset in PRESETS {
            let row = format!("| `{}` | {} | ", preset.name, preset.density_kg_m3);
            let rest = REFERENCE.split_once(&row).map(|(_, rest)| rest);
            let mut cells = rest.unwrap_or_else(|| panic!("no row {row}")).split(" | ");
            let modulus: f64 = cells.next().unwrap().parse().unwrap();
            assert_eq!(modulus, preset.youngs_modulus_pa, "{}", preset.name);
        }
    }

    #[test]
    fn the_example_of_the_reference_is_a_scene() {
        let example = REFERENCE.split("```toml").nth(1).unwrap();
        keys_of(example.split("```").next().unwrap());
    }
}
