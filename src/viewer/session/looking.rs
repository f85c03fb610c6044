//! Looking into recorded moments: these are only pictures, so what is inside is found by simulating up to them again.

use super::super::inspection::Inspection;
use super::super::snapshot::Looked;
use super::timeline::step_to;
use super::{Run, Session};
use crate::frame::Frame;
use std::sync::Arc;

/// A recorded moment that is looked into.
pub(super) struct LookedRun {
    time_s: f64,
    /// Edits before it.
    edits: usize,
    run: Run,
    /// With what is inside the bodies, if that is wanted.
    frame: Option<Arc<Frame>>,
}

impl LookedRun {
    /// Whether it is of what was before this time and so many edits.
    pub fn is_before(&self, time_s: f64, edits: usize) -> bool {
        self.time_s <= time_s && self.edits <= edits
    }
}

impl Session {
    /// Whether frames hold what is inside the bodies.
    pub(super) fn set_interior(&mut self, is_wanted: bool) {
        self.with_interior = is_wanted;
        self.course.frame_of = None;
        if let Some(looked) = &mut self.looked {
            looked.frame = None;
        }
    }

    /// Looks into the recorded moment at a time, or into none.
    pub(super) fn look_into(&mut self, time_s: Option<f64>) {
        let before = self.looked.take();
        let wanted = time_s.and_then(|time_s| self.course.recording.at(time_s)).map(|m| (m.time_s, m.edits));
        let Some((time_s, edits)) = wanted else { return };
        match self.run_from(before, time_s, edits) {
            Ok(run) => self.looked = Some(LookedRun { time_s, edits, run, frame: None }),
            Err(error) => self.tell(format!("the moment cannot be looked into: {error}")),
        }
    }

    /// From the moment looked into before, if that is the shortest way.
    fn run_from(
        &self,
        before: Option<LookedRun>,
        time_s: f64,
        edits: usize,
    ) -> Result<Run, crate::sim::SimError> {
        let is_on_the_way = |before: &LookedRun| {
            before.edits == edits
                && before.time_s <= time_s
                && !self.course.keyframes.iter().any(|k| (before.time_s..=time_s).contains(&k.time_s()))
        };
        match before.filter(is_on_the_way) {
            Some(mut before) => {
                step_to(&mut before.run.world, time_s)?;
                Ok(before.run)
            }
            None => self.run_at(time_s, edits).map(|(run, _)| run),
        }
    }

    /// What the window shows of the moment looked into.
    pub(super) fn looked(&mut self) -> Option<Looked> {
        let looked = self.looked.as_mut()?;
        let world = &looked.run.world;
        if self.with_interior && looked.frame.is_none() {
            looked.frame = Some(Arc::new(world.publish_with_interior()));
        }
        let inspection = self.inspected.and_then(|(body, element)| Inspection::of(world, body, element));
        Some(Looked { time_s: looked.time_s, frame: looked.frame.clone(), inspection })
    }
}
