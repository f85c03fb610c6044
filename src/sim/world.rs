//! The world: all bodies and their common time.

use super::arrival::start_clear;
use super::body::{Body, MassScaling, Regime};
use super::breaking::Breaking;
use super::broad::BroadPhase;
use super::contact_log::{ContactEpisode, ContactLog};
use super::elastic::StepContext;
use super::publish::{FrameParts, element_stress};
use super::rest::RestTracker;
use super::rigid::RigidMotion;
use super::touch::Touch;
use super::{BodySetup, ContactMethod, ContactParameters, PhaseTimes, Sample, StepReport, WorldSetup};
use crate::contact::CollisionList;
use crate::fracture::{CriterionError, Face, LimitsReached, SurfaceFace};
use crate::frame::ContactMark;
use crate::mesh::Pieces;
use glam::{DMat3, DVec3};

/// Why a world could not be built or a step could not be taken.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum SimError {
    /// The setup is unsound; the text says what, where and what to do.
    #[error("{0}")]
    Setup(String),
    /// A number stopped being finite.
    #[error(
        "body `{body}`: {what} of {place} is not finite in step {step} at t = {time_s:.6e} s; the run has blown \
         up (try a smaller time.cfl, or check the material's numbers)"
    )]
    NotFinite {
        /// Body.
        body: String,
        /// Quantity.
        what: &'static str,
        /// `element 12` or `element 12 (node 7)`.
        place: String,
        /// Step number.
        step: u64,
        /// Time, s.
        time_s: f64,
    },
    /// A typed failure criterion cannot be evaluated.
    #[error("body `{body}`, element {element}, t = {time_s:.6e} s: {error}")]
    Criterion {
        /// Body.
        body: String,
        /// Element.
        element: u32,
        /// Time, s.
        time_s: f64,
        /// What is wrong.
        error: CriterionError,
    },
}

impl SimError {
    /// The same error with its step number.
    pub(super) fn in_step(mut self, number: u64) -> Self {
        if let Self::NotFinite { step, .. } = &mut self {
            *step = number;
        }
        self
    }
}

/// Stress of one element.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ElementStress {
    /// Cauchy stress, Pa, tension positive, world axes.
    pub cauchy_pa: DMat3,
    /// Principal stresses, Pa, largest first.
    pub principal_pa: DVec3,
}

impl ElementStress {
    /// Of what is not strained. The default of a matrix would be the identity.
    pub const NONE: Self = Self { cauchy_pa: DMat3::ZERO, principal_pa: DVec3::ZERO };
}

/// The first touch of free bodies, looked up in advance.
#[derive(Clone, Default)]
pub(super) struct FreePlan {
    /// Regimes for which the plan was made.
    pub regimes: Vec<u8>,
    pub until_s: f64,
    pub touch: Option<Touch>,
}

/// An interval in which nothing deforms, and the motions at its start. Whoever looks at the world on the way gets
/// them moved on from there, so that looking changes nothing.
#[derive(Clone)]
pub(super) struct FreeInterval {
    pub start_s: f64,
    pub end_s: f64,
    pub touch: Option<Touch>,
    /// By body; `None` for what does not travel freely.
    pub motions: Vec<Option<RigidMotion>>,
}

impl Regime {
    /// A number per regime, to notice changes.
    pub(super) fn number(&self) -> u8 {
        match self {
            Self::Fixed => 0,
            Self::Kinematic => 1,
            Self::Free(_) => 2,
            Self::Elastic => 3,
            Self::Asleep => 4,
        }
    }
}

/// All bodies and their common time.
#[derive(Clone)]
pub struct World {
    pub(super) setup: WorldSetup,
    pub(super) bodies: Vec<Body>,
    pub(super) rest: Vec<RestTracker>,
    pub(super) frame_parts: Vec<FrameParts>,
    pub(super) broad: BroadPhase,
    pub(super) list: CollisionList,
    pub(super) plan: FreePlan,
    pub(super) free_interval: Option<FreeInterval>,
    pub(super) time_s: f64,
    pub(super) steps: u64,
    pub(super) last: StepReport,
    pub(super) log: ContactLog,
    pub(super) marks: Vec<ContactMark>,
    pub(super) phases: PhaseTimes,
    pub(super) fragments: usize,
    pub(super) contact_dissipated_j: f64,
    pub(super) contact_work_j: f64,
    /// Energy in penalty springs and in what pairs have stored of impacts, J.
    pub(super) spring_j: f64,
    pub(super) largest_penetration_ratio: f64,
    /// Of the planned changes, how many were made.
    pub(super) changes_made: usize,
    /// Friction of bodies with all others, newcomers included, as it was changed on the way.
    pub(super) body_friction: Vec<(String, f64)>,
}

/// Failure time of an element that has never taken part in a crack, s.
pub const NEVER_FAILED_S: f64 = -1.0;

impl World {
    /// Builds the world from plain data.
    ///
    /// # Errors
    /// [`SimError::Setup`] when a body, material or parameter is unsound.
    pub fn new(setup: WorldSetup) -> Result<Self, SimError> {
        check(&setup)?;
        let mut bodies = setup
            .bodies
            .iter()
            .map(|body| Body::new(body, &setup.fracture))
            .collect::<Result<Vec<_>, _>>()?;
        for body in &mut bodies {
            start(body, &setup)?;
        }
        let frame_parts = bodies.iter().zip(&setup.bodies).map(|(b, s)| FrameParts::new(b, s)).collect();
        let deformable = bodies.iter().filter(|b| b.is_deformable());
        let fragments = deformable.map(|b| Pieces::by_faces(&b.tets).count).sum();
        Ok(Self {
            broad: BroadPhase::new(bodies.len(), setup.contact.self_collision),
            rest: vec![RestTracker::default(); bodies.len()],
            frame_parts,
            fragments,
            setup,
            bodies,
            list: CollisionList::default(),
            plan: FreePlan::default(),
            free_interval: None,
            time_s: 0.0,
            steps: 0,
            last: StepReport::default(),
            log: ContactLog::default(),
            marks: Vec::new(),
            phases: PhaseTimes::default(),
            contact_dissipated_j: 0.0,
            contact_work_j: 0.0,
            spring_j: 0.0,
            largest_penetration_ratio: 0.0,
            changes_made: 0,
            body_friction: Vec::new(),
        })
    }

    /// Simulated time, s.
    #[must_use]
    pub fn time_s(&self) -> f64 {
        self.time_s
    }

    /// Steps taken.
    #[must_use]
    pub fn steps(&self) -> u64 {
        self.steps
    }

    /// The balances now.
    #[must_use]
    pub fn sample(&self) -> Sample {
        let sum = |f: fn(&Body) -> f64| self.bodies.iter().map(f).sum::<f64>();
        let moved: DVec3 = self.bodies.iter().map(Body::mass_displacement).sum();
        let deformable = || self.bodies.iter().filter(|b| b.is_deformable());
        Sample {
            step: self.last,
            kinetic_j: sum(Body::kinetic_j),
            strain_j: sum(Body::strain_j) + self.spring_j,
            potential_j: -self.setup.gravity_m_s2.dot(moved),
            dissipated_j: sum(|b| b.ledger.damped_j + b.ledger.dropped_j) + self.contact_dissipated_j
                - self.spring_j,
            external_work_j: sum(|b| b.ledger.external_j) + self.contact_work_j,
            linear_momentum_kg_m_s: self.bodies.iter().map(Body::linear_momentum).sum(),
            angular_momentum_kg_m2_s: self.bodies.iter().map(Body::angular_momentum).sum(),
            elements: deformable().map(|b| b.tets.len()).sum(),
            nodes: deformable().map(|b| b.reference_m.len()).sum(),
            fragments: self.fragments,
            crack_area_m2: self.breaking().fold(0.0, |sum, b| sum + b.crack_area_m2),
        }
    }

    /// Of the body whose cuts have come nearest to the shortest step that they can make: its name, its stable step in the reference
    /// shape, s, and that floor, s. `None` where nothing can break.
    #[must_use]
    pub fn step_and_its_floor_s(&self) -> Option<(&str, f64, f64)> {
        let steps = self.bodies.iter().filter_map(|body| {
            let (breaking, elasticity) = (body.breaking.as_ref()?, body.elasticity.as_ref()?);
            Some((body.name.as_str(), elasticity.critical_step_s, breaking.step_floor_s))
        });
        steps.min_by(|a, b| (a.1 / a.2).total_cmp(&(b.1 / b.2)))
    }

    /// Limits of fracture that were reached so far, summed over the bodies.
    #[must_use]
    pub fn fracture_limits_reached(&self) -> LimitsReached {
        let mut sum = LimitsReached::default();
        self.breaking().for_each(|b| sum += b.limits);
        sum
    }

    /// Fragment of each element of a body; empty for a body that cannot break.
    #[must_use]
    pub fn fragment_of_element(&self, body: usize) -> &[u32] {
        self.bodies[body].breaking.as_ref().map_or(&[], |b| b.solid.fragments().of_element())
    }

    /// Failure index of each element of a body (0 unstressed, 1 fails); empty for a body that cannot break.
    #[must_use]
    pub fn failure_indices(&self, body: usize) -> Vec<f64> {
        let Some(breaking) = &self.bodies[body].breaking else { return Vec::new() };
        let stresses = self.element_stresses(body);
        let indexed = (0_u32..).zip(&stresses);
        indexed.map(|(element, stress)| breaking.failure_index(element, &stress.cauchy_pa)).collect()
    }

    /// Material of an element.
    #[must_use]
    pub fn material_of(&self, body: usize, element: u32) -> Option<&super::Material> {
        let setup = self.setup.bodies.get(body)?;
        let index = match &self.bodies[body].breaking {
            Some(breaking) => breaking.material(element),
            None => *setup.element_material.get(element as usize)?,
        };
        setup.materials.get(index as usize)
    }

    /// When each element of a body first took part in a crack, s, or [`NEVER_FAILED_S`]; parts of an element that was
    /// cut have its time. Empty for a body that cannot break.
    #[must_use]
    pub fn failure_times_s(&self, body: usize) -> &[f64] {
        self.bodies[body].breaking.as_ref().map_or(&[], |b| &b.failure_times_s)
    }

    /// The cracked faces of a body: element and which of its faces, as in [`crate::mesh::TET_FACES`].
    pub fn crack_faces(&self, body: usize) -> impl Iterator<Item = SurfaceFace> + '_ {
        let breaking = self.bodies[body].breaking.as_ref();
        let surface = breaking.into_iter().flat_map(|b| b.solid.surface());
        surface.filter(|face| matches!(face.kind, Face::Crack { .. }))
    }

    fn breaking(&self) -> impl Iterator<Item = &Breaking> {
        self.bodies.iter().filter_map(|b| b.breaking.as_ref())
    }

    /// Wall time by phase.
    #[must_use]
    pub fn phase_times(&self) -> PhaseTimes {
        self.phases
    }

    /// Contacts so far, in the order of their first touch.
    #[must_use]
    pub fn contact_episodes(&self) -> &[ContactEpisode] {
        &self.log.episodes
    }

    /// Deepest penetration so far over the local element size.
    #[must_use]
    pub fn largest_penetration_ratio(&self) -> f64 {
        self.largest_penetration_ratio
    }

    /// The setup the world was built from.
    #[must_use]
    pub fn setup(&self) -> &WorldSetup {
        &self.setup
    }

    /// Changes how bodies meet, from the next step on.
    ///
    /// # Errors
    /// [`SimError::Setup`] when a parameter is unsound; the world keeps its parameters then.
    pub fn set_contact_parameters(&mut self, contact: ContactParameters) -> Result<(), SimError> {
        let before = std::mem::replace(&mut self.setup.contact, contact);
        if let Err(error) = check(&self.setup) {
            self.setup.contact = before;
            return Err(error);
        }
        self.broad.self_collision = self.setup.contact.self_collision;
        // What rested by friction may slide now.
        for body in 0..self.bodies.len() {
            if self.bodies[body].regime == Regime::Asleep {
                self.wake(body);
            }
        }
        Ok(())
    }

    /// Adds a body at the present time and returns its number. Where it would be in the same space as another body, it starts
    /// above that body instead.
    ///
    /// # Errors
    /// [`SimError::Setup`] when the body is unsound or its name is taken; the world stays as it is then.
    pub fn add_body(&mut self, mut setup: BodySetup) -> Result<usize, SimError> {
        if self.bodies.iter().any(|b| b.name == setup.name) {
            return Err(SimError::Setup(format!("there is a body `{}` already", setup.name)));
        }
        self.place_free_bodies();
        let bodies: Vec<_> = self.bodies.iter().map(|b| (&b.position_m[..], &b.tets[..])).collect();
        start_clear(&mut setup.mesh, &bodies);
        let mut body = Body::new(&setup, &self.setup.fracture)?;
        start(&mut body, &self.setup)?;
        // Who throws it does the work.
        body.ledger.external_j += body.kinetic_j();
        if body.is_deformable() {
            self.fragments += Pieces::by_faces(&body.tets).count;
        }
        self.frame_parts.push(FrameParts::new(&body, &setup));
        self.rest.push(RestTracker::default());
        self.broad.add_body();
        // The first touch was looked up without the newcomer.
        self.plan = FreePlan::default();
        self.free_interval = None;
        self.bodies.push(body);
        self.setup.bodies.push(setup);
        Ok(self.bodies.len() - 1)
    }

    /// Takes a body out at the present time. Its number stays; its energy leaves as work done on the outside.
    ///
    /// # Errors
    /// [`SimError::Setup`] when there never was a body of that number.
    pub fn remove_body(&mut self, index: usize) -> Result<(), SimError> {
        match self.bodies.get(index) {
            None => return Err(SimError::Setup(format!("there is no body number {index}"))),
            Some(body) if body.is_removed => return Ok(()),
            Some(_) => {}
        }
        self.place_free_bodies();
        let gravity = self.setup.gravity_m_s2;
        let body = &mut self.bodies[index];
        if body.is_deformable() {
            self.fragments -= body.pieces();
        }
        body.remove(gravity);
        self.list = self.list.without(index as u32);
        self.broad.forget(index);
        self.frame_parts[index].forget_surface();
        self.plan = FreePlan::default();
        self.free_interval = None;
        // What leaned on it falls.
        for other in 0..self.bodies.len() {
            if self.bodies[other].regime == Regime::Asleep {
                self.wake(other);
            }
        }
        Ok(())
    }

    /// Whether the body was taken out.
    #[must_use]
    pub fn is_removed(&self, body: usize) -> bool {
        self.bodies[body].is_removed
    }

    /// Makes the planned changes that are due; returns when the next one is.
    pub(super) fn make_planned_changes(&mut self) -> Result<f64, SimError> {
        while let Some(planned) = self.setup.changes.get(self.changes_made) {
            if planned.time_s > self.time_s {
                return Ok(planned.time_s);
            }
            let change = planned.change.clone();
            self.changes_made += 1;
            match change {
                super::Change::Enter(entrance) => drop(self.enter(&entrance)?),
                super::Change::Leave(name) => {
                    let body = self.bodies.iter().position(|b| b.name == name);
                    body.map_or(Ok(()), |body| self.remove_body(body))?;
                }
                super::Change::Contact(change) => self.change_contact(&change)?,
                super::Change::Pull(pull) => self.pull(&pull)?,
            }
        }
        Ok(f64::INFINITY)
    }

    /// Memory that a copy of the world takes, bytes, as an estimate: a plate of 20,000 elements, whose nodes all lie on its
    /// surface, took 11 MB, whole and with cracks.
    #[must_use]
    pub fn memory_bytes(&self) -> usize {
        const BASE: usize = 64 << 10;
        const PER_ELEMENT: usize = 400;
        const PER_NODE: usize = 400;
        let of_body = |b: &Body| b.tets.len() * PER_ELEMENT + b.reference_m.len() * PER_NODE;
        BASE + self.bodies.iter().map(of_body).sum::<usize>()
    }

    /// Whether some body deforms at present, so that the next step is an elastic one.
    #[must_use]
    pub fn is_deforming(&self) -> bool {
        self.bodies.iter().any(|b| b.regime == Regime::Elastic)
    }

    /// Number of bodies.
    #[must_use]
    pub fn body_count(&self) -> usize {
        self.bodies.len()
    }

    /// Reference positions of a body's nodes, m.
    #[must_use]
    pub fn reference_positions_m(&self, body: usize) -> &[DVec3] {
        &self.bodies[body].reference_m
    }

    /// Positions of a body's nodes, m; for bodies in free travel as of the last time a step reached its
    /// limit.
    #[must_use]
    pub fn positions_m(&self, body: usize) -> &[DVec3] {
        &self.bodies[body].position_m
    }

    /// Velocities of a body's nodes, m/s; see [`Self::positions_m`].
    #[must_use]
    pub fn velocities_m_s(&self, body: usize) -> &[DVec3] {
        &self.bodies[body].velocity_m_s
    }

    /// Tetrahedra of a body.
    #[must_use]
    pub fn tets(&self, body: usize) -> &[[u32; 4]] {
        &self.bodies[body].tets
    }

    /// Stress of every element of a body; zero for bodies in free travel, fixed and kinematic ones.
    #[must_use]
    pub fn element_stresses(&self, body: usize) -> Vec<ElementStress> {
        let body = &self.bodies[body];
        match (&body.elasticity, body.regime) {
            (Some(e), Regime::Elastic | Regime::Asleep) => {
                let cauchy = e.elements.cauchy_stresses_pa(&body.position_m, body.element_kinematics());
                cauchy.into_iter().map(element_stress).collect()
            }
            _ => vec![ElementStress::NONE; body.tets.len()],
        }
    }

    /// Stable elastic step of a body, s (infinite for fixed and kinematic bodies).
    #[must_use]
    pub fn stable_step_s(&self, body: usize) -> f64 {
        self.bodies[body].stable_step_s()
    }

    /// Mass of a body, with what mass scaling added, kg.
    #[must_use]
    pub fn mass_kg(&self, body: usize) -> f64 {
        self.bodies[body].reference.mass_kg
    }

    /// Linear momentum of a body, kg m/s.
    #[must_use]
    pub fn body_momentum_kg_m_s(&self, body: usize) -> DVec3 {
        self.bodies[body].linear_momentum()
    }

    /// Best-fit rotation and centre of mass of a body now.
    #[must_use]
    pub fn body_pose(&self, body: usize) -> (glam::DQuat, DVec3) {
        let rigid = self.bodies[body].rigid_part();
        (rigid.orientation, rigid.centre_m)
    }

    /// What mass scaling did to a body.
    #[must_use]
    pub fn mass_scaling(&self, body: usize) -> MassScaling {
        self.bodies[body].elasticity.as_ref().map(|e| e.mass_scaling).unwrap_or_default()
    }

    /// Angle by which the frame of a `body-frame` body, advanced by its dynamics, missed the best fit,
    /// summed over the steps, rad.
    #[must_use]
    pub fn frame_drift_rad(&self, body: usize) -> f64 {
        self.bodies[body].elasticity.as_ref().map_or(0.0, |e| e.frame_drift_rad)
    }
}

/// Brings a body into its first regime.
fn start(body: &mut Body, setup: &WorldSetup) -> Result<(), SimError> {
    if !body.is_deformable() {
        return Ok(());
    }
    if setup.time.free_travel && body.can_travel_freely() {
        body.regime = Regime::Free(body.rigid_part());
        return Ok(());
    }
    let context = StepContext { time_s: 0.0, step_s: 0.0, gravity_m_s2: setup.gravity_m_s2 };
    body.update_acceleration(&context)
}

fn check(setup: &WorldSetup) -> Result<(), SimError> {
    let fail = |text: &str| Err(SimError::Setup(text.to_owned()));
    let time = &setup.time;
    let comes = |planned: &super::PlannedChange| matches!(planned.change, super::Change::Enter(_));
    if setup.bodies.is_empty() && !setup.changes.iter().any(comes) {
        return fail("the world has no bodies");
    }
    if !(time.cfl > 0.0 && time.cfl <= 1.0) {
        return fail("time.cfl must lie in (0, 1]");
    }
    if !(time.free_interval_s > 0.0 && time.free_interval_s.is_finite()) {
        return fail("the free-travel interval must be a positive time");
    }
    if time.max_step_s.is_nan() || time.max_step_s <= 0.0 {
        return fail("the largest step must be a positive time");
    }
    if !setup.gravity_m_s2.is_finite() {
        return fail("gravity must be finite");
    }
    let friction = setup.contact.pair_friction.iter().map(|p| p.friction_coefficient);
    let mut all_friction = friction.chain([setup.contact.friction_coefficient]);
    if all_friction.any(|mu| !(mu >= 0.0 && mu.is_finite())) {
        return fail("friction coefficients must be zero or above");
    }
    match setup.contact.method {
        ContactMethod::Lagrange { passes: 0, .. } => fail("contact needs at least one pass"),
        ContactMethod::Penalty { stiffness_n_m } if !(stiffness_n_m > 0.0 && stiffness_n_m.is_finite()) => {
            fail("the penalty stiffness must be positive")
        }
        _ => Ok(()),
    }
}
