//! Mass, centre and inertia of point masses (the lumped nodes of a body).

use super::symmetric_eigen;
use glam::{DMat3, DVec3};

/// Relative moment of inertia below which an axis counts as having none (all nodes on one line).
const NO_INERTIA: f64 = 1e-12;

/// Mass, centre of mass and inertia tensor of a set of point masses.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MassProperties {
    /// Total mass, kg.
    pub mass_kg: f64,
    /// Centre of mass, m.
    pub centre_m: DVec3,
    /// Inertia tensor about the centre of mass, kg m2.
    pub inertia_kg_m2: DMat3,
}

impl MassProperties {
    /// Of the nodes with these masses (kg) at these positions (m); both of the same length.
    /// Without mass the centre is the origin.
    #[must_use]
    pub fn of_points(masses_kg: &[f64], positions_m: &[DVec3]) -> Self {
        debug_assert_eq!(masses_kg.len(), positions_m.len());
        let mass_kg = masses_kg.iter().fold(0.0, |sum, mass| sum + mass);
        // Summed from the first node, so that a small body far away keeps its digits.
        let origin_m = positions_m.first().copied().unwrap_or_default();
        let points = || masses_kg.iter().zip(positions_m);
        let moment: DVec3 = points().map(|(&mass, &x)| mass * (x - origin_m)).sum();
        let offset_m = if mass_kg > 0.0 { moment / mass_kg } else { -origin_m };
        let centre_m = origin_m + offset_m;
        let inertia_kg_m2 =
            points().fold(DMat3::ZERO, |sum, (&mass, &x)| sum + inertia_of_point_kg_m2(mass, x - centre_m));
        Self { mass_kg, centre_m, inertia_kg_m2 }
    }
}

/// Inertia tensor `m (|r|^2 I - r r^T)` of a point mass at `arm_m` from the reference point, kg m2.
#[must_use]
pub fn inertia_of_point_kg_m2(mass_kg: f64, arm_m: DVec3) -> DMat3 {
    let outer = DMat3::from_cols(arm_m * arm_m.x, arm_m * arm_m.y, arm_m * arm_m.z);
    (DMat3::from_diagonal(DVec3::splat(arm_m.length_squared())) - outer) * mass_kg
}

/// The `w` of least length with `inertia w = angular_momentum`, rad/s.
///
/// About an axis without inertia (all nodes on one line, or one node) the component is zero.
#[must_use]
pub fn solve_inertia(inertia_kg_m2: &DMat3, angular_momentum_kg_m2_s: DVec3) -> DVec3 {
    let eigen = symmetric_eigen(inertia_kg_m2);
    let floor = eigen.values.x * NO_INERTIA;
    let along = eigen.directions.transpose() * angular_momentum_kg_m2_s;
    let divide = |part: f64, moment: f64| if moment > floor { part / moment } else { 0.0 };
    eigen.directions
        * DVec3::new(
            divide(along.x, eigen.values.x),
            divide(along.y, eigen.values.y),
            divide(along.z, eigen.values.z),
        )
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn dumbbell_far_from_the_origin() {
        let far = DVec3::new(1e6, 0.0, 0.0);
        let positions = [far - DVec3::X, far + 2.0 * DVec3::X];
        let body = MassProperties::of_points(&[2.0, 1.0], &positions);
        assert_eq!(body.mass_kg, 3.0);
        assert_eq!(body.centre_m, far);
        assert_eq!(body.inertia_kg_m2, DMat3::from_diagonal(DVec3::new(0.0, 6.0, 6.0)));
        // No inertia about its own line: momentum there is answered with no spin, not with infinity.
        let spin = solve_inertia(&body.inertia_kg_m2, DVec3::new(5.0, 6.0, -12.0));
        assert!((spin - DVec3::new(0.0, 1.0, -2.0)).length() < 1e-15);
    }

    #[test]
    fn inertia_gives_the_angular_momentum_of_rigid_spin() {
        let positions: Vec<DVec3> = (0..9)
            .map(|i| DVec3::new(f64::from(i).sin(), f64::from(i * i).cos(), 0.1 * f64::from(i)))
            .collect();
        let masses: Vec<f64> = (1..10).map(f64::from).collect();
        let body = MassProperties::of_points(&masses, &positions);
        let spin = DVec3::new(0.3, -2.0, 1.1);
        let momentum: DVec3 = masses
            .iter()
            .zip(&positions)
            .map(|(&mass, &x)| mass * (x - body.centre_m).cross(spin.cross(x - body.centre_m)))
            .sum();
        assert!((body.inertia_kg_m2 * spin - momentum).length() < 1e-12 * momentum.length());
        assert!((solve_inertia(&body.inertia_kg_m2, momentum) - spin).length() < 1e-13);
    }

    #[test]
    fn nothing_has_no_mass_properties() {
        let nothing = MassProperties::of_points(&[], &[]);
        assert_eq!(
            (nothing.mass_kg, nothing.centre_m, nothing.inertia_kg_m2),
            (0.0, DVec3::ZERO, DMat3::ZERO)
        );
        assert_eq!(solve_inertia(&nothing.inertia_kg_m2, DVec3::X), DVec3::ZERO);
    }
}
