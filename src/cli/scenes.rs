//! `hammerfall scenes`: the built-in scenes, a line each.

use super::console::Console;
use super::failure::Failure;
use crate::scene::BUILTIN_SCENES;

/// Lists the scenes.
///
/// # Errors
/// [`Failure`] when stdout cannot be written.
pub fn run(console: &Console) -> Result<(), Failure> {
    let names = BUILTIN_SCENES.iter().map(|scene| scene.name.len());
    let width = names.max().unwrap_or(0);
    BUILTIN_SCENES
        .iter()
        .try_for_each(|scene| console.result(format_args!("{:width$}  {}", scene.name, scene.summary)))
}
