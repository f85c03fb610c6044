//! The list of cases.

use super::cases::{
    beams, criteria, fracture, impact, incline, kinematics, patch, penalty, pile, plates, rods, scenes, spin,
    squeeze, sweep, waves,
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

/// When a case is run that was not asked for by name.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Turn {
    /// Always, with `--quick`, too.
    Quick,
    /// When there is time.
    Full,
    /// Never: it takes minutes to hours.
    Asked,
}

/// A verification case.
#[derive(Clone, Copy)]
pub struct Case {
    /// Its name on the command line.
    pub id: &'static str,
    /// What it compares with what.
    pub title: &'static str,
    /// When it is run.
    pub turn: Turn,
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
    Case { id, title, turn: Turn::Quick, measure }
}

/// A case that takes too long for `--quick`.
const fn slow(case: Case) -> Case {
    Case { turn: Turn::Full, ..case }
}

/// A scene that breaks, under five criteria and at strengths from a tenth to ten times its own.
macro_rules! sweep {
    ($scene:literal) => {
        Case {
            turn: Turn::Asked,
            ..case(concat!("sweep-", $scene), concat!($scene, " at any criterion and strength"), |effort| {
                sweep::measure(effort, $scene)
            })
        }
    };
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
    slow(case("plates", "how the cracks of three plates lie", plates::measure)),
    case("spall", "a bar under sudden tension at both ends", fracture::measure_spall),
    case("penalty", "penalty springs against Lagrange multipliers", penalty::measure),
    sweep!("bar-torn"),
    sweep!("beam-notch"),
    sweep!("beam-notch-fine"),
    sweep!("pile-press"),
    sweep!("pile-press-fine"),
    sweep!("pile-split"),
    sweep!("cube-wall"),
    sweep!("cube-wall-fine"),
    sweep!("plate-tensile"),
    sweep!("plate-tensile-fine"),
    sweep!("plate-mohr-coulomb"),
    sweep!("plate-mohr-coulomb-fine"),
    sweep!("plate-tresca"),
    sweep!("plate-tresca-fine"),
    sweep!("plates-compared"),
    sweep!("glass-shot"),
    sweep!("pane-shot"),
    sweep!("mug-drop"),
    sweep!("brick-pile"),
];

/// The case of this name.
#[must_use]
pub fn find(id: &str) -> Option<&'static Case> {
    CASES.iter().find(|case| case.id == id)
}

/// The names of the runs of each `sweep-` case, with little effort or with much.
#[must_use]
pub fn sweep_runs(is_quick: bool) -> Vec<String> {
    sweep::names(is_quick)
}
