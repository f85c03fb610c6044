//! `hammerfall check`: is a scene or a mesh sound, and what would it cost?

use super::args::CommonArgs;
use super::console::Console;
use super::failure::Failure;
use clap::Args;

/// Arguments of `check`.
#[derive(Debug, Args)]
pub struct CheckArgs {
    /// Built-in scene, scene file or mesh file
    pub file: String,
}

pub fn run(_args: &CheckArgs, _common: &CommonArgs, _console: &Console) -> Result<(), Failure> {
    Ok(())
}
