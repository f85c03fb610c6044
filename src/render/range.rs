//! The range of values that a colour map covers.

use crate::frame::{BodyFrame, ColorBy, Frame};

/// Values at the two ends of the colour map.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Range {
    /// Value of the first colour.
    pub low: f32,
    /// Value of the last colour, above `low`.
    pub high: f32,
}

/// Share of the vertices whose values the automatic range may leave out: single peaks, at a
/// contact node say, would turn everything else into one colour.
const CLIPPED_SHARE: f32 = 0.002;

/// Share of a body's [`ColorBy::scale`] up to which its values are nothing but round-off: the digits of positions, over
/// the size of elements in the size of scenes.
const ROUND_OFF_SHARE: f32 = 1e-12;
/// A failure index comes from stresses over strengths, which are far below stiffnesses: its round-off is larger.
const INDEX_ROUND_OFF: f32 = 1e-7;
/// Share of the scale that the colours cover while there is nothing else: about what rests under its own weight.
const REST_SHARE: f32 = 1e-6;

impl Range {
    /// The range from zero (or, for signed fields, from minus as much) to a round number at or
    /// above nearly all of the frame's values; where these are nothing but round-off, [`Range::at_rest`].
    #[must_use]
    pub fn of_frame(frame: &Frame, color_by: ColorBy) -> Self {
        Self::of_frames([frame], color_by)
    }

    /// The range that serves all the frames, for an animation without flicker.
    #[must_use]
    pub fn of_frames<'a>(frames: impl IntoIterator<Item = &'a Frame>, color_by: ColorBy) -> Self {
        let mut at_rest: Option<Self> = None;
        let found = frames.into_iter().filter_map(|frame| {
            let found = Self::found_in(frame, color_by);
            if found.is_none() {
                let now = Self::at_rest(frame, color_by);
                at_rest = Some(at_rest.map_or(now, |known| known.union(now)));
            }
            found
        });
        let found = found.reduce(Self::union);
        found.or(at_rest).unwrap_or_else(|| Self::up_to(0.0, color_by))
    }

    /// As [`Range::of_frame`]; `None` where there is nothing but round-off.
    #[must_use]
    pub fn found_in(frame: &Frame, color_by: ColorBy) -> Option<Self> {
        let peak = peak(frame, color_by);
        (peak > 0.0).then(|| Self::up_to(peak, color_by))
    }

    /// The range while there is nothing to see, in the size of what the bodies are made of.
    #[must_use]
    pub fn at_rest(frame: &Frame, color_by: ColorBy) -> Self {
        let share = if color_by == ColorBy::FailureIndex { 1.0 } else { REST_SHARE };
        let scales = frame.moving().map(|body| color_by.scale(&body.scales));
        Self::up_to(share * scales.fold(0.0, f32::max), color_by)
    }

    /// The smallest range that covers both.
    #[must_use]
    pub fn union(self, other: Self) -> Self {
        Self { low: self.low.min(other.low), high: self.high.max(other.high) }
    }

    /// Where `value` lies: 0 at the low end, 1 at the high end, clamped; 0 if not a number.
    #[must_use]
    pub fn position(self, value: f32) -> f32 {
        let position = (value - self.low) / (self.high - self.low);
        if position.is_nan() {
            return 0.0;
        }
        position.clamp(0.0, 1.0)
    }

    /// A range that somebody chose.
    ///
    /// # Errors
    /// What is wrong with it, in words.
    pub fn chosen(low: f64, high: f64) -> Result<Self, &'static str> {
        // The colour map works with single precision.
        let (low, high) = (low as f32, high as f32);
        if !(low.is_finite() && high.is_finite() && (high - low).is_finite()) {
            return Err("both ends must be finite numbers");
        }
        if low >= high {
            return Err("the lower end must be below the upper one");
        }
        Ok(Self { low, high })
    }

    fn up_to(peak: f32, color_by: ColorBy) -> Self {
        let high = round_up(peak);
        Self { low: if color_by.is_signed() { -high } else { 0.0 }, high }
    }

    /// Four to seven round values inside the range, with both ends if these are round, too.
    #[must_use]
    pub fn ticks(self) -> Vec<f32> {
        let (low, high) = (f64::from(self.low), f64::from(self.high));
        let span = high - low;
        if !(span.is_finite() && span > 0.0) {
            return vec![self.low];
        }
        // Parts of the whole first, then any round step.
        let parts = [4.0, 5.0, 6.0, 3.0].map(|parts| span / parts);
        let fits = |step: &f64| is_round(*step) && is_whole(low / step);
        let step = parts.into_iter().find(fits);
        let step = step.unwrap_or_else(|| round_step(span / 5.0));
        let first = (low / step - 1e-4).ceil() as i64;
        let last = (high / step + 1e-4).floor() as i64;
        (first..=last).map(|i| (i as f64 * step) as f32).collect()
    }
}

/// Whether the value is 1, 1.5, 2, 2.5, 3, 4 or 5 times a power of ten, to the precision of `f32`.
fn is_round(value: f64) -> bool {
    let lead = value / 10f64.powf((value * (1.0 + 1e-5)).log10().floor());
    let leads = [1.0, 1.5, 2.0, 2.5, 3.0, 4.0, 5.0];
    leads.into_iter().any(|round| (lead / round - 1.0f64).abs() < 1e-5)
}

fn is_whole(value: f64) -> bool {
    (value - value.round()).abs() < 1e-4
}

/// The value that all but [`CLIPPED_SHARE`] of the finite values stay below in size.
fn peak(frame: &Frame, color_by: ColorBy) -> f32 {
    let mut sizes: Vec<f32> = frame
        .bodies
        .iter()
        .filter_map(|body| Some((color_by.values_of(body)?, round_off(body, color_by))))
        .flat_map(|(values, round_off)| values.iter().map(move |value| above(value.abs(), round_off)))
        .filter(|size| size.is_finite())
        .collect();
    if sizes.is_empty() {
        return 0.0;
    }
    let clipped = (sizes.len() as f32 * CLIPPED_SHARE) as usize;
    let index = sizes.len() - 1 - clipped;
    *sizes.select_nth_unstable_by(index, f32::total_cmp).1
}

/// The size up to which values of a body are nothing but round-off.
fn round_off(body: &BodyFrame, color_by: ColorBy) -> f32 {
    let share = if color_by == ColorBy::FailureIndex { INDEX_ROUND_OFF } else { ROUND_OFF_SHARE };
    share * color_by.scale(&body.scales)
}

/// Zero instead of what is nothing but round-off.
fn above(value: f32, round_off: f32) -> f32 {
    if value.abs() <= round_off { 0.0 } else { value }
}

/// A stress of a body, Pa; zero instead of round-off.
pub(crate) fn stress_above_round_off_pa(stress_pa: f32, body: &BodyFrame) -> f32 {
    above(stress_pa, round_off(body, ColorBy::VonMises))
}

/// The next of 1, 1.5, 2, 3, 4, 5, 6, 8 times a power of ten, at or above `value`; 1 for zero.
pub(crate) fn round_up(value: f32) -> f32 {
    if !(value.is_finite() && value > f32::MIN_POSITIVE) {
        return 1.0;
    }
    let value = f64::from(value);
    let decade = 10f64.powf(value.log10().floor());
    let lead = [1.0, 1.5, 2.0, 3.0, 4.0, 5.0, 6.0, 8.0, 10.0]
        .into_iter()
        .find(|lead| lead * decade >= value * (1.0 - 1e-6))
        .unwrap_or(10.0);
    (lead * decade) as f32
}

/// The next of 1, 2, 2.5, 5 times a power of ten, at or above `value`.
fn round_step(value: f64) -> f64 {
    let decade = 10f64.powf(value.log10().floor());
    let lead = [1.0, 2.0, 2.5, 5.0, 10.0]
        .into_iter()
        .find(|lead| lead * decade >= value * (1.0 - 1e-6))
        .unwrap_or(10.0);
    lead * decade
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::frame::{BodyFrame, Scales, VertexFields};

    fn frame_with_speeds(speed_m_s: Vec<f32>) -> Frame {
        let fields = VertexFields { max_principal_pa: speed_m_s.clone(), speed_m_s, ..Default::default() };
        Frame { bodies: vec![BodyFrame { fields, ..Default::default() }], ..Default::default() }
    }

    #[test]
    fn automatic_range_is_round_and_covers_the_values() {
        let frame = frame_with_speeds(vec![0.0, 3.7, 2.0]);
        let range = Range::of_frame(&frame, ColorBy::Speed);
        assert_eq!((range.low, range.high), (0.0, 4.0));
        let signed = Range::of_frame(&frame, ColorBy::MaxPrincipal);
        assert_eq!((signed.low, signed.high), (-4.0, 4.0));
    }

    #[test]
    fn round_off_makes_no_range() {
        let with = |value_pa: f32, stiffness_pa: f32| {
            let mut frame = frame_with_speeds(vec![value_pa, -0.5 * value_pa]);
            frame.bodies[0].scales = Scales { stiffness_pa, ..Scales::default() };
            frame
        };
        let [nothing, little] = [with(3e-9, 2e10), with(30.0, 2e10)];
        let of = |frame: &Frame| Range::of_frame(frame, ColorBy::MaxPrincipal).high;
        assert_eq!((of(&nothing), of(&little)), (2e4, 30.0));
        assert_eq!(Range::found_in(&nothing, ColorBy::MaxPrincipal), None);
        // An animation that begins with nothing has the colours of what comes.
        assert_eq!(Range::of_frames([&nothing, &little], ColorBy::MaxPrincipal).high, 30.0);
        // What is soft is measured by itself.
        let mut both = with(3e-9, 2e10);
        both.bodies.extend(with(1e-3, 1e4).bodies);
        assert_eq!(of(&both), 1e-3);
        // Nobody knows what these are made of.
        assert_eq!(of(&with(3e-9, 0.0)), 3e-9);
        assert_eq!(of(&with(0.0, 0.0)), 1.0);
    }

    #[test]
    fn chosen_ranges_have_two_different_finite_ends() {
        assert_eq!(Range::chosen(-2e6, 3e6), Ok(Range { low: -2e6, high: 3e6 }));
        for [low, high] in [[1.0, 1.0], [2.0, 1.0], [0.0, f64::NAN], [0.0, 1e300], [1.0, 1.0 + 1e-12]] {
            assert!(Range::chosen(low, high).is_err(), "{low} {high}");
        }
    }

    #[test]
    fn one_peak_among_thousands_does_not_set_the_range() {
        let mut speeds = vec![1.0; 2000];
        speeds[7] = 1e6;
        speeds[8] = f32::NAN;
        let range = Range::of_frame(&frame_with_speeds(speeds), ColorBy::Speed);
        assert_eq!(range.high, 1.0);
    }

    #[test]
    fn nothing_moving_still_gives_a_range() {
        let range = Range::of_frame(&Frame::default(), ColorBy::Speed);
        assert!(range.high > range.low);
        assert_eq!(range.position(f32::NAN), 0.0);
        assert_eq!(range.position(9.0), 1.0);
    }

    #[test]
    fn ticks_are_few_and_reach_both_ends() {
        for high in [1.0, 1.5, 2.0, 3.0, 4.0, 5.0, 6.0, 8.0, 3e8, 2e-5, 6e-3] {
            for low in [0.0, -high] {
                let ticks = Range { low, high }.ticks();
                assert!((4..=7).contains(&ticks.len()), "{low} {high}: {ticks:?}");
                let (first, last) = (ticks[0], ticks[ticks.len() - 1]);
                assert!((first - low).abs() < 1e-4 * high, "{ticks:?}");
                assert!((last - high).abs() < 1e-4 * high, "{ticks:?}");
                assert!(ticks.iter().any(|t| t.abs() < 1e-4 * high), "{ticks:?}");
            }
        }
    }

    #[test]
    fn odd_ranges_have_round_ticks_inside() {
        let range = Range { low: 0.37, high: 7.7 };
        assert_eq!(range.ticks(), [2.0, 4.0, 6.0]);
        assert_eq!(Range { low: 1.0, high: 1.0 }.ticks(), [1.0]);
    }
}
