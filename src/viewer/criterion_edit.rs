//! A failure criterion while somebody edits it.

use crate::fracture::{Criterion, CriterionError, FailureRule, Formula, FormulaError, PlaneRule, Strength};

/// Strength when there was none before, Pa: every choice starts from it.
const FIRST_STRENGTH_PA: f64 = 1e6;
/// Cohesion over tensile strength of a criterion with friction: that of brittle materials.
const COHESION_SHARE: f64 = 2.0;

/// Choices of the drop-down.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Failing {
    /// Never breaks.
    Never,
    /// Tension.
    Tensile,
    /// Largest shear.
    Tresca,
    /// Shape-changing energy.
    VonMises,
    /// Sliding with friction.
    MohrCoulomb,
    /// The same as a cone.
    DruckerPrager,
    /// Tension or sliding with friction, whichever comes first.
    TensileOrSliding,
    /// A typed formula.
    Formula,
    /// As the scene has it, which none of the others is.
    AsInScene,
}

impl Failing {
    /// Those that everybody may choose, in the order of the drop-down.
    pub const ALL: [Self; 8] = [
        Self::Never,
        Self::Tensile,
        Self::Tresca,
        Self::VonMises,
        Self::MohrCoulomb,
        Self::DruckerPrager,
        Self::TensileOrSliding,
        Self::Formula,
    ];

    /// The words in the drop-down.
    #[must_use]
    pub fn label(self) -> &'static str {
        match self {
            Self::Never => "Never breaks",
            Self::Tensile => "Tension (Rankine)",
            Self::Tresca => "Shear (Tresca)",
            Self::VonMises => "Shear (von Mises)",
            Self::MohrCoulomb => "Mohr-Coulomb",
            Self::DruckerPrager => "Drucker-Prager",
            Self::TensileOrSliding => "Mohr-Coulomb, tension cut-off",
            Self::Formula => "Formula",
            Self::AsInScene => "As in the scene",
        }
    }

    /// Where it fails, as a formula.
    #[must_use]
    pub fn explanation(self) -> &'static str {
        match self {
            Self::Never => "",
            Self::Tensile => "fails where s1 reaches the tensile strength",
            Self::Tresca => "fails where (s1 − s3)/2 reaches the shear strength",
            Self::VonMises => "fails where √J2 reaches the shear strength",
            Self::MohrCoulomb => "fails where (s1 − s3)/2 + (s1 + s3)/2 · sin φ reaches c · cos φ",
            Self::DruckerPrager => "a cone through Mohr-Coulomb's compressive edge",
            Self::TensileOrSliding => "fails by tension or by sliding, whichever comes first",
            Self::Formula => "fails where the formula is zero or above; s1 ≥ s2 ≥ s3, tension positive",
            Self::AsInScene => "several rules, or a formula with named parameters, from the scene's text",
        }
    }
}

/// The choice and all values, also those that the choice does not use: changing it back finds them again.
#[derive(Clone, Debug, PartialEq)]
pub struct CriterionEdit {
    /// The choice.
    pub kind: Failing,
    /// Pa.
    pub tensile_strength_pa: f64,
    /// Pa.
    pub shear_strength_pa: f64,
    /// Pa.
    pub cohesion_pa: f64,
    /// Degrees.
    pub friction_angle_deg: f64,
    /// The formula as typed.
    pub formula: String,
    /// What the scene has.
    original: Option<Criterion>,
}

impl CriterionEdit {
    /// What a material has.
    #[must_use]
    pub fn of(criterion: Option<&Criterion>) -> Self {
        let mut edit = Self {
            kind: Failing::Never,
            tensile_strength_pa: FIRST_STRENGTH_PA,
            shear_strength_pa: FIRST_STRENGTH_PA,
            cohesion_pa: COHESION_SHARE * FIRST_STRENGTH_PA,
            friction_angle_deg: 30.0,
            formula: String::new(),
            original: criterion.cloned(),
        };
        if let Some(criterion) = criterion {
            edit.read(criterion);
        }
        if edit.formula.is_empty() {
            edit.formula = format!("s1 - {}*MPa", edit.tensile_strength_pa / 1e6);
        }
        edit
    }

    /// Takes what it can from a criterion; what the choices cannot say stays as it is in the scene.
    fn read(&mut self, criterion: &Criterion) {
        let strengths = criterion.rules().iter().map(|rule| &rule.strength);
        for strength in strengths.clone() {
            match strength {
                Strength::Tensile { tensile_strength_pa } => {
                    self.tensile_strength_pa = *tensile_strength_pa;
                    self.shear_strength_pa = *tensile_strength_pa;
                    self.cohesion_pa = COHESION_SHARE * tensile_strength_pa;
                }
                Strength::Tresca { shear_strength_pa } | Strength::VonMises { shear_strength_pa } => {
                    self.shear_strength_pa = *shear_strength_pa;
                    self.tensile_strength_pa = *shear_strength_pa;
                    self.cohesion_pa = *shear_strength_pa;
                }
                Strength::MohrCoulomb { cohesion_pa, friction_angle_rad }
                | Strength::DruckerPrager { cohesion_pa, friction_angle_rad } => {
                    self.cohesion_pa = *cohesion_pa;
                    self.friction_angle_deg = tidy(friction_angle_rad.to_degrees());
                    self.shear_strength_pa = *cohesion_pa;
                    if criterion.rules().len() == 1 {
                        self.tensile_strength_pa = cohesion_pa / COHESION_SHARE;
                    }
                }
                Strength::Formula(formula) => self.formula = formula.text().to_owned(),
            }
        }
        let strengths: Vec<&Strength> = strengths.collect();
        self.kind = match strengths.as_slice() {
            [Strength::Tensile { .. }] => Failing::Tensile,
            [Strength::Tresca { .. }] => Failing::Tresca,
            [Strength::VonMises { .. }] => Failing::VonMises,
            [Strength::MohrCoulomb { .. }] => Failing::MohrCoulomb,
            [Strength::DruckerPrager { .. }] => Failing::DruckerPrager,
            [Strength::Tensile { .. }, Strength::MohrCoulomb { .. }] => Failing::TensileOrSliding,
            [Strength::Formula(_)] => Failing::Formula,
            _ => Failing::AsInScene,
        };
        if !self.made().is_ok_and(|made| made.is_some_and(|made| is_near(&made, criterion))) {
            self.kind = Failing::AsInScene;
        }
    }

    /// Whether the scene has something that none of the choices is.
    #[must_use]
    pub fn is_special(&self) -> bool {
        Self::of(self.original.as_ref()).kind == Failing::AsInScene
    }

    /// What is wrong with the formula as typed, if it is what counts.
    #[must_use]
    pub fn formula_error(&self) -> Option<FormulaError> {
        (self.kind == Failing::Formula).then(|| Formula::new(&self.formula, &[]).err()).flatten()
    }

    /// What a reset makes of it: a wrong formula leaves the criterion that acts now.
    #[must_use]
    pub fn or_acting(&self, acting: Option<&Criterion>) -> Self {
        match self.criterion() {
            Ok(_) => self.clone(),
            Err(_) => Self { original: self.original.clone(), ..Self::of(acting) },
        }
    }

    /// The criterion; `None` for never.
    ///
    /// # Errors
    /// What is wrong with the formula or a value.
    pub fn criterion(&self) -> Result<Option<Criterion>, CriterionError> {
        let untouched = Self::of(self.original.as_ref());
        if self.kind == Failing::AsInScene || *self == untouched {
            return Ok(self.original.clone());
        }
        self.made()
    }

    fn made(&self) -> Result<Option<Criterion>, CriterionError> {
        let friction_angle_rad = self.friction_angle_deg.to_radians();
        let tensile = Strength::Tensile { tensile_strength_pa: self.tensile_strength_pa };
        let (cohesion_pa, shear_strength_pa) = (self.cohesion_pa, self.shear_strength_pa);
        let strengths = match self.kind {
            Failing::Never | Failing::AsInScene => return Ok(None),
            Failing::Tensile => vec![tensile],
            Failing::Tresca => vec![Strength::Tresca { shear_strength_pa }],
            Failing::VonMises => vec![Strength::VonMises { shear_strength_pa }],
            Failing::MohrCoulomb => vec![Strength::MohrCoulomb { cohesion_pa, friction_angle_rad }],
            Failing::DruckerPrager => vec![Strength::DruckerPrager { cohesion_pa, friction_angle_rad }],
            Failing::TensileOrSliding => {
                vec![tensile, Strength::MohrCoulomb { cohesion_pa, friction_angle_rad }]
            }
            Failing::Formula => {
                let formula = Formula::new(&self.formula, &[]);
                let formula = formula.map_err(|error| CriterionError::Formula { rule: 0, error })?;
                vec![Strength::Formula(formula)]
            }
        };
        Criterion::any_of(strengths.into_iter().map(FailureRule::from).collect()).map(Some)
    }

    /// The `fracture` of a scene file; `None` while it cannot be used or is as in the scene.
    #[must_use]
    pub fn to_toml(&self) -> Option<String> {
        let made = self.criterion().ok()?;
        if made == self.original {
            return None;
        }
        let (tensile, shear) = (self.tensile_strength_pa, self.shear_strength_pa);
        let (cohesion, angle) = (self.cohesion_pa, self.friction_angle_deg);
        let tensile = format!("criterion = \"tensile\", tensile_strength = {tensile:?}");
        let with_shear = |name: &str| format!("criterion = \"{name}\", shear_strength = {shear:?}");
        let with_friction = |name: &str| {
            format!("criterion = \"{name}\", cohesion = {cohesion:?}, friction_angle = {angle:?}")
        };
        let rule = match self.kind {
            Failing::Never => return Some("\"never\"".to_owned()),
            Failing::AsInScene => return None,
            Failing::Tensile => tensile,
            Failing::Tresca => with_shear("tresca"),
            Failing::VonMises => with_shear("von-mises"),
            Failing::MohrCoulomb => with_friction("mohr-coulomb"),
            Failing::DruckerPrager => with_friction("drucker-prager"),
            Failing::TensileOrSliding => {
                format!("any_of = [{{ {tensile} }}, {{ {} }}]", with_friction("mohr-coulomb"))
            }
            Failing::Formula => format!("criterion = \"formula\", formula = {:?}", self.formula),
        };
        Some(format!("{{ {rule} }}"))
    }
}

/// Whether two criteria are the same but for the rounding of angles to degrees.
fn is_near(a: &Criterion, b: &Criterion) -> bool {
    let same_plane = |a: PlaneRule, b: PlaneRule| match (a, b) {
        (PlaneRule::Sliding { friction_angle_rad: a }, PlaneRule::Sliding { friction_angle_rad: b }) => {
            (a - b).abs() < 1e-9
        }
        (a, b) => a == b,
    };
    a.rules().len() == b.rules().len()
        && a.rules().iter().zip(b.rules()).all(|(a, b)| same_plane(a.plane, b.plane))
}

/// Without the last digits that degrees and radians leave.
fn tidy(value: f64) -> f64 {
    (value * 1e9).round() / 1e9
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::{BUILTIN_SCENES, Scene};

    #[test]
    fn an_untouched_criterion_stays_as_it_is_in_every_scene() {
        for builtin in BUILTIN_SCENES {
            for material in &Scene::load(builtin.name, &[]).unwrap().description.materials {
                let edit = CriterionEdit::of(material.fracture.as_ref());
                assert_eq!(edit.criterion().unwrap(), material.fracture, "{}", builtin.name);
                assert_eq!(edit.to_toml(), None);
                assert_ne!(edit.kind, Failing::AsInScene, "{}: {}", builtin.name, material.name);
            }
        }
    }

    #[test]
    fn every_choice_becomes_the_criterion_that_the_scene_then_has() {
        let scene = Scene::load("brick-pile", &[]).unwrap();
        let base = scene.description.materials.iter().find(|m| m.name == "brick").unwrap();
        for kind in Failing::ALL {
            let mut edit = CriterionEdit::of(base.fracture.as_ref());
            edit.kind = kind;
            edit.tensile_strength_pa *= 1.5;
            edit.formula = "s1 - 0.3*MPa".to_owned();
            let text = edit.to_toml();
            let Some(text) = text else {
                assert_eq!(edit.criterion().unwrap(), base.fracture);
                continue;
            };
            let changed = scene.with_overrides(&[format!("materials.brick.fracture={text}")]).unwrap();
            let now = changed.description.materials.iter().find(|m| m.name == "brick").unwrap();
            assert_eq!(now.fracture, edit.criterion().unwrap(), "{text}");
        }
    }

    #[test]
    fn a_wrong_formula_is_told_with_its_column_and_changes_nothing() {
        let mut edit = CriterionEdit::of(None);
        edit.kind = Failing::Formula;
        edit.formula = "s1 - Ftt".to_owned();
        assert_eq!(edit.formula_error().unwrap().column, 6);
        assert!(edit.to_toml().is_none() && edit.criterion().is_err());
    }
}
