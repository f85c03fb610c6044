//! The elastic step of one body: half a kick, contact, drift, forces, half a kick.
//!
//! Central differences with lumped mass and damping (METHOD 2), written as velocity Verlet: positions and
//! velocities belong to the same moment at the end of every step, so steps may change in length and
//! bodies may join and leave an island at any time. It is the leapfrog scheme
//! `v_(n+1/2) = v_(n-1/2) + h a_n`, `x_(n+1) = x_n + h v_(n+1/2)`, cut in the middle of the kick.

use super::body::Body;
use super::{Kinematics, SimError};
use crate::fem::NotFinitePlace;
use crate::math::{MassProperties, inertia_of_point_kg_m2, rotation_from_vector, solve_inertia};
use glam::{BVec3, DMat3, DQuat, DVec3};
use rayon::prelude::*;

/// Bodies with fewer nodes are not worth a second thread in node loops.
const PARALLEL_NODES: usize = 8192;
const CHUNK: usize = 2048;

/// What the world is like for a body in a step.
#[derive(Clone, Copy, Debug)]
pub(super) struct StepContext {
    pub time_s: f64,
    pub step_s: f64,
    pub gravity_m_s2: DVec3,
}

impl Body {
    /// Largest stable step now, s: the reference shape's, reduced for large strain, for damping by
    /// stiffness and for springs that pull.
    pub fn stable_step_s(&self) -> f64 {
        let Some(elasticity) = &self.elasticity else { return f64::INFINITY };
        let step_s = elasticity.critical_step_s * elasticity.step_factor.factor();
        self.pulled_step_s(crate::fem::damped_step_s(step_s, elasticity.stiffness_damping_s))
    }

    /// About the time that a wave takes to cross the body, s.
    pub fn crossing_s(&self) -> f64 {
        let elements = 2.0 * self.radius_m / self.mean_size_m.max(f64::MIN_POSITIVE);
        elements * self.stable_step_s().min(1.0)
    }

    /// First half of the kick: velocities become those of the middle of the step.
    pub fn kick_first_half(&mut self, c: &StepContext) {
        self.book_prescribed_work(c);
        self.add_acceleration(0.5 * c.step_s);
        self.enforce_prescribed_velocities();
    }

    /// Moves the nodes with the (contact-corrected) velocities, half of the damping before and half after.
    pub fn drift(&mut self, step_s: f64) {
        self.damp(step_s);
        for_nodes(&mut self.position_m, &self.velocity_m_s, |x, v| *x += *v * step_s);
        self.damp(step_s);
    }

    /// Second half of the kick, after [`Self::update_acceleration`] at the new positions.
    pub fn kick_second_half(&mut self, c: &StepContext) {
        self.book_prescribed_work(c);
        if let Some(breaking) = &self.breaking {
            self.ledger.damped_j -= breaking.releases.work_j(&self.velocity_m_s, c.step_s);
        }
        self.add_acceleration(0.5 * c.step_s);
        self.enforce_prescribed_velocities();
    }

    fn add_acceleration(&mut self, duration_s: f64) {
        for_nodes(&mut self.velocity_m_s, &self.acceleration_m_s2, |v, a| *v += *a * duration_s);
    }

    /// Work of the supports over half a step, J: the reaction `-m a` times the prescribed way.
    fn book_prescribed_work(&mut self, c: &StepContext) {
        for p in &self.prescribed {
            let node = p.node as usize;
            let power = self.acceleration_m_s2[node] * p.velocity_m_s * -self.mass_kg[node];
            let power = DVec3::select(BVec3::from_array(p.axes), power, DVec3::ZERO);
            self.ledger.external_j += power.element_sum() * 0.5 * c.step_s;
        }
    }

    /// Half a step of lumped damping `C = alpha M` on what is not rigid motion (on everything where supports
    /// hold the body); the energy taken is booked.
    ///
    /// The full factor `(1 - alpha h/2)/(1 + alpha h/2)` is that of central differences. It acts on velocities that
    /// contact has corrected already: damping the prediction would book energy that a pressed node never has.
    fn damp(&mut self, step_s: f64) {
        let alpha = self.elasticity.as_ref().map_or(0.0, |e| e.damping_per_s);
        if alpha <= 0.0 {
            return;
        }
        let half = 0.5 * alpha * step_s;
        let factor = ((1.0 - half).max(0.0) / (1.0 + half)).sqrt();
        if self.is_broken() {
            return self.damp_fragments(factor);
        }
        let rigid = self.rigid_velocity();
        self.ledger.damped_j += damp_nodes(
            &mut self.velocity_m_s,
            (&self.position_m, &self.mass_kg, &self.inverse_mass_per_kg),
            factor,
            |_| Some(rigid),
        );
    }

    /// Damps each fragment by itself; those that supports hold, as a whole.
    fn damp_fragments(&mut self, factor: f64) {
        let Some(breaking) = &self.breaking else { return };
        let fragment_of_node = breaking.fragment_of_node();
        let mut rigid = vec![RigidSums::ZERO; breaking.solid.fragments().list().len()];
        let nodes = fragment_of_node.iter().zip(&self.mass_kg).zip(&self.position_m);
        for (((fragment, m), x), v) in nodes.zip(&self.velocity_m_s) {
            if let Some(sums) = rigid.get_mut(*fragment as usize) {
                sums.add(*m, *x, *v);
            }
        }
        let mut motions: Vec<_> = rigid.iter().map(RigidSums::motion).collect();
        for p in &self.prescribed {
            if let Some(motion) = motions.get_mut(fragment_of_node[p.node as usize] as usize) {
                *motion = Default::default();
            }
        }
        self.ledger.damped_j += damp_nodes(
            &mut self.velocity_m_s,
            (&self.position_m, &self.mass_kg, &self.inverse_mass_per_kg),
            factor,
            |node| motions.get(fragment_of_node[node] as usize).copied(),
        );
    }

    /// Largest speed of a surface node as seen from a frame that moves and turns along, m/s: nodes come nearer to each other
    /// at twice that at most, since what is rigid in a motion brings nothing nearer to anything.
    pub fn inner_speed_m_s(&self) -> f64 {
        let velocity_m_s = self.inner_velocity_m_s();
        let seen = |n: &u32| velocity_m_s(*n);
        let bounds = (DVec3::INFINITY, DVec3::NEG_INFINITY);
        let nodes = self.surface.nodes.iter();
        let (low, high) = nodes.clone().map(seen).fold(bounds, |(l, h), v| (l.min(v), h.max(v)));
        // The mean of a body of which a part was struck lies near the part that was not.
        let middle = 0.5 * (low + high);
        nodes.map(|n| (seen(n) - middle).length_squared()).fold(0.0, f64::max).sqrt()
    }

    /// Velocity of a node as seen from a frame that moves and turns along, m/s.
    pub fn inner_velocity_m_s(&self) -> impl Fn(u32) -> DVec3 {
        let (centre, velocity, spin) = self.rigid_velocity();
        move |node| {
            let n = node as usize;
            self.velocity_m_s[n] - velocity - spin.cross(self.position_m[n] - centre)
        }
    }

    /// Centre, velocity and spin of the rigid motion with the same momenta; zero for held bodies.
    fn rigid_velocity(&self) -> (DVec3, DVec3, DVec3) {
        if !self.prescribed.is_empty() {
            return (DVec3::ZERO, DVec3::ZERO, DVec3::ZERO);
        }
        rigid_velocity(&self.mass_kg, &self.position_m, &self.velocity_m_s)
    }

    /// Advances the body's frame by `step_s` (body-frame kinematics): by Theorem 1 with the angular
    /// velocity of the momentum, which carries all torques and the gyroscopic term, then on to the
    /// mass-weighted best fit of the nodes; the difference of the two is the drift.
    pub fn advance_frame(&mut self, step_s: f64) {
        let is_needed = self.elasticity.as_ref().is_some_and(|e| e.kinematics == Kinematics::BodyFrame);
        if !is_needed {
            return;
        }
        let (_, _, spin) = self.rigid_velocity();
        let predicted: DQuat = rotation_from_vector(spin * step_s) * self.orientation;
        let centre = MassProperties::of_points(&self.mass_kg, &self.position_m).centre_m;
        let fitted = self.best_fit_orientation(centre);
        if let Some(elasticity) = &mut self.elasticity {
            elasticity.frame_drift_rad += (fitted * predicted.inverse()).to_scaled_axis().length();
        }
        self.orientation = fitted.normalize();
    }

    /// Elastic forces, loads and gravity at the present positions; `velocities` of the half step drive
    /// the stiffness-proportional damping.
    ///
    /// # Errors
    /// A number that is not finite, with the first element or node that has it.
    pub fn update_acceleration(&mut self, c: &StepContext) -> Result<(), SimError> {
        let kinematics = self.element_kinematics();
        let Some(elasticity) = &mut self.elasticity else { return Ok(()) };
        let state = elasticity.elements.forces(
            &mut elasticity.scratch,
            &self.position_m,
            kinematics,
            &mut self.force_n,
        );
        elasticity.strain_energy_j = state.strain_energy_j;
        if !state.strain_energy_j.is_finite() {
            return Err(self.not_finite(c));
        }
        elasticity.step_factor.follow((state.stable_step_s() / elasticity.critical_step_s).min(1.0));
        self.add_stiffness_damping(c.step_s);
        self.add_loads(c);
        self.add_pulls(c);
        if let Some(breaking) = &mut self.breaking {
            breaking.releases.advance(c.time_s, &mut self.force_n);
        }
        let gravity = c.gravity_m_s2;
        let force = &self.force_n;
        let mass = &self.mass_kg;
        let set = |(i, a): (usize, &mut DVec3)| *a = force[i] / mass[i] + gravity;
        if self.acceleration_m_s2.len() >= PARALLEL_NODES {
            self.acceleration_m_s2.par_iter_mut().with_min_len(CHUNK).enumerate().for_each(set);
        } else {
            self.acceleration_m_s2.iter_mut().enumerate().for_each(set);
        }
        Ok(())
    }

    /// `beta K v` as the change of the elastic force when the nodes move on by `beta v`.
    fn add_stiffness_damping(&mut self, step_s: f64) {
        let kinematics = self.element_kinematics();
        let Some(elasticity) = &mut self.elasticity else { return };
        let beta = elasticity.stiffness_damping_s;
        elasticity.damping_m_s2.clear();
        if beta <= 0.0 || step_s <= 0.0 {
            return;
        }
        let ahead: Vec<DVec3> =
            self.position_m.iter().zip(&self.velocity_m_s).map(|(x, v)| *x + *v * beta).collect();
        let mut damped_n = vec![DVec3::ZERO; ahead.len()];
        elasticity.elements.forces(&mut elasticity.scratch, &ahead, kinematics, &mut damped_n);
        let nodes = self.force_n.iter_mut().zip(damped_n).zip(&self.velocity_m_s).zip(&self.mass_kg);
        for (((force, damped), v), mass) in nodes {
            self.ledger.damped_j -= (damped - *force).dot(*v) * step_s;
            elasticity.damping_m_s2.push((damped - *force) / *mass);
            *force = damped;
        }
    }

    /// Adds the loads and books their work over the step.
    fn add_loads(&mut self, c: &StepContext) {
        for load in &self.loads {
            let share = load.share(c.time_s);
            for (node, full_n) in &load.node_forces_n {
                let node = *node as usize;
                self.force_n[node] += *full_n * share;
                self.ledger.external_j += (*full_n * share).dot(self.velocity_m_s[node]) * c.step_s;
            }
        }
    }

    fn not_finite(&self, c: &StepContext) -> SimError {
        let found = self
            .elasticity
            .as_ref()
            .and_then(|e| e.elements.first_not_finite(&self.position_m, self.element_kinematics()));
        let place = match found {
            Some(NotFinitePlace::Node(node)) => {
                let element = self.tets.iter().position(|t| t.contains(&(node as u32)));
                format!("element {} (node {node})", element.unwrap_or_default())
            }
            Some(NotFinitePlace::Element(element)) => format!("element {element}"),
            None => "an element".to_owned(),
        };
        SimError::NotFinite { body: self.name.clone(), what: "the stress", place, step: 0, time_s: c.time_s }
    }

    /// Kinetic energy with the velocities of the last half step, J. At the end of a step a pressed node
    /// carries half a kick that its contact will take away again; here it has not got it yet, so that a body
    /// at rest has none.
    pub fn half_step_kinetic_j(&self, step_s: f64) -> f64 {
        let nodes = self.mass_kg.iter().zip(&self.velocity_m_s).zip(&self.acceleration_m_s2);
        nodes.map(|((m, v), a)| 0.5 * m * (*v - *a * (0.5 * step_s)).length_squared()).sum()
    }

    /// Energy of deformation and of motion other than rigid, J.
    pub fn vibration_j(&self) -> f64 {
        let rigid = self.rigid_part();
        self.kinetic_j() - rigid.kinetic_j(self.reference.mass_kg) + self.strain_j()
    }
}

/// Centre, velocity and spin of the rigid motion with the same momenta.
fn rigid_velocity(mass_kg: &[f64], positions_m: &[DVec3], velocities_m_s: &[DVec3]) -> (DVec3, DVec3, DVec3) {
    let now = MassProperties::of_points(mass_kg, positions_m);
    let momentum: DVec3 = mass_kg.iter().zip(velocities_m_s).map(|(m, v)| *v * *m).sum();
    let velocity = momentum / now.mass_kg;
    let nodes = mass_kg.iter().zip(velocities_m_s).zip(positions_m);
    let angular: DVec3 = nodes.map(|((m, v), x)| (*x - now.centre_m).cross(*v - velocity) * *m).sum();
    (now.centre_m, velocity, solve_inertia(&now.inertia_kg_m2, angular))
}

/// Sums over nodes that give their rigid motion, about the first of them, so that a small piece far away keeps its digits.
#[derive(Clone, Copy, Debug)]
struct RigidSums {
    origin_m: Option<DVec3>,
    mass_kg: f64,
    moment_kg_m: DVec3,
    momentum: DVec3,
    angular_momentum: DVec3,
    inertia_kg_m2: DMat3,
}

impl RigidSums {
    // The default of a matrix is the identity.
    const ZERO: Self = Self {
        origin_m: None,
        mass_kg: 0.0,
        moment_kg_m: DVec3::ZERO,
        momentum: DVec3::ZERO,
        angular_momentum: DVec3::ZERO,
        inertia_kg_m2: DMat3::ZERO,
    };

    fn add(&mut self, mass_kg: f64, position_m: DVec3, velocity_m_s: DVec3) {
        let arm_m = position_m - *self.origin_m.get_or_insert(position_m);
        self.mass_kg += mass_kg;
        self.moment_kg_m += arm_m * mass_kg;
        self.momentum += velocity_m_s * mass_kg;
        self.angular_momentum += arm_m.cross(velocity_m_s) * mass_kg;
        self.inertia_kg_m2 += inertia_of_point_kg_m2(mass_kg, arm_m);
    }

    /// Centre, velocity and spin of the rigid motion with the same momenta.
    fn motion(&self) -> RigidMotion {
        let Some(origin_m) = self.origin_m else { return Default::default() };
        let offset_m = self.moment_kg_m / self.mass_kg;
        // Parallel axes (Steiner).
        let inertia = self.inertia_kg_m2 - inertia_of_point_kg_m2(self.mass_kg, offset_m);
        let angular_momentum = self.angular_momentum - offset_m.cross(self.momentum);
        (origin_m + offset_m, self.momentum / self.mass_kg, solve_inertia(&inertia, angular_momentum))
    }
}

/// Centre, velocity and spin.
type RigidMotion = (DVec3, DVec3, DVec3);

/// Lowers to `factor` of it what each node's velocity is beyond the rigid motion that it belongs to, if it does to any. Returns the
/// energy taken, J.
fn damp_nodes(
    velocity_m_s: &mut [DVec3],
    (position_m, mass_kg, inverse_mass_per_kg): (&[DVec3], &[f64], &[DVec3]),
    factor: f64,
    rigid_of: impl Fn(usize) -> Option<RigidMotion> + Sync,
) -> f64 {
    sum_over_nodes(velocity_m_s, |node, v| {
        let Some((centre_m, rigid_m_s, spin_rad_s)) = rigid_of(node) else { return 0.0 };
        let deforming_m_s = *v - rigid_m_s - spin_rad_s.cross(position_m[node] - centre_m);
        let deforming_m_s = free_part(deforming_m_s, inverse_mass_per_kg[node]);
        *v -= deforming_m_s * (1.0 - factor);
        0.5 * mass_kg[node] * deforming_m_s.length_squared() * (1.0 - factor * factor)
    })
}

/// A velocity without the axes along which the motion is prescribed.
fn free_part(velocity_m_s: DVec3, inverse_mass_per_kg: DVec3) -> DVec3 {
    DVec3::select(inverse_mass_per_kg.cmpgt(DVec3::ZERO), velocity_m_s, DVec3::ZERO)
}

fn for_nodes(out: &mut [DVec3], with: &[DVec3], f: impl Fn(&mut DVec3, &DVec3) + Sync + Send) {
    if out.len() >= PARALLEL_NODES {
        let chunks = out.par_chunks_mut(CHUNK).zip(with.par_chunks(CHUNK));
        chunks.for_each(|(out, with)| out.iter_mut().zip(with).for_each(|(o, w)| f(o, w)));
    } else {
        out.iter_mut().zip(with).for_each(|(o, w)| f(o, w));
    }
}

/// The sum, in the order of the nodes, of what `change` returns when it is given each node and its value.
fn sum_over_nodes(values: &mut [DVec3], change: impl Fn(usize, &mut DVec3) -> f64 + Sync) -> f64 {
    if values.len() < PARALLEL_NODES {
        return (0..).zip(values).fold(0.0, |sum, (node, value)| sum + change(node, value));
    }
    let of_chunk = |(number, values): (usize, &mut [DVec3])| -> Vec<f64> {
        (number * CHUNK..).zip(values).map(|(node, value)| change(node, value)).collect()
    };
    let of_chunks: Vec<Vec<f64>> = values.par_chunks_mut(CHUNK).enumerate().map(of_chunk).collect();
    of_chunks.iter().flatten().fold(0.0, |sum, of_node| sum + of_node)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sums_give_the_rigid_motion_of_scattered_nodes() {
        let at_m = |i: f64| DVec3::new((3.1 * i).sin(), (1.7 * i).cos() + 50.0, (0.6 * i * i).sin());
        let nodes: Vec<(f64, DVec3, DVec3)> =
            (0..9).map(f64::from).map(|i| (1.0 + i, at_m(i), at_m(i + 0.3) * 2.0)).collect();
        let mut sums = RigidSums::ZERO;
        nodes.iter().for_each(|(m, x, v)| sums.add(*m, *x, *v));
        let (centre, velocity, spin) = sums.motion();
        // What is left of the motion has neither momentum nor angular momentum.
        let rest = |(m, x, v): &(f64, DVec3, DVec3)| (*v - velocity - spin.cross(*x - centre)) * *m;
        let momentum: DVec3 = nodes.iter().map(rest).sum();
        let angular: DVec3 = nodes.iter().map(|node| (node.1 - centre).cross(rest(node))).sum();
        assert!(momentum.length() < 1e-11 && angular.length() < 1e-11, "{momentum} {angular}");
    }
}
