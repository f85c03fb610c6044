//! Saving without waiting: an animation takes its time, and everything else goes beside it, one after the other.

use super::background;
use super::saving::{Job, Outcome, Progress, Studio, free_path, save};
use std::collections::VecDeque;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
use std::sync::mpsc::{Receiver, TryRecvError, channel};

/// Most jobs that wait for their turn: each holds on to what it saves.
const MOST_WAITING: usize = 20;

/// How a job came out.
#[derive(Clone, Debug, PartialEq)]
pub struct Finished {
    /// Of its file's name.
    pub ending: &'static str,
    /// How.
    pub outcome: Outcome,
}

/// A job under way.
struct Running {
    ending: &'static str,
    done: Arc<AtomicUsize>,
    steps: usize,
    wants_end: Arc<AtomicBool>,
    outcome: Receiver<Outcome>,
    what: PathBuf,
}

/// A job that waits for its turn, with its folder and the beginning of its file's name.
struct Waiting {
    job: Job,
    folder: String,
    stem: String,
}

/// Saves an animation, and other things beside it.
#[derive(Default)]
pub struct Saver {
    animation: Option<Running>,
    other: Option<Running>,
    waiting: VecDeque<Waiting>,
    /// What could not even be started when it had its turn.
    refused: VecDeque<Finished>,
    studio: Studio,
}

impl Running {
    /// Starts a job that writes `folder/stem.ending`, with a number if there is such a file already.
    fn start(Waiting { job, folder, stem }: Waiting, studio: &Studio) -> Result<Self, String> {
        let ending = job.ending();
        let what = free_path(Path::new(folder.trim()), &stem, ending);
        let (sender, outcome) = channel();
        let done = Arc::new(AtomicUsize::new(0));
        let wants_end = Arc::new(AtomicBool::new(false));
        let steps = job.steps();
        let progress = Progress { done: done.clone(), wants_end: wants_end.clone(), studio: studio.clone() };
        let target = what.clone();
        // All of it can wait for the window: drawing, which goes to many threads, and writing.
        let workers =
            background::workers("saving").map_err(|error| format!("nothing can be saved: {error}"))?;
        let work = move || {
            background::stand_back();
            let outcome = workers.install(|| save(&job, &target, &progress));
            // The window may be gone already.
            let _ = sender.send(outcome);
        };
        std::thread::Builder::new()
            .name("saving".to_owned())
            .spawn(work)
            .map_err(|error| format!("nothing can be saved: {error}"))?;
        Ok(Self { ending, done, steps, wants_end, outcome, what })
    }

    fn share(&self) -> f32 {
        self.done.load(Ordering::Relaxed) as f32 / self.steps.max(1) as f32
    }

    fn finished(&self) -> Option<Finished> {
        let outcome = match self.outcome.try_recv() {
            Ok(outcome) => outcome,
            Err(TryRecvError::Empty) => return None,
            Err(TryRecvError::Disconnected) => {
                Err("saving stopped by a mistake in hammerfall; please report it".to_owned())
            }
        };
        Some(Finished { ending: self.ending, outcome })
    }
}

impl Saver {
    /// Starts a job, or lets it wait for the one before: its file gets its name when it is begun.
    ///
    /// # Errors
    /// When the system refuses the thread, another animation is under way, or too much waits already.
    pub fn start(&mut self, job: Job, folder: &str, stem: &str) -> Result<(), String> {
        let next = Waiting { folder: folder.to_owned(), stem: stem.to_owned(), job };
        match next.job {
            Job::Animation(..) if self.animation.is_some() => {
                Err("another animation is being saved; one at a time, or cancel it".to_owned())
            }
            Job::Animation(..) => {
                self.animation = Some(Running::start(next, &self.studio)?);
                Ok(())
            }
            _ if self.waiting.len() >= MOST_WAITING => {
                Err("many things wait to be saved already; try again in a moment".to_owned())
            }
            _ => {
                self.waiting.push_back(next);
                self.start_waiting();
                Ok(())
            }
        }
    }

    fn start_waiting(&mut self) {
        while self.other.is_none()
            && let Some(next) = self.waiting.pop_front()
        {
            let ending = next.job.ending();
            match Running::start(next, &self.studio) {
                Ok(running) => self.other = Some(running),
                Err(reason) => self.refused.push_back(Finished { ending, outcome: Err(reason) }),
            }
        }
    }

    /// The path of the animation being written and the share that is done.
    #[must_use]
    pub fn animation(&self) -> Option<(&Path, f32)> {
        self.animation.as_ref().map(|running| (running.what.as_path(), running.share()))
    }

    /// Whether anything is being saved, or is about to be.
    #[must_use]
    pub fn is_busy(&self) -> bool {
        self.animation.is_some() || self.other.is_some()
    }

    /// Ends the animation under way; what it has so far is kept.
    pub fn cancel(&self) {
        if let Some(running) = &self.animation {
            running.wants_end.store(true, Ordering::Relaxed);
        }
    }

    /// How a job came out, once.
    pub fn finished(&mut self) -> Option<Finished> {
        if let Some(refused) = self.refused.pop_front() {
            return Some(refused);
        }
        if let Some(finished) = self.other.as_ref().and_then(Running::finished) {
            self.other = None;
            self.start_waiting();
            return Some(finished);
        }
        let finished = self.animation.as_ref().and_then(Running::finished)?;
        self.animation = None;
        Some(finished)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::frame::Frame;
    use crate::viewer::look::Look;
    use crate::viewer::saving::Shot;
    use std::time::{Duration, Instant};

    const TIME_LIMIT: Duration = Duration::from_secs(120);

    fn next_outcome(saver: &mut Saver) -> Outcome {
        let asked = Instant::now();
        loop {
            if let Some(finished) = saver.finished() {
                return finished.outcome;
            }
            std::thread::sleep(Duration::from_millis(2));
            assert!(asked.elapsed() < TIME_LIMIT, "nothing is finished");
        }
    }

    #[test]
    fn other_things_are_saved_beside_an_animation_one_after_the_other() {
        let folder = tempfile::tempdir().unwrap();
        let place = folder.path().to_str().unwrap();
        let look = Look::default();
        let shot =
            Shot { camera: look.camera, view: look.view(1.0), seeing: look.seeing(), size_px: [32, 32] };
        let frame = Arc::new(Frame::default());
        // Longer than anybody waits: it is cancelled in the end.
        let animation = || Job::Animation(vec![frame.clone(); 1_000_000], Box::new(shot.clone()));
        let mut saver = Saver::default();
        saver.start(animation(), place, "mine").unwrap();
        let refused = saver.start(animation(), place, "mine").unwrap_err();
        assert!(refused.contains("one at a time"), "{refused}");
        let scene = || Job::Scene("title = \"x\"".to_owned());
        for job in [scene(), Job::Obj(frame.clone()), Job::Ply(frame.clone()), scene()] {
            saver.start(job, place, "mine").unwrap();
        }
        saver.start(Job::Picture(frame.clone(), Box::new(shot.clone())), place, "mine").unwrap();
        for name in ["mine.toml", "mine.obj", "mine.ply", "mine-2.toml", "mine.png"] {
            assert!(saver.animation().is_some() && saver.is_busy());
            let told = next_outcome(&mut saver).unwrap();
            assert!(told.ends_with(name) && folder.path().join(name).exists(), "{told}");
        }
        // One that fails leaves the others their turn.
        saver.start(scene(), "/nowhere/at/all", "mine").unwrap();
        saver.start(scene(), place, "mine").unwrap();
        assert!(next_outcome(&mut saver).is_err());
        assert!(next_outcome(&mut saver).unwrap().ends_with("mine-3.toml"));
        saver.cancel();
        let told = next_outcome(&mut saver).unwrap();
        assert!(told.contains("stopped") && !saver.is_busy(), "{told}");
    }

    #[test]
    fn no_end_of_things_waits() {
        let folder = tempfile::tempdir().unwrap();
        let place = folder.path().to_str().unwrap();
        let mut saver = Saver::default();
        let mut refused = 0;
        for _ in 0..=MOST_WAITING + 1 {
            refused += usize::from(saver.start(Job::Scene(String::new()), place, "mine").is_err());
        }
        assert_eq!(refused, 1);
        (0..=MOST_WAITING).for_each(|_| assert!(next_outcome(&mut saver).is_ok()));
        assert!(!saver.is_busy());
    }
}
