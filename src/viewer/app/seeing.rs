//! What is drawn of what is shown: fragments apart, bodies cut open, stress crosses.

use super::App;
use crate::frame::Frame;
use crate::render::has_visible_lines;
use crate::viewer::closer::{Seeing, has_interior};
use crate::viewer::exploded::exploded;
use crate::viewer::snapshot::Command;
use std::sync::Arc;

/// What is shown, what is done to it, and the result.
pub(super) struct Seen {
    of: Arc<Frame>,
    by: Seeing,
    frame: Arc<Frame>,
    /// See [`Seeing::beside_m`].
    beside_m: Option<[f32; 2]>,
}

impl App {
    /// What is drawn: that with its fragments moved apart, cut open, with stress crosses, if so wished.
    #[must_use]
    pub fn drawn(&self) -> &Arc<Frame> {
        let seen = self.seen.as_ref().filter(|_| !self.look.seeing().is_plain());
        seen.map_or_else(|| self.shown(), |seen| &seen.frame)
    }

    /// Between which distances beyond the cutting plane everything is that could be cut, m, where the plane is beside all of it.
    #[must_use]
    pub fn cut_is_beside_m(&self) -> Option<[f32; 2]> {
        self.seen.as_ref().and_then(|seen| seen.beside_m)
    }

    /// Whether there are stress crosses, but all of them too short to be seen beside the largest stress seen before.
    #[must_use]
    pub fn are_crosses_too_short(&self) -> bool {
        let crosses = &self.drawn().crosses;
        let scale_pa = self.look.view(1.0).cross_scale_pa;
        !crosses.is_empty() && scale_pa.is_some_and(|scale_pa| !has_visible_lines(crosses, scale_pa))
    }

    /// What the camera takes in: whole bodies, but where they are drawn.
    pub(super) fn to_fit(&self) -> Arc<Frame> {
        match self.look.explode > 0.0 {
            true => Arc::new(exploded(self.shown(), self.look.explode)),
            false => self.shown().clone(),
        }
    }

    /// What pictures of the animation will lack, if any.
    #[must_use]
    pub fn animation_lacks(&self) -> Option<String> {
        let seeing = self.look.seeing();
        if !seeing.needs_interior() {
            return None;
        }
        let times_s = self.animation_times();
        let moments = times_s.iter().filter_map(|time_s| self.snapshot.recording.at(*time_s));
        seeing.lacks(moments.map(|moment| &*moment.frame))
    }

    /// Asks the simulation for what is inside, where that is wanted and not there.
    pub(super) fn look_closer(&mut self) {
        if self.snapshot.scene.is_none() || self.is_waiting() {
            return;
        }
        let wants_interior = self.look.seeing().needs_interior();
        if wants_interior != self.snapshot.with_interior {
            self.simulation.send(Command::SetInterior(wants_interior));
        }
        let wants_look =
            |frame: &Frame| self.snapshot.inspection.is_some() || (wants_interior && !has_interior(frame));
        let moment = self.player.moment(&self.snapshot.recording);
        let wanted_s = moment.filter(|moment| wants_look(&moment.frame)).map(|moment| moment.time_s);
        if wanted_s != self.looked_into_s {
            self.looked_into_s = wanted_s;
            self.simulation.send(Command::LookInto(wanted_s));
        }
    }

    /// Makes what is drawn of what is shown.
    pub(super) fn see(&mut self) {
        self.look.follow_camera();
        let needs_interior = self.look.seeing().needs_interior();
        let inside = self.looked().and_then(|looked| looked.frame.as_ref());
        let shown = inside.filter(|_| needs_interior).unwrap_or(self.shown()).clone();
        self.look.make_room_for_crosses(&shown);
        let seeing = self.look.seeing();
        if seeing.is_plain() {
            self.seen = None;
            return;
        }
        let is_known = |seen: &Seen| Arc::ptr_eq(&seen.of, &shown) && seen.by == seeing;
        if !self.seen.as_ref().is_some_and(is_known) {
            let apart = seeing.apart(&shown);
            let beside_m = seeing.beside_m(&apart);
            let frame = Arc::new(seeing.of_apart(apart));
            self.look.take_in_crosses(&frame);
            self.seen = Some(Seen { of: shown, by: seeing, frame, beside_m });
        }
    }
}
