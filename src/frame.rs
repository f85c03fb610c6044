//! What a renderer needs of one moment: the seam between simulation and picture.
//!
//! The simulation publishes a [`Frame`]; the renderer, the exporters of pictures and the viewer
//! read it. Positions are `f32` here and nowhere below.

use std::str::FromStr;
use std::sync::Arc;
use thiserror::Error;

/// The drawable surface of a body; shared between frames until the topology changes.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct SurfaceTopology {
    /// Triangles, corner indices into the body's frame vertices, counter-clockwise from outside.
    pub triangles: Vec<[u32; 3]>,
    /// Colour group of each triangle: an index into [`BodyFrame::palette_srgb`] (one per material).
    pub triangle_material: Vec<u32>,
    /// Whether the triangle is a crack face, born by fracture; gets its own tint.
    pub triangle_is_crack: Vec<bool>,
    /// Fragment that the triangle belongs to, counted from 0 in each body; empty where nothing breaks.
    pub triangle_fragment: Vec<u32>,
    /// Tetrahedron behind each triangle, an index into the body's elements.
    pub triangle_element: Vec<u32>,
}

/// Values at the vertices of a body's surface that pictures can be coloured by.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct VertexFields {
    /// Speed, m/s.
    pub speed_m_s: Vec<f32>,
    /// Length of the displacement from the rigidly moved reference shape, m.
    pub displacement_m: Vec<f32>,
    /// Von Mises equivalent stress (uniaxial scale, sqrt(3 J2)), Pa; volume-weighted nodal mean.
    pub von_mises_pa: Vec<f32>,
    /// Largest principal Cauchy stress, Pa.
    pub max_principal_pa: Vec<f32>,
    /// Smallest principal Cauchy stress, Pa.
    pub min_principal_pa: Vec<f32>,
    /// Mean normal stress (tension positive), Pa.
    pub mean_stress_pa: Vec<f32>,
    /// Failure index: 0 unstressed, 1 fails; volume-weighted nodal mean.
    pub failure_index: Vec<f32>,
}

/// The tetrahedra of a body; shared between frames until the topology changes.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct InteriorTopology {
    /// Tetrahedra, corner indices into [`Interior::positions_m`].
    pub tets: Vec<[u32; 4]>,
    /// Colour group of each tetrahedron: an index into [`BodyFrame::palette_srgb`].
    pub element_material: Vec<u32>,
    /// Fragment that each tetrahedron belongs to; empty where nothing breaks.
    pub element_fragment: Vec<u32>,
}

/// What is inside a body: to be cut open, and to show stresses with their directions.
#[derive(Clone, Debug, Default)]
pub struct Interior {
    /// Tetrahedra.
    pub topology: Arc<InteriorTopology>,
    /// World positions of all nodes, metres.
    pub positions_m: Vec<[f32; 3]>,
    /// Values at all nodes.
    pub fields: VertexFields,
    /// Cauchy stress of each tetrahedron, Pa, tension positive: xx, yy, zz, xy, yz, zx.
    pub stress_pa: Vec<[f32; 6]>,
}

/// Principal stresses at a place, to be drawn as a cross of three lines.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct StressCross {
    /// World position, metres.
    pub position_m: [f32; 3],
    /// Unit normal of the surface or section it lies on.
    pub normal: [f32; 3],
    /// Unit principal directions.
    pub directions: [[f32; 3]; 3],
    /// Principal stresses in these directions, Pa, tension positive.
    pub principal_pa: [f32; 3],
    /// Room for it: distance to its neighbours, metres.
    pub room_m: f32,
}

/// How a body takes part, which pictures may show (the ground is drawn more quietly).
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum BodyRole {
    /// Deforms and moves.
    #[default]
    Deformable,
    /// Never moves (ground, wall).
    Fixed,
    /// Moves by prescription (a press platen).
    Kinematic,
}

/// One body at one moment.
#[derive(Clone, Debug, Default)]
pub struct BodyFrame {
    /// Name from the scene.
    pub name: Arc<str>,
    /// Role of the body.
    pub role: BodyRole,
    /// Base colours, sRGB 0..1, one per material of the body.
    pub palette_srgb: Arc<[[f32; 3]]>,
    /// Surface triangles.
    pub surface: Arc<SurfaceTopology>,
    /// World positions of the surface vertices, metres.
    pub positions_m: Vec<[f32; 3]>,
    /// Values to colour by; each vector is as long as `positions_m`.
    pub fields: VertexFields,
    /// What is inside; only when it was asked for, since it takes more memory than the surface.
    pub interior: Option<Arc<Interior>>,
}

/// A place where bodies press on each other, for drawing contact marks.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ContactMark {
    /// World position, metres.
    pub position_m: [f32; 3],
    /// Force on the first body, newtons.
    pub force_n: [f32; 3],
}

/// A spring that pulls at a body.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PullMark {
    /// The grabbed point, metres.
    pub from_m: [f32; 3],
    /// What it is pulled to, metres.
    pub to_m: [f32; 3],
}

/// Numbers that a caption or a status line shows.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct FrameStatus {
    /// Stage of the step: `"free travel"`, `"beginning of collision"`, `"collision"`, `"resting"`.
    pub stage: String,
    /// Last step, seconds.
    pub step_s: f64,
    /// Number of tetrahedra.
    pub elements: usize,
    /// Number of nodes.
    pub nodes: usize,
    /// Active contact pairs.
    pub contact_pairs: usize,
    /// Connected pieces of the deformable bodies.
    pub fragments: usize,
    /// Bodies at rest and skipped.
    pub sleeping_bodies: usize,
    /// Steps taken since the start.
    pub steps: u64,
}

/// Everything drawable of one moment.
#[derive(Clone, Debug, Default)]
pub struct Frame {
    /// Simulated time, seconds.
    pub time_s: f64,
    /// The bodies, in scene order.
    pub bodies: Vec<BodyFrame>,
    /// Contacts of the last step.
    pub contacts: Vec<ContactMark>,
    /// Stress crosses; only when they were asked for.
    pub crosses: Vec<StressCross>,
    /// Springs that pull at bodies.
    pub pulls: Vec<PullMark>,
    /// Whether there is no gravity, so that nothing stands on a floor.
    pub is_weightless: bool,
    /// Numbers for captions.
    pub status: FrameStatus,
}

impl VertexFields {
    /// All fields, in a fixed order, to be treated alike.
    pub fn all(&self) -> [&Vec<f32>; 7] {
        [
            &self.speed_m_s,
            &self.displacement_m,
            &self.von_mises_pa,
            &self.max_principal_pa,
            &self.min_principal_pa,
            &self.mean_stress_pa,
            &self.failure_index,
        ]
    }

    /// As [`VertexFields::all`], to be changed.
    pub fn all_mut(&mut self) -> [&mut Vec<f32>; 7] {
        [
            &mut self.speed_m_s,
            &mut self.displacement_m,
            &mut self.von_mises_pa,
            &mut self.max_principal_pa,
            &mut self.min_principal_pa,
            &mut self.mean_stress_pa,
            &mut self.failure_index,
        ]
    }
}

impl Frame {
    /// Smallest and largest world coordinates over the moving bodies, or over all bodies when
    /// nothing moves; `None` when there is nothing to draw. Metres.
    #[must_use]
    pub fn bounds_m(&self) -> Option<([f32; 3], [f32; 3])> {
        let moving = self.bodies.iter().filter(|b| b.role != BodyRole::Fixed);
        bounds_of(moving).or_else(|| bounds_of(self.bodies.iter()))
    }
}

/// What the surface colours mean.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum ColorBy {
    /// Each material in its own colour.
    #[default]
    Material,
    /// Each body in its own colour.
    Body,
    /// Each fragment in its own colour.
    Fragment,
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
    /// How near the material is to failure: 1 fails.
    FailureIndex,
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
    pub const ALL: [Self; 10] = [
        Self::Material,
        Self::Body,
        Self::Fragment,
        Self::Speed,
        Self::Displacement,
        Self::VonMises,
        Self::MaxPrincipal,
        Self::MinPrincipal,
        Self::MeanStress,
        Self::FailureIndex,
    ];

    /// The word on the command line and in scene files.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Material => "material",
            Self::Body => "body",
            Self::Fragment => "fragment",
            Self::Speed => "speed",
            Self::Displacement => "displacement",
            Self::VonMises => "von-mises",
            Self::MaxPrincipal => "max-principal",
            Self::MinPrincipal => "min-principal",
            Self::MeanStress => "mean-stress",
            Self::FailureIndex => "failure-index",
        }
    }

    /// The words in menus and legends.
    #[must_use]
    pub fn label(self) -> &'static str {
        match self {
            Self::Material => "Material",
            Self::Body => "Body",
            Self::Fragment => "Fragment",
            Self::Speed => "Speed",
            Self::Displacement => "Displacement",
            Self::VonMises => "Von Mises stress",
            Self::MaxPrincipal => "Max principal stress",
            Self::MinPrincipal => "Min principal stress",
            Self::MeanStress => "Mean stress",
            Self::FailureIndex => "Failure index",
        }
    }

    /// Unit of the values, empty for colours without values.
    #[must_use]
    pub fn unit(self) -> &'static str {
        match self {
            Self::Material | Self::Body | Self::Fragment | Self::FailureIndex => "",
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
        !matches!(self, Self::Material | Self::Body | Self::Fragment)
    }

    /// The values at the vertices, in [`ColorBy::unit`]; `None` for colours without values.
    #[must_use]
    pub fn values(self, fields: &VertexFields) -> Option<&[f32]> {
        match self {
            Self::Material | Self::Body | Self::Fragment => None,
            Self::Speed => Some(&fields.speed_m_s),
            Self::Displacement => Some(&fields.displacement_m),
            Self::VonMises => Some(&fields.von_mises_pa),
            Self::MaxPrincipal => Some(&fields.max_principal_pa),
            Self::MinPrincipal => Some(&fields.min_principal_pa),
            Self::MeanStress => Some(&fields.mean_stress_pa),
            Self::FailureIndex => Some(&fields.failure_index),
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

fn bounds_of<'a>(bodies: impl Iterator<Item = &'a BodyFrame>) -> Option<([f32; 3], [f32; 3])> {
    bodies.flat_map(|b| &b.positions_m).fold(None, |bounds, p| {
        let (low, high) = bounds.unwrap_or((*p, *p));
        Some((std::array::from_fn(|i| low[i].min(p[i])), std::array::from_fn(|i| high[i].max(p[i]))))
    })
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
}
