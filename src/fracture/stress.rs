//! Principal stresses and their invariants: what every criterion looks at.

use crate::math::symmetric_eigen;
use glam::{DMat3, DVec3};

/// Principal Cauchy stresses `s1 >= s2 >= s3` with their directions `v1, v2, v3`; tension positive.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PrincipalStress {
    /// `(s1, s2, s3)`, Pa, largest first.
    pub values_pa: DVec3,
    /// Columns are the unit directions `v1, v2, v3`; their signs mean nothing.
    pub directions: DMat3,
}

impl PrincipalStress {
    /// Of a Cauchy stress tensor, Pa; its lower triangle is read.
    #[must_use]
    pub fn of(cauchy_pa: &DMat3) -> Self {
        let eigen = symmetric_eigen(cauchy_pa);
        Self { values_pa: eigen.values, directions: eigen.directions }
    }

    /// The numbers that criteria and formulas are written in.
    #[must_use]
    pub fn measures(&self) -> StressMeasures {
        StressMeasures::of_sorted(self.values_pa)
    }
}

/// Principal stresses and invariants of a stress state.
///
/// `I1 = s1 + s2 + s3`, `J2 = ((s1-s2)^2 + (s2-s3)^2 + (s3-s1)^2)/6`,
/// `J3 = (s1-p)(s2-p)(s3-p)` with `p = I1/3`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct StressMeasures {
    /// Principal stresses, Pa, largest first.
    pub s_pa: [f64; 3],
    /// First invariant of the stress, Pa.
    pub i1_pa: f64,
    /// Second invariant of the deviator, Pa2.
    pub j2_pa2: f64,
    /// Third invariant of the deviator, Pa3.
    pub j3_pa3: f64,
}

impl StressMeasures {
    /// Of principal stresses in any order, Pa.
    #[must_use]
    pub fn of(values_pa: DVec3) -> Self {
        let mut sorted = values_pa.to_array();
        sorted.sort_by(|a, b| b.total_cmp(a));
        Self::of_sorted(DVec3::from_array(sorted))
    }

    fn of_sorted(values_pa: DVec3) -> Self {
        let [s1, s2, s3] = values_pa.to_array();
        let i1_pa = s1 + s2 + s3;
        let differences = DVec3::new(s1 - s2, s2 - s3, s3 - s1);
        let deviator = values_pa - DVec3::splat(i1_pa / 3.0);
        Self {
            s_pa: [s1, s2, s3],
            i1_pa,
            j2_pa2: differences.length_squared() / 6.0,
            j3_pa3: deviator.element_product(),
        }
    }

    /// Whether every number is finite.
    #[must_use]
    pub fn is_finite(&self) -> bool {
        self.j2_pa2.is_finite() && self.j3_pa3.is_finite() && self.i1_pa.is_finite()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::rotation_from_vector;

    #[test]
    fn invariants_are_those_of_the_tensor() {
        let turn = DMat3::from_quat(rotation_from_vector(DVec3::new(0.4, -1.0, 0.3)));
        let stress = turn * DMat3::from_diagonal(DVec3::new(-2.0, 7.0, 1.0)) * turn.transpose();
        let measures = PrincipalStress::of(&stress).measures();
        let deviator = stress - DMat3::IDENTITY * 2.0;
        let squares: f64 = deviator.to_cols_array().iter().map(|x| x * x).sum();
        assert!((measures.i1_pa - 6.0).abs() < 1e-14);
        assert!((measures.j2_pa2 - squares / 2.0).abs() < 1e-13);
        assert!((measures.j3_pa3 - deviator.determinant()).abs() < 1e-13);
        assert_eq!(StressMeasures::of(DVec3::new(1.0, -2.0, 7.0)).s_pa, [7.0, 1.0, -2.0]);
    }
}
