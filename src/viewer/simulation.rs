//! The thread that owns the world: commands in by a channel, snapshots out by a latest-wins slot.

use super::background;
use super::pacing::FRAME_S;
use super::session::{SLICE_S, Session};
use super::slot::LatestSlot;
use super::snapshot::{Command, Snapshot};
use std::panic::AssertUnwindSafe;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{Receiver, RecvTimeoutError, Sender, channel};
use std::thread::JoinHandle;
use std::time::{Duration, Instant};

/// Share of the wall time that stepping may take, so that drawing and the window always get some.
const WORK_SHARE: f64 = 0.85;
/// Share of the wall time that making snapshots may take.
const SNAPSHOT_SHARE: f64 = 0.2;
/// How long the end of a step is waited for when the window closes.
const LONGEST_GOODBYE: Duration = Duration::from_secs(2);

/// Called when there is something new to see.
pub type Waker = Box<dyn Fn() + Send>;

/// The window's end of the simulation thread.
pub struct Simulation {
    commands: Sender<Command>,
    sent: Sent,
    slot: Arc<LatestSlot<Snapshot>>,
    wants_end: Arc<AtomicBool>,
    thread: Option<JoinHandle<()>>,
}

/// What was sent so far.
#[derive(Default)]
struct Sent {
    count: u64,
    /// The last commands, for a test that finds out that there is no end to them.
    #[cfg(test)]
    lately: std::collections::VecDeque<String>,
}

impl Simulation {
    /// Starts the thread.
    ///
    /// # Errors
    /// When the system refuses the thread.
    pub fn start(waker: Waker) -> std::io::Result<Self> {
        let (commands, inbox) = channel();
        let slot = Arc::new(LatestSlot::default());
        let wants_end = Arc::new(AtomicBool::new(false));
        let worker = Worker {
            session: Session::default(),
            inbox,
            slot: slot.clone(),
            wants_end: wants_end.clone(),
            waker,
            started: Instant::now(),
            next_snapshot_s: 0.0,
        };
        let workers = background::workers("simulation")?;
        let work = move || workers.install(|| worker.run());
        let thread = std::thread::Builder::new().name("simulation".to_owned()).spawn(work)?;
        Ok(Self { commands, sent: Sent::default(), slot, wants_end, thread: Some(thread) })
    }

    /// One that stands still and shows a snapshot for ever, without a thread.
    #[must_use]
    pub fn still(snapshot: Snapshot) -> Self {
        let slot = Arc::default();
        let simulation = Self {
            commands: channel().0,
            sent: Sent::default(),
            slot,
            wants_end: Arc::default(),
            thread: None,
        };
        simulation.show(snapshot);
        simulation
    }

    /// Shows another snapshot; for one that stands still.
    pub fn show(&self, mut snapshot: Snapshot) {
        snapshot.commands_done = 0;
        self.slot.put(Arc::new(snapshot));
    }

    /// Sends a command. It never waits.
    pub fn send(&mut self, command: Command) {
        #[cfg(test)]
        {
            self.sent.lately.truncate(9);
            self.sent.lately.push_front(format!("{command:?}"));
        }
        // The thread only ends after this end is gone.
        if self.commands.send(command).is_ok() {
            self.sent.count += 1;
        }
    }

    /// The last commands, the latest first, and how many there were.
    #[cfg(test)]
    pub fn lately(&self) -> (u64, Vec<&str>) {
        (self.sent.count, self.sent.lately.iter().map(String::as_str).collect())
    }

    /// The latest state, if there is one yet.
    #[must_use]
    pub fn latest(&self) -> Option<Arc<Snapshot>> {
        self.slot.latest()
    }

    /// Whether commands are under way that `snapshot` does not show yet.
    #[must_use]
    pub fn is_behind(&self, snapshot: &Snapshot) -> bool {
        snapshot.commands_done < self.sent.count
    }
}

impl Drop for Simulation {
    fn drop(&mut self) {
        self.wants_end.store(true, Ordering::Relaxed);
        // Wakes a thread that waits for a command.
        let _ = self.commands.send(Command::Close);
        let Some(thread) = self.thread.take() else { return };
        let asked = Instant::now();
        while !thread.is_finished() && asked.elapsed() < LONGEST_GOODBYE {
            std::thread::sleep(Duration::from_millis(1));
        }
        // In the middle of a very long step it is left behind; the process is about to end.
        if thread.is_finished() {
            let _ = thread.join();
        }
    }
}

/// The thread's side.
struct Worker {
    session: Session,
    inbox: Receiver<Command>,
    slot: Arc<LatestSlot<Snapshot>>,
    wants_end: Arc<AtomicBool>,
    waker: Waker,
    started: Instant,
    next_snapshot_s: f64,
}

impl Worker {
    fn run(mut self) {
        while self.take_commands() {
            let is_late = self.guarded(Self::work).unwrap_or(false);
            self.publish(false);
            if is_late {
                // What comes in during the rest is taken up at once in the next round.
                std::thread::sleep(Duration::from_secs_f64(SLICE_S * (1.0 - WORK_SHARE) / WORK_SHARE));
            }
        }
    }

    fn wall_s(&self) -> f64 {
        self.started.elapsed().as_secs_f64()
    }

    /// Waits as long as there is nothing to do and carries out what comes; `false` at the end.
    fn take_commands(&mut self) -> bool {
        let mut wait = self.session.wait_s(self.wall_s());
        loop {
            let received = match wait {
                None => self.inbox.recv().map_err(|_| RecvTimeoutError::Disconnected),
                Some(seconds) => self.inbox.recv_timeout(Duration::from_secs_f64(seconds)),
            };
            if self.wants_end.load(Ordering::Relaxed) {
                return false;
            }
            match received {
                Ok(command) => {
                    self.guarded(|worker| worker.session.execute(command));
                    self.publish(true);
                }
                Err(RecvTimeoutError::Timeout) => return true,
                Err(RecvTimeoutError::Disconnected) => return false,
            }
            // Take in what else is there, then go on.
            wait = Some(0.0);
        }
    }

    /// Steps for a slice of time; returns whether the next moment is still ahead.
    fn work(&mut self) -> bool {
        let wall_s = self.wall_s();
        let was_playing = self.session.is_playing();
        let slice = Instant::now();
        let wants_end = self.wants_end.clone();
        let is_enough = || slice.elapsed().as_secs_f64() > SLICE_S || wants_end.load(Ordering::Relaxed);
        let is_reached = self.session.advance(wall_s, is_enough);
        if was_playing && !self.session.is_playing() {
            self.publish(true);
        }
        !is_reached
    }

    /// Makes a snapshot if the window has seen the last one, and not too often, unless it `must` be.
    fn publish(&mut self, must: bool) {
        let wall_s = self.wall_s();
        let is_due = self.session.is_playing() && wall_s >= self.next_snapshot_s && self.slot.was_taken();
        if !(must || is_due) {
            return;
        }
        let Some(snapshot) = self.guarded(|worker| worker.session.snapshot()) else { return };
        self.slot.put(Arc::new(snapshot));
        let took_s = self.wall_s() - wall_s;
        self.next_snapshot_s = wall_s + (0.5 * FRAME_S).max(took_s / SNAPSHOT_SHARE);
        (self.waker)();
    }

    /// Runs a piece of work; a panic in it fails the run instead of killing the thread.
    fn guarded<T>(&mut self, work: impl FnOnce(&mut Self) -> T) -> Option<T> {
        let result = std::panic::catch_unwind(AssertUnwindSafe(|| work(self)));
        result.map_err(|payload| self.session.fail(panic_text(payload.as_ref()))).ok()
    }
}

fn panic_text(payload: &(dyn std::any::Any + Send)) -> String {
    let text = payload.downcast_ref::<&str>().map(|text| (*text).to_owned());
    let text = text.or_else(|| payload.downcast_ref::<String>().cloned());
    let reason = text.unwrap_or_else(|| "no reason given".to_owned());
    format!("This is a mistake in hammerfall, not in your input: {reason}. Please report it with the scene.")
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::sync::mpsc::sync_channel;

    /// A simulation, and a receiver that hears whenever there is something new.
    fn start() -> (Simulation, Receiver<()>) {
        let (bell, ears) = sync_channel(1);
        let waker = Box::new(move || {
            let _ = bell.try_send(());
        });
        (Simulation::start(waker).unwrap(), ears)
    }

    /// Waits for a snapshot that fits; a generous limit keeps a broken thread from hanging the tests.
    fn wait_for(
        simulation: &Simulation,
        ears: &Receiver<()>,
        fits: impl Fn(&Snapshot) -> bool,
    ) -> Arc<Snapshot> {
        let asked = Instant::now();
        loop {
            let _ = ears.recv_timeout(Duration::from_secs(1));
            if let Some(snapshot) = simulation.latest().filter(|snapshot| fits(snapshot)) {
                return snapshot;
            }
            assert!(asked.elapsed() < Duration::from_secs(120), "the thread does not get there");
        }
    }

    fn open(scene: &str, play: bool) -> Command {
        Command::Open { scene: scene.to_owned(), overrides: Vec::new(), play }
    }

    #[test]
    fn the_thread_plays_answers_and_ends() {
        let (mut simulation, ears) = start();
        simulation.send(open("bounce", true));
        wait_for(&simulation, &ears, |s| s.is_playing && s.frame.time_s > 0.0 && s.history.rows().len() > 3);
        simulation.send(Command::Pause);
        let paused = wait_for(&simulation, &ears, |s| !simulation.is_behind(s));
        assert!(!paused.is_playing);
        simulation.send(Command::Step);
        let stepped = wait_for(&simulation, &ears, |s| !simulation.is_behind(s));
        assert!(stepped.frame.time_s > paused.frame.time_s);
        drop(simulation);
        // The waker goes with the thread.
        assert!(ears.iter().count() <= 1);
    }

    #[test]
    fn closing_in_the_middle_of_a_run_ends_the_thread() {
        let (mut simulation, ears) = start();
        simulation.send(open("hammer-table", true));
        simulation.send(Command::SetSpeed(1.0));
        wait_for(&simulation, &ears, |s| s.frame.time_s > 0.0);
        drop(simulation);
        assert!(ears.iter().count() <= 1);
    }
}
