//! Threads whose work can wait: the window's own comes first.

/// How far behind the window, in steps of niceness: each is worth about a quarter more or less time on a core that is
/// fought for.
#[cfg(target_os = "linux")]
const NICENESS: i32 = 10;

/// Lets the window's threads go before this one, and before those that it starts from now on, where cores are scarce.
/// Nothing but time hangs on it.
pub fn stand_back() {
    // For Linux a thread is a process of its own here, and none given is the one that asks. A system that refuses makes
    // a window that answers later, no more.
    #[cfg(target_os = "linux")]
    let _ = rustix::process::setpriority_process(None, NICENESS);
}

/// Worker threads beside the program's own ones, as many as those, for work that can wait. Whoever draws hands pieces
/// to the program's own workers, and must find none of them busy with a step.
///
/// # Errors
/// When the system refuses the threads.
pub fn workers(name: &'static str) -> std::io::Result<rayon::ThreadPool> {
    rayon::ThreadPoolBuilder::new()
        .num_threads(rayon::current_num_threads())
        .thread_name(move |index| format!("{name}-{index}"))
        .start_handler(|_| stand_back())
        .build()
        .map_err(std::io::Error::other)
}
