//! Isotropic Hooke's law: `S = lambda tr(E) I + 2 mu E`,
//! `lambda = E_Y nu / ((1+nu)(1-2nu))`, `mu = E_Y / (2(1+nu))` (METHOD 1).

use glam::{DMat3, DVec3};

/// Why material constants are refused.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
pub enum MaterialError {
    /// Density.
    #[error("density must be a positive finite number of kg/m3, not {0}")]
    Density(f64),
    /// Young's modulus.
    #[error("Young's modulus must be a positive finite number of Pa, not {0}")]
    YoungsModulus(f64),
    /// Poisson's ratio.
    #[error(
        "Poisson's ratio must lie between -1 and 0.5, both excluded, not {0} \
         (0.5 is incompressible, for which these elements lock; try 0.49)"
    )]
    PoissonRatio(f64),
}

/// Elastic constants and density of one element.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ElasticConstants {
    /// First Lame constant, Pa; negative for auxetic materials, above `-2/3 mu`.
    pub lambda_pa: f64,
    /// Second Lame constant (shear modulus), Pa, positive.
    pub mu_pa: f64,
    /// Density, kg/m3, positive.
    pub density_kg_m3: f64,
}

impl ElasticConstants {
    /// From Young's modulus `E` (Pa), Poisson's ratio and density (kg/m3).
    ///
    /// # Errors
    /// [`MaterialError`] for a value outside its physical range.
    pub fn new(
        youngs_modulus_pa: f64,
        poisson_ratio: f64,
        density_kg_m3: f64,
    ) -> Result<Self, MaterialError> {
        let positive = |x: f64| x.is_finite() && x > 0.0;
        if !positive(youngs_modulus_pa) {
            return Err(MaterialError::YoungsModulus(youngs_modulus_pa));
        }
        if !(poisson_ratio > -1.0 && poisson_ratio < 0.5) {
            return Err(MaterialError::PoissonRatio(poisson_ratio));
        }
        if !positive(density_kg_m3) {
            return Err(MaterialError::Density(density_kg_m3));
        }
        let (e, nu) = (youngs_modulus_pa, poisson_ratio);
        Ok(Self {
            lambda_pa: e * nu / ((1.0 + nu) * (1.0 - 2.0 * nu)),
            mu_pa: e / (2.0 * (1.0 + nu)),
            density_kg_m3,
        })
    }

    /// Speed of longitudinal waves `c_p = sqrt((lambda + 2 mu) / rho)`, m/s.
    #[must_use]
    pub fn p_wave_speed_m_s(&self) -> f64 {
        ((self.lambda_pa + 2.0 * self.mu_pa) / self.density_kg_m3).sqrt()
    }

    /// Stress `lambda tr(strain) I + 2 mu strain`, Pa.
    #[must_use]
    pub fn stress_pa(&self, strain: &DMat3) -> DMat3 {
        let trace = strain.x_axis.x + strain.y_axis.y + strain.z_axis.z;
        DMat3::from_diagonal(DVec3::splat(self.lambda_pa * trace)) + *strain * (2.0 * self.mu_pa)
    }

    /// Whether the three numbers are finite, density and shear and bulk modulus positive.
    #[must_use]
    pub fn is_sound(&self) -> bool {
        let bulk_pa = self.lambda_pa + 2.0 / 3.0 * self.mu_pa;
        [self.mu_pa, bulk_pa, self.density_kg_m3].iter().all(|x| x.is_finite() && *x > 0.0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn uniaxial_stress_gives_youngs_modulus_and_poisson_ratio() {
        for nu in [-0.9, -0.3, 0.0, 0.3, 0.49] {
            let material = ElasticConstants::new(206.82e9, nu, 7844.0).unwrap();
            assert!(material.is_sound());
            let strain = DMat3::from_diagonal(DVec3::new(1.0, -nu, -nu) * 1e-3);
            let stress = material.stress_pa(&strain);
            assert!((stress.x_axis.x / 206.82e6 - 1.0).abs() < 1e-12);
            assert!(stress.y_axis.y.abs() < 1e-12 * 206.82e6);
        }
    }

    #[test]
    fn wave_speed_without_lateral_contraction_is_that_of_a_rod() {
        let material = ElasticConstants::new(206.82e9, 0.0, 7844.0).unwrap();
        assert!((material.p_wave_speed_m_s() - (206.82e9f64 / 7844.0).sqrt()).abs() < 1e-9);
    }

    #[test]
    fn impossible_constants_are_refused_by_name() {
        let e = |e, nu, rho| ElasticConstants::new(e, nu, rho).unwrap_err();
        assert_eq!(e(1e9, 0.5, 1.0), MaterialError::PoissonRatio(0.5));
        assert_eq!(e(1e9, -1.0, 1.0), MaterialError::PoissonRatio(-1.0));
        assert!(matches!(e(1e9, f64::NAN, 1.0), MaterialError::PoissonRatio(_)));
        assert_eq!(e(0.0, 0.3, 1.0), MaterialError::YoungsModulus(0.0));
        assert_eq!(e(f64::INFINITY, 0.3, 1.0), MaterialError::YoungsModulus(f64::INFINITY));
        assert_eq!(e(1e9, 0.3, -7844.0), MaterialError::Density(-7844.0));
    }
}
