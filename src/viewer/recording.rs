//! The timeline: what was simulated so far, to be scrubbed through, in bounded memory.

use crate::frame::{BodyFrame, Frame, Interior};
use std::sync::Arc;

/// Memory for the recording when nobody has set a limit, bytes.
pub const DEFAULT_LIMIT_BYTES: usize = 512 << 20;
/// Least memory that makes sense, bytes.
pub const LEAST_LIMIT_BYTES: usize = 16 << 20;
/// Share of the memory for the pictures' data; the rest is for moments to play on from.
const FRAME_SHARE: f64 = 0.6;
/// Most marks kept.
const MOST_MARKS: usize = 400;

/// A recorded moment.
#[derive(Clone, Debug)]
pub struct Moment {
    /// Simulated time, s.
    pub time_s: f64,
    /// What is seen.
    pub frame: Arc<Frame>,
    /// How many edits of the running scene came before it.
    pub edits: usize,
    bytes: usize,
}

/// What a mark on the timeline stands for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum MarkKind {
    /// Two bodies begin to touch.
    Contact,
    /// Cracks start to grow.
    Crack,
    /// Somebody threw in a body or took one out.
    Edit,
}

/// A mark on the timeline.
#[derive(Clone, Debug, PartialEq)]
pub struct Mark {
    /// Simulated time, s.
    pub time_s: f64,
    /// What it stands for.
    pub kind: MarkKind,
    /// What happened.
    pub text: String,
    /// How many edits of the running scene had been made by then.
    pub edits: usize,
}

/// Everything recorded, in the order of time.
#[derive(Clone, Debug)]
pub struct Recording {
    moments: Vec<Moment>,
    marks: Vec<Mark>,
    frame_bytes: usize,
    /// Memory of the moments to play on from, bytes.
    pub world_bytes: usize,
    /// Memory of runs before this one, to which undo goes back, bytes.
    pub reserved_bytes: usize,
    limit_bytes: usize,
    /// Of so many moments offered one is kept, as a power of two.
    thinning: u32,
    offered: u64,
}

impl Default for Recording {
    fn default() -> Self {
        Self {
            moments: Vec::new(),
            marks: Vec::new(),
            frame_bytes: 0,
            world_bytes: 0,
            reserved_bytes: 0,
            limit_bytes: DEFAULT_LIMIT_BYTES,
            thinning: 0,
            offered: 0,
        }
    }
}

impl Recording {
    /// Nothing yet, with a limit of memory.
    #[must_use]
    pub fn with_limit(limit_bytes: usize) -> Self {
        Self { limit_bytes: limit_bytes.max(LEAST_LIMIT_BYTES), ..Self::default() }
    }

    /// The moments.
    #[must_use]
    pub fn moments(&self) -> &[Moment] {
        &self.moments
    }

    /// The marks.
    #[must_use]
    pub fn marks(&self) -> &[Mark] {
        &self.marks
    }

    /// Memory in use, bytes.
    #[must_use]
    pub fn bytes(&self) -> usize {
        self.own_bytes() + self.reserved_bytes
    }

    /// The same without what runs before this one have, bytes.
    #[must_use]
    pub fn own_bytes(&self) -> usize {
        self.frame_bytes + self.world_bytes
    }

    /// What runs before this one leave of the limit, bytes.
    fn own_limit_bytes(&self) -> usize {
        self.limit_bytes.saturating_sub(self.reserved_bytes).max(LEAST_LIMIT_BYTES)
    }

    /// Memory that may be used, bytes.
    #[must_use]
    pub fn limit_bytes(&self) -> usize {
        self.limit_bytes
    }

    /// Of so many simulated moments one is kept.
    #[must_use]
    pub fn one_of(&self) -> u64 {
        1 << self.thinning
    }

    /// Memory that moments to play on from may use, bytes.
    #[must_use]
    pub fn world_limit_bytes(&self) -> usize {
        (self.own_limit_bytes() as f64 * (1.0 - FRAME_SHARE)) as usize
    }

    /// The last moment not after `time_s`, or the first one.
    #[must_use]
    pub fn at(&self, time_s: f64) -> Option<&Moment> {
        let after = self.moments.partition_point(|moment| moment.time_s <= time_s);
        self.moments.get(after.saturating_sub(1))
    }

    /// The moment nearest to `time_s`.
    #[must_use]
    pub fn nearest(&self, time_s: f64) -> Option<&Moment> {
        let (before, after) = (self.at(time_s)?, self.beside(time_s, 1)?);
        let is_after = (after.time_s - time_s).abs() < (time_s - before.time_s).abs();
        Some(if is_after { after } else { before })
    }

    /// The moment `by` places after the one shown at `time_s`.
    #[must_use]
    pub fn beside(&self, time_s: f64, by: isize) -> Option<&Moment> {
        let now = self.moments.partition_point(|moment| moment.time_s <= time_s).saturating_sub(1);
        self.moments.get(now.saturating_add_signed(by).min(self.moments.len().saturating_sub(1)))
    }

    /// Counts a simulated moment; whether it should be recorded.
    pub fn wants_next(&mut self) -> bool {
        self.offered += 1;
        (self.offered - 1).is_multiple_of(1 << self.thinning)
    }

    /// Records a moment, later than all before.
    pub fn push(&mut self, frame: Arc<Frame>, edits: usize) {
        let before = self.moments.last().map(|moment| moment.frame.as_ref());
        let bytes = frame_bytes(&frame, before);
        self.frame_bytes += bytes;
        self.moments.push(Moment { time_s: frame.time_s, frame, edits, bytes });
        self.keep_within_limit();
    }

    /// Adds a mark.
    pub fn mark(&mut self, mark: Mark) {
        if self.marks.len() < MOST_MARKS {
            self.marks.push(mark);
        }
    }

    /// Forgets what comes after a moment.
    pub fn cut_after(&mut self, time_s: f64, edits: usize) {
        self.moments.retain(|moment| moment.time_s <= time_s && moment.edits <= edits);
        self.marks.retain(|mark| mark.time_s <= time_s && mark.edits <= edits);
        self.count_bytes();
        self.offered = (self.moments.len() as u64) << self.thinning;
    }

    /// Takes what comes after a moment out.
    pub fn split_off(&mut self, time_s: f64, edits: usize) -> Self {
        let mut later = Self { reserved_bytes: 0, world_bytes: 0, ..self.clone() };
        self.cut_after(time_s, edits);
        later.moments.retain(|moment| moment.time_s > time_s || moment.edits > edits);
        later.marks.retain(|mark| mark.time_s > time_s || mark.edits > edits);
        later.count_bytes();
        later
    }

    /// Puts what was recorded later behind.
    pub fn append(&mut self, later: &Self) {
        self.moments.extend_from_slice(&later.moments);
        self.marks.extend_from_slice(&later.marks);
        self.world_bytes += later.world_bytes;
        self.thinning = self.thinning.max(later.thinning);
        self.offered = (self.moments.len() as u64) << self.thinning;
        self.count_bytes();
        self.keep_within_limit();
    }

    /// Changes the limit of memory.
    pub fn set_limit(&mut self, limit_bytes: usize) {
        self.limit_bytes = limit_bytes.max(LEAST_LIMIT_BYTES);
        self.keep_within_limit();
    }

    fn keep_within_limit(&mut self) {
        let limit = (self.own_limit_bytes() as f64 * FRAME_SHARE) as usize;
        while self.frame_bytes > limit && self.moments.len() > 2 {
            let mut is_kept = false;
            self.moments.retain(|_| {
                is_kept = !is_kept;
                is_kept
            });
            self.thinning += 1;
            self.count_bytes();
        }
    }

    /// Anew: what two frames shared may now be kept by another.
    fn count_bytes(&mut self) {
        self.frame_bytes = 0;
        for index in 0..self.moments.len() {
            let (before, rest) = self.moments.split_at_mut(index);
            let before = before.last().map(|moment| moment.frame.as_ref());
            rest[0].bytes = frame_bytes(&rest[0].frame, before);
            self.frame_bytes += rest[0].bytes;
        }
    }
}

/// Memory of a frame besides what it has in common with the one before, bytes.
pub(super) fn frame_bytes(frame: &Frame, before: Option<&Frame>) -> usize {
    const VERTEX_FIELDS: usize = 7;
    let of_interior = |interior: &Interior| {
        let nodes = interior.positions_m.len() * (12 + 4 * VERTEX_FIELDS);
        // Its topology, too: at worst no other frame has it.
        nodes + interior.stress_pa.len() * (24 + 16 + 4 + 4)
    };
    let of_body = |(index, body): (usize, &BodyFrame)| {
        let vertices = body.positions_m.len() * (12 + 4 * VERTEX_FIELDS);
        let is_shared = before
            .and_then(|frame| frame.bodies.get(index))
            .is_some_and(|old| Arc::ptr_eq(&old.surface, &body.surface));
        let surface = if is_shared { 0 } else { body.surface.triangles.len() * (12 + 4 + 1 + 4 + 4) };
        let interior = body.interior.as_deref().map_or(0, of_interior);
        size_of::<BodyFrame>() + vertices + surface + interior
    };
    let bodies: usize = frame.bodies.iter().enumerate().map(of_body).sum();
    size_of::<Frame>() + bodies + frame.contacts.len() * size_of::<crate::frame::ContactMark>()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn frame(time_s: f64, vertices: usize) -> Arc<Frame> {
        let body = BodyFrame { positions_m: vec![[0.0; 3]; vertices], ..BodyFrame::default() };
        Arc::new(Frame { time_s, bodies: vec![body], ..Frame::default() })
    }

    #[test]
    fn memory_stays_below_its_limit_and_moments_evenly_spaced() {
        let mut recording = Recording::with_limit(LEAST_LIMIT_BYTES);
        for moment in 0..3000 {
            if recording.wants_next() {
                recording.push(frame(f64::from(moment), 2000), 0);
            }
            assert!(recording.bytes() <= LEAST_LIMIT_BYTES);
        }
        let times: Vec<f64> = recording.moments().iter().map(|m| m.time_s).collect();
        assert!(times.len() > 50 && times[0] == 0.0 && recording.one_of() > 1, "{}", times.len());
        let gap = times[1] - times[0];
        assert!(times.windows(2).all(|pair| pair[1] - pair[0] == gap));
        assert!(times[times.len() - 1] > 3000.0 - 2.0 * gap);
    }

    #[test]
    fn the_moment_at_a_time_is_the_last_one_before_it() {
        let mut recording = Recording::default();
        assert!(recording.at(1.0).is_none() && recording.beside(1.0, 1).is_none());
        (0..5).for_each(|i| recording.push(frame(f64::from(i), 3), 0));
        let at = |time_s: f64| recording.at(time_s).unwrap().time_s;
        assert_eq!([at(-1.0), at(0.0), at(2.5), at(99.0)], [0.0, 0.0, 2.0, 4.0]);
        let beside = |by| recording.beside(2.5, by).unwrap().time_s;
        assert_eq!([beside(-9), beside(-1), beside(1), beside(9)], [0.0, 1.0, 3.0, 4.0]);
        recording.cut_after(2.5, 0);
        assert_eq!(recording.moments().len(), 3);
    }
}
