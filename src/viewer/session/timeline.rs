//! Recording what was simulated, and going back into it.
//!
//! A recorded moment is only a picture. To play on from one, the last world kept before it is copied and stepped up to
//! it, with the edits that came in between: steps end where they end, whoever looks, so this gives the same bytes.

use super::super::recording::{Mark, MarkKind, Recording};
use super::edit_tree::{Done, Edit, EditTree};
use super::{Run, Session};
use crate::render::with_unit;
use crate::sim::{SimError, World};
use std::sync::Arc;

/// Of so many moments one comes with a world at first.
pub(super) const FIRST_KEYFRAME_EVERY: u32 = 40;

/// A world to play on from.
pub(super) struct Keyframe {
    time_s: f64,
    /// How many edits it has seen.
    edits: usize,
    thrown: usize,
    bytes: usize,
    run: Run,
}

impl Keyframe {
    pub fn time_s(&self) -> f64 {
        self.time_s
    }
}

impl Session {
    /// The frame of the present moment, made once.
    pub(super) fn renew_frame(&mut self) {
        if let Some(run) = self.run.as_mut().filter(|_| self.run_error.is_none()) {
            let is_new =
                self.frame_of != Some((run.world.steps(), run.world.time_s().to_bits(), self.edits.len()));
            if is_new {
                // It may have been interrupted on its way to a moment.
                run.world.place_free_bodies();
                let world = &run.world;
                let frame = if self.with_interior { world.publish_with_interior() } else { world.publish() };
                self.frame = Arc::new(frame);
                self.frame_of = Some((run.world.steps(), run.world.time_s().to_bits(), self.edits.len()));
            }
        }
    }

    /// Records the present moment if it is its turn.
    pub(super) fn record(&mut self) {
        if self.run.is_none() || !Arc::make_mut(&mut self.recording).wants_next() {
            return;
        }
        self.renew_frame();
        Arc::make_mut(&mut self.recording).push(self.frame.clone(), self.edits.len());
        self.moments_since_keyframe += 1;
        if self.keyframes.is_empty() || self.moments_since_keyframe >= self.keyframe_every {
            self.keep_world();
        }
    }

    /// Keeps a copy of the world, and fewer of the older ones when memory runs out; the first one always stays.
    pub(super) fn keep_world(&mut self) {
        let Some(run) = &self.run else { return };
        self.moments_since_keyframe = 0;
        let bytes = run.world.memory_bytes();
        let limit = self.recording.world_limit_bytes();
        if !self.keyframes.is_empty() && bytes + self.keyframes[0].bytes > limit {
            return;
        }
        let (edits, thrown, time_s) = (self.edits.len(), self.thrown, run.world.time_s());
        self.keyframes.push(Keyframe { time_s, edits, thrown, bytes, run: run.clone() });
        self.keep_worlds_within(limit);
    }

    pub(super) fn keep_worlds_within(&mut self, limit_bytes: usize) {
        let (halvings, world_bytes) = thin_worlds(&mut self.keyframes, limit_bytes);
        self.keyframe_every = self.keyframe_every.saturating_mul(1 << halvings.min(16));
        Arc::make_mut(&mut self.recording).world_bytes = world_bytes;
    }

    pub(super) fn set_memory_limit(&mut self, bytes: usize) {
        Arc::make_mut(&mut self.recording).set_limit(bytes);
        self.share_memory();
    }

    pub(super) fn forget_recording(&mut self) {
        self.recording = Arc::new(Recording::with_limit(self.recording.limit_bytes()));
        self.keyframes.clear();
        self.keyframe_every = FIRST_KEYFRAME_EVERY;
        self.moments_since_keyframe = 0;
        self.edits = EditTree::default();
        self.redoing = None;
        self.hand = None;
        self.frame_of = None;
        self.looked = None;
        (self.contacts_marked, self.crack_area_m2, self.are_cracks_growing) = (0, 0.0, false);
    }

    /// Marks contacts and cracks that have begun since the last moment.
    pub(super) fn note_marks(&mut self, crack_area_m2: f64) {
        let Some(run) = &self.run else { return };
        let episodes = run.world.contact_episodes();
        let mut marks = Vec::new();
        for episode in &episodes[self.contacts_marked.min(episodes.len())..] {
            let [a, b] = episode.bodies;
            if a != b {
                let [a, b] = [a, b].map(|body| run.body_names.get(body).map_or("?", String::as_str));
                marks.push((episode.begin_s, MarkKind::Contact, format!("{a} meets {b}")));
            }
        }
        self.contacts_marked = episodes.len();
        let is_growing = crack_area_m2 > self.crack_area_m2;
        if is_growing && !self.are_cracks_growing {
            marks.push((run.world.time_s(), MarkKind::Crack, "cracks start".to_owned()));
        }
        (self.are_cracks_growing, self.crack_area_m2) = (is_growing, crack_area_m2);
        if !marks.is_empty() {
            let (recording, edits) = (Arc::make_mut(&mut self.recording), self.edits.len());
            marks
                .into_iter()
                .for_each(|(time_s, kind, text)| recording.mark(Mark { time_s, kind, text, edits }));
        }
    }

    /// Goes back to the recorded moment at a time and stands there.
    pub(super) fn play_on_from(&mut self, time_s: f64, play: bool) {
        let Some((time_s, edits)) = self.recording.at(time_s).map(|m| (m.time_s, m.edits)) else { return };
        self.let_go();
        let told = dropped_text(time_s, &self.edits.steps_after(edits), play);
        if self.go_back(time_s, edits)
            && let Some(told) = told
        {
            self.mention(told);
        }
        self.set_playing(play);
    }

    /// Goes back to a time at which so many edits had been made.
    pub(super) fn go_back(&mut self, time_s: f64, edits: usize) -> bool {
        self.let_go();
        let (mut run, thrown) = match self.run_at(time_s, edits) {
            Ok(found) => found,
            Err(error) => {
                self.tell(format!("the moment cannot be reached again: {error}"));
                return false;
            }
        };
        self.edits.go_back_to(edits);
        // Nobody holds on from here.
        self.edits.let_go_at(time_s).iter().for_each(|pull| run.world.renew_pull(pull));
        self.looked = self.looked.take().filter(|looked| looked.is_before(time_s, edits));
        let has_contact = self.edits.iter().any(|edit| matches!(edit.done, Done::Contact(_)));
        self.contact =
            if has_contact { Some(run.world.setup().contact.clone()) } else { self.contact_given.clone() };
        self.keyframes.retain(|keyframe| keyframe.time_s <= time_s && keyframe.edits <= edits);
        self.keep_worlds_within(self.recording.world_limit_bytes());
        Arc::make_mut(&mut self.recording).cut_after(time_s, edits);
        Arc::make_mut(&mut self.history).cut_after(time_s);
        self.contacts_marked = run.world.contact_episodes().len();
        (self.crack_area_m2, self.are_cracks_growing) = (run.world.sample().crack_area_m2, false);
        (self.pressed_n_s, self.pressed_s) = (0.0, 0.0);
        self.standing_steps = 0;
        self.run_error = None;
        self.thrown = thrown;
        self.run = Some(run);
        self.frame_of = None;
        self.restart_clock();
        true
    }

    fn keyframe_before(&self, time_s: f64, edits: usize) -> Option<&Keyframe> {
        let is_before = |keyframe: &&Keyframe| keyframe.time_s <= time_s && keyframe.edits <= edits;
        self.keyframes.iter().rev().find(is_before)
    }

    /// The last run that was kept before a time and so many edits, and how many bodies had been thrown in by then: not the
    /// moment itself, but who was there.
    pub(super) fn run_before(&self, time_s: f64, edits: usize) -> Option<(&Run, usize)> {
        let keyframe = self.keyframe_before(time_s, edits)?;
        let since = self.edits.iter().take(edits).skip(keyframe.edits);
        let thrown = since.filter(|edit| matches!(edit.done, Done::Enter(..))).count();
        Some((&keyframe.run, keyframe.thrown + thrown))
    }

    /// The run at a time, after so many edits.
    pub(super) fn run_at(&self, time_s: f64, edits: usize) -> Result<(Run, usize), SimError> {
        let Some(keyframe) = self.keyframe_before(time_s, edits) else {
            return Err(SimError::Setup("nothing of it is in memory".to_owned()));
        };
        let mut run = keyframe.run.clone();
        let mut thrown = keyframe.thrown;
        // A world that was kept during a pull knows its path up to then.
        for pull in self.edits.iter().take(keyframe.edits).filter_map(Edit::pull) {
            run.world.renew_pull(pull);
        }
        for edit in self.edits.iter().take(edits).skip(keyframe.edits) {
            step_to(&mut run.world, edit.time_s)?;
            thrown += usize::from(matches!(edit.done, Done::Enter(..)));
            run.make(&edit.done)?;
        }
        step_to(&mut run.world, time_s)?;
        Ok((run, thrown))
    }
}

/// Leaves out every second world, but never the first one, until they fit; returns how often, and what is left, bytes.
pub(super) fn thin_worlds(keyframes: &mut Vec<Keyframe>, limit_bytes: usize) -> (u32, usize) {
    let sum = |keyframes: &[Keyframe]| keyframes.iter().map(|k| k.bytes).sum::<usize>();
    let mut halvings = 0;
    while sum(keyframes) > limit_bytes && keyframes.len() > 1 {
        let mut is_kept = false;
        keyframes.retain(|_| {
            is_kept = !is_kept;
            is_kept
        });
        halvings += 1;
    }
    (halvings, sum(keyframes))
}

fn dropped_text(time_s: f64, dropped: &[&str], is_playing: bool) -> Option<String> {
    let (changes, again) = match dropped.len() {
        0 => return None,
        1 => ("one later change".to_owned(), "does it again, at its time"),
        count => (format!("{count} later changes"), "does them again one by one, each at its time"),
    };
    // Otherwise something is done in their place: that has to be taken back first.
    let keys = if is_playing { "Ctrl Y" } else { "Ctrl Z, then Ctrl Shift Y" };
    Some(format!(
        "Going on from {} drops {changes}: {}. {keys} {again}.",
        with_unit(time_s, "s"),
        named(dropped)
    ))
}

/// The first of some things, in words.
pub(super) fn named(things: &[&str]) -> String {
    const MOST_NAMED: usize = 3;
    let more = if things.len() > MOST_NAMED { ", …" } else { "" };
    format!("{}{more}", things[..things.len().min(MOST_NAMED)].join(", "))
}

pub(super) fn step_to(world: &mut World, time_s: f64) -> Result<(), SimError> {
    while world.time_s() < time_s {
        world.step(time_s)?;
    }
    Ok(())
}
