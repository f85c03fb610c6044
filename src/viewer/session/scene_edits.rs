//! Throwing bodies into the running scene and taking them out.

use super::super::foresight::Foreseen;
use super::super::recording::{Mark, MarkKind};
use super::super::thrown::{Placing, Throw, scene_with_throw};
use super::edit_tree::{Done, Edit};
use super::{Run, Session, names_of};
use crate::render::with_unit;
use crate::sim::SimError;
use glam::DVec3;
use std::sync::Arc;

impl Session {
    pub(super) fn throw(&mut self, throw: &Throw) {
        let (Some(run), None) = (&self.course.run, &self.course.run_error) else { return };
        let made = scene_with_throw(throw, self.course.thrown + 1, &run.scene, &run.world);
        let weightless = run.scene.description.gravity_m_s2.length() < 1e-6;
        let what = format!("{} thrown in", throw.kind.label());
        match made {
            Ok((scene, entrance, text)) => {
                let asked_m = lowest_m(&entrance.body.mesh.nodes_m);
                if !self.edit(Done::Enter(Arc::new(scene), Arc::new(entrance), text), what) {
                    return;
                }
                self.course.thrown += 1;
                self.mention_start(throw, asked_m);
            }
            Err(reason) => return self.tell(format!("nothing was thrown: {reason}")),
        }
        if weightless && matches!(throw.placing, Placing::Above { .. }) {
            self.tell("There is no gravity in this scene: what is dropped stays where it is.".to_owned());
        }
    }

    /// Says so where a body could not start at the place that was chosen for it, or is not seen to do anything.
    fn mention_start(&mut self, throw: &Throw, asked_m: f64) {
        let Some(world) = self.course.run.as_ref().map(|run| &run.world) else { return };
        let nodes_m = world.positions_m(world.body_count() - 1);
        let lowest_m = lowest_m(nodes_m);
        let lift_m = lowest_m - asked_m;
        let told = match throw.placing {
            Placing::From { .. } if lift_m > 0.0 => {
                format!("thrown in. It starts {} higher, clear of what is there", with_unit(lift_m, "m"))
            }
            Placing::From { .. } => return,
            Placing::Above { top_m } => {
                let highest_m = nodes_m.iter().map(|x| x.z).fold(lowest_m, f64::max);
                let is_seen = top_m.is_some_and(|top_m| lowest_m < top_m);
                // But for the digits that places are rounded to.
                let is_whole = top_m.is_some_and(|top_m| highest_m < top_m + 0.01 * (highest_m - lowest_m));
                match (is_seen, self.is_playing) {
                    (true, false) if !is_whole => {
                        "waits above the picture, in part: F shows all of it, play (Space) lets it fall"
                            .to_owned()
                    }
                    (true, true) => return,
                    (true, false) => "waits above. Play (Space) lets it fall".to_owned(),
                    (false, true) => "falls from above the picture. F shows everything".to_owned(),
                    (false, false) => {
                        "waits above the picture: F shows it, play (Space) lets it fall".to_owned()
                    }
                }
            }
        };
        self.mention(format!("{} {told}.", throw.kind.label()));
    }

    /// Builds what a throw into a moment would bring in; nothing, where it cannot be made: throwing it says why.
    pub(super) fn foresee(&mut self, number: u64, throw: &Throw, time_s: Option<f64>) {
        self.foreseen = None;
        let Placing::From { position_m, .. } = throw.placing else { return };
        let then = time_s
            .and_then(|time_s| self.course.recording.at(time_s))
            .map(|moment| (moment.time_s, moment.edits));
        let (run, thrown) = match then {
            None => (self.course.run.as_ref(), self.course.thrown),
            Some((time_s, edits)) => {
                self.run_before(time_s, edits).map_or((None, 0), |(run, n)| (Some(run), n))
            }
        };
        let Some(run) = run else { return };
        if let Ok((_, entrance, _)) = scene_with_throw(throw, thrown + 1, &run.scene, &run.world) {
            self.foreseen = Some(Arc::new(Foreseen::new(number, throw, position_m, &entrance.body)));
        }
    }

    pub(super) fn remove(&mut self, body: usize) {
        let (Some(run), None) = (&self.course.run, &self.course.run_error) else { return };
        let Some(name) = run.body_names.get(body).filter(|_| !run.world.is_removed(body)) else { return };
        let name = name.clone();
        if run.scene.entry_of(&name).is_none() {
            return self.tell(format!("`{name}` stays: only the scene's bodies can be taken out."));
        }
        match run.scene.with_removal(&name, run.world.time_s()) {
            Ok((scene, text)) => {
                self.edit(Done::Leave(Arc::new(scene), body, text), format!("{name} taken out"));
            }
            Err(error) => self.tell(format!("`{name}` could not be taken out: {error}")),
        }
    }

    /// Makes an edit, which can be taken back.
    pub(super) fn edit(&mut self, done: Done, what: String) -> bool {
        self.let_go();
        let edit = Edit { time_s: self.time_s(), done, what };
        let is_made = self.make(&edit);
        if is_made {
            self.course.edits.push(edit.clone());
            self.mark_edit(edit);
        }
        is_made
    }

    /// Makes what redo has to make, at the time that it is.
    pub(super) fn make_next(&mut self) -> bool {
        let Some(edit) = self.course.edits.next().cloned() else { return false };
        let is_made = self.make(&edit);
        if is_made {
            self.course.edits.go_on();
            self.course.thrown += usize::from(matches!(edit.done, Done::Enter(..)));
            self.mark_edit(edit);
        }
        is_made
    }

    fn make(&mut self, edit: &Edit) -> bool {
        if self.course.edits.would_begin_step(edit) && self.course.run_error.is_none() {
            // Taking it back must not cost a long way. A world that failed is nothing to go back to.
            self.keep_world();
        }
        let Some(run) = &mut self.course.run else { return false };
        match run.make(&edit.done) {
            Ok(()) => {
                if let Done::Contact(_) = edit.done {
                    self.course.contact = Some(run.world.setup().contact.clone());
                }
                true
            }
            Err(error) => {
                self.tell(format!("the scene stays as it is: {error}"));
                false
            }
        }
    }

    fn mark_edit(&mut self, edit: Edit) {
        if matches!(edit.done, Done::Contact(_)) {
            return;
        }
        let Edit { time_s, what, .. } = edit;
        let mark = Mark { time_s, kind: MarkKind::Edit, text: what, edits: self.course.edits.len() };
        Arc::make_mut(&mut self.course.recording).mark(mark);
    }
}

fn lowest_m(nodes_m: &[DVec3]) -> f64 {
    nodes_m.iter().map(|x| x.z).fold(f64::INFINITY, f64::min)
}

impl Run {
    /// Makes an edit at the present time, after what the scene has planned for it.
    pub(super) fn make(&mut self, done: &Done) -> Result<(), SimError> {
        self.world.catch_up()?;
        match done {
            Done::Contact(change) => self.world.change_contact(change)?,
            Done::Enter(scene, entrance, _) => {
                self.world.enter(entrance)?;
                self.scene = scene.clone();
            }
            Done::Leave(scene, body, _) => {
                self.world.remove_body(*body)?;
                self.scene = scene.clone();
            }
            Done::Pull(pull) => self.world.pull(pull)?,
        }
        self.renew_names();
        Ok(())
    }

    /// Somebody may have come in.
    pub(super) fn renew_names(&mut self) {
        if self.body_names.len() != self.world.body_count() {
            self.body_names = names_of(&self.world);
        }
    }
}
