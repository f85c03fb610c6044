//! Throwing bodies into the running scene and taking them out.

use super::super::recording::MarkKind;
use super::super::thrown::{Throw, scene_with_throw};
use super::timeline::{Done, Edit, UndoPoint};
use super::{GROUND_BODY, Run, Session, names_of};
use crate::sim::SimError;
use std::sync::Arc;

impl Session {
    pub(super) fn throw(&mut self, throw: &Throw) {
        let (Some(run), None) = (&self.run, &self.run_error) else { return };
        let made = scene_with_throw(throw, self.thrown + 1, &run.scene, &run.world);
        let weightless = run.scene.description.gravity_m_s2.length() < 1e-6;
        let what = format!("{} thrown in", throw.kind.label());
        match made {
            Ok((scene, body)) => {
                if self.edit(Done::Enter(Arc::new(scene), Box::new(body)), what) {
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
            Ok(scene) => {
                self.edit(Done::Leave(Arc::new(scene), body), format!("{name} taken out"));
            }
            Err(error) => self.tell(format!("`{name}` could not be taken out: {error}")),
        }
    }

    /// Makes an edit and remembers how to take it back.
    fn edit(&mut self, done: Done, what: String) -> bool {
        // Taking it back must not cost a long way.
        self.keep_world();
        let Some(run) = &mut self.run else { return false };
        let (time_s, edits) = (run.world.time_s(), self.edits.len());
        if let Err(error) = run.make(&done) {
            self.tell(format!("the scene stays as it is: {error}"));
            return false;
        }
        self.undo.push(UndoPoint { what: what.clone(), time_s, edits });
        self.edits.push(Edit { time_s, done });
        Arc::make_mut(&mut self.recording).mark(time_s, MarkKind::Edit, what);
        true
    }
}

impl Run {
    /// Makes an edit at the present time.
    pub(super) fn make(&mut self, done: &Done) -> Result<(), SimError> {
        match done {
            Done::Contact(contact) => self.world.set_contact_parameters(contact.clone())?,
            Done::Enter(scene, body) => {
                let index = self.world.add_body((**body).clone())?;
                self.scene = scene.clone();
                self.body_names = names_of(&self.world);
                self.take_ground_friction(index)?;
            }
            Done::Leave(scene, body) => {
                self.world.remove_body(*body);
                self.scene = scene.clone();
            }
        }
        Ok(())
    }

    /// The friction that the scene has for the newcomer; that of the ground as it is on the slider.
    fn take_ground_friction(&mut self, index: usize) -> Result<(), SimError> {
        let mut contact = self.world.setup().contact.clone();
        let pairs = &self.scene.setup.contact.pair_friction;
        let own: Vec<_> = pairs.iter().filter(|pair| pair.bodies.contains(&index)).copied().collect();
        if own.is_empty() {
            return Ok(());
        }
        let has_ground = self.scene.description.ground.is_some();
        let on_ground =
            contact.pair_friction.iter().find(|pair| has_ground && pair.bodies.contains(&GROUND_BODY));
        let now = on_ground.map(|pair| pair.friction_coefficient);
        for mut pair in own {
            if let Some(now) = now.filter(|_| pair.bodies.contains(&GROUND_BODY)) {
                pair.friction_coefficient = now;
            }
            contact.pair_friction.retain(|known| known.bodies != pair.bodies);
            contact.pair_friction.push(pair);
        }
        self.world.set_contact_parameters(contact)
    }
}
