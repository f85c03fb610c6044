//! When materials break, and how cracks grow.

use super::super::document::SceneDocument;
use super::super::findings::Findings;
use super::super::problem::SceneError;
use super::super::quantity::Quantity;
use super::super::reader::{Kind, Table};
use crate::fracture::plane::PlaneRule;
use crate::fracture::{
    Criterion, FailureRule, Formula, FormulaError, FormulaProblem, PropagationRule, Strength,
};
use crate::sim::FractureParameters;

/// Says that a material never breaks.
const NEVER: &str = "never";

/// The kinds of failure that a scene can name.
#[derive(Clone, Copy)]
enum Failing {
    Tensile,
    Tresca,
    VonMises,
    MohrCoulomb,
    DruckerPrager,
    Formula,
}

const KINDS: [(&str, Failing); 6] = [
    ("tensile", Failing::Tensile),
    ("tresca", Failing::Tresca),
    ("von-mises", Failing::VonMises),
    ("mohr-coulomb", Failing::MohrCoulomb),
    ("drucker-prager", Failing::DruckerPrager),
    ("formula", Failing::Formula),
];

/// The table `fracture` of a material: one criterion, or several of which any may fail.
pub(super) fn read_criterion(material: &mut Table) -> Option<Criterion> {
    if material.kind_of("fracture") == Some(Kind::Text) {
        if material.text("fracture").is_none_or(|text| text != NEVER) {
            material.report_type("fracture", "a criterion, or \"never\"");
        }
        return None;
    }
    let mut table = material.table("fracture")?;
    let rules: Option<Vec<FailureRule>> = if table.has("any_of") {
        let rules = table.tables("any_of");
        if rules.is_empty() {
            table.problem("any_of", format!("`{}` needs at least one criterion", table.name_of("any_of")));
        }
        rules.into_iter().map(|mut rule| read_rule(&mut rule)).collect()
    } else {
        read_rule(&mut table).map(|rule| vec![rule])
    };
    // Ranges have been checked key by key; what is left is told at the table.
    Criterion::any_of(rules.filter(|rules| !rules.is_empty())?)
        .map_err(|error| table.problem("", error.to_string()))
        .ok()
}

/// What makes a text of a criterion.
pub(in super::super) const CRITERION_PREFIX: &str = "fracture = ";

/// Reads a criterion on its own, from an inline table as a scene has it.
pub(in super::super) fn parse_criterion(label: &str, table: &str) -> Result<Criterion, SceneError> {
    let document = SceneDocument::parse(label, &format!("{CRITERION_PREFIX}{table}"))?;
    let findings = Findings::default();
    let criterion = read_criterion(&mut Table::root(document.root(), &findings));
    match criterion.filter(|_| findings.is_empty()) {
        Some(criterion) => Ok(criterion),
        None => Err(document.invalid(findings.into_problems())),
    }
}

fn read_rule(table: &mut Table) -> Option<FailureRule> {
    table.require("criterion", "when the material breaks, as in `criterion = \"tensile\"`");
    let Some(kind) = table.choice("criterion", &KINDS) else {
        table.forgive_the_rest();
        return None;
    };
    let strength = match kind {
        Failing::Tensile => {
            Strength::Tensile { tensile_strength_pa: read_strength(table, "tensile_strength") }
        }
        Failing::Tresca => Strength::Tresca { shear_strength_pa: read_strength(table, "shear_strength") },
        Failing::VonMises => Strength::VonMises { shear_strength_pa: read_strength(table, "shear_strength") },
        Failing::MohrCoulomb => Strength::MohrCoulomb {
            cohesion_pa: read_strength(table, "cohesion"),
            friction_angle_rad: read_friction_angle(table),
        },
        Failing::DruckerPrager => Strength::DruckerPrager {
            cohesion_pa: read_strength(table, "cohesion"),
            friction_angle_rad: read_friction_angle(table),
        },
        Failing::Formula => Strength::Formula(read_formula(table)?),
    };
    Some(FailureRule { plane: read_plane(table, &strength), strength })
}

fn read_strength(table: &mut Table, key: &'static str) -> f64 {
    table.required_number(key, Quantity::positive("Pa"))
}

/// Radians.
fn read_friction_angle(table: &mut Table) -> f64 {
    let angle = Quantity::not_negative("degrees").less_than(90.0);
    table.required_number("friction_angle", angle).to_radians()
}

fn read_formula(table: &mut Table) -> Option<Formula> {
    let text = table.required_text("formula");
    let parameters = table.table("parameters").map(|mut table| table.named_numbers()).unwrap_or_default();
    // Asked for here so that they stay known where the formula is refused.
    let parameters: Vec<(&str, f64)> =
        parameters.iter().map(|(name, value)| (name.as_str(), *value)).collect();
    if !table.has("formula") {
        return None;
    }
    let formula = Formula::new(&text, &parameters);
    let told = |error: FormulaError| {
        let hint = match &error.problem {
            FormulaProblem::UnknownName { name, .. } => {
                format!("; a name of your own gets its value by `parameters = {{ {name} = 3e6 }}`")
            }
            _ => String::new(),
        };
        table.problem("formula", format!("{error}{hint}"));
    };
    formula.map_err(told).ok()
}

/// How the cutting plane stands: across the largest tension, or sliding at the friction angle.
fn read_plane(table: &mut Table, strength: &Strength) -> PlaneRule {
    let natural = strength.natural_plane();
    let slides = table.choice("plane", &[("opening", false), ("sliding", true)]);
    match (slides, natural) {
        (Some(false), _) => PlaneRule::Opening,
        (Some(true), PlaneRule::Opening) => PlaneRule::Sliding { friction_angle_rad: 0.0 },
        _ => natural,
    }
}

/// The table `[fracture]`: how cracks grow.
pub(super) fn read_fracture(mut table: Table) -> FractureParameters {
    let defaults = FractureParameters::default();
    let rules =
        [("two-at-node", PropagationRule::TwoAtNode), ("single-element", PropagationRule::SingleElement)];
    let smallest = table.number("smallest_fragment", Quantity::not_negative("elements"));
    let altitude = table.number("smallest_altitude", Quantity::positive("").up_to(1.0));
    let spacing = table.number("crack_spacing", Quantity::not_negative("elements"));
    FractureParameters {
        rule: table.choice("propagation", &rules).unwrap_or(defaults.rule),
        crack_speed_m_s: table.number("crack_speed", Quantity::positive("m/s")),
        max_elements: table.integer("max_elements", 1, 10_000_000),
        smallest_fragment_elements: smallest.unwrap_or(defaults.smallest_fragment_elements),
        smallest_altitude_share: altitude.unwrap_or(defaults.smallest_altitude_share),
        crack_spacing_elements: spacing.unwrap_or(defaults.crack_spacing_elements),
    }
}
