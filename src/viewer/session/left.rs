//! Runs that a reset has left, and later times from which somebody went back, as they stood: undo goes back to them, redo comes
//! back from there.
//!
//! Nothing is simulated again for it. They share the memory of the recording: the older ones go first.

use super::Session;
use super::course::{Course, Place};
use std::sync::Arc;

/// Most that are kept each way.
const MOST: usize = 8;
/// Share of the recording's memory that they may have.
const MEMORY_SHARE: f64 = 0.5;

/// A course that was left for another one.
struct Left {
    /// What left it, in words.
    what: String,
    /// Where the other way on begins, if only what came after that was left, and not all of the run.
    since: Option<Place>,
    /// The edits that led to its end, where they are among those of the present run.
    path: Vec<usize>,
    /// Redo comes back to it from where these edits had been made.
    from: Vec<usize>,
    course: Course,
}

/// What was left before this, and what undo has left.
#[derive(Default)]
pub(super) struct LeftRuns {
    before: Vec<Left>,
    after: Vec<Left>,
}

impl LeftRuns {
    fn bytes(&self) -> usize {
        self.before.iter().chain(&self.after).map(|left| left.course.bytes()).sum()
    }

    fn keep_within(&mut self, bytes: usize) {
        for runs in [&mut self.before, &mut self.after] {
            runs.drain(..runs.len().saturating_sub(MOST));
        }
        loop {
            let count = self.before.len() + self.after.len();
            let share = bytes / count.max(1);
            self.before.iter_mut().chain(&mut self.after).for_each(|left| left.course.keep_within(share));
            // The one that undo goes back to stays however large it is.
            if self.bytes() <= bytes || count <= 1 {
                return;
            }
            let runs = if self.before.len() > 1 || self.after.is_empty() {
                &mut self.before
            } else {
                &mut self.after
            };
            runs.remove(0);
        }
    }
}

impl Session {
    /// Leaves the run for one that begins anew. One in which nothing was done is nothing to go back to.
    pub(super) fn leave_run(&mut self, what: &str, keep: bool) {
        let drops_kept = !keep && !self.course.kept_text.is_empty();
        // The time that somebody left in it can be brought back only with it.
        let has_left = self.left.before.last().is_some_and(|left| left.since.is_some());
        if self.course.edits.has_own() || drops_kept || has_left {
            let left = self.take(what.to_owned(), None);
            self.left.before.push(left);
            self.left.after.clear();
        } else if let Some(last) = self.left.before.last_mut() {
            what.clone_into(&mut last.what);
            self.left.after.clear();
        }
    }

    /// Leaves what came after a place; whether all that was recorded of it fits into memory. The run has no end then, until one
    /// is given to it.
    pub(super) fn leave_time(&mut self, place: Place, what: String) -> bool {
        let left = self.take(what, Some(place));
        let recorded = left.course.recording.moments().len();
        self.left.before.push(left);
        self.left.after.clear();
        self.share_memory();
        self.left.before.last().is_some_and(|left| left.course.recording.moments().len() == recorded)
    }

    /// What undo takes back, in words, where that is no edit alone: it goes back to what was left before. Something that was done
    /// to the past is taken back with the way there.
    pub(super) fn undo_left_words(&self) -> Option<&str> {
        let left = self.left.before.last()?;
        let Some((index, step)) = self.course.edits.last_step() else { return Some(&left.what) };
        let place = left.since.filter(|place| index <= place.edits)?;
        match index == place.edits {
            true => (step.time_s == place.time_s).then_some(&step.what),
            false => Some(&left.what),
        }
    }

    /// What redo does again, in words, if it comes back to what undo has left here.
    pub(super) fn redo_left_words(&self) -> Option<&str> {
        let left = self.left_here()?;
        let at_once = self.redo_left_number().and_then(|number| self.course.edits.at(number));
        Some(at_once.map_or(&left.what, |edit| &edit.what))
    }

    /// The number of the edit that this does again, if it comes back to one that was made where somebody had gone back to.
    pub(super) fn redo_left_number(&self) -> Option<usize> {
        let left = self.left_here()?;
        let place = left.since?;
        let number = *left.path.get(place.edits)?;
        (self.course.edits.at(number)?.time_s == place.time_s).then_some(number)
    }

    /// What undo has left here.
    fn left_here(&self) -> Option<&Left> {
        self.left.after.last().filter(|left| left.from == self.course.edits.path())
    }

    /// Goes back to what was left before, where it stood.
    pub(super) fn undo_left(&mut self) {
        let Some(what) = self.undo_left_words().map(str::to_owned) else { return };
        let Some(before) = self.left.before.pop() else { return };
        let mut left = self.take(before.what.clone(), before.since);
        let told = match before.since {
            Some(_) => format!(
                "The later time up to {} is back",
                crate::render::with_unit(before.course.time_s(), "s")
            ),
            None => "The scene is where it was before".to_owned(),
        };
        self.put(before);
        self.course.edits.path().clone_into(&mut left.from);
        self.left.after.push(left);
        self.share_memory();
        self.mention(format!("Taken back: {what}. {told}. Ctrl Y does it again."));
    }

    /// Comes back to what undo has left, where it stood.
    pub(super) fn redo_left(&mut self) {
        let Some(what) = self.redo_left_words().map(str::to_owned) else { return };
        let Some(after) = self.left.after.pop() else { return };
        let left = self.take(after.what.clone(), after.since);
        self.put(after);
        self.left.before.push(left);
        self.share_memory();
        self.mention(format!("Done again: {what}. The scene is where it was then."));
    }

    /// Gives what was left its part of the memory.
    pub(super) fn share_memory(&mut self) {
        let limit = self.course.recording.limit_bytes();
        self.left.keep_within((limit as f64 * MEMORY_SHARE) as usize);
        let recording = Arc::make_mut(&mut self.course.recording);
        recording.reserved_bytes = self.left.bytes();
        recording.set_limit(limit);
        let world_limit_bytes = recording.world_limit_bytes();
        self.course.keep_worlds_within(world_limit_bytes);
    }

    /// Takes the course out, or what came after a place in it.
    fn take(&mut self, what: String, since: Option<Place>) -> Left {
        self.let_go();
        self.redoing = None;
        let path = self.course.edits.path().to_vec();
        let course = match since {
            Some(place) => self.course.split_off(place),
            None => {
                let anew = self.course.anew();
                std::mem::replace(&mut self.course, anew)
            }
        };
        Left { what, since, path, from: Vec::new(), course }
    }

    fn put(&mut self, left: Left) {
        let limit = self.course.recording.limit_bytes();
        if left.since.is_some() {
            let before = std::mem::take(&mut self.course);
            self.course = left.course.following(before);
            self.course.edits.go_to(left.path);
        } else {
            self.built += 1;
            self.course = left.course;
        }
        Arc::make_mut(&mut self.course.recording).set_limit(limit);
        (self.course.pressed_n_s, self.course.pressed_s, self.course.standing_steps) = (0.0, 0.0, 0);
        (self.course.frame_of, self.looked) = (None, None);
        self.restart_clock();
    }
}
