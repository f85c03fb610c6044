//! Free travel: a parabola and a torque-free rotation (METHOD 3).

use crate::math::{rotation_from_vector, solve_inertia};
use glam::{DMat3, DQuat, DVec3};

/// Largest rotation of one integration step, rad. The midpoint rule keeps the angular momentum exactly and
/// the energy to about a twelfth of this squared.
const LARGEST_ANGLE_RAD: f64 = 2e-3;

/// The motion of a body that keeps its shape, gravity its only load.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct RigidMotion {
    /// Centre of mass, m.
    pub centre_m: DVec3,
    /// Its velocity, m/s.
    pub velocity_m_s: DVec3,
    /// World from reference orientation.
    pub orientation: DQuat,
    /// Angular momentum about the centre of mass, kg m2/s; constant.
    pub angular_momentum: DVec3,
    /// Inertia about the centre of mass in the reference orientation, kg m2.
    pub inertia: DMat3,
}

impl RigidMotion {
    /// Angular velocity in `orientation`, rad/s.
    fn spin_at(&self, orientation: DQuat) -> DVec3 {
        let world = DMat3::from_quat(orientation);
        world * solve_inertia(&self.inertia, world.transpose() * self.angular_momentum)
    }

    /// Angular velocity now, rad/s.
    pub fn spin_rad_s(&self) -> DVec3 {
        self.spin_at(self.orientation)
    }

    /// Kinetic energy, J, for a body of this mass.
    pub fn kinetic_j(&self, mass_kg: f64) -> f64 {
        0.5 * mass_kg * self.velocity_m_s.length_squared()
            + 0.5 * self.angular_momentum.dot(self.spin_rad_s())
    }

    /// The motion `duration_s` later.
    pub fn after(&self, duration_s: f64, gravity_m_s2: DVec3) -> Self {
        let mut moved = *self;
        moved.centre_m += self.velocity_m_s * duration_s + gravity_m_s2 * (0.5 * duration_s * duration_s);
        moved.velocity_m_s += gravity_m_s2 * duration_s;
        let angle_rad = self.spin_rad_s().length() * duration_s;
        let steps = (angle_rad / LARGEST_ANGLE_RAD).ceil().clamp(1.0, 1e7);
        let step_s = duration_s / steps;
        if self.angular_momentum != DVec3::ZERO {
            for _ in 0..steps as u64 {
                moved.orientation = moved.turned(step_s);
            }
        }
        moved
    }

    /// One midpoint step of `dR/dt = omega x R`, each rotation by Theorem 1 of METHOD 1.
    fn turned(&self, step_s: f64) -> DQuat {
        let half = rotation_from_vector(self.spin_rad_s() * (0.5 * step_s)) * self.orientation;
        (rotation_from_vector(self.spin_at(half) * step_s) * self.orientation).normalize()
    }

    /// Where a point of the reference shape is; `arm_m` is from the reference centre of mass.
    pub fn place_m(&self, arm_m: DVec3) -> DVec3 {
        self.centre_m + self.orientation * arm_m
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn tumbling() -> RigidMotion {
        RigidMotion {
            centre_m: DVec3::ZERO,
            velocity_m_s: DVec3::X,
            orientation: DQuat::IDENTITY,
            angular_momentum: DVec3::new(0.1, 3.0, 0.2),
            inertia: DMat3::from_diagonal(DVec3::new(1.0, 2.0, 3.0)),
        }
    }

    #[test]
    fn tumbling_about_the_unstable_axis_keeps_its_energy() {
        let start = tumbling();
        let end = start.after(50.0, DVec3::ZERO);
        let (before, after) = (start.kinetic_j(1.0), end.kinetic_j(1.0));
        assert!((after / before - 1.0).abs() < 1e-6, "{before} {after}");
        // It must have flipped on the way: the rotation is no plain spin.
        assert!((end.orientation * DVec3::Y).dot(start.spin_rad_s()) < start.spin_rad_s().y * 0.99);
    }

    #[test]
    fn free_fall_is_the_exact_parabola_in_one_step_or_many() {
        let gravity = DVec3::new(0.0, 0.0, -9.81);
        let once = tumbling().after(2.0, gravity);
        let twice = tumbling().after(0.7, gravity).after(1.3, gravity);
        assert!((once.centre_m - twice.centre_m).length() < 1e-12);
        assert!((once.centre_m.z + 0.5 * 9.81 * 4.0).abs() < 1e-12);
    }
}
