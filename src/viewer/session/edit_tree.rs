//! What was done to the running scene, as a tree: time that goes back leaves what came after, and what is done then
//! begins another branch.
//!
//! An edit hangs on those before it: a scene with a newcomer is the scene before and that body. So it can only be made
//! again after the same bodies came and went. Changes of contact and pulls are none of the scene's bodies: what could
//! be made again before one of them can be after it.

use crate::scene::Scene;
use crate::scene::{contact_change_text, pull_text};
use crate::sim::{ContactChange, Entrance, Pull};
use std::sync::Arc;

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

impl Done {
    fn changes_who_is_there(&self) -> bool {
        matches!(self, Self::Enter(..) | Self::Leave(..))
    }
}

/// An edit and its time.
#[derive(Clone)]
pub(super) struct Edit {
    pub time_s: f64,
    pub done: Done,
    /// What was done, in words.
    pub what: String,
}

impl Edit {
    pub fn pull(&self) -> Option<&Pull> {
        if let Done::Pull(pull) = &self.done { Some(pull) } else { None }
    }

    fn pull_mut(&mut self) -> Option<&mut Pull> {
        if let Done::Pull(pull) = &mut self.done { Some(pull) } else { None }
    }

    /// Whether it moves the slider on that the edit before it moved.
    fn goes_on_from(&self, before: &Self) -> bool {
        let (Done::Contact(now), Done::Contact(then)) = (&self.done, &before.done) else { return false };
        let names = |change: &ContactChange| {
            let bodies: Vec<String> = change.body_friction.iter().map(|(name, _)| name.clone()).collect();
            let pairs: Vec<[String; 2]> = change.pairs.iter().map(|(pair, _)| pair.clone()).collect();
            (bodies, pairs)
        };
        let values = |change: &ContactChange| {
            [
                change.friction_coefficient.is_some(),
                change.self_collision.is_some(),
                change.rest_speed_m_s.is_some(),
                change.method.is_some(),
            ]
        };
        values(now) == values(then) && names(now) == names(then)
    }
}

/// An edit, and those that followed it: the last of them is what redo makes.
struct Node {
    edit: Edit,
    then: Vec<usize>,
}

/// All that was done to the running scene since its start.
#[derive(Default)]
pub(super) struct EditTree {
    nodes: Vec<Node>,
    /// What followed the start.
    start: Vec<usize>,
    /// From the start to the present.
    path: Vec<usize>,
    /// So many at the start came with the scene: they cannot be taken back.
    given: usize,
}

impl EditTree {
    /// Edits up to the present.
    pub fn len(&self) -> usize {
        self.path.len()
    }

    /// Edits up to the present, in order.
    pub fn iter(&self) -> impl Iterator<Item = &Edit> {
        self.path.iter().map(|node| &self.nodes[*node].edit)
    }

    /// The way from the start to the present; each edit keeps its number in it for good.
    pub fn path(&self) -> &[usize] {
        &self.path
    }

    /// Goes to where another way leads.
    pub fn go_to(&mut self, path: Vec<usize>) {
        self.path = path;
    }

    /// The edit of a number in a way.
    pub fn at(&self, number: usize) -> Option<&Edit> {
        self.nodes.get(number).map(|node| &node.edit)
    }

    /// The pull that was the edit of this number.
    pub fn pull_mut(&mut self, index: usize) -> Option<&mut Pull> {
        self.path.get(index).and_then(|node| self.nodes[*node].edit.pull_mut())
    }

    /// Lets go of what is still held at a time, and returns these pulls; as they were, they can be made again instead.
    pub fn let_go_at(&mut self, time_s: f64) -> Vec<Pull> {
        let mut cut = Vec::new();
        for index in 0..self.path.len() {
            let node = &self.nodes[self.path[index]];
            let Some(pull) = node.edit.pull().filter(|pull| pull.until_s > time_s) else { continue };
            let pull = Pull { until_s: time_s, ..pull.clone() };
            cut.push(pull.clone());
            let edit = Edit { done: Done::Pull(pull), ..node.edit.clone() };
            let (new, then) = (self.nodes.len(), node.then.clone());
            self.nodes.push(Node { edit, then });
            let before = index.checked_sub(1).map(|before| self.path[before]);
            before.map_or(&mut self.start, |before| &mut self.nodes[before].then).push(new);
            self.path[index] = new;
        }
        cut
    }

    /// Makes what was done so far part of the start.
    pub fn give(&mut self) {
        self.given = self.path.len();
    }

    /// Whether anything was done that can be taken back or done again.
    pub fn has_own(&self) -> bool {
        self.nodes.len() > self.given
    }

    /// Adds what was just done.
    pub fn push(&mut self, edit: Edit) {
        let mut then = Vec::new();
        if !edit.done.changes_who_is_there() {
            let later = |node: &&usize| self.nodes[**node].edit.time_s >= edit.time_s;
            then = self.ways_on().iter().filter(later).copied().collect();
        }
        let new = self.nodes.len();
        self.nodes.push(Node { edit, then });
        self.ways_on_mut().push(new);
        self.path.push(new);
    }

    /// Goes back to where so many edits had been made; the rest can be made again.
    pub fn go_back_to(&mut self, edits: usize) {
        self.path.truncate(edits);
    }

    /// Goes on to what redo makes.
    pub fn go_on(&mut self) {
        self.path.extend(self.ways_on().last().copied());
    }

    /// Forgets what redo would make: it never was.
    pub fn forget_next(&mut self) {
        self.ways_on_mut().pop();
    }

    /// What redo makes.
    pub fn next(&self) -> Option<&Edit> {
        self.next_number().and_then(|number| self.at(number))
    }

    /// The number of what redo makes.
    pub fn next_number(&self) -> Option<usize> {
        self.ways_on().last().copied()
    }

    /// The number of what redo could make instead.
    pub fn other_number(&self) -> Option<usize> {
        let [.., other, _] = self.ways_on() else { return None };
        Some(*other)
    }

    /// Lets redo make the other one; one after the other has its turn.
    pub fn turn_to_other(&mut self) {
        if let Some(last) = self.ways_on_mut().pop() {
            self.ways_on_mut().insert(0, last);
        }
    }

    /// Whether what redo makes belongs to what was done last.
    pub fn goes_on_as_one(&self) -> bool {
        self.next().is_some_and(|next| !self.would_begin_step(next))
    }

    /// What undo takes back: the number of its first edit, and that.
    pub fn last_step(&self) -> Option<(usize, &Edit)> {
        let first = (self.given..self.path.len()).rev().find(|index| self.begins_step(*index))?;
        Some((first, self.edit(first)))
    }

    /// Whether an edit would be another thing to take back than the last one.
    pub fn would_begin_step(&self, edit: &Edit) -> bool {
        let last = self.iter().last().filter(|_| self.path.len() > self.given);
        last.is_none_or(|last| !edit.goes_on_from(last))
    }

    /// What was done after so many edits, in words.
    pub fn steps_after(&self, edits: usize) -> Vec<&str> {
        let steps = (edits..self.path.len()).filter(|index| *index == edits || self.begins_step(*index));
        steps.map(|index| self.edit(index).what.as_str()).collect()
    }

    fn begins_step(&self, index: usize) -> bool {
        index <= self.given || !self.edit(index).goes_on_from(self.edit(index - 1))
    }

    fn edit(&self, index: usize) -> &Edit {
        &self.nodes[self.path[index]].edit
    }

    fn ways_on(&self) -> &[usize] {
        self.path.last().map_or(&self.start, |node| &self.nodes[*node].then)
    }

    fn ways_on_mut(&mut self) -> &mut Vec<usize> {
        match self.path.last() {
            Some(node) => &mut self.nodes[*node].then,
            None => &mut self.start,
        }
    }

    /// What the edits add to the text of a scene; those `in_scene` add what has come into the scene of the run already.
    pub fn text(&self, now_s: f64, in_scene: bool) -> String {
        let mut text = String::new();
        let mut add = |more: &str| {
            text.push_str(more);
            text.push('\n');
        };
        let mut contact: Option<(f64, ContactChange)> = None;
        for edit in self.iter() {
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
}
