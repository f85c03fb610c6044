//! `hammerfall check`: is a scene or a mesh sound, and what would it cost?

use super::args::CommonArgs;
use super::console::Console;
use super::failure::Failure;
use super::scene_source::is_built_in;
use crate::mesh::MeshReport;
use crate::mesh::import::{ImportOptions, ImportedMesh, read_mesh};
use crate::scene::{PRESETS, Preset, Scene};
use crate::sim::World;
use clap::Args;
use std::path::Path;

/// Arguments of `check`.
#[derive(Debug, Args)]
pub struct CheckArgs {
    /// Built-in scene, scene file (.toml), or mesh file (Gmsh .msh, legacy .vtk, MEDIT .mesh)
    pub file: String,
}

/// Computing time of one elastic step of one element on one core, s; a round guess.
const ELEMENT_STEP_S: f64 = 50e-9;
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
    World::new(scene.setup.clone())?;
    let summary = &scene.summary;
    console.result(summary.to_string().trim_end())?;
    let cost_s = ELEMENT_STEP_S * summary.elements() as f64 * summary.steps_at_most();
    if cost_s.is_finite() {
        let cost = rough_time(cost_s);
        console.result(format_args!("  that is roughly {cost} of computing on one core at most"))?;
    }
    console.result(format_args!("`{file}` is sound"))
}

fn rough_time(seconds: f64) -> String {
    match seconds {
        s if s < 1.0 => "a second".to_owned(),
        s if s < 120.0 => format!("{s:.0} s"),
        s if s < 7200.0 => format!("{:.0} min", s / 60.0),
        s => format!("{:.0} h", s / 3600.0),
    }
}

fn check_mesh(file: &str, common: &CommonArgs, console: &Console) -> Result<(), Failure> {
    if let Some(first) = common.overrides.first() {
        return Err(Failure::BadInput(format!(
            "`{file}` is a mesh, so there is nothing for `--set {first}` to override; --set is for scenes"
        )));
    }
    let ImportedMesh { mesh, notes, format, .. } = read_mesh(Path::new(file), &ImportOptions::default())
        .map_err(|error| Failure::BadInput(error.to_string()))?;
    let report = MeshReport::of(&mesh);
    console.result(format_args!("format              {format}"))?;
    console.result(&report)?;
    for name in EXAMPLE_MATERIALS {
        if let Some(step_s) = stable_step_s(&report, name) {
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

/// Smallest altitude over the speed of pressure waves, s.
fn stable_step_s(report: &MeshReport, material: &str) -> Option<f64> {
    let preset = PRESETS.iter().find(|preset| preset.name == material)?;
    Some(report.smallest_altitude_m?.value / pressure_wave_speed_m_s(preset))
}

/// c_p = sqrt((lambda + 2 mu) / rho).
fn pressure_wave_speed_m_s(material: &Preset) -> f64 {
    let nu = material.poisson_ratio;
    let modulus_pa = material.youngs_modulus_pa * (1.0 - nu) / ((1.0 + nu) * (1.0 - 2.0 * nu));
    (modulus_pa / material.density_kg_m3).sqrt()
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
