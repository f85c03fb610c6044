//! `hammerfall check`: is a scene or a mesh sound, and what would it cost?

use super::args::CommonArgs;
use super::console::Console;
use super::failure::Failure;
use crate::sim::World;
use clap::Args;
use std::path::Path;

/// Arguments of `check`.
#[derive(Debug, Args)]
pub struct CheckArgs {
    /// Built-in scene, scene file (.toml) or mesh file (.msh, .vtk, .mesh)
    pub file: String,
}

/// Computing time of one elastic step of one element on one core, s; a round guess.
const ELEMENT_STEP_S: f64 = 50e-9;

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

fn is_mesh(file: &str) -> bool {
    let extension = Path::new(file).extension().unwrap_or_default();
    ["msh", "vtk", "mesh", "vtu"].iter().any(|known| extension.eq_ignore_ascii_case(known))
}

fn check_scene(file: &str, common: &CommonArgs, console: &Console) -> Result<(), Failure> {
    let scene = crate::scene::Scene::load(file, &common.overrides)
        .map_err(|error| Failure::BadInput(error.to_string()))?;
    World::new(scene.setup.clone())?;
    let summary = &scene.summary;
    console.result(summary.to_string().trim_end())?;
    let cost_s = ELEMENT_STEP_S * summary.elements() as f64 * summary.steps_at_most();
    if cost_s.is_finite() {
        let cost = rough_time(cost_s);
        console.result(format_args!("  that is at most {cost} of computing on one core"))?;
    }
    console.result(format_args!("`{file}` is sound"))
}

fn check_mesh(file: &str, _common: &CommonArgs, _console: &Console) -> Result<(), Failure> {
    Err(Failure::Run(format!("checking meshes such as `{file}` is not built in yet")))
}

fn rough_time(seconds: f64) -> String {
    match seconds {
        s if s < 1.0 => "a second".to_owned(),
        s if s < 120.0 => format!("about {s:.0} s"),
        s if s < 7200.0 => format!("about {:.0} min", s / 60.0),
        s => format!("about {:.0} h", s / 3600.0),
    }
}
