//! Runs that a reset has left, as they stood: undo goes back to them, redo comes back from there.
//!
//! Nothing is simulated again for it. They share the memory of the recording: the older ones go first.

use super::super::history::History;
use super::super::recording::{Mark, Recording};
use super::edit_tree::EditTree;
use super::timeline::{Keyframe, thin_worlds};
use super::{Run, Session};
use crate::frame::Frame;
use crate::sim::ContactParameters;
use std::sync::Arc;

/// Most runs that are kept each way.
const MOST: usize = 8;
/// Share of the recording's memory that they may have.
const MEMORY_SHARE: f64 = 0.5;

/// Everything about a run that a reset begins anew.
pub(super) struct Left {
    /// What left it, in words.
    pub what: String,
    /// Redo comes back to it where so many edits had been made.
    edits_before: usize,
    run: Option<Run>,
    contact: Option<ContactParameters>,
    contact_given: Option<ContactParameters>,
    run_up_end_s: f64,
    frame: Arc<Frame>,
    history: Arc<History>,
    thrown: usize,
    recording: Arc<Recording>,
    keyframes: Vec<Keyframe>,
    keyframe_every: u32,
    moments_since_keyframe: u32,
    edits: EditTree,
    kept_text: String,
    planned: Arc<[Mark]>,
    contacts_marked: usize,
    crack_area_m2: f64,
    are_cracks_growing: bool,
    run_error: Option<String>,
}

impl Left {
    fn bytes(&self) -> usize {
        let world = self.run.as_ref().map_or(0, |run| run.world.memory_bytes());
        self.recording.own_bytes() + world
    }

    fn keep_within(&mut self, bytes: usize) {
        let recording = Arc::make_mut(&mut self.recording);
        recording.reserved_bytes = 0;
        recording.set_limit(bytes);
        let (halvings, world_bytes) = thin_worlds(&mut self.keyframes, recording.world_limit_bytes());
        recording.world_bytes = world_bytes;
        self.keyframe_every = self.keyframe_every.saturating_mul(1 << halvings.min(16));
    }
}

/// The runs before this one, and those that undo has left.
#[derive(Default)]
pub(super) struct LeftRuns {
    before: Vec<Left>,
    after: Vec<Left>,
}

impl LeftRuns {
    fn bytes(&self) -> usize {
        self.before.iter().chain(&self.after).map(Left::bytes).sum()
    }

    fn keep_within(&mut self, bytes: usize) {
        for runs in [&mut self.before, &mut self.after] {
            runs.drain(..runs.len().saturating_sub(MOST));
        }
        loop {
            let count = self.before.len() + self.after.len();
            let share = bytes / count.max(1);
            self.before.iter_mut().chain(&mut self.after).for_each(|left| left.keep_within(share));
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
        let drops_kept = !keep && !self.kept_text.is_empty();
        if self.edits.has_own() || drops_kept {
            let left = self.take_run(what.to_owned(), 0);
            self.left.before.push(left);
            self.left.after.clear();
        } else if let Some(last) = self.left.before.last_mut() {
            what.clone_into(&mut last.what);
            self.left.after.clear();
        }
    }

    /// Whether undo goes back to a run before this one.
    pub(super) fn undo_reset_words(&self) -> Option<&str> {
        self.left.before.last().map(|left| left.what.as_str())
    }

    /// What left this run, if redo comes back to the run after it from here.
    pub(super) fn redo_reset_words(&self) -> Option<&str> {
        let next = self.left.after.last().filter(|left| left.edits_before == self.edits.len());
        next.map(|left| left.what.as_str())
    }

    /// Goes back to the run before the reset, where it stood.
    pub(super) fn undo_reset(&mut self) {
        let Some(before) = self.left.before.pop() else { return };
        let what = before.what.clone();
        let left = self.take_run(what.clone(), before.edits.len());
        self.put_run(before);
        self.left.after.push(left);
        self.share_memory();
        self.mention(format!("Taken back: {what}. The scene is where it was before. Ctrl Y does it again."));
    }

    /// Comes back to the run after the reset, where it stood.
    pub(super) fn redo_reset(&mut self) {
        let Some(after) = self.left.after.pop() else { return };
        let what = after.what.clone();
        let left = self.take_run(what.clone(), 0);
        self.put_run(after);
        self.left.before.push(left);
        self.share_memory();
        self.mention(format!("Done again: {what}. The scene is where it was then."));
    }

    /// Gives the runs that were left their part of the memory.
    pub(super) fn share_memory(&mut self) {
        let limit = self.recording.limit_bytes();
        self.left.keep_within((limit as f64 * MEMORY_SHARE) as usize);
        let recording = Arc::make_mut(&mut self.recording);
        recording.reserved_bytes = self.left.bytes();
        recording.set_limit(limit);
        self.keep_worlds_within(self.recording.world_limit_bytes());
    }

    fn take_run(&mut self, what: String, edits_before: usize) -> Left {
        self.let_go();
        self.redoing = None;
        let anew = Arc::new(Recording::with_limit(self.recording.limit_bytes()));
        Left {
            what,
            edits_before,
            run: self.run.take(),
            contact: self.contact.clone(),
            contact_given: self.contact_given.clone(),
            run_up_end_s: self.run_up_end_s,
            frame: self.frame.clone(),
            history: std::mem::take(&mut self.history),
            thrown: self.thrown,
            recording: std::mem::replace(&mut self.recording, anew),
            keyframes: std::mem::take(&mut self.keyframes),
            keyframe_every: self.keyframe_every,
            moments_since_keyframe: self.moments_since_keyframe,
            edits: std::mem::take(&mut self.edits),
            kept_text: self.kept_text.clone(),
            planned: self.planned.clone(),
            contacts_marked: self.contacts_marked,
            crack_area_m2: self.crack_area_m2,
            are_cracks_growing: self.are_cracks_growing,
            run_error: self.run_error.take(),
        }
    }

    fn put_run(&mut self, left: Left) {
        let limit = self.recording.limit_bytes();
        self.built += 1;
        self.run = left.run;
        self.contact = left.contact;
        self.contact_given = left.contact_given;
        self.run_up_end_s = left.run_up_end_s;
        self.frame = left.frame;
        self.frame_of = None;
        self.looked = None;
        self.history = left.history;
        self.thrown = left.thrown;
        self.recording = left.recording;
        Arc::make_mut(&mut self.recording).set_limit(limit);
        self.keyframes = left.keyframes;
        self.keyframe_every = left.keyframe_every;
        self.moments_since_keyframe = left.moments_since_keyframe;
        self.edits = left.edits;
        self.kept_text = left.kept_text;
        self.planned = left.planned;
        self.contacts_marked = left.contacts_marked;
        self.crack_area_m2 = left.crack_area_m2;
        self.are_cracks_growing = left.are_cracks_growing;
        self.run_error = left.run_error;
        (self.pressed_n_s, self.pressed_s, self.standing_steps) = (0.0, 0.0, 0);
    }
}
