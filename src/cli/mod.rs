//! The command line: one file per subcommand.
//!
//! Results go to stdout, everything said along the way to stderr. A subcommand returns a
//! `Failure` and never exits itself; [`main`] alone turns it into a message
//! and an exit status.

mod args;
mod check;
mod console;
mod criteria;
mod failure;
mod interrupt;
mod limits;
mod looking;
mod output_folder;
mod picture_output;
mod render;
mod report_pictures;
mod run;
mod scene_source;
mod scenes;
mod shot;
mod stepping;
mod verify;
mod view;

use args::{CommonArgs, NoArgs, WithCommon};
use clap::{CommandFactory as _, Parser, Subcommand};
use console::Console;
use failure::Failure;
use std::ffi::OsString;
use std::panic::AssertUnwindSafe;
use std::process::ExitCode;

const ABOUT: &str = "Deformable solids collide and break: in a window, and as pictures and data";

const CLOSING_HELP: &str = "\
Examples:
  hammerfall                                    open the gallery of scenes
  hammerfall view hammer-table                  open one scene
  hammerfall render hammer-table -o fall.gif    make a picture or an animation
  hammerfall run hammer-table -o data --vtu     make data: history.csv, summary.json, ParaView files
  hammerfall check my_scene.toml                is it sound, and what would it cost?
  hammerfall criteria -o criteria.png           draw failure criteria
  hammerfall verify --quick                     how far is each answer from the truth?

SCENE is the name of a built-in scene (see `hammerfall scenes`) or the path of a scene file.
Times are in seconds; 10ms and 250us are understood too.

Exit status: 0 done; 1 the run failed (what was written so far stays readable); 2 bad usage or bad
input; 130 stopped by Ctrl-C (what was finished is kept; a second Ctrl-C stops at once).";

#[derive(Debug, Parser)]
#[command(name = "hammerfall", version, about = ABOUT, after_help = CLOSING_HELP)]
#[command(disable_help_subcommand = true)]
struct Cli {
    #[command(subcommand)]
    command: Option<Command>,
    #[command(flatten)]
    common: CommonArgs,
}

#[derive(Debug, Subcommand)]
enum Command {
    /// Open the viewer, on its gallery or on a scene
    View(WithCommon<view::ViewArgs>),
    /// Make a PNG, a GIF or a folder of numbered PNGs, without a window
    Render(WithCommon<render::RenderArgs>),
    /// Run a scene without pictures and write its data
    Run(WithCommon<run::RunArgs>),
    /// List the built-in scenes
    Scenes(WithCommon<NoArgs>),
    /// Say whether a scene or a mesh file is sound, and what it would cost
    Check(WithCommon<check::CheckArgs>),
    /// Draw the failure surfaces of a scene's materials, of the standard criteria or of a formula
    Criteria(WithCommon<criteria::CriteriaArgs>),
    /// Compare with known answers: value, reference, error, bound, and whether it falls short
    Verify(WithCommon<verify::VerifyArgs>),
}

impl Command {
    fn common(&self) -> &CommonArgs {
        match self {
            Self::View(with) => &with.common,
            Self::Render(with) => &with.common,
            Self::Run(with) => &with.common,
            Self::Scenes(with) => &with.common,
            Self::Check(with) => &with.common,
            Self::Criteria(with) => &with.common,
            Self::Verify(with) => &with.common,
        }
    }
}

impl Cli {
    /// The common options, wherever they stand on the command line.
    fn all_common(&self) -> CommonArgs {
        let before = self.common.clone();
        match &self.command {
            Some(command) => before.followed_by(command.common()),
            None => before,
        }
    }
}

/// Parses the arguments, runs the subcommand and returns the exit status.
#[must_use]
pub fn main() -> ExitCode {
    failure::install_panic_hook();
    let arguments: Vec<OsString> = std::env::args_os().collect();
    let cli = match Cli::try_parse_from(&arguments) {
        Ok(cli) => cli,
        Err(error) => return failure::report_usage(error, &Cli::command(), &arguments),
    };
    // The hook has told about a panic; here it only gets its exit status.
    match std::panic::catch_unwind(AssertUnwindSafe(|| run_command(&cli))) {
        Ok(Ok(())) => ExitCode::SUCCESS,
        Ok(Err(failure)) => failure.report(),
        Err(_) => ExitCode::from(failure::STATUS_RUN_FAILED),
    }
}

fn run_command(cli: &Cli) -> Result<(), Failure> {
    let common = cli.all_common();
    common.start_threads()?;
    let console = Console::new(common.quiet);
    match &cli.command {
        None => view::run(&view::ViewArgs::default(), &common),
        Some(Command::View(with)) => view::run(&with.args, &common),
        Some(Command::Render(with)) => render::run(&with.args, &common, &console),
        Some(Command::Run(with)) => on_worker(|| run::run(&with.args, &common, &console)),
        Some(Command::Scenes(_)) => scenes::run(&console),
        Some(Command::Check(with)) => check::run(&with.args, &common, &console),
        Some(Command::Criteria(with)) => criteria::run(&with.args, &common, &console),
        Some(Command::Verify(with)) => verify::run(&with.args, &common, &console),
    }
}

/// Runs work of many short parallel parts on one of the threads that share them, so that no part has to be handed over to
/// another thread first. The work must not wait for a thread of the pool but through the pool: there may be only this one.
fn on_worker<T: Send>(work: impl FnOnce() -> T + Send) -> T {
    rayon::scope(|_| work())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_definition_of_the_command_line_is_sound() {
        Cli::command().debug_assert();
    }

    #[test]
    fn overrides_count_wherever_they_stand() {
        let line = ["hammerfall", "--set", "a=1", "run", "x", "-o", "d", "--set", "b=2", "--set=c=3"];
        let cli = Cli::try_parse_from(line).unwrap();
        assert_eq!(cli.all_common().overrides, ["a=1", "b=2", "c=3"]);
    }
}
