//! The list of cases.

use super::cases::{
    beams, criteria, fracture, impact, incline, kinematics, patch, penalty, pile, rods, scenes, spin,
    squeeze, waves,
};
use super::{CaseError, Effort, Plot, Quantity};

/// What a case measured.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Outcome {
    /// The quantities, in the order of the table.
    pub quantities: Vec<Quantity>,
    /// The curves, for the report.
    pub plots: Vec<Plot>,
}

impl Outcome {
    /// Whether every quantity that is judged is within its bound.
    #[must_use]
    pub fn passes(&self) -> bool {
        self.quantities.iter().all(Quantity::passes)
    }
}

impl From<Vec<Quantity>> for Outcome {
    fn from(quantities: Vec<Quantity>) -> Self {
        Self { quantities, plots: Vec::new() }
    }
}

/// A verification case.
#[derive(Clone, Copy)]
pub struct Case {
    /// Its name on the command line.
    pub id: &'static str,
    /// What it compares with what.
    pub title: &'static str,
    /// Whether `--quick` runs it.
    pub is_quick: bool,
    measure: fn(&Effort) -> Result<Outcome, CaseError>,
}

impl Case {
    /// Measures the case.
    ///
    /// # Errors
    /// [`CaseError`] when it could not be measured, or an end was asked for.
    pub fn run(&self, effort: &Effort) -> Result<Outcome, CaseError> {
        (self.measure)(effort)
    }
}

const fn case(
    id: &'static str,
    title: &'static str,
    measure: fn(&Effort) -> Result<Outcome, CaseError>,
) -> Case {
    Case { id, title, is_quick: true, measure }
}

/// A case that takes too long for `--quick`.
const fn slow(case: Case) -> Case {
    Case { is_quick: false, ..case }
}

/// All cases, in the order of the report.
pub const CASES: &[Case] = &[
    case("patch", "uniform strain gives uniform stress", patch::measure),
    case("waves", "speed of waves in a bar", waves::measure),
    case("cantilever", "deflection and first frequency of a clamped beam", beams::measure),
    case("squeeze", "uniaxial and confined compression", squeeze::measure),
    case("rods", "two steel rods collide head-on", rods::measure),
    slow(case("rods-fine", "the same with 40 elements along", rods::measure_fine)),
    case("rods-refined", "length of the collision under refinement", rods::measure_refinement),
    case("rods-oblique", "rods that slide along each other", rods::measure_oblique),
    case("section", "a wave meets a change of section", waves::measure_section),
    case("cradle", "Newton's cradle of three equal rods", impact::measure_cradle),
    slow(case("hertz", "a ball bounces off a rigid plane", impact::measure_hertz)),
    slow(case("rolling", "a sliding ball comes to roll", impact::measure_rolling)),
    case("spin", "a box turns freely", spin::measure),
    case("kinematics", "the four elastic laws beside each other", kinematics::measure),
    case("incline", "a block on a slope", incline::measure),
    case("scenes", "energy balance of shipped scenes", scenes::measure),
    case("criteria", "failure criteria at known states", criteria::measure),
    slow(case("beam-notch", "first crack of a notched beam", fracture::measure_notch)),
    case("pile-press", "planes on which a pressed pile fails", pile::measure_planes),
    slow(case("pile-band", "the band that goes through a pressed pile", pile::measure_band)),
    slow(case("pile-split", "the crack that runs along a pile", pile::measure_split)),
    case("spall", "a bar under sudden tension at both ends", fracture::measure_spall),
    case("penalty", "penalty springs against Lagrange multipliers", penalty::measure),
];

/// The case of this name.
#[must_use]
pub fn find(id: &str) -> Option<&'static Case> {
    CASES.iter().find(|case| case.id == id)
}
