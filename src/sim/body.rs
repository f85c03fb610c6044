//! A body: its shape, its elements, its state.

use super::breaking::Breaking;
use super::pull::Grip;
use super::rigid::RigidMotion;
use super::step_factor::HeldStepFactor;
use super::{
    BodyMotion, BodySetup, BoundaryAction, FractureParameters, Kinematics, PrescribedMotion, SimError,
};
use crate::contact::ContactSurface;
use crate::fem::{ElasticConstants, ElementBatches, ElementKinematics, ForceScratch};
use crate::math::{MassProperties, best_fit_rotation};
use crate::mesh::Surface;
use glam::{DMat3, DQuat, DVec3};

/// What a body does at present.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Regime {
    /// Never moves.
    Fixed,
    /// Moves as prescribed.
    Kinematic,
    /// Free travel: moves as a rigid body.
    Free(RigidMotion),
    /// Deforms; takes elastic steps.
    Elastic,
    /// At rest; skipped until something wakes it.
    Asleep,
}

/// How far down a body goes that was taken out, m: beyond everything that can be seen or met.
const OUT_OF_REACH_M: f64 = 1e9;

/// A velocity that a node must have along some axes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct PrescribedNode {
    pub node: u32,
    pub velocity_m_s: DVec3,
    pub axes: [bool; 3],
}

/// A force that grows to its full size over a time.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Load {
    /// Node and its share of the force, N.
    pub node_forces_n: Vec<(u32, DVec3)>,
    pub ramp_s: f64,
}

impl Load {
    /// Share of the full force at a time.
    pub fn share(&self, time_s: f64) -> f64 {
        if self.ramp_s > 0.0 { (time_s / self.ramp_s).clamp(0.0, 1.0) } else { 1.0 }
    }
}

/// Energies that left or entered the body, J, since the start.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Ledger {
    /// Taken by damping.
    pub damped_j: f64,
    /// Vibration dropped on return to free travel or to sleep.
    pub dropped_j: f64,
    /// Work of loads and prescribed nodes.
    pub external_j: f64,
}

/// Mass added to raise the stable step.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct MassScaling {
    /// Mass added, kg.
    pub added_kg: f64,
    /// Share of the body's own mass.
    pub added_share: f64,
    /// Elements that were made heavier.
    pub elements: usize,
    /// Stable step before, s.
    pub step_before_s: f64,
    /// Stable step after, s.
    pub step_after_s: f64,
}

/// The elastic half of a body; fixed and kinematic bodies have none.
#[derive(Clone)]
pub(super) struct Elasticity {
    pub kinematics: Kinematics,
    pub elements: ElementBatches,
    pub scratch: ForceScratch,
    /// 2 / omega_max of the reference shape, s.
    pub critical_step_s: f64,
    /// Mass-proportional damping, 1/s.
    pub damping_per_s: f64,
    /// Stiffness-proportional damping, s.
    pub stiffness_damping_s: f64,
    /// What damping by stiffness adds to the accelerations of the nodes, m/s2; empty without it.
    pub damping_m_s2: Vec<DVec3>,
    pub strain_energy_j: f64,
    /// Factor on the critical step for large strain.
    pub step_factor: HeldStepFactor,
    pub mass_scaling: MassScaling,
    /// Largest angle by which the frame advanced by dynamics missed the best fit in one step, summed, rad.
    pub frame_drift_rad: f64,
}

/// One body of the world.
#[derive(Clone)]
pub(super) struct Body {
    pub name: String,
    pub motion: BodyMotion,
    pub reference_m: Vec<DVec3>,
    pub tets: Vec<[u32; 4]>,
    pub boundary: Surface,
    pub surface: ContactSurface,
    pub elasticity: Option<Elasticity>,
    /// How the body breaks; `None` for what never does.
    pub breaking: Option<Breaking>,
    pub mass_kg: Vec<f64>,
    /// 1/m along x, y, z; zero where the motion is prescribed.
    pub inverse_mass_per_kg: Vec<DVec3>,
    /// Mass, centre and inertia of the reference shape.
    pub reference: MassProperties,
    /// Arms of the nodes from the reference centre of mass, m.
    pub arms_m: Vec<DVec3>,
    pub radius_m: f64,
    /// By ascending node.
    pub prescribed: Vec<PrescribedNode>,
    pub loads: Vec<Load>,
    /// Pulls at work.
    pub grips: Vec<Grip>,
    pub position_m: Vec<DVec3>,
    pub velocity_m_s: Vec<DVec3>,
    /// Acceleration by elastic forces, loads and gravity at `position_m`, m/s2.
    pub acceleration_m_s2: Vec<DVec3>,
    pub force_n: Vec<DVec3>,
    /// Orientation of the body's frame (body-frame kinematics; warm start of best fits otherwise).
    pub orientation: DQuat,
    pub regime: Regime,
    pub ledger: Ledger,
    /// Mean local element size of the surface, m.
    pub mean_size_m: f64,
    /// Young's modulus of the softest of its materials, Pa.
    pub softest_pa: f64,
    /// Largest vibration energy since the last touch, J.
    pub vibration_reference_j: f64,
    /// Whether it was taken out of the world.
    pub is_removed: bool,
}

impl Body {
    /// Builds a body.
    pub fn new(setup: &BodySetup, fracture: &FractureParameters) -> Result<Self, SimError> {
        check(setup)?;
        let breaking = Breaking::new(setup, fracture)?;
        let mesh = &setup.mesh;
        let boundary = Surface::of(&mesh.tets);
        let surface = ContactSurface::new(&boundary, &mesh.nodes_m);
        let (elasticity, mass_kg) = build_elasticity(setup)?;
        let reference = MassProperties::of_points(&mass_kg, &mesh.nodes_m);
        let arms_m: Vec<DVec3> = mesh.nodes_m.iter().map(|x| *x - reference.centre_m).collect();
        let mean_size_m = surface.mean_size_m();
        let nodes = mesh.nodes_m.len();
        let mut body = Self {
            name: setup.name.clone(),
            motion: setup.motion.clone(),
            reference_m: mesh.nodes_m.clone(),
            tets: mesh.tets.clone(),
            radius_m: arms_m.iter().map(|a| a.length()).fold(0.0, f64::max),
            boundary,
            surface,
            inverse_mass_per_kg: vec![DVec3::ZERO; nodes],
            elasticity,
            breaking,
            reference,
            arms_m,
            prescribed: Vec::new(),
            loads: Vec::new(),
            grips: Vec::new(),
            position_m: mesh.nodes_m.clone(),
            velocity_m_s: vec![DVec3::ZERO; nodes],
            acceleration_m_s2: vec![DVec3::ZERO; nodes],
            force_n: vec![DVec3::ZERO; nodes],
            orientation: DQuat::IDENTITY,
            regime: Regime::Fixed,
            ledger: Ledger::default(),
            mean_size_m,
            softest_pa: setup.materials.iter().map(|m| m.youngs_modulus_pa).fold(f64::INFINITY, f64::min),
            vibration_reference_j: 0.0,
            is_removed: false,
            mass_kg,
        };
        body.apply_boundary(setup);
        body.start_moving(setup);
        Ok(body)
    }

    fn apply_boundary(&mut self, setup: &BodySetup) {
        if self.elasticity.is_some() {
            self.inverse_mass_per_kg = self.mass_kg.iter().map(|m| DVec3::splat(1.0 / m)).collect();
        }
        for condition in &setup.boundary {
            match condition.action {
                BoundaryAction::Fixed { axes } => self.prescribe(&condition.nodes, DVec3::ZERO, axes),
                BoundaryAction::Velocity { velocity_m_s, axes } => {
                    self.prescribe(&condition.nodes, velocity_m_s, axes);
                }
                BoundaryAction::Force { total_n, ramp_s } => {
                    self.loads.push(shared_load(&condition.nodes, &self.mass_kg, total_n, ramp_s));
                }
            }
        }
        // Of several conditions on a node the last one counts.
        self.prescribed.sort_by_key(|p| p.node);
    }

    fn prescribe(&mut self, nodes: &[u32], velocity_m_s: DVec3, axes: [bool; 3]) {
        for &node in nodes {
            self.prescribed.push(PrescribedNode { node, velocity_m_s, axes });
            let inverse = &mut self.inverse_mass_per_kg[node as usize];
            *inverse = DVec3::select(glam::BVec3::from_array(axes), DVec3::ZERO, *inverse);
        }
    }

    fn start_moving(&mut self, setup: &BodySetup) {
        let centre = self.reference.centre_m;
        for (v, x) in self.velocity_m_s.iter_mut().zip(&self.position_m) {
            *v = setup.velocity_m_s + setup.spin_rad_s.cross(*x - centre);
        }
        self.regime = match self.motion {
            BodyMotion::Fixed => Regime::Fixed,
            BodyMotion::Kinematic(_) => Regime::Kinematic,
            BodyMotion::Deformable(_) => Regime::Elastic,
        };
        if !self.is_deformable() {
            self.velocity_m_s.fill(DVec3::ZERO);
        }
        self.enforce_prescribed_velocities();
    }

    /// How a node is held.
    pub fn prescribed_at(&self, node: u32) -> &[PrescribedNode] {
        let [from, to] = [node, node + 1].map(|n| self.prescribed.partition_point(|p| p.node < n));
        &self.prescribed[from..to]
    }

    /// Sets the prescribed velocities of nodes.
    pub fn enforce_prescribed_velocities(&mut self) {
        for p in &self.prescribed {
            let v = &mut self.velocity_m_s[p.node as usize];
            *v = DVec3::select(glam::BVec3::from_array(p.axes), p.velocity_m_s, *v);
        }
    }

    /// Whether the body has elements that deform.
    pub fn is_deformable(&self) -> bool {
        self.elasticity.is_some()
    }

    /// Connected pieces.
    pub fn pieces(&self) -> usize {
        match &self.breaking {
            Some(breaking) => breaking.solid.fragments().list().len(),
            None => crate::mesh::Pieces::by_faces(&self.tets).count,
        }
    }

    /// Takes the body out: what is left of it stands still where nothing ever comes, and its energy is booked as gone
    /// to the outside.
    pub fn remove(&mut self, gravity_m_s2: DVec3) {
        let potential_j = -gravity_m_s2.dot(self.mass_displacement());
        self.ledger.external_j -= self.kinetic_j() + self.strain_j() + potential_j;
        self.is_removed = true;
        self.regime = Regime::Fixed;
        self.motion = BodyMotion::Fixed;
        self.elasticity = None;
        self.breaking = None;
        self.grips.clear();
        self.velocity_m_s.fill(DVec3::ZERO);
        self.inverse_mass_per_kg.fill(DVec3::ZERO);
        self.position_m.iter_mut().for_each(|x| x.z -= OUT_OF_REACH_M);
    }

    /// Whether the body has come apart.
    pub fn is_broken(&self) -> bool {
        self.breaking.as_ref().is_some_and(Breaking::is_broken)
    }

    /// Whether nothing holds, loads or pulls the body and it is in one piece, so that it can travel freely.
    pub fn can_travel_freely(&self) -> bool {
        let is_free = self.prescribed.is_empty() && self.loads.is_empty() && self.grips.is_empty();
        self.is_deformable() && is_free && !self.is_broken()
    }

    /// Linear momentum, kg m/s.
    pub fn linear_momentum(&self) -> DVec3 {
        match self.regime {
            Regime::Fixed | Regime::Kinematic => DVec3::ZERO,
            Regime::Free(motion) => motion.velocity_m_s * self.reference.mass_kg,
            _ => self.mass_kg.iter().zip(&self.velocity_m_s).map(|(m, v)| *v * *m).sum(),
        }
    }

    /// Angular momentum about the world's origin, kg m2/s.
    pub fn angular_momentum(&self) -> DVec3 {
        match self.regime {
            Regime::Fixed | Regime::Kinematic => DVec3::ZERO,
            Regime::Free(motion) => {
                let momentum = motion.velocity_m_s * self.reference.mass_kg;
                motion.centre_m.cross(momentum) + motion.angular_momentum
            }
            _ => {
                let nodes = self.mass_kg.iter().zip(&self.velocity_m_s).zip(&self.position_m);
                nodes.map(|((m, v), x)| x.cross(*v) * *m).sum()
            }
        }
    }

    /// Kinetic energy, J.
    pub fn kinetic_j(&self) -> f64 {
        match self.regime {
            Regime::Fixed | Regime::Kinematic => 0.0,
            Regime::Free(motion) => motion.kinetic_j(self.reference.mass_kg),
            _ => {
                let nodes = self.mass_kg.iter().zip(&self.velocity_m_s);
                nodes.map(|(m, v)| 0.5 * m * v.length_squared()).sum()
            }
        }
    }

    /// Strain energy, J.
    pub fn strain_j(&self) -> f64 {
        match self.regime {
            Regime::Elastic | Regime::Asleep => self.elasticity.as_ref().map_or(0.0, |e| e.strain_energy_j),
            _ => 0.0,
        }
    }

    /// First moment of mass relative to the start, `sum m (x - X)`, kg m.
    pub fn mass_displacement(&self) -> DVec3 {
        match self.regime {
            Regime::Fixed | Regime::Kinematic => DVec3::ZERO,
            Regime::Free(motion) => (motion.centre_m - self.reference.centre_m) * self.reference.mass_kg,
            _ => {
                let nodes = self.mass_kg.iter().zip(&self.position_m).zip(&self.reference_m);
                nodes.map(|((m, x), start)| (*x - *start) * *m).sum()
            }
        }
    }

    /// The rigid part of the present motion: momentum, angular momentum and best-fit orientation.
    pub fn rigid_part(&self) -> RigidMotion {
        if let Regime::Free(motion) = self.regime {
            return motion;
        }
        let now = MassProperties::of_points(&self.mass_kg, &self.position_m);
        let momentum = self.linear_momentum();
        let angular_momentum = self.angular_momentum() - now.centre_m.cross(momentum);
        RigidMotion {
            centre_m: now.centre_m,
            velocity_m_s: momentum / self.reference.mass_kg,
            orientation: self.best_fit_orientation(now.centre_m),
            angular_momentum,
            inertia: self.reference.inertia_kg_m2,
        }
    }

    /// Mass-weighted best-fit rotation of the reference shape to the present one.
    pub fn best_fit_orientation(&self, centre_m: DVec3) -> DQuat {
        let mut moment = DMat3::ZERO;
        for ((m, x), arm) in self.mass_kg.iter().zip(&self.position_m).zip(&self.arms_m) {
            let d = (*x - centre_m) * *m;
            moment += DMat3::from_cols(d * arm.x, d * arm.y, d * arm.z);
        }
        best_fit_rotation(&moment, self.orientation)
    }

    /// Writes node positions and velocities of a rigid motion.
    pub fn take_rigid_state(&mut self, motion: &RigidMotion) {
        let turn = DMat3::from_quat(motion.orientation);
        let spin = motion.spin_rad_s();
        for (i, arm) in self.arms_m.iter().enumerate() {
            let arm_now = turn * *arm;
            self.position_m[i] = motion.centre_m + arm_now;
            self.velocity_m_s[i] = motion.velocity_m_s + spin.cross(arm_now);
        }
        self.orientation = motion.orientation;
    }

    /// Kinematics for the element kernel.
    pub fn element_kinematics(&self) -> ElementKinematics {
        self.elasticity
            .as_ref()
            .map_or(ElementKinematics::Green, |e| e.kinematics.of_elements(self.orientation))
    }
}

fn shared_load(nodes: &[u32], mass_kg: &[f64], total_n: DVec3, ramp_s: f64) -> Load {
    let sum_kg: f64 = nodes.iter().map(|n| mass_kg[*n as usize]).sum();
    let share = |n: &u32| (*n, total_n * (mass_kg[*n as usize] / sum_kg));
    Load { node_forces_n: nodes.iter().map(share).collect(), ramp_s }
}

/// Pose of a prescribed motion at a time: displacement of the centre and rotation about it.
pub(super) fn prescribed_pose(motion: &PrescribedMotion, time_s: f64) -> (DVec3, DQuat) {
    let active_s = time_s.clamp(motion.start_s, motion.stop_s.max(motion.start_s)) - motion.start_s;
    (motion.velocity_m_s * active_s, crate::math::rotation_from_vector(motion.spin_rad_s * active_s))
}

fn check(setup: &BodySetup) -> Result<(), SimError> {
    let fail = |text: String| Err(SimError::Setup(format!("body `{}`: {text}", setup.name)));
    let mesh = &setup.mesh;
    if mesh.tets.is_empty() {
        return fail("has no tetrahedra".to_owned());
    }
    if setup.materials.is_empty() {
        return fail("has no material".to_owned());
    }
    if setup.element_material.len() != mesh.tets.len() {
        return fail("needs one material per element".to_owned());
    }
    if let Some(wrong) = setup.element_material.iter().find(|m| **m as usize >= setup.materials.len()) {
        return fail(format!("refers to material {wrong}, which it does not have"));
    }
    if let Some(node) = mesh.nodes_m.iter().position(|x| !x.is_finite()) {
        return fail(format!("node {node} has a coordinate that is not a finite number"));
    }
    let vectors = [setup.velocity_m_s, setup.spin_rad_s];
    if vectors.iter().any(|v| !v.is_finite()) {
        return fail("velocity and spin must be finite".to_owned());
    }
    if !(0.0..=1.0).contains(&setup.mass_scaling_max_share) {
        return fail("mass_scaling_max_share must lie between 0 and 1".to_owned());
    }
    for condition in &setup.boundary {
        if condition.nodes.is_empty() {
            return fail("a boundary condition selects no node".to_owned());
        }
        if condition.nodes.iter().any(|n| *n as usize >= mesh.nodes_m.len()) {
            return fail("a boundary condition names a node that does not exist".to_owned());
        }
    }
    Ok(())
}

/// Elastic constants of the materials of a body.
pub(super) fn elastic_constants(setup: &BodySetup) -> Result<Vec<ElasticConstants>, SimError> {
    let constants = setup.materials.iter().map(|m| {
        ElasticConstants::new(m.youngs_modulus_pa, m.poisson_ratio, m.density_kg_m3)
            .map_err(|e| SimError::Setup(format!("body `{}`: material `{}`: {e}", setup.name, m.name)))
    });
    constants.collect()
}

fn build_elasticity(setup: &BodySetup) -> Result<(Option<Elasticity>, Vec<f64>), SimError> {
    let fail = |text: String| SimError::Setup(format!("body `{}`: {text}", setup.name));
    let constants = elastic_constants(setup)?;
    let per_element: Vec<ElasticConstants> =
        setup.element_material.iter().map(|m| constants[*m as usize]).collect();
    let mesh = &setup.mesh;
    let mut elements =
        ElementBatches::new(&mesh.nodes_m, &mesh.tets, &per_element).map_err(|e| fail(e.to_string()))?;
    let BodyMotion::Deformable(kinematics) = setup.motion else {
        let mass_kg = elements.lumped_masses_kg(None);
        return Ok((None, mass_kg));
    };
    let (mass_kg, mass_scaling) = scale_masses(&mut elements, setup.mass_scaling_max_share);
    let mean = |value: fn(&super::Material) -> f64| {
        let volumes = setup.element_material.iter().zip(elements.element_masses_kg());
        let (sum, total) = volumes.fold((0.0, 0.0), |(sum, total), (m, kg)| {
            (sum + value(&setup.materials[*m as usize]) * kg, total + kg)
        });
        sum / total
    };
    let elasticity = Elasticity {
        kinematics,
        critical_step_s: mass_scaling.step_after_s,
        damping_per_s: mean(|m| m.damping_per_s),
        stiffness_damping_s: mean(|m| m.stiffness_damping_s),
        damping_m_s2: Vec::new(),
        elements,
        scratch: ForceScratch::default(),
        strain_energy_j: 0.0,
        step_factor: HeldStepFactor::default(),
        mass_scaling,
        frame_drift_rad: 0.0,
    };
    Ok((Some(elasticity), mass_kg))
}

/// Lumped masses, and what scaling them up to `max_share` of the body's mass did.
fn scale_masses(elements: &mut ElementBatches, max_share: f64) -> (Vec<f64>, MassScaling) {
    let mass_kg = elements.lumped_masses_kg(None);
    let step_before_s = elements.share_masses(&mass_kg);
    if max_share <= 0.0 {
        let none = MassScaling { step_before_s, step_after_s: step_before_s, ..MassScaling::default() };
        return (mass_kg, none);
    }
    let scaled = elements.scale_node_masses(&mass_kg, max_share);
    elements.share_masses_evenly(scaled.step_s);
    let report = MassScaling {
        added_kg: scaled.added_mass_kg,
        added_share: scaled.added_mass_kg / mass_kg.iter().sum::<f64>(),
        elements: scaled.heavier_elements,
        step_before_s,
        step_after_s: scaled.step_s,
    };
    (scaled.node_masses_kg, report)
}
