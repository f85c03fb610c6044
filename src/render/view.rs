//! What to show of a frame: plain data, the same for the window and for files.

use crate::frame::{BodyFrame, BodyRole, Frame, VertexFields};
use crate::render::framing::Floor;
use crate::render::range::Range;
use std::str::FromStr;
use thiserror::Error;

/// What the surface colours mean.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum ColorBy {
    /// Each material in its own colour.
    #[default]
    Material,
    /// Each body in its own colour.
    Body,
    /// Speed.
    Speed,
    /// Length of the displacement from the rigidly moved shape.
    Displacement,
    /// Von Mises equivalent stress.
    VonMises,
    /// Largest principal stress.
    MaxPrincipal,
    /// Smallest principal stress.
    MinPrincipal,
    /// Mean normal stress, tension positive.
    MeanStress,
}

/// A word that is no field to colour by.
#[derive(Clone, Debug, Error, PartialEq, Eq)]
#[error("cannot colour by '{given}'; choose one of {}", ColorBy::ALL.map(ColorBy::name).join(", "))]
pub struct UnknownColorBy {
    /// The word.
    pub given: String,
}

impl ColorBy {
    /// All of them, in the order of menus.
    pub const ALL: [Self; 8] = [
        Self::Material,
        Self::Body,
        Self::Speed,
        Self::Displacement,
        Self::VonMises,
        Self::MaxPrincipal,
        Self::MinPrincipal,
        Self::MeanStress,
    ];

    /// The word on the command line and in scene files.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Material => "material",
            Self::Body => "body",
            Self::Speed => "speed",
            Self::Displacement => "displacement",
            Self::VonMises => "von-mises",
            Self::MaxPrincipal => "max-principal",
            Self::MinPrincipal => "min-principal",
            Self::MeanStress => "mean-stress",
        }
    }

    /// The words in menus and legends.
    #[must_use]
    pub fn label(self) -> &'static str {
        match self {
            Self::Material => "Material",
            Self::Body => "Body",
            Self::Speed => "Speed",
            Self::Displacement => "Displacement",
            Self::VonMises => "Von Mises stress",
            Self::MaxPrincipal => "Max principal stress",
            Self::MinPrincipal => "Min principal stress",
            Self::MeanStress => "Mean stress",
        }
    }

    /// Unit of the values, empty for colours without values.
    #[must_use]
    pub fn unit(self) -> &'static str {
        match self {
            Self::Material | Self::Body => "",
            Self::Speed => "m/s",
            Self::Displacement => "m",
            Self::VonMises | Self::MaxPrincipal | Self::MinPrincipal | Self::MeanStress => "Pa",
        }
    }

    /// Whether values of both signs occur, so that the map must be centred at zero.
    #[must_use]
    pub fn is_signed(self) -> bool {
        matches!(self, Self::MaxPrincipal | Self::MinPrincipal | Self::MeanStress)
    }

    /// Whether there are values behind the colours, and so a legend.
    #[must_use]
    pub fn has_values(self) -> bool {
        !matches!(self, Self::Material | Self::Body)
    }

    /// The values at the vertices, in [`ColorBy::unit`]; `None` for colours without values.
    #[must_use]
    pub fn values(self, fields: &VertexFields) -> Option<&[f32]> {
        match self {
            Self::Material | Self::Body => None,
            Self::Speed => Some(&fields.speed_m_s),
            Self::Displacement => Some(&fields.displacement_m),
            Self::VonMises => Some(&fields.von_mises_pa),
            Self::MaxPrincipal => Some(&fields.max_principal_pa),
            Self::MinPrincipal => Some(&fields.min_principal_pa),
            Self::MeanStress => Some(&fields.mean_stress_pa),
        }
    }

    /// The values of a body that takes colours by value: fixed bodies stay as they are.
    #[must_use]
    pub fn values_of(self, body: &BodyFrame) -> Option<&[f32]> {
        (body.role != BodyRole::Fixed).then(|| self.values(&body.fields)).flatten()
    }
}

impl FromStr for ColorBy {
    type Err = UnknownColorBy;

    fn from_str(text: &str) -> Result<Self, UnknownColorBy> {
        let wanted = text.trim().to_ascii_lowercase().replace(['_', ' '], "-");
        Self::ALL
            .into_iter()
            .find(|choice| choice.name() == wanted)
            .ok_or_else(|| UnknownColorBy { given: text.to_owned() })
    }
}

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

    /// The range of values to use for `frame`: the fixed one, or the frame's own; `None` for
    /// colours without values.
    #[must_use]
    pub fn range_for(&self, frame: &Frame) -> Option<Range> {
        self.color_by
            .has_values()
            .then(|| self.range.unwrap_or_else(|| Range::of_frame(frame, self.color_by)))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_name_reads_back() {
        for choice in ColorBy::ALL {
            assert_eq!(choice.name().parse(), Ok(choice));
        }
        assert_eq!("Von Mises".parse(), Ok(ColorBy::VonMises));
    }

    #[test]
    fn unknown_field_lists_the_choices() {
        let text = "vonmises".parse::<ColorBy>().unwrap_err().to_string();
        assert!(text.contains("'vonmises'") && text.contains("von-mises"), "{text}");
    }

    #[test]
    fn text_grows_with_the_picture() {
        assert_eq!(View::for_size([960, 540]).pixels_per_point, 1.0);
        assert_eq!(View::for_size([1920, 1080]).pixels_per_point, 2.0);
    }
}
