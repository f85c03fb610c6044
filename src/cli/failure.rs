//! What can go wrong, and the one place that tells it.

use super::render::PanelState;
use crate::export::ExportError;
use crate::scene::nearest;
use crate::sim::SimError;
use clap::ValueEnum as _;
use clap::error::{ContextKind, ContextValue, ErrorKind};
use std::ffi::OsString;
use std::io::{self, Write as _};
use std::process::ExitCode;

/// Exit status of a run that failed.
pub const STATUS_RUN_FAILED: u8 = 1;
/// Exit status of bad usage or bad input.
pub const STATUS_BAD_INPUT: u8 = 2;
/// Exit status after Ctrl-C, as shells count it: 128 + SIGINT.
pub const STATUS_INTERRUPTED: u8 = 130;

/// Why a subcommand did not do all it was asked for.
#[derive(Debug)]
pub enum Failure {
    /// What was asked for makes no sense or cannot be read: nothing was run.
    BadInput(String),
    /// It was begun and went wrong.
    Run(String),
    /// The user stopped it; the text says what was kept.
    Interrupted(String),
    /// Whoever read the output has seen enough (`hammerfall scenes | head -1`).
    OutputClosed,
}

impl Failure {
    /// Tells the user and gives the exit status.
    pub fn report(&self) -> ExitCode {
        let (word, message, status) = match self {
            Self::BadInput(message) => ("error", message, STATUS_BAD_INPUT),
            Self::Run(message) => ("error", message, STATUS_RUN_FAILED),
            Self::Interrupted(message) => ("interrupted", message, STATUS_INTERRUPTED),
            Self::OutputClosed => return ExitCode::SUCCESS,
        };
        // A closed stderr leaves nobody to tell; the exit status still says it.
        let _ = writeln!(io::stderr(), "{word}: {message}");
        ExitCode::from(status)
    }

    /// The same reason, for something that happened before anything was run.
    pub fn before_the_run(self) -> Self {
        match self {
            Self::Run(message) => Self::BadInput(message),
            other => other,
        }
    }
}

impl std::fmt::Display for Failure {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(match self {
            Self::BadInput(message) | Self::Run(message) | Self::Interrupted(message) => message,
            Self::OutputClosed => "nobody reads the output any more",
        })
    }
}

impl From<SimError> for Failure {
    fn from(error: SimError) -> Self {
        match error {
            SimError::Setup(reason) => Self::BadInput(reason),
            SimError::NotFinite { .. } | SimError::Criterion { .. } => Self::Run(error.to_string()),
        }
    }
}

impl From<ExportError> for Failure {
    fn from(error: ExportError) -> Self {
        Self::Run(error.to_string())
    }
}
/// Prints clap's message, or the help that was asked for, and gives its exit status.
pub fn report_usage(mut error: clap::Error, commands: &clap::Command, arguments: &[OsString]) -> ExitCode {
    suggest_command(&mut error, commands);
    // Fails only when nobody reads any more.
    let _ = error.print();
    if let Some(state) = unexpected_state(&error, arguments) {
        let _ = writeln!(
            io::stderr(),
            "\n  tip: a state of the window follows --panels with an equals sign: --panels={state}"
        );
    }
    ExitCode::from(if error.use_stderr() { STATUS_BAD_INPUT } else { 0 })
}

/// Puts the nearest command into the place of clap's suggestion, which does not take letters that changed places for a slip.
fn suggest_command(error: &mut clap::Error, commands: &clap::Command) {
    if error.kind() != ErrorKind::InvalidSubcommand {
        return;
    }
    let Some(ContextValue::String(typed)) = error.get(ContextKind::InvalidSubcommand) else { return };
    let found = nearest(typed, commands.get_subcommands().map(clap::Command::get_name)).map(str::to_owned);
    if let Some(name) = found {
        error.insert(ContextKind::SuggestedSubcommand, ContextValue::Strings(vec![name]));
    }
}

/// The state in `--panels element`, which is read as one argument too many.
fn unexpected_state<'a>(error: &'a clap::Error, arguments: &[OsString]) -> Option<&'a str> {
    let context = error.get(ContextKind::InvalidArg).filter(|_| error.kind() == ErrorKind::UnknownArgument);
    let Some(ContextValue::String(argument)) = context else { return None };
    let follows = |state: &str| arguments.windows(2).any(|pair| pair[0] == "--panels" && pair[1] == state);
    let is_state = |argument: &&str| PanelState::from_str(argument, false).is_ok() && follows(argument);
    Some(argument.as_str()).filter(is_state)
}

/// Makes a panic say that it is our mistake, in words instead of a dump.
pub fn install_panic_hook() {
    std::panic::set_hook(Box::new(|info| {
        let reason = info.payload_as_str().unwrap_or("no reason given");
        let place = info.location().map_or_else(|| "an unknown place".to_owned(), ToString::to_string);
        let backtrace = std::backtrace::Backtrace::capture();
        let details = match backtrace.status() {
            std::backtrace::BacktraceStatus::Captured => backtrace.to_string(),
            _ => "RUST_BACKTRACE=1 shows where it came from.".to_owned(),
        };
        let _ = writeln!(
            io::stderr(),
            "error: this is a mistake in hammerfall, not in your input: {reason}\n  \
             at {place}\n  \
             Please report it with the command line and the scene. What was written so far is kept.\n  \
             {details}"
        );
    }));
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_what_stops_before_the_run_is_bad_input() {
        let unsound = Failure::from(SimError::Setup("bodies overlap".to_owned()));
        assert!(matches!(unsound, Failure::BadInput(_)));
        let blown_up = Failure::from(SimError::NotFinite {
            body: "ball".to_owned(),
            what: "stress",
            place: "element 3".to_owned(),
            step: 7,
            time_s: 0.5,
        });
        assert!(matches!(&blown_up, Failure::Run(text) if text.contains("element 3")));
        assert!(matches!(blown_up.before_the_run(), Failure::BadInput(_)));
    }
}
