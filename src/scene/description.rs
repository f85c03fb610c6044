//! A scene as plain data: what the text says, checked value by value, before any mesh is made.
//!
//! Lengths are metres, times seconds, angles radians, axes the world's with z up, unless a field says
//! otherwise. What the simulation takes as it stands ([`Material`], [`BodyMotion`], ...) is used here too.

use crate::frame::ColorBy;
use crate::sim::{
    BodyMotion, BoundaryAction, ContactChange, ContactMethod, FractureParameters, Material, Pull,
    TimeParameters,
};
use glam::{DQuat, DVec3, Vec3};

pub use super::shape::Shape;

/// The name under which the ground takes part in contact and messages.
pub const GROUND: &str = "ground";

/// A whole scene.
#[derive(Clone, Debug, PartialEq)]
pub struct SceneDescription {
    /// Title, for lists and captions.
    pub title: String,
    /// What there is to see, a sentence or two.
    pub description: String,
    /// Gravity, m/s2.
    pub gravity_m_s2: DVec3,
    /// The materials that bodies can name, those of the library that they do name included.
    pub materials: Vec<Material>,
    /// The ground, if any.
    pub ground: Option<Ground>,
    /// The bodies, in the order of the text; copies not yet made.
    pub bodies: Vec<Body>,
    /// Contact.
    pub contact: Contact,
    /// How much time is simulated, s.
    pub duration_s: f64,
    /// Intervals of time.
    pub time: TimeParameters,
    /// Growth of cracks.
    pub fracture: FractureParameters,
    /// Views that pictures can name; the first is the default. May be empty: the automatic view.
    pub cameras: Vec<Camera>,
    /// How pictures and data are recorded.
    pub recording: Recording,
    /// Bodies that are taken out on the way.
    pub removals: Vec<Removal>,
    /// Contact that changes on the way.
    pub contact_changes: Vec<LateContact>,
    /// Springs that pull at bodies.
    pub pulls: Vec<Pull>,
}

/// A change of contact.
#[derive(Clone, Debug, PartialEq)]
pub struct LateContact {
    /// When, s.
    pub at_s: f64,
    /// What.
    pub change: ContactChange,
}

/// A body that is taken out.
#[derive(Clone, Debug, PartialEq)]
pub struct Removal {
    /// Its name.
    pub body: String,
    /// When, s.
    pub at_s: f64,
}

/// A level, fixed, square block of ground.
#[derive(Clone, Debug, PartialEq)]
pub struct Ground {
    /// Height of its top, m.
    pub height_m: f64,
    /// Centre of its top, m.
    pub center_m: [f64; 2],
    /// Side of the square, m.
    pub size_m: f64,
    /// Thickness, m.
    pub thickness_m: f64,
    /// Name of its material.
    pub material: String,
    /// Friction coefficient against every other body; `None` takes the scene's.
    pub friction_coefficient: Option<f64>,
    /// Colour in place of the material's, sRGB 0..1.
    pub color_srgb: Option<[f32; 3]>,
}

/// One `[[bodies]]` entry: one body, or several alike.
#[derive(Clone, Debug, PartialEq)]
pub struct Body {
    /// Name; copies are called `name-1`, `name-2`, ...
    pub name: String,
    /// Shape.
    pub shape: Shape,
    /// Material.
    pub material: BodyMaterial,
    /// Colour in place of the materials', sRGB 0..1.
    pub color_srgb: Option<[f32; 3]>,
    /// How it moves.
    pub motion: BodyMotion,
    /// Where it is at the start.
    pub placement: Placement,
    /// Copies.
    pub copies: Copies,
    /// Velocity of the centre of mass at the start, m/s.
    pub velocity_m_s: DVec3,
    /// Angular velocity about the centre of mass at the start, rad/s.
    pub spin_rad_s: DVec3,
    /// Boundary conditions.
    pub boundary: Vec<Boundary>,
    /// Largest share of the mass that may be added for the sake of the stable step.
    pub mass_scaling_max_share: f64,
    /// When the body comes in, s; `None`: it is there from the start.
    pub enters_s: Option<f64>,
}

impl Body {
    /// The names of the bodies that this entry stands for: its own, or `name-1`, `name-2`, ...
    #[must_use]
    pub fn names_of_copies(&self) -> Vec<String> {
        match self.copies.count {
            1 => vec![self.name.clone()],
            count => (1..=count).map(|n| format!("{}-{n}", self.name)).collect(),
        }
    }
}

/// Which material a body is of.
#[derive(Clone, Debug, PartialEq)]
pub enum BodyMaterial {
    /// One for the whole body, by name.
    One(String),
    /// One for each region: (region, material).
    ByRegion(Vec<(String, String)>),
}

impl BodyMaterial {
    /// The materials' names.
    pub fn names(&self) -> impl Iterator<Item = &str> {
        let (one, many) = match self {
            Self::One(name) => (Some(name.as_str()), [].as_slice()),
            Self::ByRegion(pairs) => (None, pairs.as_slice()),
        };
        let many = many.iter().map(|(_, name): &(String, String)| name.as_str());
        one.into_iter().chain(many)
    }
}

/// Where a body is at the start.
#[derive(Clone, Debug, PartialEq)]
pub struct Placement {
    /// Where the middle of the shape's bounding box goes, m. The z is not used with `on`.
    pub position_m: DVec3,
    /// How the shape is turned about that point.
    pub rotation: DQuat,
    /// The body (or the ground) it stands on or hangs above.
    pub on: Option<String>,
    /// Free height between it and what it stands on, m.
    pub gap_m: f64,
    /// The body in whose axes position, rotation and `on` are meant; `None` for the world's.
    pub axes_of: Option<String>,
}

/// Copies of a body, each moved and turned a little further than the one before.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Copies {
    /// How many bodies in all, at least 1.
    pub count: u32,
    /// Added to the position from one to the next, m.
    pub offset_m: DVec3,
    /// Turned from one to the next.
    pub rotation: DQuat,
}

/// A boundary condition.
#[derive(Clone, Debug, PartialEq)]
pub struct Boundary {
    /// Where it acts.
    pub at: Selection,
    /// What it does.
    pub action: BoundaryAction,
}

/// A choice of nodes.
#[derive(Clone, Debug, PartialEq)]
pub enum Selection {
    /// All nodes.
    All,
    /// The nodes of a named region.
    Region(String),
    /// The nodes at one side, no deeper than `depth_m`.
    Side {
        /// Which side.
        side: Side,
        /// How deep the layer is, m; zero for the outermost nodes only.
        depth_m: f64,
    },
    /// The nodes inside a box in the world, m.
    Box {
        /// Smallest corner.
        min_m: DVec3,
        /// Largest corner.
        max_m: DVec3,
    },
    /// The nodes inside a sphere in the world, m.
    Sphere {
        /// Centre.
        center_m: DVec3,
        /// Radius.
        radius_m: f64,
    },
}

/// A side of a body.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Side {
    /// Lowest in the world.
    Bottom,
    /// Highest in the world.
    Top,
    /// The end of the shape's own axis 0, 1 or 2, before it is turned: smallest or largest.
    Own {
        /// Axis.
        axis: usize,
        /// The largest end rather than the smallest.
        largest: bool,
    },
}

/// Contact between all bodies.
#[derive(Clone, Debug, PartialEq)]
pub struct Contact {
    /// Enforcement.
    pub method: ContactMethod,
    /// Friction coefficient of every pair not named below.
    pub friction_coefficient: f64,
    /// Pairs of body names with their own coefficient.
    pub pairs: Vec<([String; 2], f64)>,
    /// Whether bodies collide with themselves.
    pub self_collision: bool,
    /// Closing speed below which an impact gives nothing back, m/s; `None` derives it.
    pub rest_speed_m_s: Option<f64>,
}

/// A named view.
#[derive(Clone, Debug, PartialEq)]
pub struct Camera {
    /// Name.
    pub name: String,
    /// The point in the middle of the picture, m; `None` for the middle of what moves.
    pub target_m: Option<DVec3>,
    /// Where the eye is.
    pub eye: Eye,
    /// Vertical angle of view, degrees.
    pub field_of_view_deg: f64,
}

/// Where a camera's eye is.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Eye {
    /// At a point, m.
    At(DVec3),
    /// In a direction from the target.
    Around {
        /// Angle about z, degrees; 0 looks from -y towards +y, 90 from +x towards -x.
        yaw_deg: f64,
        /// Height above the horizon, degrees.
        pitch_deg: f64,
        /// Distance from the target, m; `None` for one that frames what moves.
        distance_m: Option<f64>,
    },
}

/// How pictures and data are recorded.
#[derive(Clone, Debug, PartialEq)]
pub struct Recording {
    /// Frames a second of the picture.
    pub fps: f64,
    /// How many times slower than life.
    pub slow_motion: f64,
    /// When recording of pictures starts, s.
    pub start_s: f64,
    /// Width and height, pixels.
    pub size_px: [u32; 2],
    /// What surfaces are coloured by.
    pub color_by: ColorBy,
    /// Name of the view; `None` for the first, or the automatic one.
    pub camera: Option<String>,
    /// Time between rows of the history, s; 0 for every step.
    pub history_every_s: f64,
    /// Ends of the colours, in the unit of what they mean; `None`: found from the values.
    pub color_range: Option<[f64; 2]>,
    /// The plane by which bodies are shown cut open.
    pub cut: Option<CutPlane>,
    /// Whether principal stresses are drawn as crosses.
    pub crosses: bool,
}

/// A plane by which bodies are shown cut open.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CutPlane {
    /// What lies in this direction is left out; not zero.
    pub across: DVec3,
    /// Where the plane is along the direction, m; `None`: in the middle of the bodies at the start.
    pub at_m: Option<f64>,
}

impl CutPlane {
    /// The direction as a unit vector in single precision; `None` where it has none.
    #[must_use]
    pub fn normal(&self) -> Option<Vec3> {
        self.across.normalize_or_zero().as_vec3().try_normalize()
    }
}
