//! What is fed with random bytes: by the fuzz targets beside this file, and by tests over a saved corpus.
//!
//! Each entry takes whatever comes and checks what must hold of it; nothing may panic, hang or take memory without bound.

use hammerfall::fracture::stress::StressMeasures;
use hammerfall::fracture::{Formula, FormulaError};
use hammerfall::mesh::MeshReport;
use hammerfall::mesh::import::{ImportOptions, read_mesh_bytes};
use hammerfall::scene::{Scene, SceneDescription, SceneDocument, SceneError, Shape, parse_criterion};
use hammerfall::sim::World;
use std::path::Path;

/// The mesh readers, all formats. A mesh that is accepted is sound.
pub fn mesh(data: &[u8]) {
    for extension in ["msh", "obj"] {
        for drop_bad_elements in [false, true] {
            let file = Path::new("fuzzed").with_extension(extension);
            match read_mesh_bytes(data, &file, &ImportOptions { drop_bad_elements }) {
                Ok(imported) => {
                    let report = MeshReport::of(&imported.mesh);
                    assert!(report.is_sound(), "{report}");
                    assert!(
                        imported
                            .mesh
                            .regions
                            .iter()
                            .all(|r| (*r as usize) < imported.mesh.region_names.len())
                    );
                }
                Err(error) => assert!(!error.to_string().is_empty()),
            }
        }
    }
}

/// The formula parser, by itself and inside the criterion of a scene. A formula that is accepted can be evaluated or says
/// why not.
pub fn formula(data: &[u8]) {
    let text = String::from_utf8_lossy(data);
    let states_pa = [[0.0; 3], [1e6, 0.0, -1e6], [5e6, 5e6, 5e6], [-1.0, -1e3, -1e9], [1e300, 0.0, -1e300]];
    match Formula::new(&text, &[("Ft", 2e6), ("a", 0.2)]) {
        Ok(formula) => {
            assert!(formula.unstressed_value() < 0.0);
            for state_pa in states_pa {
                let value = formula.evaluate(&StressMeasures::of(state_pa.into()));
                value.map_or_else(|error| check_error(&error), |_| ());
            }
        }
        Err(error) => check_error(&error),
    }
    let quoted = toml::Value::String(text.into_owned());
    let table =
        format!("{{ criterion = \"formula\", formula = {quoted}, parameters = {{ Ft = 2e6, a = 0.2 }} }}");
    if let Err(error) = parse_criterion("fuzzed", &table) {
        assert!(!error.to_string().is_empty());
    }
}

fn check_error(error: &FormulaError) {
    assert!(error.column >= 1 && error.column <= error.text.chars().count() + 1, "{error}");
}

/// A line of the text that begins so is an override, as after `--set`.
const OVERRIDE: &str = "#--set ";

/// The scene parser with overrides; scenes that would be large are read but not built. What is accepted is the same scene
/// after it has been saved.
pub fn scene(data: &[u8]) {
    let text = String::from_utf8_lossy(data);
    let overrides: Vec<String> =
        text.lines().filter_map(|line| line.strip_prefix(OVERRIDE)).map(str::to_owned).collect();
    let description = match Scene::describe("fuzzed", &text, &overrides) {
        Ok(description) => description,
        Err(error) => return check_problems(&error),
    };
    if !is_small(&description) {
        return;
    }
    match Scene::from_text("fuzzed", &text, Path::new("."), &overrides) {
        Ok(scene) => {
            let saved = scene.to_toml();
            SceneDocument::parse("saved", &saved).unwrap_or_else(|error| panic!("{error}\n{saved}"));
            let again = Scene::from_text("saved", &saved, Path::new("."), &[]);
            let again = again.unwrap_or_else(|error| panic!("{error}\n{saved}"));
            assert_eq!(again.description, scene.description);
            // Numbers that no material has may still make no world; that is told, too.
            if let Err(error) = World::new(scene.setup) {
                assert!(!error.to_string().is_empty());
            }
        }
        Err(error) => check_problems(&error),
    }
}

fn check_problems(error: &SceneError) {
    assert!(!error.problems().is_empty() && !error.to_string().is_empty());
}

/// Whether a scene is built in no time. Mesh files would be looked for on the disk.
fn is_small(description: &SceneDescription) -> bool {
    use hammerfall::mesh::shapes::Resolution;
    let is_small = |shape: &Shape| match shape {
        Shape::BuiltIn { meshing, .. } => match meshing.resolution {
            Resolution::Refinement(n) => n <= 2,
            Resolution::Cells(cells) => cells.iter().map(|n| u64::from(*n)).product::<u64>() <= 500,
            Resolution::ElementSize(_) => false,
        },
        Shape::File(_) => false,
    };
    let copies: u64 = description.bodies.iter().map(|body| u64::from(body.copies.count)).sum();
    copies <= 20 && description.bodies.iter().all(|body| is_small(&body.shape))
}
