//! Recording what was simulated, and going back into it.
//!
//! A recorded moment is only a picture. To play on from one, the last world kept before it is copied and stepped up to
//! it, with the edits that came in between: steps end where they end, whoever looks, so this gives the same bytes.

use super::super::recording::{Mark, MarkKind};
use super::course::Place;
use super::edit_tree::{Done, Edit};
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

    pub fn edits(&self) -> usize {
        self.edits
    }
}

impl Session {
    /// The frame of the present moment, made once.
    pub(super) fn renew_frame(&mut self) {
        if let Some(run) = self.course.run.as_mut().filter(|_| self.course.run_error.is_none()) {
            let is_new = self.course.frame_of
                != Some((run.world.steps(), run.world.time_s().to_bits(), self.course.edits.len()));
            if is_new {
                // It may have been interrupted on its way to a moment.
                run.world.place_free_bodies();
                let world = &run.world;
                let frame = if self.with_interior { world.publish_with_interior() } else { world.publish() };
                self.course.frame = Arc::new(frame);
                self.course.frame_of =
                    Some((run.world.steps(), run.world.time_s().to_bits(), self.course.edits.len()));
            }
        }
    }

    /// Records the present moment if it is its turn.
    pub(super) fn record(&mut self) {
        if self.course.run.is_none() || !Arc::make_mut(&mut self.course.recording).wants_next() {
            return;
        }
        self.renew_frame();
        Arc::make_mut(&mut self.course.recording).push(self.course.frame.clone(), self.course.edits.len());
        self.course.moments_since_keyframe += 1;
        if self.course.keyframes.is_empty()
            || self.course.moments_since_keyframe >= self.course.keyframe_every
        {
            self.keep_world();
        }
    }

    /// Keeps a copy of the world, and fewer of the older ones when memory runs out; the first one always stays.
    pub(super) fn keep_world(&mut self) {
        let Some(run) = &self.course.run else { return };
        self.course.moments_since_keyframe = 0;
        let bytes = run.world.memory_bytes();
        let limit = self.course.recording.world_limit_bytes();
        if !self.course.keyframes.is_empty() && bytes + self.course.keyframes[0].bytes > limit {
            return;
        }
        let (edits, thrown, time_s) = (self.course.edits.len(), self.course.thrown, run.world.time_s());
        self.course.keyframes.push(Keyframe { time_s, edits, thrown, bytes, run: run.clone() });
        self.course.keep_worlds_within(limit);
    }

    pub(super) fn set_memory_limit(&mut self, bytes: usize) {
        Arc::make_mut(&mut self.course.recording).set_limit(bytes);
        self.share_memory();
    }

    /// Marks contacts and cracks that have begun since the last moment.
    pub(super) fn note_marks(&mut self, crack_area_m2: f64) {
        let Some(run) = &self.course.run else { return };
        let episodes = run.world.contact_episodes();
        let mut marks = Vec::new();
        for episode in &episodes[self.course.contacts_marked.min(episodes.len())..] {
            let [a, b] = episode.bodies;
            if a != b {
                let [a, b] = [a, b].map(|body| run.body_names.get(body).map_or("?", String::as_str));
                marks.push((episode.begin_s, MarkKind::Contact, format!("{a} meets {b}")));
            }
        }
        self.course.contacts_marked = episodes.len();
        let is_growing = crack_area_m2 > self.course.crack_area_m2;
        if is_growing && !self.course.are_cracks_growing {
            marks.push((run.world.time_s(), MarkKind::Crack, "cracks start".to_owned()));
        }
        (self.course.are_cracks_growing, self.course.crack_area_m2) = (is_growing, crack_area_m2);
        if !marks.is_empty() {
            let (recording, edits) = (Arc::make_mut(&mut self.course.recording), self.course.edits.len());
            marks
                .into_iter()
                .for_each(|(time_s, kind, text)| recording.mark(Mark { time_s, kind, text, edits }));
        }
    }

    /// Goes back to the recorded moment at a time and stands there; what came after it is left, and can be brought back.
    pub(super) fn play_on_from(&mut self, time_s: f64, play: bool) {
        let Some(moment) = self.course.recording.at(time_s) else { return };
        let place = Place { time_s: moment.time_s, edits: moment.edits };
        self.let_go();
        if let Some(found) = self.found_again(place) {
            let end_s = self.time_s();
            if end_s > place.time_s || self.course.edits.len() > place.edits {
                let told = left_text(place.time_s, end_s, &self.course.edits.steps_after(place.edits), play);
                let fits = self.leave_time(place, format!("going on from {}", with_unit(place.time_s, "s")));
                let less = "\nMemory is short: only some of its recorded moments are kept.";
                self.mention(format!("{told}{}", if fits { "" } else { less }));
                self.way_back_told = (!play).then_some(self.commands_done + 1);
            }
            self.stand_at(place, found);
        }
        self.set_playing(play);
    }

    /// Goes back to a place in the course of the run, and forgets what came after it.
    pub(super) fn go_back(&mut self, place: Place) -> bool {
        self.let_go();
        let found = self.found_again(place);
        let is_found = found.is_some();
        found.into_iter().for_each(|found| self.stand_at(place, found));
        is_found
    }

    /// The run at a place, and how many bodies had been thrown in by then; says why where it cannot be reached.
    fn found_again(&mut self, place: Place) -> Option<(Run, usize)> {
        let found = self.run_at(place.time_s, place.edits);
        found.map_err(|error| self.tell(format!("the moment cannot be reached again: {error}"))).ok()
    }

    fn stand_at(&mut self, place: Place, (mut run, thrown): (Run, usize)) {
        let Place { time_s, edits } = place;
        let course = &mut self.course;
        course.edits.go_back_to(edits);
        // Nobody holds on from here.
        course.edits.let_go_at(time_s).iter().for_each(|pull| run.world.renew_pull(pull));
        self.looked = self.looked.take().filter(|looked| looked.is_before(time_s, edits));
        let has_contact = course.edits.iter().any(|edit| matches!(edit.done, Done::Contact(_)));
        course.contact =
            if has_contact { Some(run.world.setup().contact.clone()) } else { course.contact_given.clone() };
        course.keyframes.retain(|keyframe| place.holds(keyframe.time_s, keyframe.edits));
        course.keep_worlds_within(course.recording.world_limit_bytes());
        Arc::make_mut(&mut course.recording).cut_after(time_s, edits);
        Arc::make_mut(&mut course.history).cut_after(time_s);
        course.contacts_marked = run.world.contact_episodes().len();
        (course.crack_area_m2, course.are_cracks_growing) = (run.world.sample().crack_area_m2, false);
        (course.pressed_n_s, course.pressed_s) = (0.0, 0.0);
        course.standing_steps = 0;
        course.run_error = None;
        course.thrown = thrown;
        course.run = Some(run);
        course.frame_of = None;
        self.restart_clock();
    }

    fn keyframe_before(&self, time_s: f64, edits: usize) -> Option<&Keyframe> {
        let is_before = |keyframe: &&Keyframe| keyframe.time_s <= time_s && keyframe.edits <= edits;
        self.course.keyframes.iter().rev().find(is_before)
    }

    /// The last run that was kept before a time and so many edits, and how many bodies had been thrown in by then: not the
    /// moment itself, but who was there.
    pub(super) fn run_before(&self, time_s: f64, edits: usize) -> Option<(&Run, usize)> {
        let keyframe = self.keyframe_before(time_s, edits)?;
        let since = self.course.edits.iter().take(edits).skip(keyframe.edits);
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
        for pull in self.course.edits.iter().take(keyframe.edits).filter_map(Edit::pull) {
            run.world.renew_pull(pull);
        }
        for edit in self.course.edits.iter().take(edits).skip(keyframe.edits) {
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

/// What is left when time goes on from an earlier moment, and how it comes back.
fn left_text(from_s: f64, end_s: f64, done: &[&str], is_playing: bool) -> String {
    let changes = match done.len() {
        0 => String::new(),
        1 => format!(", and with it a later change: {}", named(done)),
        count => format!(", and with it {count} later changes: {}", named(done)),
    };
    // Otherwise something is done in their place: that has to be taken back first.
    let again = if is_playing && !done.is_empty() { " Ctrl Y does what was done in it again." } else { "" };
    let [from, end] = [from_s, end_s].map(|time_s| with_unit(time_s, "s"));
    format!(
        "From {from} on, the time up to {end} is set aside{changes}. Ctrl Z brings it back as it was.{again}"
    )
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
