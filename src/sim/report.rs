//! What a step tells about itself.

use crate::contact::Settling;
use glam::DVec3;

/// Stage of the two-interval scheme (METHOD 3).
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Stage {
    /// Nothing touches and nothing vibrates.
    #[default]
    Free,
    /// Bodies move without contact, at least one of them vibrating.
    Vibrating,
    /// The step that ends at the exact first touch.
    Beginning,
    /// At least one contact pair presses.
    Collision,
    /// The step in which the contact list emptied.
    End,
    /// Everything is at rest.
    Resting,
}

impl Stage {
    /// The word in `history.csv` and captions.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Free => "free",
            Self::Vibrating => "vibrating",
            Self::Beginning => "beginning",
            Self::Collision => "collision",
            Self::End => "end",
            Self::Resting => "resting",
        }
    }
}

/// What one step did.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct StepReport {
    /// Time after the step, s.
    pub time_s: f64,
    /// Length of the step, s.
    pub step_s: f64,
    /// Stage.
    pub stage: Stage,
    /// Elastic steps taken inside (0 in free travel).
    pub elastic_steps: u32,
    /// Pairs that pressed.
    pub contact_pairs: u32,
    /// How the Gauss-Seidel passes went, of the worst island.
    pub settling: Settling,
    /// Deepest penetration at the end of the step, m.
    pub max_penetration_m: f64,
    /// Deepest penetration over the local element size, at the end of the step.
    pub max_penetration_ratio: f64,
    /// Sum over the pairs of the length of the contact force, N, mean over the step.
    pub contact_force_n: f64,
}

/// The balances at one moment: one row of `history.csv`.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Sample {
    /// The step that led here.
    pub step: StepReport,
    /// Kinetic energy, J.
    pub kinetic_j: f64,
    /// Strain energy, J.
    pub strain_j: f64,
    /// Potential energy of gravity relative to the start, J.
    pub potential_j: f64,
    /// Energy dissipated by damping, friction, plastic impact, dropped vibration, J.
    pub dissipated_j: f64,
    /// Work of applied forces, prescribed motion and kinematic bodies, J.
    pub external_work_j: f64,
    /// Linear momentum, kg m/s.
    pub linear_momentum_kg_m_s: DVec3,
    /// Angular momentum about the world's origin, kg m2/s.
    pub angular_momentum_kg_m2_s: DVec3,
    /// Number of tetrahedra.
    pub elements: usize,
    /// Number of nodes.
    pub nodes: usize,
    /// Connected pieces of the deformable bodies.
    pub fragments: usize,
    /// Area of crack faces, one side counted, m2.
    pub crack_area_m2: f64,
}

impl Sample {
    /// Kinetic + strain + potential + dissipated - external work: constant when all is well, J.
    #[must_use]
    pub fn balance_j(&self) -> f64 {
        self.kinetic_j + self.strain_j + self.potential_j + self.dissipated_j - self.external_work_j
    }
}

/// Wall time by phase since the start, seconds; for the summary only, never in results.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct PhaseTimes {
    /// Elastic forces and integration.
    pub elastic_s: f64,
    /// Search for contact.
    pub detection_s: f64,
    /// Contact response.
    pub response_s: f64,
    /// Looking for failure, cutting, and building anew what was cut.
    pub fracture_s: f64,
    /// Free travel and everything else inside steps.
    pub other_s: f64,
}

impl PhaseTimes {
    /// All but `other_s`, s.
    #[must_use]
    pub fn counted_s(&self) -> f64 {
        self.elastic_s + self.detection_s + self.response_s + self.fracture_s
    }
}
