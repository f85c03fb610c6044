//! Where the cutting plane of a failed element stands (METHOD 6).
//!
//! A plane has no front: `n` and `-n` are the same. Nothing here depends on the signs that an
//! eigenvalue solver happens to give its directions, nor, where principal stresses coincide, on
//! which directions it happened to choose.

use super::stress::PrincipalStress;
use glam::DVec3;
use std::f64::consts::FRAC_PI_4;

/// Principal stresses closer than this share of the largest count as equal: their directions are
/// then noise. Stresses of a simulation carry about 1e-10 of noise; a true difference of a
/// millionth turns no crack that anyone could see.
const EQUAL_STRESSES: f64 = 1e-6;
/// Conjugate planes whose fit to a crack differs by less than this fit it equally well.
const EQUAL_FIT: f64 = 1e-9;
/// Directions get the sign that makes their product with this positive. It is off all the planes
/// in which meshes and loads like to lie, so that round-off cannot flip the sign there.
const UPWARD: DVec3 = DVec3::new(1.0, 0.618, 0.272);

/// How the cutting plane stands to the principal stresses.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum PlaneRule {
    /// The plane opens under the largest tension: its normal is `v1`.
    Opening,
    /// The plane slides: its normal is `cos(45 - phi/2) v1 ± sin(45 - phi/2) v3`, so that under
    /// uniaxial compression it stands at 45 + phi/2 degrees to the horizontal.
    Sliding {
        /// Friction angle phi, radians.
        friction_angle_rad: f64,
    },
}

impl PlaneRule {
    /// Unit normal of the cutting plane.
    ///
    /// `crack_normal` is the unit normal of a crack already there, which the new plane continues
    /// as well as it can: it decides between the two conjugate planes, and between the equally
    /// good ones where principal stresses coincide. Without it a fixed rule decides: of the
    /// conjugate planes the one whose normal lies between `v1` and `v3` when both are given a
    /// positive product with a fixed direction; of coinciding directions the projection of the
    /// first suitable axis.
    #[must_use]
    pub fn normal(self, stress: &PrincipalStress, crack_normal: Option<DVec3>) -> DVec3 {
        let normal = match self {
            Self::Opening => directions(stress, crack_normal)[0],
            Self::Sliding { friction_angle_rad } => sliding_normal(stress, friction_angle_rad, crack_normal),
        };
        upward(normal)
    }
}

fn sliding_normal(stress: &PrincipalStress, friction_angle_rad: f64, crack_normal: Option<DVec3>) -> DVec3 {
    let [v1, v3] = directions(stress, crack_normal).map(upward);
    if let (true, Some(crack)) = (is_hydrostatic(stress), crack_normal) {
        // No plane slides more than another.
        return crack;
    }
    let (sin, cos) = (FRAC_PI_4 - friction_angle_rad / 2.0).sin_cos();
    let [first, second] = [cos * v1 + sin * v3, cos * v1 - sin * v3];
    let fit = |normal: DVec3| crack_normal.map_or(0.0, |crack| normal.dot(crack).abs());
    if fit(second) > fit(first) + EQUAL_FIT { second } else { first }
}

fn is_hydrostatic(stress: &PrincipalStress) -> bool {
    let [s1, _, s3] = stress.values_pa.to_array();
    s1 - s3 <= EQUAL_STRESSES * s1.abs().max(s3.abs())
}

/// `v1` and `v3`; where principal stresses coincide, those nearest to `crack_normal`.
fn directions(stress: &PrincipalStress, crack_normal: Option<DVec3>) -> [DVec3; 2] {
    let [s1, s2, s3] = stress.values_pa.to_array();
    let [v1, v3] = [stress.directions.x_axis, stress.directions.z_axis];
    if is_hydrostatic(stress) {
        let first = crack_normal.unwrap_or(DVec3::X);
        return [first, across(first, None)];
    }
    let equal = EQUAL_STRESSES * s1.abs().max(s3.abs());
    match (s1 - s2 <= equal, s2 - s3 <= equal) {
        (true, _) => [across(v3, crack_normal), v3],
        (false, true) => [v1, across(v1, crack_normal)],
        (false, false) => [v1, v3],
    }
}

/// Unit vector across `axis`: nearest to `wanted`, else to the first coordinate axis that is not
/// too nearly parallel to it.
fn across(axis: DVec3, wanted: Option<DVec3>) -> DVec3 {
    let project = |v: DVec3| v - axis * axis.dot(v);
    wanted
        .into_iter()
        .chain([DVec3::X, DVec3::Y, DVec3::Z])
        .map(project)
        .find(|v| v.length_squared() >= 0.3)
        .map_or(DVec3::X, DVec3::normalize)
}

/// Of the two directions of a line, always the same one.
#[must_use]
pub fn upward(direction: DVec3) -> DVec3 {
    if direction.dot(UPWARD) < 0.0 { -direction } else { direction }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::rotation_from_vector;
    use glam::DMat3;
    use proptest::prelude::*;

    const SLIDING: PlaneRule = PlaneRule::Sliding { friction_angle_rad: 0.4 };

    fn stress(values_pa: [f64; 3]) -> PrincipalStress {
        PrincipalStress::of(&DMat3::from_diagonal(DVec3::from_array(values_pa)))
    }

    /// Angle between the plane and the horizontal, degrees.
    fn slope_deg(normal: DVec3) -> f64 {
        normal.z.abs().acos().to_degrees()
    }

    #[test]
    fn uniaxial_compression_fails_at_45_plus_half_phi() {
        for phi_deg in [0.0_f64, 10.0, 20.0, 30.0, 60.0] {
            let rule = PlaneRule::Sliding { friction_angle_rad: phi_deg.to_radians() };
            for lateral_pa in [0.0, -10.0] {
                let normal = rule.normal(&stress([0.0, lateral_pa, -100.0]), None);
                assert!((slope_deg(normal) - (45.0 + phi_deg / 2.0)).abs() < 1e-9, "{phi_deg}: {normal}");
            }
        }
    }

    #[test]
    fn a_crack_decides_between_conjugate_planes_and_equal_directions() {
        let states = [[3.0, 1.0, -5.0], [0.0, 0.0, -5.0], [5.0, 0.0, 0.0]];
        for values in states {
            let free = SLIDING.normal(&stress(values), None);
            for crack in [free, DVec3::new(free.x, free.y, -free.z), DVec3::new(-free.x, free.y, free.z)] {
                let continued = SLIDING.normal(&stress(values), Some(crack));
                assert!(continued.dot(crack).abs() > 1.0 - 1e-12, "{values:?}: {crack} became {continued}");
            }
        }
        let crack = DVec3::new(0.6, 0.0, 0.8);
        let opened = PlaneRule::Opening.normal(&stress([2.0, 2.0, 2.0]), Some(crack));
        assert!((opened.dot(crack).abs() - 1.0).abs() < 1e-12);
        // A crack across the load does not turn the plane.
        let pulled = PlaneRule::Opening.normal(&stress([2.0, 1.0, 0.0]), Some(crack));
        assert_eq!(pulled, DVec3::X);
    }

    proptest! {
        #[test]
        fn signs_of_directions_do_not_matter(turn in prop::array::uniform3(-3.0..3.0f64), kind in 0usize..5, flips in 0u8..4) {
            let values = [[3.0, 1.0, -2.0], [1.0, 1.0, -1.0], [1.0, -1.0, -1.0], [1.0, 1.0, 1.0], [0.0, 0.0, 0.0]][kind];
            let rotation = DMat3::from_quat(rotation_from_vector(DVec3::from_array(turn)));
            let plain = PrincipalStress { values_pa: DVec3::from_array(values), directions: rotation };
            let mut flipped = plain;
            if flips & 1 != 0 { flipped.directions.x_axis *= -1.0; }
            if flips & 2 != 0 { flipped.directions.z_axis *= -1.0; }
            for rule in [PlaneRule::Opening, SLIDING] {
                let normal = rule.normal(&plain, None);
                prop_assert!((normal - rule.normal(&flipped, None)).length() < 1e-14);
                prop_assert!((normal.length() - 1.0).abs() < 1e-14);
            }
        }

        #[test]
        fn noise_in_equal_stresses_does_not_turn_the_plane(turn in prop::array::uniform3(-3.0..3.0f64), noise in prop::array::uniform3(-1e-9..1e-9f64)) {
            // Uniaxial compression along x, written with two different bases of the plane across it.
            let spin = DMat3::from_rotation_x(turn[0]);
            let values = DVec3::new(noise[0], noise[1], -1.0);
            let directions = spin * DMat3::from_cols(DVec3::Y, DVec3::Z, DVec3::X);
            let noisy = PrincipalStress { values_pa: values, directions };
            let normal = SLIDING.normal(&noisy, None);
            prop_assert!((normal - SLIDING.normal(&stress([-1.0, 0.0, 0.0]), None)).length() < 1e-12);
        }
    }
}
