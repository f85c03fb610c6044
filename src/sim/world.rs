//! The world: all bodies and their common time.

use super::{PhaseTimes, Sample, StepReport, WorldSetup};
use crate::frame::Frame;
use glam::{DMat3, DVec3};

/// Why a world could not be built or a step could not be taken.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum SimError {
    /// The setup is unsound; the text says what, where and what to do.
    #[error("{0}")]
    Setup(String),
    /// A number stopped being finite.
    #[error(
        "body `{body}`: {what} at {place} is not finite in step {step} at t = {time_s:.6e} s; \
         the run has blown up (try a smaller time.cfl, or check the material's numbers)"
    )]
    NotFinite {
        /// Body.
        body: String,
        /// Quantity.
        what: &'static str,
        /// `element 12` or `node 7`.
        place: String,
        /// Step number.
        step: u64,
        /// Time, s.
        time_s: f64,
    },
}

/// Stress of one element.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct ElementStress {
    /// Cauchy stress, Pa, tension positive, world axes.
    pub cauchy_pa: DMat3,
    /// Principal stresses, Pa, largest first.
    pub principal_pa: DVec3,
}

/// All bodies and their common time.
pub struct World {
    setup: WorldSetup,
    time_s: f64,
    steps: u64,
}

impl World {
    /// Builds the world from plain data.
    ///
    /// # Errors
    /// [`SimError::Setup`] when a body, material or parameter is unsound or bodies overlap.
    pub fn new(setup: WorldSetup) -> Result<Self, SimError> {
        Ok(Self { setup, time_s: 0.0, steps: 0 })
    }

    /// Simulated time, s.
    #[must_use]
    pub fn time_s(&self) -> f64 {
        self.time_s
    }

    /// Advances by one step, not beyond `limit_s` (absolute time).
    ///
    /// # Errors
    /// [`SimError::NotFinite`] when the run blows up; the state before the step stays readable.
    pub fn step(&mut self, limit_s: f64) -> Result<StepReport, SimError> {
        let step_s = (limit_s - self.time_s).min(1e-3);
        self.time_s += step_s;
        self.steps += 1;
        Ok(StepReport { time_s: self.time_s, step_s, ..StepReport::default() })
    }

    /// The balances now.
    #[must_use]
    pub fn sample(&self) -> Sample {
        Sample::default()
    }

    /// What a renderer needs of this moment.
    #[must_use]
    pub fn publish(&self) -> Frame {
        Frame::default()
    }

    /// Wall time by phase.
    #[must_use]
    pub fn phase_times(&self) -> PhaseTimes {
        PhaseTimes::default()
    }

    /// The setup the world was built from.
    #[must_use]
    pub fn setup(&self) -> &WorldSetup {
        &self.setup
    }
    /// Number of bodies.
    #[must_use]
    pub fn body_count(&self) -> usize {
        self.setup.bodies.len()
    }
    /// Reference positions of a body's nodes, m.
    #[must_use]
    pub fn reference_positions_m(&self, body: usize) -> &[DVec3] {
        &self.setup.bodies[body].mesh.nodes_m
    }
    /// Current positions of a body's nodes, m.
    #[must_use]
    pub fn positions_m(&self, body: usize) -> &[DVec3] {
        &self.setup.bodies[body].mesh.nodes_m
    }
    /// Velocities of a body's nodes, m/s.
    #[must_use]
    pub fn velocities_m_s(&self, body: usize) -> Vec<DVec3> {
        vec![DVec3::ZERO; self.setup.bodies[body].mesh.nodes_m.len()]
    }
    /// Tetrahedra of a body.
    #[must_use]
    pub fn tets(&self, body: usize) -> &[[u32; 4]] {
        &self.setup.bodies[body].mesh.tets
    }
    /// Stress of every element of a body.
    #[must_use]
    pub fn element_stresses(&self, body: usize) -> Vec<ElementStress> {
        vec![ElementStress::default(); self.setup.bodies[body].mesh.tets.len()]
    }
    /// Stable elastic step of a body, s (infinite for fixed and kinematic bodies).
    #[must_use]
    pub fn stable_step_s(&self, _body: usize) -> f64 {
        f64::INFINITY
    }
}
