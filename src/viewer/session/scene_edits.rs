//! Throwing bodies into the running scene and taking them out.

use super::super::recording::{Mark, MarkKind};
use super::super::thrown::{Throw, scene_with_throw};
use super::edit_tree::{Done, Edit};
use super::{Run, Session, names_of};
use crate::sim::SimError;
use std::sync::Arc;

impl Session {
    pub(super) fn throw(&mut self, throw: &Throw) {
        let (Some(run), None) = (&self.run, &self.run_error) else { return };
        let made = scene_with_throw(throw, self.thrown + 1, &run.scene, &run.world);
        let weightless = run.scene.description.gravity_m_s2.length() < 1e-6;
        let what = format!("{} thrown in", throw.kind.label());
        match made {
            Ok((scene, entrance, text)) => {
                if self.edit(Done::Enter(Arc::new(scene), Arc::new(entrance), text), what) {
                    self.thrown += 1;
                }
            }
            Err(reason) => return self.tell(format!("nothing was thrown: {reason}")),
        }
        if weightless && throw.placing == super::super::thrown::Placing::Above {
            self.tell("There is no gravity in this scene: what is dropped stays where it is.".to_owned());
        }
    }

    pub(super) fn remove(&mut self, body: usize) {
        let (Some(run), None) = (&self.run, &self.run_error) else { return };
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
            self.edits.push(edit.clone());
            self.mark_edit(edit);
        }
        is_made
    }

    /// Makes what redo has to make, at the time that it is.
    pub(super) fn make_next(&mut self) -> bool {
        let Some(edit) = self.edits.next().cloned() else { return false };
        let is_made = self.make(&edit);
        if is_made {
            self.edits.go_on();
            self.thrown += usize::from(matches!(edit.done, Done::Enter(..)));
            self.mark_edit(edit);
        }
        is_made
    }

    fn make(&mut self, edit: &Edit) -> bool {
        if self.edits.would_begin_step(edit) && self.run_error.is_none() {
            // Taking it back must not cost a long way. A world that failed is nothing to go back to.
            self.keep_world();
        }
        let Some(run) = &mut self.run else { return false };
        match run.make(&edit.done) {
            Ok(()) => {
                if let Done::Contact(_) = edit.done {
                    self.contact = Some(run.world.setup().contact.clone());
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
        let mark = Mark { time_s, kind: MarkKind::Edit, text: what, edits: self.edits.len() };
        Arc::make_mut(&mut self.recording).mark(mark);
    }
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
