//! Recording what was simulated, and going back into it.
//!
//! A recorded moment is only a picture. To play on from one, the last world kept before it is copied and stepped up to
//! it, with the edits that came in between: steps end where they end, whoever looks, so this gives the same bytes.

use super::super::recording::{Mark, MarkKind, Recording};
use super::{Run, Session};
use crate::render::with_unit;
use crate::scene::Scene;
use crate::scene::{contact_change_text, pull_text};
use crate::sim::{ContactChange, Entrance, Pull, SimError, World};
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

/// What was done to the running scene.
#[derive(Clone)]
pub(super) enum Done {
    Contact(ContactChange),
    /// The scene with the newcomer, that body, and what was added to the scene's text.
    Enter(Arc<Scene>, Arc<Entrance>, String),
    /// The scene without the body, its number, and what was added to the scene's text.
    Leave(Arc<Scene>, usize, String),
    /// Grows while the mouse holds the body.
    Pull(Pull),
}

/// An edit and its time.
#[derive(Clone)]
pub(super) struct Edit {
    pub time_s: f64,
    pub done: Done,
}

impl Edit {
    pub fn pull(&mut self) -> Option<&mut Pull> {
        if let Done::Pull(pull) = &mut self.done { Some(pull) } else { None }
    }
}

/// What edits add to the text of a scene; those `in_scene` add what has come into the scene of the run already.
pub(super) fn text_of(edits: &[Edit], now_s: f64, in_scene: bool) -> String {
    let mut text = String::new();
    let mut add = |more: &str| {
        text.push_str(more);
        text.push('\n');
    };
    let mut contact: Option<(f64, ContactChange)> = None;
    for edit in edits {
        match &edit.done {
            Done::Contact(change) => match &mut contact {
                Some((time_s, known)) if *time_s == edit.time_s => known.merge(change.clone()),
                _ => {
                    let before = contact.replace((edit.time_s, change.clone()));
                    before
                        .into_iter()
                        .for_each(|(time_s, change)| add(&contact_change_text(&change, time_s)));
                }
            },
            Done::Enter(_, _, own) | Done::Leave(_, _, own) if in_scene => add(own),
            Done::Pull(pull) if now_s > pull.begins_s() => {
                // One that still pulls is seen up to now.
                add(&pull_text(&Pull { until_s: pull.until_s.min(now_s), ..pull.clone() }));
            }
            Done::Enter(..) | Done::Leave(..) | Done::Pull(_) => {}
        }
    }
    contact.into_iter().for_each(|(time_s, change)| add(&contact_change_text(&change, time_s)));
    text
}

/// Where an edit can be taken back to.
pub(super) struct UndoPoint {
    /// What was done, in words.
    pub what: String,
    pub time_s: f64,
    /// Edits before it.
    pub edits: usize,
    /// What could be done again when it was done, and comes later: it can again once this is taken back.
    pub later: Vec<RedoPoint>,
}

/// An edit that was taken back and can be made again.
pub(super) struct RedoPoint {
    /// What was done, in words.
    pub what: String,
    pub edit: Edit,
}

impl Edit {
    /// What was done, in words, for what has no point to go back to.
    fn words(&self) -> String {
        match &self.done {
            Done::Contact(_) => "contact changed".to_owned(),
            Done::Enter(_, entrance, _) => format!("{} thrown in", entrance.body.name),
            Done::Leave(..) => "a body taken out".to_owned(),
            Done::Pull(pull) => format!("{} pulled", pull.body),
        }
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

    fn keep_worlds_within(&mut self, limit_bytes: usize) {
        let sum = |keyframes: &[Keyframe]| keyframes.iter().map(|k| k.bytes).sum::<usize>();
        while sum(&self.keyframes) > limit_bytes && self.keyframes.len() > 1 {
            let mut is_kept = false;
            self.keyframes.retain(|_| {
                is_kept = !is_kept;
                is_kept
            });
            self.keyframe_every = self.keyframe_every.saturating_mul(2);
        }
        Arc::make_mut(&mut self.recording).world_bytes = sum(&self.keyframes);
    }

    pub(super) fn set_memory_limit(&mut self, bytes: usize) {
        Arc::make_mut(&mut self.recording).set_limit(bytes);
        self.keep_worlds_within(self.recording.world_limit_bytes());
    }

    pub(super) fn forget_recording(&mut self) {
        self.recording = Arc::new(Recording::with_limit(self.recording.limit_bytes()));
        self.keyframes.clear();
        self.keyframe_every = FIRST_KEYFRAME_EVERY;
        self.moments_since_keyframe = 0;
        self.edits.clear();
        self.undo.clear();
        self.redo.clear();
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
        let dropped = self.edits_after(edits);
        if self.go_back(time_s, edits) {
            // The first of them is done again first.
            self.redo = dropped.into_iter().rev().collect();
            if !self.redo.is_empty() {
                self.mention(dropped_text(time_s, &self.redo, play));
            }
        }
        self.set_playing(play);
    }

    /// What was done after so many edits, to be done again.
    fn edits_after(&self, edits: usize) -> Vec<RedoPoint> {
        let point = |(index, edit): (usize, &Edit)| {
            let known = self.undo.iter().find(|point| point.edits == index);
            let what = known.map_or_else(|| edit.words(), |point| point.what.clone());
            RedoPoint { what, edit: edit.clone() }
        };
        self.edits.iter().enumerate().skip(edits).map(point).collect()
    }

    /// Takes the last throw, removal or pull back.
    pub(super) fn undo_last(&mut self) {
        self.let_go();
        let Some(point) = self.undo.pop() else { return };
        let was_playing = self.is_playing;
        let edit = self.edits.get(point.edits).cloned();
        if self.go_back(point.time_s, point.edits) {
            if !point.later.is_empty() {
                self.redo = point.later;
            }
            self.redo.extend(edit.map(|edit| RedoPoint { what: point.what.clone(), edit }));
            self.mention(format!("Taken back: {}. The scene is where it was then.", point.what));
        }
        self.set_playing(was_playing);
    }

    /// Makes the edit again that was taken back last, at its own time.
    pub(super) fn redo_last(&mut self) {
        self.let_go();
        let Some(RedoPoint { what, edit }) = self.redo.pop() else { return };
        let was_playing = self.is_playing;
        let thrown = usize::from(matches!(edit.done, Done::Enter(..)));
        // What was dropped comes after the present: time goes there first, and is recorded on the way.
        let is_there = match edit.time_s > self.time_s() {
            true => self.simulate_to(edit.time_s),
            false => self.go_back(edit.time_s, self.edits.len()),
        };
        if is_there {
            // The edit is one of them and not another that makes them void.
            let others = std::mem::take(&mut self.redo);
            self.thrown += thrown * usize::from(self.edit(edit.done, what.clone()));
            self.redo = others;
            self.mention(format!("Done again: {what}."));
        }
        self.set_playing(was_playing);
    }

    pub(super) fn go_back(&mut self, time_s: f64, edits: usize) -> bool {
        self.let_go();
        let (mut run, thrown) = match self.run_at(time_s, edits) {
            Ok(found) => found,
            Err(error) => {
                self.tell(format!("the moment cannot be reached again: {error}"));
                return false;
            }
        };
        self.edits.truncate(edits);
        // Nobody holds on from here.
        for pull in self.edits.iter_mut().filter_map(Edit::pull).filter(|pull| pull.until_s > time_s) {
            pull.until_s = time_s;
            run.world.renew_pull(pull);
        }
        self.undo.retain(|point| point.edits < edits);
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

    /// The run at a time, after so many edits.
    pub(super) fn run_at(&self, time_s: f64, edits: usize) -> Result<(Run, usize), SimError> {
        let is_before = |keyframe: &&Keyframe| keyframe.time_s <= time_s && keyframe.edits <= edits;
        let keyframe = self.keyframes.iter().rev().find(is_before);
        let Some(keyframe) = keyframe else {
            return Err(SimError::Setup("nothing of it is in memory".to_owned()));
        };
        let mut run = keyframe.run.clone();
        let mut thrown = keyframe.thrown;
        // A world that was kept during a pull knows its path up to then.
        let pulls = self.edits[..keyframe.edits.min(self.edits.len())].iter();
        for pull in pulls.filter_map(|edit| if let Done::Pull(pull) = &edit.done { Some(pull) } else { None })
        {
            run.world.renew_pull(pull);
        }
        for edit in &self.edits[keyframe.edits..edits.min(self.edits.len())] {
            step_to(&mut run.world, edit.time_s)?;
            thrown += usize::from(matches!(edit.done, Done::Enter(..)));
            run.make(&edit.done)?;
        }
        step_to(&mut run.world, time_s)?;
        Ok((run, thrown))
    }
}

/// `dropped` begins with the last one.
fn dropped_text(time_s: f64, dropped: &[RedoPoint], is_playing: bool) -> String {
    const MOST_NAMED: usize = 3;
    let names: Vec<&str> = dropped.iter().rev().take(MOST_NAMED).map(|point| point.what.as_str()).collect();
    let more = if dropped.len() > MOST_NAMED { ", …" } else { "" };
    let (changes, them) = match dropped.len() {
        1 => ("one later change".to_owned(), "does it again, at its time"),
        count => (format!("{count} later changes"), "does them again one by one, each at its time"),
    };
    let undo = if is_playing { "Ctrl Y" } else { "Once this is taken back (Ctrl Z), Ctrl Y" };
    format!(
        "Going on from {} drops {changes}: {}{more}. {undo} {them}.",
        with_unit(time_s, "s"),
        names.join(", ")
    )
}

pub(super) fn step_to(world: &mut World, time_s: f64) -> Result<(), SimError> {
    while world.time_s() < time_s {
        world.step(time_s)?;
    }
    Ok(())
}
