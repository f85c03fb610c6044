//! When an element fails (METHOD 6): failure functions, their combination, the failure index.
//!
//! Tension is positive, `s1 >= s2 >= s3`. A state fails when its failure function `f >= 0`.
//! W. F. Chen, D. J. Han, *Plasticity for Structural Engineers*, chapter 2; D. C. Drucker,
//! W. Prager, Q. Appl. Math. 10, 1952, with the cone through Mohr-Coulomb's compressive meridian.

use super::formula::{Formula, FormulaError};
use super::plane::PlaneRule;
use super::stress::{PrincipalStress, StressMeasures};
use glam::DVec3;
use std::f64::consts::{FRAC_1_SQRT_2, FRAC_PI_2};

/// The strength of a material under one kind of failure.
#[derive(Clone, Debug, PartialEq)]
pub enum Strength {
    /// Rankine: `f = s1 - F_t`.
    Tensile {
        /// Tensile strength F_t, Pa.
        tensile_strength_pa: f64,
    },
    /// `f = (s1 - s3)/2 - k`.
    Tresca {
        /// Shear strength k, Pa.
        shear_strength_pa: f64,
    },
    /// `f = sqrt(J2) - k`.
    VonMises {
        /// Shear strength k, Pa.
        shear_strength_pa: f64,
    },
    /// `f = (s1 - s3)/2 + (s1 + s3)/2 sin phi - c cos phi`.
    MohrCoulomb {
        /// Cohesion c, Pa.
        cohesion_pa: f64,
        /// Friction angle phi, radians, in [0, pi/2).
        friction_angle_rad: f64,
    },
    /// `f = a I1 + sqrt(J2) - k`, `a = 2 sin phi/(sqrt3 (3 - sin phi))`,
    /// `k = 6 c cos phi/(sqrt3 (3 - sin phi))`.
    DruckerPrager {
        /// Cohesion c, Pa.
        cohesion_pa: f64,
        /// Friction angle phi, radians, in [0, pi/2).
        friction_angle_rad: f64,
    },
    /// `f` as typed.
    Formula(Formula),
}

/// Why a criterion cannot be used.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum CriterionError {
    /// A criterion without rules never fails.
    #[error("the failure criterion is an empty list; give at least one criterion, or leave fracture out")]
    Empty,
    /// A number is out of its range.
    #[error("criterion {}: `{argument}` is {value}, but it must be {expected}", .rule + 1)]
    Argument {
        /// Which of the list, from 0.
        rule: usize,
        /// Name of the argument.
        argument: &'static str,
        /// Its value, in the unit of the text (angles: degrees).
        value: f64,
        /// Values it may have.
        expected: &'static str,
    },
    /// A formula cannot be evaluated.
    #[error("criterion {}: {error}", .rule + 1)]
    Formula {
        /// Which of the list, from 0.
        rule: usize,
        /// What is wrong, and in which column.
        error: FormulaError,
    },
}

impl Strength {
    /// How the plane stands when nothing else is asked for: opening for tensile, sliding at the
    /// friction angle for the others (zero where there is none).
    #[must_use]
    pub fn natural_plane(&self) -> PlaneRule {
        match *self {
            Self::Tensile { .. } => PlaneRule::Opening,
            Self::Tresca { .. } | Self::VonMises { .. } | Self::Formula(_) => {
                PlaneRule::Sliding { friction_angle_rad: 0.0 }
            }
            Self::MohrCoulomb { friction_angle_rad, .. } | Self::DruckerPrager { friction_angle_rad, .. } => {
                PlaneRule::Sliding { friction_angle_rad }
            }
        }
    }

    /// Failure function and failure index of a state.
    ///
    /// All but the formula have `f = demand - capacity`, the demand proportional to the stress.
    /// Their index `demand / capacity` (zero where negative) is the inverse of the factor by which
    /// the stress would have to grow to fail. A formula's index is `1 - f / f(0)`: the same
    /// wherever the formula has that shape, and in any case 0 without stress and 1 at failure.
    fn evaluate(&self, stress: &StressMeasures) -> Result<(f64, f64), FormulaError> {
        if let Self::Formula(formula) = self {
            let f = formula.evaluate(stress)?;
            return Ok((f, (1.0 - f / formula.unstressed_value()).max(0.0)));
        }
        let (demand_pa, capacity_pa) = self.demand_and_capacity_pa(stress);
        Ok((demand_pa - capacity_pa, (demand_pa / capacity_pa).max(0.0)))
    }

    fn demand_and_capacity_pa(&self, stress: &StressMeasures) -> (f64, f64) {
        let [s1, _, s3] = stress.s_pa;
        match *self {
            Self::Tensile { tensile_strength_pa } => (s1, tensile_strength_pa),
            Self::Tresca { shear_strength_pa } => ((s1 - s3) / 2.0, shear_strength_pa),
            Self::VonMises { shear_strength_pa } => (stress.j2_pa2.sqrt(), shear_strength_pa),
            Self::MohrCoulomb { cohesion_pa, friction_angle_rad } => {
                let (sin, cos) = friction_angle_rad.sin_cos();
                ((s1 - s3) / 2.0 + (s1 + s3) / 2.0 * sin, cohesion_pa * cos)
            }
            Self::DruckerPrager { cohesion_pa, friction_angle_rad } => {
                let (sin, cos) = friction_angle_rad.sin_cos();
                let scale = 3.0_f64.sqrt() * (3.0 - sin);
                let demand_pa = 2.0 * sin / scale * stress.i1_pa + stress.j2_pa2.sqrt();
                (demand_pa, 6.0 * cohesion_pa * cos / scale)
            }
            Self::Formula(_) => (0.0, 1.0),
        }
    }

    /// States whose tensor has a Frobenius norm below this cannot fail, Pa.
    ///
    /// The demand is at most the norm times: 1 (tensile), `1/sqrt2` (Tresca, von Mises),
    /// `sqrt((1 + sin^2 phi)/2)` (Mohr-Coulomb), `sqrt(3 a^2 + 1/2)` (Drucker-Prager, by
    /// `|s|^2 = I1^2/3 + 2 J2`). Of a formula nothing is known.
    fn safe_norm_pa(&self) -> f64 {
        let (_, capacity_pa) = self.demand_and_capacity_pa(&StressMeasures::of(DVec3::ZERO));
        let most = match *self {
            Self::Tensile { .. } => 1.0,
            Self::Tresca { .. } | Self::VonMises { .. } => FRAC_1_SQRT_2,
            Self::MohrCoulomb { friction_angle_rad, .. } => {
                ((1.0 + friction_angle_rad.sin().powi(2)) / 2.0).sqrt()
            }
            Self::DruckerPrager { friction_angle_rad, .. } => {
                let sin = friction_angle_rad.sin();
                (2.0 * sin / (3.0 - sin)).hypot(FRAC_1_SQRT_2)
            }
            Self::Formula(_) => return 0.0,
        };
        capacity_pa / most
    }

    fn check(&self, rule: usize) -> Result<(), CriterionError> {
        let strength = |argument, value| check_strength(rule, argument, value);
        match *self {
            Self::Tensile { tensile_strength_pa } => strength("tensile_strength_pa", tensile_strength_pa),
            Self::Tresca { shear_strength_pa } | Self::VonMises { shear_strength_pa } => {
                strength("shear_strength_pa", shear_strength_pa)
            }
            Self::MohrCoulomb { cohesion_pa, friction_angle_rad }
            | Self::DruckerPrager { cohesion_pa, friction_angle_rad } => {
                strength("cohesion_pa", cohesion_pa)?;
                check_friction(rule, friction_angle_rad)
            }
            Self::Formula(_) => Ok(()),
        }
    }
}

fn check_strength(rule: usize, argument: &'static str, value: f64) -> Result<(), CriterionError> {
    if value > 0.0 && value.is_finite() {
        return Ok(());
    }
    Err(CriterionError::Argument { rule, argument, value, expected: "a stress above zero" })
}

fn check_friction(rule: usize, friction_angle_rad: f64) -> Result<(), CriterionError> {
    if (0.0..FRAC_PI_2).contains(&friction_angle_rad) {
        return Ok(());
    }
    Err(CriterionError::Argument {
        rule,
        argument: "friction_angle",
        value: friction_angle_rad.to_degrees(),
        expected: "from 0 up to, but not including, 90 degrees",
    })
}

/// A strength with the way its cutting plane stands.
#[derive(Clone, Debug, PartialEq)]
pub struct FailureRule {
    /// When it fails.
    pub strength: Strength,
    /// How the cutting plane then stands.
    pub plane: PlaneRule,
}

impl From<Strength> for FailureRule {
    fn from(strength: Strength) -> Self {
        Self { plane: strength.natural_plane(), strength }
    }
}

/// A failure criterion: any of a list of rules, checked.
#[derive(Clone, Debug, PartialEq)]
pub struct Criterion {
    rules: Vec<FailureRule>,
}

/// How near to failure a state is, by the rule that governs.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Assessment {
    /// The rule of the highest index; the first of equals.
    pub rule: usize,
    /// Its failure function `f`, Pa (a formula's own unit): fails from 0 on.
    pub excess_pa: f64,
    /// Failure index: 0 unstressed, 1 fails.
    pub index: f64,
}

impl Assessment {
    /// Whether the state fails.
    #[must_use]
    pub fn fails(&self) -> bool {
        self.excess_pa >= 0.0
    }
}

impl Criterion {
    /// Fails when any of the rules does.
    ///
    /// # Errors
    /// [`CriterionError`] naming the rule and its argument.
    pub fn any_of(rules: Vec<FailureRule>) -> Result<Self, CriterionError> {
        if rules.is_empty() {
            return Err(CriterionError::Empty);
        }
        for (index, rule) in rules.iter().enumerate() {
            rule.strength.check(index)?;
            if let PlaneRule::Sliding { friction_angle_rad } = rule.plane {
                check_friction(index, friction_angle_rad)?;
            }
        }
        Ok(Self { rules })
    }

    /// One strength with its natural plane.
    ///
    /// # Errors
    /// [`CriterionError`] naming the argument.
    pub fn single(strength: Strength) -> Result<Self, CriterionError> {
        Self::any_of(vec![strength.into()])
    }

    /// The rules.
    #[must_use]
    pub fn rules(&self) -> &[FailureRule] {
        &self.rules
    }

    /// Stress tensors whose Frobenius norm (root of the sum of the squares of all nine entries) is
    /// below this cannot fail, Pa: a cheap test before principal stresses are sought.
    #[must_use]
    pub fn safe_norm_pa(&self) -> f64 {
        self.rules.iter().map(|rule| rule.strength.safe_norm_pa()).fold(f64::INFINITY, f64::min)
    }

    /// How near to failure a state is. A stress that is not finite does not fail: who steps the
    /// elements stops there first.
    ///
    /// # Errors
    /// A formula that cannot be evaluated for this state, with the place.
    pub fn assess(&self, stress: &StressMeasures) -> Result<Assessment, CriterionError> {
        let mut governing: Option<Assessment> = None;
        for (rule, FailureRule { strength, .. }) in self.rules.iter().enumerate() {
            let (excess_pa, index) =
                strength.evaluate(stress).map_err(|error| CriterionError::Formula { rule, error })?;
            if governing.is_none_or(|best| index > best.index) {
                governing = Some(Assessment { rule, excess_pa, index });
            }
        }
        governing.ok_or(CriterionError::Empty)
    }

    /// Unit normal of the cutting plane when rule `rule` fails; see [`PlaneRule::normal`].
    #[must_use]
    pub fn normal(&self, rule: usize, stress: &PrincipalStress, crack_normal: Option<DVec3>) -> DVec3 {
        self.rules[rule].plane.normal(stress, crack_normal)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::FRAC_PI_6;

    const K: f64 = 2e6;

    fn index(strength: &Strength, values_pa: [f64; 3]) -> f64 {
        let criterion = Criterion::single(strength.clone()).unwrap();
        let found = criterion.assess(&StressMeasures::of(DVec3::from_array(values_pa))).unwrap();
        assert_eq!(found.fails(), found.index >= 1.0);
        found.index
    }

    fn assert_fails_at(strength: &Strength, at_failure_pa: [f64; 3]) {
        for share in [0.25, 0.999, 1.001, 3.0] {
            let found = index(strength, at_failure_pa.map(|s| s * share));
            assert!(
                (found / share - 1.0).abs() < 1e-12,
                "{strength:?} {at_failure_pa:?}: {found} for {share}"
            );
        }
    }

    #[test]
    fn tensile_looks_at_the_largest_stress_alone() {
        let tensile = Strength::Tensile { tensile_strength_pa: K };
        assert_fails_at(&tensile, [K, 0.0, 0.0]);
        assert_fails_at(&tensile, [K, K, K]);
        assert_fails_at(&tensile, [K, 0.0, -K]);
        assert_fails_at(&tensile, [-50.0 * K, K, -3.0 * K]);
        assert_eq!(index(&tensile, [-K, -K, -9.0 * K]), 0.0);
    }

    #[test]
    fn tresca_and_von_mises_against_closed_forms() {
        let tresca = Strength::Tresca { shear_strength_pa: K };
        let mises = Strength::VonMises { shear_strength_pa: K };
        let root3 = 3.0_f64.sqrt();
        // Pure shear of k fails both; uniaxial: 2k and sqrt(3) k, in tension and compression alike.
        assert_fails_at(&tresca, [K, 0.0, -K]);
        assert_fails_at(&mises, [K, 0.0, -K]);
        for sign in [1.0, -1.0] {
            assert_fails_at(&tresca, [sign * 2.0 * K, 0.0, 0.0]);
            assert_fails_at(&mises, [sign * root3 * K, 0.0, 0.0]);
            assert_eq!(index(&tresca, [sign * 1e9; 3]), 0.0);
            assert_eq!(index(&mises, [sign * 1e9; 3]), 0.0);
        }
        // Confining pressure changes nothing.
        assert!((index(&tresca, [-7.0 * K, -7.0 * K, -9.0 * K]) - 1.0).abs() < 1e-12);
    }

    #[test]
    fn mohr_coulomb_against_closed_forms() {
        for phi in [0.0, FRAC_PI_6, 0.9] {
            let strength = Strength::MohrCoulomb { cohesion_pa: K, friction_angle_rad: phi };
            let (sin, cos) = phi.sin_cos();
            assert_fails_at(&strength, [2.0 * K * cos / (1.0 + sin), 0.0, 0.0]);
            assert_fails_at(&strength, [0.0, 0.0, -2.0 * K * cos / (1.0 - sin)]);
            assert_fails_at(&strength, [K * cos, 0.0, -K * cos]);
            // Triaxial: axial = lateral (1 + sin)/(1 - sin) + 2 c cos/(1 - sin).
            let lateral = 3.0 * K;
            let axial = (lateral * (1.0 + sin) + 2.0 * K * cos) / (1.0 - sin);
            assert!((index(&strength, [-lateral, -lateral, -axial]) - 1.0).abs() < 1e-12);
            assert_eq!(index(&strength, [-K; 3]), 0.0);
        }
        // The apex: hydrostatic tension c cot(phi).
        let apex = K / FRAC_PI_6.tan();
        assert_fails_at(&Strength::MohrCoulomb { cohesion_pa: K, friction_angle_rad: FRAC_PI_6 }, [apex; 3]);
    }

    #[test]
    fn drucker_prager_meets_mohr_coulomb_on_the_compressive_meridian() {
        for phi in [0.0, 0.3, 0.9] {
            let strength = Strength::DruckerPrager { cohesion_pa: K, friction_angle_rad: phi };
            let (sin, cos) = phi.sin_cos();
            assert_fails_at(&strength, [0.0, 0.0, -2.0 * K * cos / (1.0 - sin)]);
            let axial = (2.0 * K * (1.0 + sin) + 2.0 * K * cos) / (1.0 - sin);
            assert!((index(&strength, [-2.0 * K, -2.0 * K, -axial]) - 1.0).abs() < 1e-12);
            // Uniaxial tension: s (a + 1/sqrt3) = k.
            assert_fails_at(&strength, [6.0 * K * cos / (3.0 + sin), 0.0, 0.0]);
        }
        assert_fails_at(
            &Strength::DruckerPrager { cohesion_pa: K, friction_angle_rad: FRAC_PI_6 },
            [K / FRAC_PI_6.tan(); 3],
        );
    }

    #[test]
    fn states_below_the_safe_norm_are_safe_and_some_just_above_fail() {
        let friction_angle_rad = 0.6;
        for strength in [
            Strength::Tensile { tensile_strength_pa: K },
            Strength::Tresca { shear_strength_pa: K },
            Strength::VonMises { shear_strength_pa: K },
            Strength::MohrCoulomb { cohesion_pa: K, friction_angle_rad },
            Strength::DruckerPrager { cohesion_pa: K, friction_angle_rad },
        ] {
            let norm_pa = Criterion::single(strength.clone()).unwrap().safe_norm_pa();
            let mut highest = 0.0_f64;
            for step in 0..10_000 {
                let (height, turn) = (f64::from(step) / 5000.0 - 1.0, f64::from(step) * 2.4);
                let ring = (1.0 - height * height).sqrt();
                let direction = DVec3::new(ring * turn.cos(), ring * turn.sin(), height);
                highest = highest.max(index(&strength, (direction * norm_pa).to_array()));
            }
            assert!((0.75..1.0 + 1e-12).contains(&highest), "{strength:?}: {highest}");
        }
    }

    #[test]
    fn the_first_to_fail_of_a_list_governs_and_brings_its_plane() {
        let shear = Strength::MohrCoulomb { cohesion_pa: K, friction_angle_rad: FRAC_PI_6 };
        let cut_off = Strength::Tensile { tensile_strength_pa: K / 2.0 };
        let both = Criterion::any_of(vec![shear.into(), cut_off.into()]).unwrap();
        let rule = |s: [f64; 3]| both.assess(&StressMeasures::of(DVec3::from_array(s))).unwrap().rule;
        assert_eq!(rule([K, 0.0, 0.0]), 1);
        assert_eq!(rule([0.0, 0.0, -K]), 0);
        assert_eq!(rule([0.0; 3]), 0);
        assert_eq!(both.rules()[1].plane, PlaneRule::Opening);
        let formula = Formula::new("s1 - 0.5*s3 - F", &[("F", K)]).unwrap();
        assert_fails_at(&Strength::Formula(formula), [K, 0.0, 0.0]);
    }

    #[test]
    fn impossible_strengths_are_refused_with_the_place() {
        let good = || FailureRule::from(Strength::Tresca { shear_strength_pa: K });
        let text = |rules| Criterion::any_of(rules).unwrap_err().to_string();
        for value in [0.0, -1.0, f64::NAN, f64::INFINITY] {
            let bad = Strength::Tensile { tensile_strength_pa: value };
            let text = text(vec![good(), bad.into()]);
            assert!(text.starts_with("criterion 2: `tensile_strength_pa` is"), "{text}");
        }
        for angle_deg in [-1.0_f64, 90.0, 120.0, f64::NAN] {
            let friction_angle_rad = angle_deg.to_radians();
            let bad = Strength::DruckerPrager { cohesion_pa: K, friction_angle_rad };
            assert!(text(vec![bad.into()]).contains("`friction_angle` is"));
            let plane = PlaneRule::Sliding { friction_angle_rad };
            assert!(Criterion::any_of(vec![FailureRule { plane, ..good() }]).is_err());
        }
        assert_eq!(Criterion::any_of(Vec::new()), Err(CriterionError::Empty));
    }
}
