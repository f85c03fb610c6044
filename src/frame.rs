//! What a renderer needs of one moment: the seam between simulation and picture.
//!
//! The simulation publishes a [`Frame`]; the renderer, the exporters of pictures and the viewer
//! read it. Positions are `f32` here and nowhere below.

use glam::Vec3;
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
    /// Whether the triangle is part of a section, where a body is cut open for the eye; empty in whole bodies.
    pub triangle_is_section: Vec<bool>,
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

/// What a body's values are measured by, so that round-off is not taken for something; zero where nobody knows.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Scales {
    /// Young's modulus of the stiffest material, Pa.
    pub stiffness_pa: f32,
    /// Speed of waves in it, m/s.
    pub wave_speed_m_s: f32,
    /// Size of the body, m.
    pub size_m: f32,
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
    /// What these are measured by.
    pub scales: Scales,
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
    /// Edges that cuts did not divide because a body has as many elements as it may.
    pub edges_left_whole: u32,
    /// Nodes at which a cut was left out because a fragment would have been too small.
    pub nodes_left_whole: u32,
    /// Nodes at which a crack had to wait because it would have run faster than it may.
    pub nodes_held_up: u32,
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
    pub fn bounds_m(&self) -> Option<Bounds> {
        bounds_of(self.moving().flat_map(|body| &body.positions_m))
            .or_else(|| bounds_of(self.bodies.iter().flat_map(|body| &body.positions_m)))
    }

    /// As [`Frame::bounds_m`], without what has flown or fallen far off: a shard on its way out of the scene must not
    /// make all the rest small. Metres.
    #[must_use]
    pub fn near_bounds_m(&self) -> Option<Bounds> {
        let Some((low, high)) = self.near_limits_m() else { return self.bounds_m() };
        let is_near = |p: &&[f32; 3]| (0..3).all(|i| (low[i]..=high[i]).contains(&p[i]));
        bounds_of(self.moving().flat_map(|body| &body.positions_m).filter(is_near))
            .or_else(|| self.bounds_m())
    }

    /// The room around most of the moving surfaces outside of which nothing counts as near, metres; `None` where that
    /// cannot be told.
    #[must_use]
    pub fn near_limits_m(&self) -> Option<Bounds> {
        let mut patches = self.patches();
        // What is below all that stands fixed never comes back, as long as something is still above.
        let underside_m =
            bounds_of(self.bodies.iter().filter(|b| b.role == BodyRole::Fixed).flat_map(|b| &b.positions_m))
                .map_or(f32::NEG_INFINITY, |(low, _)| low[2]);
        let area_m2 = |patches: &[Patch]| patches.iter().map(|patch| patch.area_m2).sum::<f64>();
        let all_m2 = area_m2(&patches);
        let above: Vec<Patch> =
            patches.iter().copied().filter(|patch| patch.middle_m[2] >= underside_m).collect();
        let has_floor = !self.is_weightless && area_m2(&above) > LEAST_SHARE_ABOVE * all_m2;
        if has_floor {
            patches = above;
        }
        let core = [0, 1, 2].map(|axis| core_along(&mut patches, axis));
        let [x, y, z] = [core[0]?, core[1]?, core[2]?];
        let size_m = [x, y, z].iter().fold(0.0_f32, |most, [low, high]| most.max(high - low));
        let reach_m = REACH_SIZES * size_m;
        let mut low = [x, y, z].map(|[low, _]| low - reach_m);
        if has_floor {
            low[2] = low[2].max(underside_m - BELOW_SIZES * size_m);
        }
        (size_m > 0.0).then(|| (low, [x, y, z].map(|[_, high]| high + reach_m)))
    }

    /// The bodies that do not stand fixed.
    pub fn moving(&self) -> impl Iterator<Item = &BodyFrame> {
        self.bodies.iter().filter(|body| body.role != BodyRole::Fixed)
    }

    /// Triangles of the moving bodies, or evenly chosen ones where there are many.
    fn patches(&self) -> Vec<Patch> {
        let count: usize = self.moving().map(|body| body.surface.triangles.len()).sum();
        let triangles = self.moving().flat_map(|body| body.surface.triangles.iter().map(move |t| (body, t)));
        triangles
            .step_by(count.div_ceil(MOST_PATCHES).max(1))
            .filter_map(|(body, t)| body.patch(*t))
            .collect()
    }
}

/// Smallest and largest coordinates, metres.
pub type Bounds = ([f32; 3], [f32; 3]);

/// Share of the surface that may lie beyond each end of the core of a scene.
const CORE_TAIL: f64 = 0.1;
/// What is farther from the core than this many times its longest side has left the scene.
const REACH_SIZES: f32 = 2.5;
/// The same, for what is below the undersides of all fixed bodies.
const BELOW_SIZES: f32 = 0.5;
/// Share of the surface that must still be above the lowest fixed body for the rest to count as fallen off.
const LEAST_SHARE_ABOVE: f64 = 0.1;
/// Enough for tenths of a surface.
const MOST_PATCHES: usize = 1024;

/// A triangle of a surface, as far as its weight and place go.
#[derive(Clone, Copy, Debug)]
struct Patch {
    middle_m: [f32; 3],
    area_m2: f64,
}

impl BodyFrame {
    /// Lowest and highest corner of the box around it, m.
    #[must_use]
    pub fn bounds_m(&self) -> Option<Bounds> {
        bounds_of(self.positions_m.iter())
    }

    fn patch(&self, triangle: [u32; 3]) -> Option<Patch> {
        let [a, b, c] = triangle.map(|corner| self.positions_m.get(corner as usize).copied());
        let [a, b, c] = [Vec3::from(a?), Vec3::from(b?), Vec3::from(c?)];
        let area_m2 = f64::from(0.5 * (b - a).cross(c - a).length());
        (area_m2.is_finite() && area_m2 > 0.0)
            .then(|| Patch { middle_m: ((a + b + c) / 3.0).to_array(), area_m2 })
    }
}

/// Between which coordinates all but a tail of the surface lies.
fn core_along(patches: &mut [Patch], axis: usize) -> Option<[f32; 2]> {
    patches.sort_unstable_by(|a, b| a.middle_m[axis].total_cmp(&b.middle_m[axis]));
    let tail_m2 = CORE_TAIL * patches.iter().map(|patch| patch.area_m2).sum::<f64>();
    let [first, last] =
        [end_along(patches.iter(), axis, tail_m2), end_along(patches.iter().rev(), axis, tail_m2)];
    Some([first?, last?])
}

/// Where, passing along the surface, the tail is over.
fn end_along<'a>(mut patches: impl Iterator<Item = &'a Patch>, axis: usize, tail_m2: f64) -> Option<f32> {
    let mut passed_m2 = 0.0;
    let is_core = |patch: &&Patch| {
        passed_m2 += patch.area_m2;
        passed_m2 >= tail_m2
    };
    patches.find(is_core).map(|patch| patch.middle_m[axis])
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

    /// What values of this meaning are measured by; a failure index by failure itself, and colours without values by nothing.
    #[must_use]
    pub fn scale(self, scales: &Scales) -> f32 {
        match self {
            Self::Material | Self::Body | Self::Fragment => 0.0,
            Self::Speed => scales.wave_speed_m_s,
            Self::Displacement => scales.size_m,
            Self::VonMises | Self::MaxPrincipal | Self::MinPrincipal | Self::MeanStress => {
                scales.stiffness_pa
            }
            Self::FailureIndex => 1.0,
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

fn bounds_of<'a>(points: impl Iterator<Item = &'a [f32; 3]>) -> Option<Bounds> {
    points.fold(None, |bounds, p| {
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

    /// A level square of 1 m, in 50 triangles.
    fn square(role: BodyRole, [x, y, z]: [f32; 3]) -> BodyFrame {
        let at = |k: u32| [x + 0.2 * (k % 6) as f32, y + 0.2 * (k / 6) as f32, z];
        let cells = (0..25).map(|k| k + k / 5);
        let triangles = cells.flat_map(|k| [[k, k + 1, k + 7], [k, k + 7, k + 6]]).collect();
        BodyFrame {
            role,
            positions_m: (0..36).map(at).collect(),
            surface: Arc::new(SurfaceTopology { triangles, ..SurfaceTopology::default() }),
            ..BodyFrame::default()
        }
    }

    #[test]
    fn what_has_left_the_scene_is_not_near() {
        let shard = |at: [f32; 3]| BodyFrame {
            positions_m: [[0.0; 3], [0.01, 0.0, 0.0], [0.0, 0.01, 0.0]]
                .map(|p| [p[0] + at[0], p[1] + at[1], p[2] + at[2]])
                .to_vec(),
            surface: Arc::new(SurfaceTopology { triangles: vec![[0, 1, 2]], ..SurfaceTopology::default() }),
            ..BodyFrame::default()
        };
        let ground = square(BodyRole::Fixed, [0.0; 3]);
        let plate = square(BodyRole::Deformable, [0.0, 0.0, 0.1]);
        let near = |bodies: Vec<BodyFrame>| Frame { bodies, ..Frame::default() }.near_bounds_m().unwrap();
        let frame = |shards: Vec<BodyFrame>| {
            near([ground.clone(), plate.clone()].into_iter().chain(shards).collect())
        };
        let whole = ([0.0, 0.0, 0.1], [1.0, 1.0, 0.1]);
        assert_eq!(frame(vec![]), whole);
        // Fallen off, and flown away.
        assert_eq!(frame(vec![shard([0.5, 0.5, -40.0]), shard([90.0, 0.5, 3.0])]), whole);
        // One that is still about, and a coarse plate that is larger than what is fine on it.
        assert_eq!(frame(vec![shard([0.5, 0.5, 1.2])]).1[2], 1.2);
        assert_eq!(frame((0..300).map(|_| shard([0.5, 0.5, 0.1])).collect()), whole);
        // Most of it has fallen off, and is far below what is left; then all of it.
        let halves = |count: usize| (0..count).map(|_| square(BodyRole::Deformable, [0.0, 0.0, -30.0]));
        assert_eq!(frame(halves(4).collect()), whole);
        let below = near(std::iter::once(ground.clone()).chain(halves(2)).collect());
        assert_eq!(below, ([0.0, 0.0, -30.0], [1.0, 1.0, -30.0]));
        // Points alone, and broken numbers.
        let points = BodyFrame { positions_m: vec![[0.0; 3], [500.0, 0.0, 0.0]], ..BodyFrame::default() };
        assert_eq!(near(vec![points]).1[0], 500.0);
        assert_eq!(frame(vec![shard([f32::NAN; 3])]), whole);
    }

    #[test]
    fn unknown_field_lists_the_choices() {
        let text = "vonmises".parse::<ColorBy>().unwrap_err().to_string();
        assert!(text.contains("'vonmises'") && text.contains("von-mises"), "{text}");
    }
}
