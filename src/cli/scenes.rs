//! `hammerfall scenes`: the built-in scenes, a line each.

use super::console::Console;
use super::failure::Failure;
use super::scene_source;

/// Lists the scenes.
///
/// # Errors
/// [`Failure`] when stdout cannot be written.
pub fn run(console: &Console) -> Result<(), Failure> {
    let scenes = scene_source::built_in();
    let width = scenes.iter().map(|(name, _)| name.len()).max().unwrap_or(0);
    scenes
        .iter()
        .try_for_each(|(name, title)| console.result(format_args!("{name:width$}  {title}")))
}
