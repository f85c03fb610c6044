//! `hammerfall check`: is a scene or a mesh sound, and what would it cost?

use super::args::CommonArgs;
use super::console::Console;
use super::failure::Failure;
use super::scene_source::{is_built_in, warn};
use crate::fem::{ElasticConstants, ElementBatches};
use crate::mesh::import::{ImportError, ImportOptions, ImportedMesh, Problem, read_mesh};
use crate::mesh::{MeshReport, TetMesh};
use crate::scene::{PRESETS, Scene, SceneSummary};
use crate::sim::{World, WorldSetup};
use clap::Args;
use std::path::Path;
use std::time::Instant;

/// Arguments of `check`.
#[derive(Debug, Args)]
pub struct CheckArgs {
    /// Built-in scene, scene file (.toml), or mesh file (Gmsh .msh, legacy .vtk, MEDIT .mesh)
    pub file: String,
}

/// How long a trial goes on, s of wall time, unless the scene ends before.
const TRIAL_S: f64 = 0.4;
/// Materials that a mesh's stable step is told for: about the stiffest and the softest.
const EXAMPLE_MATERIALS: [&str; 2] = ["steel", "rubber"];

/// Checks the file and says what it found.
///
/// # Errors
/// [`Failure::BadInput`] with everything that is wrong.
pub fn run(args: &CheckArgs, common: &CommonArgs, console: &Console) -> Result<(), Failure> {
    if is_mesh(&args.file) {
        check_mesh(&args.file, common, console)
    } else {
        check_scene(&args.file, common, console)
    }
}

/// Files with an ending other than `.toml` are meshes, read or not; the reader says which it reads.
fn is_mesh(file: &str) -> bool {
    let path = Path::new(file);
    let Some(extension) = path.extension() else {
        return false;
    };
    !is_built_in(file) && !extension.eq_ignore_ascii_case("toml") && !path.is_dir()
}

fn check_scene(file: &str, common: &CommonArgs, console: &Console) -> Result<(), Failure> {
    let scene = Scene::load(file, &common.overrides).map_err(|error| Failure::BadInput(error.to_string()))?;
    warn(&scene, console);
    let world = World::new(scene.setup.clone())?;
    let summary = SceneSummary::of(&scene, &world)?;
    console.result(summary.to_string().trim_end())?;
    if let Some(cost) = trial(&scene.setup, summary.duration_s) {
        let threads = match rayon::current_num_threads() {
            1 => "one thread".to_owned(),
            count => format!("{count} threads"),
        };
        console.result(format_args!(
            "  at the pace of its first {} steps, with everything deforming, that takes {} here and now on {threads}",
            cost.steps,
            rough_time(cost.total_s),
        ))?;
        if let Some(words) = breaking_words(&scene, cost.total_s) {
            console.result(words)?;
        }
        console.result(
            "  (less while bodies move freely or rest; more where contacts are many or large strain shortens \
             the step)",
        )?;
    }
    console.result(format_args!("`{file}` is sound"))
}

/// How many times the cost of whole bodies the built-in scenes take at most once they break: `mug-drop`
/// takes some 50, `glass-shot` 17.
const MOST_FOR_BREAKING: f64 = 50.0;

/// What can break, and what that may come to; `None` when nothing can.
fn breaking_words(scene: &Scene, total_s: f64) -> Option<String> {
    let bodies = scene.setup.bodies.iter().filter(|body| body.can_break());
    let breaking: Vec<&str> = bodies
        .flat_map(|body| &body.materials)
        .filter(|material| material.fracture.is_some())
        .map(|material| material.name.as_str())
        .collect();
    let materials = scene.description.materials.iter();
    let materials = materials.filter(|material| breaking.contains(&material.name.as_str()));
    let names: Vec<String> = materials.map(|material| format!("`{}`", material.name)).collect();
    (!names.is_empty()).then(|| {
        format!(
            "  without breaking, but {} can: with its cracks and pieces a built-in scene takes 1 to {MOST_FOR_BREAKING} times \
             as long, which here may come to {}",
            names.join(", "),
            rough_time(MOST_FOR_BREAKING * total_s.max(0.5))
        )
    })
}

/// What a trial found.
struct TrialCost {
    /// Steps that were timed.
    steps: u64,
    /// Wall time of the whole scene at their pace, s.
    total_s: f64,
}

/// Times the beginning of the scene with every body deforming, touching what it stands on; `None` when nothing
/// deforms, or when that run blows up.
fn trial(setup: &WorldSetup, duration_s: f64) -> Option<TrialCost> {
    let mut setup = setup.clone();
    setup.time.free_travel = false;
    setup.time.sleeping = false;
    let mut world = World::new(setup).ok()?;
    if !world.is_deforming() {
        return None;
    }
    // The first step looks for everything that is near, which few others do.
    world.step(duration_s).ok()?;
    let (started, start_s) = (Instant::now(), world.time_s());
    while started.elapsed().as_secs_f64() < TRIAL_S && world.time_s() < duration_s {
        world.step(duration_s).ok()?;
    }
    let total_s = started.elapsed().as_secs_f64() / (world.time_s() - start_s) * duration_s;
    total_s.is_finite().then_some(TrialCost { steps: world.steps() - 1, total_s })
}

fn rough_time(seconds: f64) -> String {
    match seconds {
        s if s < 1.5 => "about a second".to_owned(),
        s if s < 120.0 => format!("about {s:.0} s"),
        s if s < 7200.0 => format!("about {:.0} min", s / 60.0),
        s => format!("about {:.0} h", s / 3600.0),
    }
}

fn check_mesh(file: &str, common: &CommonArgs, console: &Console) -> Result<(), Failure> {
    if let Some(first) = common.overrides.first() {
        return Err(Failure::BadInput(format!(
            "`{file}` is a mesh, so there is nothing for `--set {first}` to override; --set is for scenes"
        )));
    }
    let ImportedMesh { mesh, notes, format, .. } =
        read_mesh(Path::new(file), &ImportOptions::default()).map_err(|error| refused(file, &error))?;
    let report = MeshReport::of(&mesh);
    console.result(format_args!("format              {format}"))?;
    console.result(&report)?;
    for name in EXAMPLE_MATERIALS {
        if let Some(step_s) = stable_step_s(&mesh, name) {
            let steps_a_second = 1.0 / step_s;
            console.result(format_args!(
                "stable step         {step_s:.2e} s if it were of {name}: {steps_a_second:.1e} steps a second"
            ))?;
        }
    }
    console.result("(lengths as if the file's unit were the metre; `scale` in a scene changes that)")?;
    notes.iter().try_for_each(|note| console.result(format_args!("note: {note}")))?;
    if report.is_sound() {
        console.result(format_args!("`{file}` is sound"))
    } else {
        Err(Failure::BadInput(format!("`{file}` cannot be simulated as it is; see above")))
    }
}

/// A file that no reader of meshes knows was perhaps meant as a scene.
fn refused(file: &str, error: &ImportError) -> Failure {
    Failure::BadInput(match &error.problem {
        problem @ Problem::UnknownFormat { .. } => {
            format!("`{file}` is not a scene file (scene files end in .toml), and not a mesh file: {problem}")
        }
        _ => error.to_string(),
    })
}

/// Stable step of a body of this mesh and a material of the library, s; `None` for a mesh that makes no body.
fn stable_step_s(mesh: &TetMesh, material: &str) -> Option<f64> {
    let preset = PRESETS.iter().find(|preset| preset.name == material)?;
    let constants =
        ElasticConstants::new(preset.youngs_modulus_pa, preset.poisson_ratio, preset.density_kg_m3).ok()?;
    let elements = ElementBatches::new(&mesh.nodes_m, &mesh.tets, &vec![constants; mesh.tets.len()]).ok()?;
    Some(elements.stable_step_s(&elements.lumped_masses_kg(None))).filter(|step_s| step_s.is_finite())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn built_in_names_and_toml_files_are_scenes() {
        assert!(!is_mesh("hammer-table") && !is_mesh("a/b.toml") && !is_mesh("B.TOML"));
        assert!(is_mesh("a.msh") && is_mesh("a.stl"));
    }
}
