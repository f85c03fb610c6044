//! The course of a run: where it stands, and all that is known of how it came there. A reset begins another one, and
//! going on from an earlier moment another end of the same.

use super::super::history::History;
use super::super::recording::{Mark, Recording};
use super::Run;
use super::edit_tree::EditTree;
use super::timeline::{FIRST_KEYFRAME_EVERY, Keyframe, thin_worlds};
use crate::frame::Frame;
use crate::sim::ContactParameters;
use std::sync::Arc;

/// Everything about a run that begins anew with a reset.
pub(super) struct Course {
    pub run: Option<Run>,
    /// Contact set by the user, to be kept over resets.
    pub contact: Option<ContactParameters>,
    /// What of it was there when the world was built.
    pub contact_given: Option<ContactParameters>,
    /// Time up to which playing hurries, s: where the scene's recording starts.
    pub run_up_end_s: f64,
    pub frame: Arc<Frame>,
    /// Steps, time and edits that `frame` shows.
    pub frame_of: Option<(u64, u64, usize)>,
    pub history: Arc<History>,
    /// Impulse and time since the last row of the history.
    pub pressed_n_s: f64,
    pub pressed_s: f64,
    pub standing_steps: u32,
    pub thrown: usize,
    pub recording: Arc<Recording>,
    /// Worlds to play on from, in the order of time.
    pub keyframes: Vec<Keyframe>,
    /// Of so many recorded moments one comes with a world.
    pub keyframe_every: u32,
    pub moments_since_keyframe: u32,
    /// What was changed in the running scene.
    pub edits: EditTree,
    /// What earlier edits added to the scene's text that a reset kept.
    pub kept_text: String,
    /// What the scene as it was built has in store.
    pub planned: Arc<[Mark]>,
    /// Contacts that have a mark already.
    pub contacts_marked: usize,
    pub crack_area_m2: f64,
    pub are_cracks_growing: bool,
    pub run_error: Option<String>,
}

/// A moment in the course of a run: its time, s, and how many edits came before it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Place {
    pub time_s: f64,
    pub edits: usize,
}

impl Place {
    /// Whether something at a time, after so many edits, belongs to what led here.
    pub fn holds(self, time_s: f64, edits: usize) -> bool {
        time_s <= self.time_s && edits <= self.edits
    }
}

impl Default for Course {
    fn default() -> Self {
        Self::with_limit(Recording::default().limit_bytes())
    }
}

impl Course {
    /// Nothing yet, with a limit of memory for what is recorded.
    pub fn with_limit(limit_bytes: usize) -> Self {
        Self {
            run: None,
            contact: None,
            contact_given: None,
            run_up_end_s: 0.0,
            frame: Arc::default(),
            frame_of: None,
            history: Arc::default(),
            pressed_n_s: 0.0,
            pressed_s: 0.0,
            standing_steps: 0,
            thrown: 0,
            recording: Arc::new(Recording::with_limit(limit_bytes)),
            keyframes: Vec::new(),
            keyframe_every: FIRST_KEYFRAME_EVERY,
            moments_since_keyframe: 0,
            edits: EditTree::default(),
            kept_text: String::new(),
            planned: Arc::default(),
            contacts_marked: 0,
            crack_area_m2: 0.0,
            are_cracks_growing: false,
            run_error: None,
        }
    }

    /// One that begins anew after this: contact, and what is kept of what was done, goes on.
    pub fn anew(&self) -> Self {
        Self {
            contact: self.contact.clone(),
            thrown: self.thrown,
            kept_text: self.kept_text.clone(),
            frame: self.frame.clone(),
            ..Self::with_limit(self.recording.limit_bytes())
        }
    }

    /// Memory of what is recorded and of the world at its end, bytes.
    pub fn bytes(&self) -> usize {
        let world = self.run.as_ref().map_or(0, |run| run.world.memory_bytes());
        self.recording.own_bytes() + world
    }

    /// Time where it stands, s.
    pub fn time_s(&self) -> f64 {
        self.run.as_ref().map_or(0.0, |run| run.world.time_s())
    }

    /// Makes do with so much memory, as far as that goes.
    pub fn keep_within(&mut self, bytes: usize) {
        let recording = Arc::make_mut(&mut self.recording);
        recording.reserved_bytes = 0;
        recording.set_limit(bytes);
        let limit_bytes = recording.world_limit_bytes();
        self.keep_worlds_within(limit_bytes);
    }

    /// Keeps fewer worlds to play on from, until they fit.
    pub fn keep_worlds_within(&mut self, limit_bytes: usize) {
        let (halvings, world_bytes) = thin_worlds(&mut self.keyframes, limit_bytes);
        self.keyframe_every = self.keyframe_every.saturating_mul(1 << halvings.min(16));
        Arc::make_mut(&mut self.recording).world_bytes = world_bytes;
    }

    /// Takes what came after a place out of it, with the end that it leads to, and moves it: nothing is kept twice. What is left
    /// has no end, but all of the edits.
    pub fn split_off(&mut self, place: Place) -> Self {
        let mut later = std::mem::replace(self, Self::with_limit(self.recording.limit_bytes()));
        let recorded = Arc::make_mut(&mut later.recording).split_off(place.time_s, place.edits);
        self.recording = std::mem::replace(&mut later.recording, Arc::new(recorded));
        let rows = Arc::make_mut(&mut later.history).split_off(place.time_s);
        self.history = std::mem::replace(&mut later.history, Arc::new(rows));
        let is_kept = |keyframe: &Keyframe| place.holds(keyframe.time_s(), keyframe.edits());
        (self.keyframes, later.keyframes) =
            std::mem::take(&mut later.keyframes).into_iter().partition(is_kept);
        self.keep_worlds_within(usize::MAX);
        later.keep_worlds_within(usize::MAX);
        self.edits = std::mem::take(&mut later.edits);
        self.contact_given.clone_from(&later.contact_given);
        self.kept_text.clone_from(&later.kept_text);
        (self.planned, self.frame) = (later.planned.clone(), later.frame.clone());
        (self.run_up_end_s, self.keyframe_every) = (later.run_up_end_s, later.keyframe_every);
        later
    }

    /// Puts what was split off back behind what it followed.
    pub fn following(self, before: Self) -> Self {
        let mut recording = before.recording;
        let together = Arc::make_mut(&mut recording);
        // What was left has no part of the memory any more.
        together.reserved_bytes = 0;
        together.append(&self.recording);
        let mut history = before.history;
        Arc::make_mut(&mut history).append(&self.history);
        let mut keyframes = before.keyframes;
        keyframes.extend(self.keyframes);
        let keyframe_every = self.keyframe_every.max(before.keyframe_every);
        Self { recording, history, keyframes, keyframe_every, edits: before.edits, ..self }
    }
}
