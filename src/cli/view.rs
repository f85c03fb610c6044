//! `hammerfall` and `hammerfall view`: the window.

use super::args::CommonArgs;
use super::failure::Failure;
use clap::Args;

/// Arguments of `view`.
#[derive(Debug, Default, Args)]
pub struct ViewArgs {
    /// Built-in scene or scene file; the gallery by default
    pub scene: Option<String>,
}

/// Opens the viewer.
///
/// # Errors
/// [`Failure`] when the scene or the window cannot be opened.
pub fn run(_args: &ViewArgs, _common: &CommonArgs) -> Result<(), Failure> {
    // The one place to call `crate::viewer::run` from.
    Err(Failure::Run(
        "the viewer is not built in yet; `hammerfall render SCENE -o out.gif` makes a picture".to_owned(),
    ))
}
