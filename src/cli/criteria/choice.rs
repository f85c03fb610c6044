//! Which criteria are drawn, and what the legend calls them.

use super::CriteriaArgs;
use crate::cli::args::{CommonArgs, split_unit};
use crate::cli::console::Console;
use crate::cli::failure::Failure;
use crate::cli::scene_source;
use crate::fracture::{Criterion, Formula, FormulaError, FormulaProblem, Strength};
use crate::render::{short, with_unit};
use crate::scene::{CRITERION_COLUMN, Location, Problem, SceneError, parse_criterion};

/// A criterion with its name.
pub struct Entry {
    /// Of the material and the criterion, with its parameters.
    pub name: String,
    pub criterion: Criterion,
}

/// The standard criteria. All but Drucker-Prager bear 10 MPa in uniaxial tension; it and Mohr-Coulomb bear 30 MPa in uniaxial
/// compression.
const STANDARD: [(&str, &str); 5] = [
    ("tensile", "tensile_strength=10e6"),
    ("tresca", "shear_strength=5e6"),
    ("von-mises", "shear_strength=5.773502691896258e6"),
    ("mohr-coulomb", "cohesion=8.660254037844386e6 friction_angle=30"),
    ("drucker-prager", "cohesion=8.660254037844386e6 friction_angle=30"),
];

/// Everything that the arguments ask for, equal criteria once.
pub fn entries(args: &CriteriaArgs, common: &CommonArgs, console: &Console) -> Result<Vec<Entry>, Failure> {
    let mut found = match &args.scene {
        Some(scene) => of_scene(scene, common, console)?,
        None => Vec::new(),
    };
    let added = added_values(args, common)?;
    for text in &args.criterion {
        found.push(unnamed(of_text(text, &added)?));
    }
    for text in &args.formula {
        found.push(unnamed(of_formula(text, &args.parameter)?));
    }
    if args.formula.is_empty() && !args.parameter.is_empty() {
        return Err(Failure::BadInput(
            "--parameter is given, but no --formula that could use it; parameters of --criterion go with it, as in \
             \"tresca shear_strength=5e6\""
                .to_owned(),
        ));
    }
    if found.is_empty() {
        for (kind, _) in STANDARD {
            found.push(unnamed(of_text(kind, "")?));
        }
    }
    Ok(merged(found))
}

/// What `--set` adds to the one criterion that is asked for by itself.
fn added_values(args: &CriteriaArgs, common: &CommonArgs) -> Result<String, Failure> {
    let first = common.overrides.first().filter(|_| args.scene.is_none());
    match (first, args.criterion.len()) {
        (None, _) => Ok(String::new()),
        (Some(_), 1) => Ok(common.overrides.join(" ")),
        (Some(first), 0) => Err(Failure::BadInput(format!(
            "there is no scene for `--set {first}` to override; name the scene, or use --criterion"
        ))),
        (Some(first), _) => Err(Failure::BadInput(format!(
            "`--set {first}` goes with one --criterion and there are several; write the values with each, as in \
             --criterion \"tensile tensile_strength=1MPa\""
        ))),
    }
}

fn of_scene(name: &str, common: &CommonArgs, console: &Console) -> Result<Vec<Entry>, Failure> {
    let scene = scene_source::load(name, &common.overrides, console)?;
    let entries: Vec<Entry> = scene
        .description
        .materials
        .iter()
        .filter_map(|material| {
            let criterion = material.fracture.clone()?;
            Some(Entry { name: format!("{}: {}", material.name, describe(&criterion)), criterion })
        })
        .collect();
    if entries.is_empty() {
        return Err(Failure::BadInput(format!(
            "nothing breaks in `{name}`: none of its materials has a `fracture`; without a scene `hammerfall criteria` \
             draws the five standard criteria"
        )));
    }
    Ok(entries)
}

fn unnamed(criterion: Criterion) -> Entry {
    Entry { name: describe(&criterion), criterion }
}

/// From a kind with its parameters in words, or from a table as in a scene; `added` are more parameters in words.
fn of_text(text: &str, added: &str) -> Result<Criterion, Failure> {
    let text = text.trim();
    let table = match text.strip_suffix('}').filter(|_| text.starts_with('{')) {
        Some(_) if added.is_empty() => text.to_owned(),
        Some(open) => format!("{open}, {} }}", values_of_words("", added)?.join(", ")),
        None if text.starts_with('{') => {
            return Err(Failure::BadInput(format!(
                "--criterion \"{text}\": the table is not closed, a `}}` is missing at its end"
            )));
        }
        None => table_of_words(text, added)?,
    };
    parse_criterion("--criterion", &table).map_err(|error| refused(text, &error))
}

/// `tresca shear_strength=5e6`, `tresca shear_strength=5MPa` and `tresca 5MPa` as a table; a kind alone with the values
/// of [`STANDARD`].
fn table_of_words(text: &str, added: &str) -> Result<String, Failure> {
    let (kind, values) = text.split_once([' ', ':', '\t']).unwrap_or((text, ""));
    let standard = STANDARD.iter().find(|(name, _)| *name == kind);
    let values = match standard {
        Some((_, standard)) if values.trim().is_empty() && added.is_empty() => (*standard).to_owned(),
        _ => format!("{values} {added}"),
    };
    let mut words = vec![format!("criterion = {kind:?}")];
    words.extend(values_of_words(standard.map_or("", |(_, values)| values), &values)?);
    Ok(format!("{{ {} }}", words.join(", ")))
}

/// Names with values as TOML, in Pa and degrees. Values without a name are those of `standard`, in its order.
fn values_of_words(standard: &str, values: &str) -> Result<Vec<String>, Failure> {
    let is_unit =
        |word: &str| ["deg", "°"].contains(&word) || STRESS_UNITS.iter().any(|(unit, _)| *unit == word);
    let mut words: Vec<String> = Vec::new();
    for word in values.replace('=', " = ").split([' ', ',', '\t']).filter(|word| !word.is_empty()) {
        match words.last_mut() {
            // What belongs to the word before: an equals sign, what follows it, a unit.
            Some(last) if word == "=" || last.ends_with('=') || is_unit(word) => last.push_str(word),
            _ => words.push(word.to_owned()),
        }
    }
    let names: Vec<&str> = standard.split([' ', '=']).step_by(2).filter(|name| !name.is_empty()).collect();
    let mut unnamed = names.iter();
    let pair = |word: String| match word.split_once('=') {
        Some((name, value)) => Ok(format!("{name} = {}", bare_value(value))),
        None => match unnamed.next().filter(|_| word.starts_with(|first: char| !first.is_alphabetic())) {
            Some(name) => Ok(format!("{name} = {}", bare_value(&word))),
            None => Err(Failure::BadInput(format!(
                "--criterion: `{word}` has no name; write NAME=VALUE, as in \"tensile tensile_strength=1MPa\" (stresses in \
                 Pa, kPa, MPa or GPa, angles in degrees)"
            ))),
        },
    };
    words.into_iter().map(pair).collect()
}

/// A value in Pa or degrees without its unit; what is no such value stays for the reader to judge.
fn bare_value(value: &str) -> String {
    let bare = value.strip_suffix("deg").or(value.strip_suffix('°')).unwrap_or(value);
    match parse_stress(bare) {
        Ok(number) if bare.parse::<f64>().is_err() => format!("{number:e}"),
        _ => bare.to_owned(),
    }
}

fn refused(text: &str, error: &SceneError) -> Failure {
    let messages: Vec<String> = error.problems().iter().map(|problem| problem_in(text, problem)).collect();
    Failure::BadInput(format!("--criterion \"{text}\": {}", messages.join("\n  ")))
}

/// The message; in a table typed as such with its column.
fn problem_in(text: &str, Problem { location, message, .. }: &Problem) -> String {
    match location {
        Location::Line { line: 1, column } if text.starts_with('{') => {
            format!("column {}: {message}", column.saturating_sub(CRITERION_COLUMN).max(1))
        }
        _ => message.clone(),
    }
}

fn of_formula(text: &str, parameters: &[(String, f64)]) -> Result<Criterion, Failure> {
    let parameters: Vec<(&str, f64)> =
        parameters.iter().map(|(name, value)| (name.as_str(), *value)).collect();
    let refused = |reason: String| Failure::BadInput(format!("--formula: {reason}"));
    let in_words = |error: FormulaError| match &error.problem {
        FormulaProblem::UnknownName { name, .. } => {
            refused(format!("{error}; a name of your own gets its value by --parameter {name}=3e6"))
        }
        _ => refused(error.to_string()),
    };
    let formula = Formula::new(text, &parameters).map_err(in_words)?;
    Criterion::single(Strength::Formula(formula)).map_err(|error| refused(error.to_string()))
}

/// Equal criteria under one name.
fn merged(entries: Vec<Entry>) -> Vec<Entry> {
    let mut kept: Vec<Entry> = Vec::new();
    for entry in entries {
        match kept.iter_mut().find(|other| other.criterion == entry.criterion) {
            Some(other) if other.name == entry.name => {}
            Some(other) => {
                let material = entry.name.split(':').next().unwrap_or_default();
                other.name = format!("{material}, {}", other.name);
            }
            None => kept.push(entry),
        }
    }
    kept
}

fn describe(criterion: &Criterion) -> String {
    let rules: Vec<String> = criterion.rules().iter().map(|rule| describe_strength(&rule.strength)).collect();
    rules.join(" or ")
}

fn describe_strength(strength: &Strength) -> String {
    let stress = |value_pa: f64| with_unit(value_pa, "Pa");
    let cone = |name: &str, cohesion_pa: f64, friction_angle_rad: f64| {
        format!("{name}, c = {}, φ = {}°", stress(cohesion_pa), short(friction_angle_rad.to_degrees()))
    };
    match strength {
        Strength::Tensile { tensile_strength_pa } => {
            format!("tensile, Ft = {}", stress(*tensile_strength_pa))
        }
        Strength::Tresca { shear_strength_pa } => format!("Tresca, k = {}", stress(*shear_strength_pa)),
        Strength::VonMises { shear_strength_pa } => format!("von Mises, k = {}", stress(*shear_strength_pa)),
        Strength::MohrCoulomb { cohesion_pa, friction_angle_rad } => {
            cone("Mohr-Coulomb", *cohesion_pa, *friction_angle_rad)
        }
        Strength::DruckerPrager { cohesion_pa, friction_angle_rad } => {
            cone("Drucker-Prager", *cohesion_pa, *friction_angle_rad)
        }
        Strength::Formula(formula) => formula.text().trim().to_owned(),
    }
}

/// Reads `NAME=VALUE`.
///
/// # Errors
/// What is expected, for clap to print.
pub fn parse_named_number(text: &str) -> Result<(String, f64), String> {
    let pair = text.split_once('=').and_then(|(name, value)| Some((name.trim(), value.trim().parse().ok()?)));
    match pair {
        Some((name, value)) if !name.is_empty() => Ok((name.to_owned(), value)),
        _ => Err("expected NAME=NUMBER, e.g. Ft=3e6".to_owned()),
    }
}

/// Units of stress, Pa; the one that others end in comes last.
const STRESS_UNITS: [(&str, f64); 4] = [("kPa", 1e3), ("MPa", 1e6), ("GPa", 1e9), ("Pa", 1.0)];

/// Reads a stress in Pa, or with `kPa`, `MPa` or `GPa`.
///
/// # Errors
/// What is expected, for clap to print.
pub fn parse_stress(text: &str) -> Result<f64, String> {
    let (number, factor) = split_unit(text, &STRESS_UNITS);
    match number.parse::<f64>() {
        Ok(value) if (value * factor).abs() < 1e12 => Ok(value * factor),
        Ok(_) => Err("no material bears such a stress".to_owned()),
        Err(_) => Err("expected a stress in Pa, e.g. -5e6 or -5MPa".to_owned()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn words_and_tables_say_the_same() {
        let criterion = |text: &str| of_text(text, "").unwrap();
        let words = criterion("tresca shear_strength=5e6");
        for text in [
            "{ criterion = \"tresca\", shear_strength = 5e6 }",
            "tresca",
            "tresca shear_strength=5MPa",
            "tresca shear_strength = 5 MPa",
            "tresca 5MPa",
            "tresca:5e6",
        ] {
            assert_eq!(words, criterion(text), "{text}");
        }
        let cone = criterion("mohr-coulomb cohesion=5e6 friction_angle=30");
        assert_eq!(cone, criterion("mohr-coulomb cohesion=5 MPa, friction_angle=30°"));
        assert_eq!(cone, criterion("mohr-coulomb 5MPa 30deg"));
        assert_eq!(cone, of_text("mohr-coulomb cohesion=5e6", "friction_angle=30").unwrap());
        assert_eq!(words, of_text("{ criterion = \"tresca\" }", "shear_strength=5MPa").unwrap());
        assert_ne!(words, of_text("tresca", "shear_strength=6MPa").unwrap());
        for (text, part) in [
            ("tresca shear_strength=0", "shear_strength"),
            ("{ criterion = \"tresca\"", "a `}` is missing at its end"),
            ("tresca much", "`much` has no name; write NAME=VALUE"),
            ("tresca 1e6 2e6", "`2e6` has no name"),
            ("tresca shear_strength=lots", "valid TOML"),
        ] {
            assert!(
                matches!(of_text(text, ""), Err(Failure::BadInput(told)) if told.contains(part)),
                "{text}"
            );
        }
    }

    #[test]
    fn stresses_have_units() {
        assert_eq!(parse_stress("-5MPa"), Ok(-5e6));
        assert_eq!(parse_stress("2 kPa"), Ok(2e3));
        assert_eq!(parse_stress("1e6"), Ok(1e6));
        for text in ["", "MPa", "nan", "inf", "1e12 MPa", "5 psi"] {
            assert!(parse_stress(text).is_err(), "{text}");
        }
    }

    #[test]
    fn equal_criteria_are_drawn_once() {
        let named =
            |name: &str| Entry { name: format!("{name}: tresca"), criterion: of_text("tresca", "").unwrap() };
        let merged = merged(vec![named("a"), named("b")]);
        assert_eq!(merged.len(), 1);
        assert!(merged[0].name.contains('a') && merged[0].name.contains('b'));
    }
}
