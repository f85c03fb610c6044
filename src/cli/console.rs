//! Results on stdout, progress and notes on stderr.

use super::failure::Failure;
use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};
use std::io::{self, Write as _};
use std::time::{Duration, Instant};

/// Where a subcommand speaks.
#[derive(Debug)]
pub struct Console {
    quiet: bool,
}

impl Console {
    /// A console; a quiet one says nothing but results that were asked for, errors, and what came to nothing.
    pub fn new(quiet: bool) -> Self {
        Self { quiet }
    }

    /// Writes a line that the command exists for (a list, a finding).
    ///
    /// # Errors
    /// [`Failure::OutputClosed`] when nobody reads any more, [`Failure::Run`] when stdout cannot be written.
    pub fn result(&self, line: impl std::fmt::Display) -> Result<(), Failure> {
        writeln!(io::stdout(), "{line}").map_err(|error| match error.kind() {
            io::ErrorKind::BrokenPipe => Failure::OutputClosed,
            _ => Failure::Run(format!("cannot write to stdout: {error}")),
        })
    }

    /// Writes a closing line (what was written, where), unless quiet.
    ///
    /// # Errors
    /// As [`Console::result`].
    pub fn closing(&self, line: impl std::fmt::Display) -> Result<(), Failure> {
        if self.quiet { Ok(()) } else { self.result(line) }
    }

    /// Says something on stderr, unless quiet.
    pub fn note(&self, line: impl std::fmt::Display) {
        if !self.quiet {
            // Notes are a courtesy: without a stderr the work goes on.
            let _ = writeln!(io::stderr(), "{line}");
        }
    }

    /// Says on stderr that something that was asked for came to nothing, quiet or not: the results are not what they were
    /// meant to be, and do not show it by themselves.
    pub fn came_to_nothing(&self, what: impl std::fmt::Display) {
        let _ = writeln!(io::stderr(), "warning: {what}");
    }

    /// A progress bar over simulated time, visible only on a terminal.
    pub fn progress(&self, duration_s: f64) -> Progress {
        Progress::new(duration_s, self.quiet)
    }
}

/// A time for people: six digits at most, in plain notation where that is short.
pub fn seconds(time_s: f64) -> String {
    let rounded: f64 = format!("{time_s:.5e}").parse().unwrap_or(time_s);
    if rounded == 0.0 || (1e-3..1e6).contains(&rounded) {
        format!("{rounded} s")
    } else {
        format!("{rounded:e} s")
    }
}

/// A bar over simulated time.
pub struct Progress {
    bar: ProgressBar,
    duration_s: f64,
    last_draw: Option<Instant>,
}

impl Progress {
    const TICKS: u64 = 1000;
    const DRAW_INTERVAL: Duration = Duration::from_millis(100);

    fn new(duration_s: f64, quiet: bool) -> Self {
        let target = if quiet {
            ProgressDrawTarget::hidden()
        } else {
            // Hides itself where stderr is no terminal.
            ProgressDrawTarget::stderr()
        };
        let bar = ProgressBar::with_draw_target(Some(Self::TICKS), target);
        let template = "{bar:30} {percent:>3} %  {msg}  {elapsed} gone, {eta} to go";
        if let Ok(style) = ProgressStyle::with_template(template) {
            bar.set_style(style.progress_chars("=> "));
        }
        Self { bar, duration_s, last_draw: None }
    }

    /// Moves the bar; `describe` is asked for its text only when the bar is drawn.
    pub fn at(&mut self, time_s: f64, describe: impl FnOnce() -> String) {
        if self.bar.is_hidden() || self.drawn_just_now() {
            return;
        }
        self.last_draw = Some(Instant::now());
        let share = (time_s / self.duration_s).clamp(0.0, 1.0);
        self.bar.set_message(describe());
        self.bar.set_position((share * Self::TICKS as f64) as u64);
    }

    fn drawn_just_now(&self) -> bool {
        self.last_draw.is_some_and(|drawn| drawn.elapsed() < Self::DRAW_INTERVAL)
    }
}

impl Drop for Progress {
    fn drop(&mut self) {
        self.bar.finish_and_clear();
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn times_are_short_to_read() {
        let cases = [
            (0.0, "0 s"),
            (1.999_999_999_999_998_2, "2 s"),
            (0.123_456_789, "0.123457 s"),
            (9.89e-5, "9.89e-5 s"),
        ];
        for (time_s, text) in cases {
            assert_eq!(seconds(time_s), text);
        }
    }
}
