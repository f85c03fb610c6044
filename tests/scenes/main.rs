//! Scenes as users meet them: the shipped ones build, wrong ones are refused with the place and the
//! reason, overrides reach every value, and nothing that can be typed makes the program panic.

#[path = "../../fuzz/entries.rs"]
#[expect(dead_code, reason = "the other entries have their tests elsewhere")]
mod entries;
#[path = "../fuzzing/mod.rs"]
mod fuzzing;
mod nonsense;
mod overrides;
mod refused;
mod shipped;

use hammerfall::fracture::Criterion;
use hammerfall::mesh::overlap;
use hammerfall::scene::{BUILTIN_SCENES, Location, Scene, SceneError, SceneSummary};
use hammerfall::sim::{BodyMotion, BodySetup, BoundaryAction, ContactMethod, Material, World};
use std::io::Write as _;
use std::path::Path;

const STACK: &str = "stack";

/// A small sound scene; the tests add to it and break it.
const CUBE: &str = r#"title = "A cube"

[ground]

[[bodies]]
name = "cube"
shape = { type = "box", size = [1, 1, 1], cells = 2 }
material = "rubber"
on = "ground"

[time]
duration = 1
"#;

fn build(text: &str, overrides: &[&str]) -> Result<Scene, SceneError> {
    let overrides: Vec<String> = overrides.iter().map(|&text| text.to_owned()).collect();
    Scene::from_text("test.toml", text, Path::new("."), &overrides)
}

/// Problems as `line: message` or `--set text: message`.
fn problems(text: &str, overrides: &[&str]) -> Vec<String> {
    let Err(error) = build(text, overrides) else {
        return Vec::new();
    };
    error
        .problems()
        .iter()
        .map(|problem| match &problem.location {
            Location::Line { line, .. } => format!("{line}: {}", problem.message),
            Location::Override(text) => format!("--set {text}: {}", problem.message),
        })
        .collect()
}

/// Every expected problem is found (by its beginning, after `...` anywhere), and no other.
fn assert_problems(text: &str, overrides: &[&str], expected: &[&str]) {
    let found = problems(text, overrides);
    let matches = |found: &str, expected: &str| {
        let mut parts = expected.split("...");
        found.starts_with(parts.next().unwrap_or_default()) && parts.all(|part| found.contains(part))
    };
    let missing: Vec<_> = expected.iter().filter(|e| !found.iter().any(|f| matches(f, e))).collect();
    let extra: Vec<_> = found.iter().filter(|f| !expected.iter().any(|e| matches(f, e))).collect();
    assert!(
        missing.is_empty() && found.len() == expected.len(),
        "missing {missing:#?}\nextra {extra:#?}\nof {found:#?}"
    );
}

fn summary_of(scene: &Scene) -> SceneSummary {
    SceneSummary::of(scene, &World::new(scene.setup.clone()).unwrap()).unwrap()
}
