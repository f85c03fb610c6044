//! Ctrl-C: the first press asks for a clean end, a later one stops at once.

use super::failure::{Failure, STATUS_INTERRUPTED};
use std::io::Write as _;
use std::sync::OnceLock;
use std::time::{Duration, Instant};

/// When a clean end was asked for.
static REQUESTED: OnceLock<Instant> = OnceLock::new();

/// Time in which a second request is an echo of the first: GNU `timeout` sends its signal to the program and then to the group
/// that the program is in.
const ECHO: Duration = Duration::from_secs(1);

/// Listens for Ctrl-C, and for requests to terminate where the system has them, from now on.
///
/// # Errors
/// [`Failure::Run`] when the system refuses the handler.
pub fn listen() -> Result<(), Failure> {
    ctrlc::set_handler(|| {
        let now = Instant::now();
        if REQUESTED.set(now).is_ok() {
            let _ = writeln!(std::io::stderr(), "\nstopping cleanly; press Ctrl-C again to stop at once");
        } else if REQUESTED.get().is_some_and(|first| now.duration_since(*first) > ECHO) {
            std::process::exit(i32::from(STATUS_INTERRUPTED));
        }
    })
    .map_err(|error| Failure::Run(format!("cannot listen for Ctrl-C: {error}")))
}

/// Whether a clean end has been asked for; cheap enough for every step.
pub fn requested() -> bool {
    REQUESTED.get().is_some()
}
