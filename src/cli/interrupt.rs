//! Ctrl-C: the first press asks for a clean end, the second stops at once.

use super::failure::{Failure, STATUS_INTERRUPTED};
use std::io::Write as _;
use std::sync::atomic::{AtomicBool, Ordering};

static REQUESTED: AtomicBool = AtomicBool::new(false);

/// Listens for Ctrl-C, and for requests to terminate where the system has them, from now on.
///
/// # Errors
/// [`Failure::Run`] when the system refuses the handler.
pub fn listen() -> Result<(), Failure> {
    ctrlc::set_handler(|| {
        if REQUESTED.swap(true, Ordering::SeqCst) {
            std::process::exit(i32::from(STATUS_INTERRUPTED));
        }
        let _ = writeln!(std::io::stderr(), "\nstopping cleanly; press Ctrl-C again to stop at once");
    })
    .map_err(|error| Failure::Run(format!("cannot listen for Ctrl-C: {error}")))
}

/// Whether a clean end has been asked for; cheap enough for every step.
pub fn requested() -> bool {
    REQUESTED.load(Ordering::Relaxed)
}
