//! Taking back what was done and making it again.
//!
//! What is made again comes at its own time. Where that is still ahead, time goes there first, as fast as it can, and
//! is recorded on the way: a slice at a time, so that commands are heard meanwhile.

use super::super::pacing::FRAME_S;
use super::course::Place;
use super::timeline::named;
use super::{Session, is_reached};
use crate::render::with_unit;

/// Most moments that a way to a time is made of: in extreme slow motion it would never end.
const MOST_MOMENTS: f64 = 2e4;

/// On the way to what is made again.
pub(super) struct Redoing {
    /// So many are to be made again.
    count: usize,
    /// Whether time runs on afterwards.
    pub then_plays: bool,
    /// The next moment to be recorded, s.
    moment_s: f64,
}

/// How a stretch of the way ended.
enum Way {
    Reached,
    Interrupted,
    Failed,
}

impl Session {
    /// What redo would make again, in words, while time goes there.
    pub(super) fn redoing_words(&self) -> Option<String> {
        self.redoing.as_ref().and_then(|_| self.course.edits.next()).map(|edit| edit.what.clone())
    }

    /// What undo would take back: the last edit, or the reset or the way back before it.
    pub(super) fn undo_words(&self) -> Option<String> {
        let edit = || self.course.edits.last_step().map(|(_, step)| step.what.as_str());
        self.undo_left_words().or_else(edit).map(str::to_owned)
    }

    /// What redo would do again: where a reset or a way back was taken back, that.
    pub(super) fn redo_words(&self) -> Option<String> {
        let edit = self.course.edits.next().map(|edit| edit.what.as_str());
        self.redo_left_words().or(edit).map(str::to_owned)
    }

    /// What had been done here before that.
    pub(super) fn redo_other_words(&self) -> Option<String> {
        let (edits, other) = (&self.course.edits, self.other_number()?);
        let what = &edits.at(other)?.what;
        if self.redo_words().as_ref() != Some(what) {
            return Some(what.clone());
        }
        // Two of the same words are told apart by which was done first.
        let first = self.redo_left_number().or_else(|| edits.next_number())?;
        Some(format!("{what}, the {} one", if other < first { "earlier" } else { "later" }))
    }

    /// The number of what had been done here before that: never what redo does, too.
    fn other_number(&self) -> Option<usize> {
        let edits = &self.course.edits;
        let beside = self.redo_left_words().and_then(|_| edits.next_number());
        beside.filter(|number| self.redo_left_number() != Some(*number)).or_else(|| edits.other_number())
    }

    /// What a reset comes to, where something was done before it.
    pub(super) fn reset_text(&self, keep: bool) -> Option<String> {
        let done = named(&self.course.edits.steps_after(0));
        let back = "Ctrl Z goes back to where the scene was";
        match (keep, done.as_str()) {
            (true, "") if self.course.kept_text.is_empty() => None,
            (true, "") => Some(
                "Rerun from the start: what was done before comes again, each at its mark on the timeline."
                    .to_owned(),
            ),
            (true, done) => Some(format!(
                "Rerun from the start: what was done before comes again, each at its mark on the timeline ({done}). {back}."
            )),
            (false, "") if self.course.kept_text.is_empty() => None,
            (false, "") => {
                Some(format!("Reset to the start, without what was done before. {back}, with all of it."))
            }
            (false, done) => {
                Some(format!("Reset to the start, without what was done: {done}. {back}, with all of it."))
            }
        }
    }

    /// Takes back what was done last.
    pub(super) fn undo_last(&mut self) {
        self.let_go();
        let was_playing = self.is_playing;
        if self.undo_left_words().is_some() {
            self.undo_left();
            return self.set_playing(was_playing);
        }
        let Some((edits, step)) = self.course.edits.last_step() else { return };
        let (time_s, what) = (step.time_s, step.what.clone());
        if self.go_back(Place { time_s, edits }) {
            let other = self
                .redo_other_words()
                .map(|other| format!(" Ctrl Shift Y goes over to what was done here before: {other}."));
            let other = other.unwrap_or_default();
            self.mention(format!("Taken back: {what}. The scene is where it was then.{other}"));
        }
        self.set_playing(was_playing);
    }

    /// Makes again, at its own time, what was left last.
    pub(super) fn redo_next(&mut self) {
        self.let_go();
        if self.redoing.is_none() && self.redo_left_words().is_some() {
            let was_playing = self.is_playing;
            self.redo_left();
            return self.set_playing(was_playing);
        }
        self.redo_next_edit();
    }

    fn redo_next_edit(&mut self) {
        if let Some(redoing) = &mut self.redoing {
            redoing.count += 1;
            return;
        }
        let Some(next) = self.course.edits.next() else { return };
        let (time_s, what) = (next.time_s, next.what.clone());
        let (then_plays, moment_s) = (self.is_playing, self.time_s());
        let is_ahead = time_s > moment_s;
        if is_ahead {
            self.set_playing(true);
            if !self.is_playing {
                return;
            }
            self.mention(format!(
                "Playing on to {}, where this is done again: {what}.",
                with_unit(time_s, "s")
            ));
        }
        self.redoing = Some(Redoing { count: 1, then_plays, moment_s });
        if !is_ahead {
            self.go_on_redoing(|| true);
        }
    }

    /// Makes again what had been done at this place before that.
    pub(super) fn redo_other(&mut self) {
        self.let_go();
        let Some(other) = self.other_number() else { return };
        if self.course.edits.next_number() != Some(other) {
            self.course.edits.turn_to_other();
        }
        self.redo_next_edit();
    }

    /// Ends the way to what would have been made again; that still can be.
    pub(super) fn stop_redoing(&mut self) {
        if let Some(redoing) = self.redoing.take() {
            self.set_playing(redoing.then_plays);
        }
    }

    /// Goes on to what is made again, until it `is_enough` for now; `false` when there is more of the way.
    pub(super) fn go_on_redoing(&mut self, mut is_enough: impl FnMut() -> bool) -> bool {
        while self.redoing.is_some() {
            let Some(next) = self.course.edits.next().map(|edit| edit.time_s) else { break };
            let is_there = match next {
                ahead_s if ahead_s > self.time_s() => match self.play_to_redo(ahead_s, &mut is_enough) {
                    Way::Reached => true,
                    Way::Interrupted => return false,
                    Way::Failed => false,
                },
                now_s if now_s == self.time_s() && self.course.run_error.is_none() => true,
                time_s => self.go_back(Place { time_s, edits: self.course.edits.len() }),
            };
            if !(is_there && self.make_next()) {
                break;
            }
            if self.course.edits.goes_on_as_one() {
                continue;
            }
            self.mention_redone();
            let Some(redoing) = &mut self.redoing else { break };
            redoing.count -= 1;
            if redoing.count == 0 {
                break;
            }
        }
        self.stop_redoing();
        true
    }

    fn mention_redone(&mut self) {
        let Some((_, step)) = self.course.edits.last_step() else { return };
        let told = format!("Done again: {}.", step.what);
        self.mention(told);
    }

    /// Simulates up to a time, recording moments on the way as on a machine that is always in time; the last one is that
    /// of the first step that reaches it. `false` when the run cannot go on.
    pub fn simulate_to(&mut self, until_s: f64) -> bool {
        let mut moment_s = self.time_s();
        matches!(self.play_towards(until_s, &mut moment_s, &mut || false), Way::Reached)
    }

    fn play_to_redo(&mut self, until_s: f64, is_enough: &mut impl FnMut() -> bool) -> Way {
        let mut moment_s = self.redoing.as_ref().map_or(0.0, |redoing| redoing.moment_s);
        let way = self.play_towards(until_s, &mut moment_s, is_enough);
        if let Some(redoing) = &mut self.redoing {
            redoing.moment_s = moment_s;
        }
        way
    }

    /// The same in slices; `next_s` is when the next moment is recorded.
    fn play_towards(&mut self, until_s: f64, next_s: &mut f64, is_enough: &mut impl FnMut() -> bool) -> Way {
        while !is_reached(self.time_s(), until_s) {
            let now_s = self.time_s();
            if is_reached(now_s, *next_s) {
                *next_s = now_s + (FRAME_S * self.speed_now()).max(until_s / MOST_MOMENTS);
            }
            // No moment a rounding before the end: what is made there is made at its very time.
            let moment_s = if is_reached(*next_s, until_s) { until_s } else { *next_s };
            if !self.take_step(moment_s) {
                return Way::Failed;
            }
            if is_reached(self.time_s(), moment_s) {
                self.note_moment();
            }
            if !is_reached(self.time_s(), until_s) && is_enough() {
                return Way::Interrupted;
            }
        }
        Way::Reached
    }
}
