//! What to show of a frame: plain data, the same for the window and for files.

use crate::frame::{ColorBy, Frame};
use crate::render::crosses::cross_scale_pa;
use crate::render::framing::Floor;
use crate::render::range::Range;

/// Light or dark surroundings.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum Background {
    /// A bright studio.
    #[default]
    Light,
    /// A dark studio.
    Dark,
}

/// Whether and where a floor is drawn.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum Ground {
    /// Found from the frame itself; in an animation prefer [`Ground::At`], which cannot jump.
    #[default]
    Auto,
    /// At a given place; see [`crate::render::Framing::floor`].
    At(Floor),
    /// None; fixed bodies are drawn as they are.
    Hidden,
}

/// Lines of text in the lower left corner.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Caption {
    /// Whether the frame's time is the first line.
    pub show_time: bool,
    /// How many times slower than life the animation runs; 1 or less says nothing.
    pub slow_motion: Option<f64>,
    /// Further lines.
    pub text: String,
}

/// What to show of a frame.
#[derive(Clone, Debug, PartialEq)]
pub struct View {
    /// Meaning of the colours.
    pub color_by: ColorBy,
    /// Values at the ends of the colour map, in the field's unit; `None` takes the frame's own.
    pub range: Option<Range>,
    /// Whether somebody chose the range, so that values may lie beyond it; the legend then says so.
    pub is_range_chosen: bool,
    /// Stress of the longest line of the stress crosses, Pa; `None` takes the frame's own.
    pub cross_scale_pa: Option<f32>,
    /// Whether the edges of the elements are drawn.
    pub wireframe: bool,
    /// The floor.
    pub ground: Ground,
    /// Text in the lower left corner.
    pub caption: Option<Caption>,
    /// Whether the colour map is explained where there are values.
    pub legend: bool,
    /// Light or dark.
    pub background: Background,
    /// Size of text and lines: physical pixels per logical point.
    pub pixels_per_point: f32,
}

impl Default for View {
    fn default() -> Self {
        Self {
            color_by: ColorBy::default(),
            range: None,
            is_range_chosen: false,
            cross_scale_pa: None,
            wireframe: false,
            ground: Ground::default(),
            caption: None,
            legend: true,
            background: Background::default(),
            pixels_per_point: 1.0,
        }
    }
}

impl View {
    /// A view whose text is as large, relative to the picture, as in a 960x540 one.
    #[must_use]
    pub fn for_size([width, height]: [u32; 2]) -> Self {
        let relative = (width as f32 / 960.0).min(height as f32 / 540.0);
        Self { pixels_per_point: relative.clamp(0.6, 8.0), ..Self::default() }
    }

    /// Whether values may lie below and above the range: no size lies below zero.
    pub(crate) fn open_ends(&self, range: Range) -> [bool; 2] {
        [self.is_range_chosen && (self.color_by.is_signed() || range.low > 0.0), self.is_range_chosen]
    }

    /// The range of values to use for `frame`: the fixed one, or the frame's own; `None` for
    /// colours without values.
    #[must_use]
    pub fn range_for(&self, frame: &Frame) -> Option<Range> {
        self.color_by
            .has_values()
            .then(|| self.range.unwrap_or_else(|| Range::of_frame(frame, self.color_by)))
    }

    /// The stress of the longest line of the frame's crosses, Pa: the fixed one, or the frame's own; `None` without
    /// crosses.
    #[must_use]
    pub fn cross_scale_for(&self, frame: &Frame) -> Option<f32> {
        if frame.crosses.is_empty() {
            return None;
        }
        self.cross_scale_pa.filter(|scale| *scale > 0.0).or_else(|| cross_scale_pa([frame]))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_a_chosen_range_leaves_values_out() {
        let ends = |is_range_chosen, color_by, low| {
            View { is_range_chosen, color_by, ..View::default() }.open_ends(Range { low, high: 2.0 })
        };
        assert_eq!(ends(false, ColorBy::Speed, 0.0), [false, false]);
        assert_eq!(ends(true, ColorBy::Speed, 0.0), [false, true]);
        assert_eq!(ends(true, ColorBy::Speed, 1.0), [true, true]);
        assert_eq!(ends(true, ColorBy::MeanStress, 0.0), [true, true]);
    }

    #[test]
    fn text_grows_with_the_picture() {
        assert_eq!(View::for_size([960, 540]).pixels_per_point, 1.0);
        assert_eq!(View::for_size([1920, 1080]).pixels_per_point, 2.0);
    }
}
