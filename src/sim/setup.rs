//! What a world is built from: plain data, checked by [`crate::sim::World::new`].

use super::{ContactChange, Entrance, Pull};
use crate::fem::ElementKinematics;
use crate::fracture::{Criterion, PropagationRule, SMALLEST_FRAGMENT_ELEMENTS};
use crate::mesh::TetMesh;
use glam::{DMat3, DQuat, DVec3};

/// An isotropic elastic material.
#[derive(Clone, Debug, PartialEq)]
pub struct Material {
    /// Name from the scene.
    pub name: String,
    /// Density, kg/m3, positive.
    pub density_kg_m3: f64,
    /// Young's modulus, Pa, positive.
    pub youngs_modulus_pa: f64,
    /// Poisson's ratio, in (-1, 0.5).
    pub poisson_ratio: f64,
    /// Mass-proportional damping alpha of C = alpha M, 1/s, not negative. Acts on deformation
    /// velocities relative to the body's rigid motion, so that it never slows flight or spin.
    pub damping_per_s: f64,
    /// Stiffness-proportional damping beta of C = beta K, s, not negative; costs stable step.
    pub stiffness_damping_s: f64,
    /// Base colour, sRGB 0..1.
    pub color_srgb: [f32; 3],
    /// When the material breaks; `None` for never.
    pub fracture: Option<Criterion>,
}

impl Material {
    /// Speed of waves along a slender bar of it, m/s.
    pub(super) fn bar_wave_speed_m_s(&self) -> f64 {
        (self.youngs_modulus_pa / self.density_kg_m3).sqrt()
    }

    /// An undamped grey material that never breaks.
    #[must_use]
    pub fn elastic(name: &str, density_kg_m3: f64, youngs_modulus_pa: f64, poisson_ratio: f64) -> Self {
        Self {
            name: name.to_owned(),
            density_kg_m3,
            youngs_modulus_pa,
            poisson_ratio,
            damping_per_s: 0.0,
            stiffness_damping_s: 0.0,
            color_srgb: [0.5; 3],
            fracture: None,
        }
    }
}

/// Strain measure and what is split off the motion (METHOD 1).
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Kinematics {
    /// Green-Lagrange strain of the total displacement.
    #[default]
    Green,
    /// Linear stiffness of the reference shape in the body's own rotating frame.
    BodyFrame,
    /// Small strain in each element's own rotated frame.
    Corotated,
    /// Stable neo-Hookean law, for large and soft deformation.
    NeoHookean,
}

impl Kinematics {
    /// All of them with the names that scenes give them.
    pub const NAMED: [(&str, Self); 4] = [
        ("green", Self::Green),
        ("body-frame", Self::BodyFrame),
        ("corotated", Self::Corotated),
        ("neo-hookean", Self::NeoHookean),
    ];

    /// For the elements of a body that is turned by `orientation`.
    pub(crate) fn of_elements(self, orientation: DQuat) -> ElementKinematics {
        match self {
            Self::Green => ElementKinematics::Green,
            Self::BodyFrame => ElementKinematics::BodyFrame { rotation: DMat3::from_quat(orientation) },
            Self::Corotated => ElementKinematics::Corotated,
            Self::NeoHookean => ElementKinematics::NeoHookean,
        }
    }
}

/// How a body moves.
#[derive(Clone, Debug, PartialEq)]
pub enum BodyMotion {
    /// By its own dynamics.
    Deformable(Kinematics),
    /// Never.
    Fixed,
    /// As prescribed, whatever touches it.
    Kinematic(PrescribedMotion),
}

/// Rigid motion at constant velocity and spin within a time window, at rest outside it.
#[derive(Clone, Debug, PartialEq)]
pub struct PrescribedMotion {
    /// Velocity of the centre, m/s.
    pub velocity_m_s: DVec3,
    /// Angular velocity about the centre of the body's bounding box, rad/s.
    pub spin_rad_s: DVec3,
    /// When the motion starts, s.
    pub start_s: f64,
    /// When it stops, s; infinity for never.
    pub stop_s: f64,
}

/// What happens at selected nodes.
#[derive(Clone, Debug, PartialEq)]
pub enum BoundaryAction {
    /// Held at the start position along the axes marked true (x, y, z).
    Fixed {
        /// Which axes are held.
        axes: [bool; 3],
    },
    /// Moved with a prescribed velocity along the axes marked true.
    Velocity {
        /// Velocity, m/s.
        velocity_m_s: DVec3,
        /// Which axes are prescribed.
        axes: [bool; 3],
    },
    /// A total force shared over the nodes in proportion to their mass.
    Force {
        /// Total force, N.
        total_n: DVec3,
        /// Time over which it grows linearly from zero, s; zero for at once.
        ramp_s: f64,
    },
}

/// A boundary condition of one body.
#[derive(Clone, Debug, PartialEq)]
pub struct BoundaryCondition {
    /// Node indices of the body's mesh, not empty.
    pub nodes: Vec<u32>,
    /// What happens there.
    pub action: BoundaryAction,
}

/// One body of the world.
#[derive(Clone, Debug, PartialEq)]
pub struct BodySetup {
    /// Unique name, for messages and columns.
    pub name: String,
    /// Shape at the start, placed in the world, free of stress.
    pub mesh: TetMesh,
    /// Materials of the body, at least one.
    pub materials: Vec<Material>,
    /// Material of each tetrahedron, an index into `materials`.
    pub element_material: Vec<u32>,
    /// How the body moves.
    pub motion: BodyMotion,
    /// Velocity of the centre of mass at the start, m/s.
    pub velocity_m_s: DVec3,
    /// Angular velocity about the centre of mass at the start, rad/s.
    pub spin_rad_s: DVec3,
    /// Boundary conditions.
    pub boundary: Vec<BoundaryCondition>,
    /// Largest share of the body's mass that may be added to raise the stable step of its worst
    /// elements; 0 switches mass scaling off.
    pub mass_scaling_max_share: f64,
}

impl BodySetup {
    /// A deformable body of one material, at rest and without supports.
    #[must_use]
    pub fn at_rest(name: &str, mesh: TetMesh, material: Material) -> Self {
        Self {
            name: name.to_owned(),
            element_material: vec![0; mesh.tets.len()],
            mesh,
            materials: vec![material],
            motion: BodyMotion::Deformable(Kinematics::Green),
            velocity_m_s: DVec3::ZERO,
            spin_rad_s: DVec3::ZERO,
            boundary: Vec::new(),
            mass_scaling_max_share: 0.0,
        }
    }

    /// Whether the body can break.
    #[must_use]
    pub fn can_break(&self) -> bool {
        matches!(self.motion, BodyMotion::Deformable(_))
            && self.materials.iter().any(|m| m.fracture.is_some())
    }
}

/// Why a body with a material that breaks cannot be of these kinematics, and why it cannot have this mass scaling (the largest
/// share, see [`BodySetup::mass_scaling_max_share`]): the end of a sentence that begins with "a body that can break".
#[must_use]
pub fn bars_to_breaking(kinematics: Kinematics, mass_scaling_max_share: f64) -> [Option<&'static str>; 2] {
    let of_kinematics = "cannot have kinematics \"body-frame\", which has one frame for the whole body while pieces turn each \
                         by itself; \"green\", \"corotated\" and \"neo-hookean\" can";
    let of_scaling = "cannot have mass scaling; leave one of them out";
    [
        (kinematics == Kinematics::BodyFrame).then_some(of_kinematics),
        (mass_scaling_max_share > 0.0).then_some(of_scaling),
    ]
}

/// How contact is enforced.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum ContactMethod {
    /// Forward Lagrange multipliers (METHOD 5).
    Lagrange {
        /// Gauss-Seidel passes that should do, at least 1; more are taken while the multipliers still change
        /// or a penetration is left.
        passes: u32,
        /// Largest relative change of a multiplier at which the passes stop (1e-4 = 0.01 %).
        tolerance: f64,
        /// Whether what an impact takes is given back when the pair opens.
        conserve_impact_energy: bool,
    },
    /// Springs between node and patch: the baseline.
    Penalty {
        /// Spring stiffness, N/m.
        stiffness_n_m: f64,
    },
}

/// Friction coefficient of one pair of bodies.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PairFriction {
    /// The two bodies, indices into [`WorldSetup::bodies`], in any order.
    pub bodies: [usize; 2],
    /// Coulomb friction coefficient mu = tan(phi), not negative.
    pub friction_coefficient: f64,
}

/// Contact between all bodies.
#[derive(Clone, Debug, PartialEq)]
pub struct ContactParameters {
    /// Enforcement.
    pub method: ContactMethod,
    /// Coulomb friction coefficient mu = tan(phi), not negative.
    pub friction_coefficient: f64,
    /// Exceptions for named pairs.
    pub pair_friction: Vec<PairFriction>,
    /// Whether bodies collide with themselves.
    pub self_collision: bool,
    /// Closing speed below which an impact gives nothing back, m/s; `None` derives it from gravity and step.
    pub rest_speed_m_s: Option<f64>,
}

impl Default for ContactParameters {
    fn default() -> Self {
        Self {
            method: ContactMethod::Lagrange { passes: 3, tolerance: 1e-4, conserve_impact_energy: true },
            friction_coefficient: 0.3,
            pair_friction: Vec::new(),
            self_collision: true,
            rest_speed_m_s: None,
        }
    }
}

/// Intervals of time.
#[derive(Clone, Debug, PartialEq)]
pub struct TimeParameters {
    /// Share of the stability limit that elastic steps use, in (0, 1].
    pub cfl: f64,
    /// Free-travel interval D_r, s, positive.
    pub free_interval_s: f64,
    /// Whether bodies that touch nothing and do not vibrate move as rigid bodies.
    pub free_travel: bool,
    /// Share of a body's largest vibration energy since its last touch, below which the rest is
    /// dropped (and booked as dissipated) and the body returns to free travel or to sleep.
    pub vibration_tolerance: f64,
    /// Whether resting islands may sleep.
    pub sleeping: bool,
    /// Upper limit of the elastic step, s; infinity for none.
    pub max_step_s: f64,
}

impl Default for TimeParameters {
    fn default() -> Self {
        Self {
            cfl: 0.8,
            free_interval_s: 1.0 / 240.0,
            free_travel: true,
            vibration_tolerance: 1e-3,
            sleeping: true,
            max_step_s: f64::INFINITY,
        }
    }
}

/// The crack spacing when the scene does not say.
const CRACK_SPACING_ELEMENTS: f64 = 3.0;

/// The smallest altitude when the scene does not say.
const SMALLEST_ALTITUDE_SHARE: f64 = 0.25;

/// How cracks grow, in every body with a material that breaks.
#[derive(Clone, Debug, PartialEq)]
pub struct FractureParameters {
    /// Which failed elements make a node crack.
    pub rule: PropagationRule,
    /// Fastest crack, m/s, positive; `None` takes half of the body's slowest shear wave speed.
    pub crack_speed_m_s: Option<f64>,
    /// Most elements of a body; `None` takes eight times those it starts with.
    pub max_elements: Option<u32>,
    /// No fragment below the mass of so many of the body's average elements comes off; not negative.
    pub smallest_fragment_elements: f64,
    /// How far from a crack no other starts until the relief has arrived, in distances of neighbouring nodes; not negative.
    pub crack_spacing_elements: f64,
    /// No cut leaves an element with a smaller altitude than this share of the smallest one in the mesh as given; above 0,
    /// at most 1. Small ones let cracks run where they want, at the price of small steps.
    pub smallest_altitude_share: f64,
}

impl Default for FractureParameters {
    fn default() -> Self {
        Self {
            rule: PropagationRule::default(),
            crack_speed_m_s: None,
            max_elements: None,
            smallest_fragment_elements: SMALLEST_FRAGMENT_ELEMENTS,
            crack_spacing_elements: CRACK_SPACING_ELEMENTS,
            smallest_altitude_share: SMALLEST_ALTITUDE_SHARE,
        }
    }
}

/// What happens to the bodies on the way.
#[derive(Clone, Debug, PartialEq)]
pub enum Change {
    /// A body comes in, as a thrown one does; see [`crate::sim::World::enter`].
    Enter(Box<Entrance>),
    /// The body of this name is taken out.
    Leave(String),
    /// Contact changes.
    Contact(Box<ContactChange>),
    /// Somebody grabs a body.
    Pull(Box<Pull>),
}

/// A change at the end of the first step that reaches its time.
#[derive(Clone, Debug, PartialEq)]
pub struct PlannedChange {
    /// When, s.
    pub time_s: f64,
    /// What.
    pub change: Change,
}

/// Everything a world starts from.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct WorldSetup {
    /// Gravity, m/s2.
    pub gravity_m_s2: DVec3,
    /// The bodies.
    pub bodies: Vec<BodySetup>,
    /// Contact.
    pub contact: ContactParameters,
    /// Time.
    pub time: TimeParameters,
    /// Growth of cracks.
    pub fracture: FractureParameters,
    /// What comes in or goes out later, by ascending time.
    pub changes: Vec<PlannedChange>,
}
