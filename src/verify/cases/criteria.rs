//! Failure criteria at states whose strength is known in closed form, and the planes they cut
//! (W. F. Chen, D. J. Han, *Plasticity for Structural Engineers*, 1988, chapter 2).

use super::super::{CaseError, Effort, Outcome, Quantity};
use crate::fracture::{Criterion, PrincipalStress, Strength};
use crate::math::rotation_from_vector;
use glam::{DMat3, DVec3};

const K_PA: f64 = 2e6;
const PHI_DEG: f64 = 30.0;
const TENSION: DVec3 = DVec3::new(1.0, 0.0, 0.0);
const PRESSURE: DVec3 = DVec3::new(0.0, 0.0, -1.0);
const SHEAR: DVec3 = DVec3::new(1.0, 0.0, -1.0);

pub(in crate::verify) fn measure(_: &Effort) -> Result<Outcome, CaseError> {
    let (sin, cos) = PHI_DEG.to_radians().sin_cos();
    let root3 = 3.0_f64.sqrt();
    let friction_angle_rad = PHI_DEG.to_radians();
    let tensile = Strength::Tensile { tensile_strength_pa: K_PA };
    let tresca = Strength::Tresca { shear_strength_pa: K_PA };
    let mises = Strength::VonMises { shear_strength_pa: K_PA };
    let mohr = Strength::MohrCoulomb { cohesion_pa: K_PA, friction_angle_rad };
    let prager = Strength::DruckerPrager { cohesion_pa: K_PA, friction_angle_rad };
    let cases = [
        ("tensile, tension", &tensile, TENSION, 1.0, "F_t"),
        ("Tresca, tension", &tresca, TENSION, 2.0, "2 k"),
        ("Tresca, pure shear", &tresca, SHEAR, 1.0, "k"),
        ("von Mises, tension", &mises, TENSION, root3, "sqrt(3) k"),
        ("von Mises, pure shear", &mises, SHEAR, 1.0, "k"),
        ("Mohr-Coulomb, tension", &mohr, TENSION, 2.0 * cos / (1.0 + sin), "2 c cos phi/(1 + sin phi)"),
        ("Mohr-Coulomb, pressure", &mohr, PRESSURE, 2.0 * cos / (1.0 - sin), "2 c cos phi/(1 - sin phi)"),
        ("Mohr-Coulomb, pure shear", &mohr, SHEAR, cos, "c cos phi"),
        ("Drucker-Prager, tension", &prager, TENSION, 6.0 * cos / (3.0 + sin), "6 c cos phi/(3 + sin phi)"),
        (
            "Drucker-Prager, pressure",
            &prager,
            PRESSURE,
            2.0 * cos / (1.0 - sin),
            "2 c cos phi/(1 - sin phi): it meets Mohr-Coulomb",
        ),
    ];
    let turn = DMat3::from_quat(rotation_from_vector(DVec3::new(0.4, -1.0, 0.3)));
    let mut all = Vec::new();
    for (name, strength, state, factor, source) in cases {
        let criterion = Criterion::single(strength.clone()).map_err(unmeasured)?;
        let stress = PrincipalStress::of(&(turn * DMat3::from_diagonal(state * K_PA) * turn.transpose()));
        let found = criterion.assess(&stress.measures()).map_err(unmeasured)?;
        all.push(
            Quantity::relative(format!("{name}: strength"), "Pa", K_PA / found.index, K_PA * factor)
                .by(source)
                .within(1e-12, "round-off of principal stresses"),
        );
    }
    for (name, strength, state, angle_deg, source) in [
        ("tensile, tension: plane to the load", &tensile, TENSION, 90.0, "across the load (METHOD 6)"),
        ("Tresca, pressure: plane across the load", &tresca, PRESSURE, 45.0, "45 degrees (METHOD 6)"),
        (
            "Mohr-Coulomb, pressure: plane across the load",
            &mohr,
            PRESSURE,
            45.0 + PHI_DEG / 2.0,
            "45 + phi/2 (METHOD 6)",
        ),
    ] {
        // Three different stresses, so that the directions are no matter of choice.
        let triaxial = state + DVec3::new(0.0, -1e-3, 0.0);
        let criterion = Criterion::single(strength.clone()).map_err(unmeasured)?;
        let stress = PrincipalStress::of(&(turn * DMat3::from_diagonal(triaxial * K_PA) * turn.transpose()));
        let axis = turn * state.normalize();
        // Between a plane and the plane across the load; for tension between plane and load.
        let between_normals = criterion.normal(0, &stress, None).dot(axis).abs().min(1.0).acos().to_degrees();
        let found_deg = if state == TENSION { 90.0 - between_normals } else { between_normals };
        all.push(
            Quantity::absolute(name, "degrees", found_deg, angle_deg)
                .by(source)
                .within(1e-6, "round-off; the arc cosine near 1 halves the digits"),
        );
    }
    Ok(all.into())
}

fn unmeasured(error: impl std::fmt::Display) -> CaseError {
    CaseError::Unmeasured(error.to_string())
}
