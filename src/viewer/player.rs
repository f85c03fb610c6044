//! Looking back: which recorded moment is shown, and playing the recording.

use super::recording::{Moment, Recording};

/// Shows recorded moments instead of the present one.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Player {
    /// Time shown, s; `None`: the present.
    time_s: Option<f64>,
    /// Whether the recording is played.
    is_playing: bool,
}

impl Player {
    /// Whether something recorded is shown.
    #[must_use]
    pub fn is_back(&self) -> bool {
        self.time_s.is_some()
    }

    /// Whether the recording plays.
    #[must_use]
    pub fn is_playing(&self) -> bool {
        self.is_playing
    }

    /// Shows a time and stops there.
    pub fn go_to(&mut self, time_s: f64) {
        *self = Self { time_s: Some(time_s), is_playing: false };
    }

    /// Back to the present.
    pub fn leave(&mut self) {
        *self = Self::default();
    }

    /// Plays the recording from here, from its start when at its end, or stops it.
    pub fn toggle(&mut self, recording: &Recording) {
        let (Some(first), Some(last)) = (recording.moments().first(), recording.moments().last()) else {
            return;
        };
        let now = self.time_s.unwrap_or(f64::INFINITY);
        if self.is_playing {
            self.is_playing = false;
        } else {
            let time_s = if now >= last.time_s { first.time_s } else { now };
            *self = Self { time_s: Some(time_s), is_playing: true };
        }
    }

    /// Moves by recorded moments and stops there.
    pub fn step(&mut self, recording: &Recording, by: isize) {
        let now = self.time_s.unwrap_or(f64::INFINITY);
        if let Some(moment) = recording.beside(now, by) {
            self.go_to(moment.time_s);
        }
    }

    /// Time goes on by `duration_s`; stops at the end.
    pub fn advance(&mut self, recording: &Recording, duration_s: f64) {
        let (true, Some(now), Some(last)) = (self.is_playing, self.time_s, recording.moments().last()) else {
            return;
        };
        let next = now + duration_s;
        self.is_playing = next < last.time_s;
        self.time_s = Some(next.min(last.time_s));
    }

    /// The moment shown.
    #[must_use]
    pub fn moment<'r>(&self, recording: &'r Recording) -> Option<&'r Moment> {
        recording.at(self.time_s?)
    }
}
