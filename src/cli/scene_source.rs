//! Loading scenes for the subcommands.

use super::console::Console;
use super::failure::Failure;
use crate::scene::{BUILTIN_SCENES, Scene};

/// Loads a built-in scene or a scene file with the overrides, and passes on what looks like a slip in it and what
/// reading its meshes had to say.
///
/// # Errors
/// [`Failure::BadInput`] with everything that is wrong with it.
pub fn load(name_or_path: &str, overrides: &[String], console: &Console) -> Result<Scene, Failure> {
    let scene = Scene::load(name_or_path, overrides).map_err(|error| Failure::BadInput(error.to_string()))?;
    warn(&scene, console);
    for (body, note) in &scene.notes {
        console.note(format_args!("note on `{body}`: {note}"));
    }
    Ok(scene)
}

/// Says what looks like a slip in the scene.
pub fn warn(scene: &Scene, console: &Console) {
    for warning in &scene.warnings {
        console.note(format_args!("warning: {warning}"));
    }
}

/// Whether a built-in scene has this name.
pub fn is_built_in(name: &str) -> bool {
    BUILTIN_SCENES.iter().any(|scene| scene.name == name)
}
