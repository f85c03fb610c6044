//! What the cases found, as text, JSON, CSV and one HTML page.

mod csv;
mod html;
mod json;
mod svg;
mod text;

pub use csv::csv_files;
pub use html::html;
pub use json::to_json;
pub use text::{markdown, table};

use super::{CASES, Case, Measure, Outcome, Quantity};

/// A case with what it found, or why it found nothing.
pub struct CaseReport {
    /// The case.
    pub case: &'static Case,
    /// What it measured, or a sentence that says why it could not be.
    pub outcome: Result<Outcome, String>,
}

impl CaseReport {
    /// Whether the case was measured and everything judged is within its bound.
    #[must_use]
    pub fn passes(&self) -> bool {
        self.outcome.as_ref().is_ok_and(Outcome::passes)
    }

    fn quantities(&self) -> &[Quantity] {
        self.outcome.as_ref().map_or(&[], |outcome| &outcome.quantities)
    }
}

/// Numbers of the quantities that pass, fall short and are only shown; a case that could not be measured counts as one
/// that falls short.
#[must_use]
pub fn counts(reports: &[CaseReport]) -> [usize; 3] {
    let verdicts = |verdict: &'static str| {
        let all = reports.iter().flat_map(CaseReport::quantities);
        all.filter(|quantity| quantity.verdict() == verdict).count()
    };
    let unmeasured = reports.iter().filter(|report| report.outcome.is_err()).count();
    [verdicts("pass"), verdicts("falls short") + unmeasured, verdicts("shown")]
}

/// The names of all cases, for messages.
#[must_use]
pub fn known_cases() -> String {
    CASES.iter().map(|case| case.id).collect::<Vec<_>>().join(", ")
}

/// Name of the page among the files of a report.
pub const PAGE_FILE: &str = "report.html";

/// A picture for the page.
pub struct Picture {
    /// Name of the case it belongs to.
    pub case: &'static str,
    /// What it shows.
    pub caption: &'static str,
    /// The content of a PNG file.
    pub png: Vec<u8>,
}

/// The pictures of a page; drawn by whoever asks for it, since nothing here draws.
#[derive(Default)]
pub struct Pictures {
    /// The pictures.
    pub list: Vec<Picture>,
    /// Why there are none, as a sentence for the page.
    pub missing: Option<String>,
}

/// All files of a report with their content: the page, and the same as CSV.
#[must_use]
pub fn files(reports: &[CaseReport], is_quick: bool, pictures: &Pictures) -> Vec<(String, String)> {
    let page = (PAGE_FILE.to_owned(), html(reports, is_quick, pictures));
    std::iter::once(page).chain(csv_files(reports)).collect()
}

/// A number for people: five digits, in plain notation where that is short.
fn number(value: f64) -> String {
    if !value.is_finite() {
        return "none".to_owned();
    }
    let rounded: f64 = format!("{value:.4e}").parse().unwrap_or(value);
    if rounded == 0.0 {
        "0".to_owned()
    } else if (1e-3..1e5).contains(&rounded.abs()) {
        format!("{rounded}")
    } else {
        format!("{rounded:e}")
    }
}

fn with_unit(value: f64, unit: &str) -> String {
    if unit.is_empty() { number(value) } else { format!("{} {unit}", number(value)) }
}

/// An error or a bound: percent for shares, the quantity's unit otherwise.
fn deviation(value: f64, quantity: &Quantity) -> String {
    match quantity.measure {
        Measure::Relative if value.is_finite() => {
            let percent: f64 = format!("{:.2e}", value * 100.0).parse().unwrap_or(value * 100.0);
            if percent == 0.0 || (1e-3..1e5).contains(&percent.abs()) {
                format!("{percent} %")
            } else {
                format!("{percent:e} %")
            }
        }
        Measure::Relative => "none".to_owned(),
        Measure::Absolute => {
            let rounded: f64 = format!("{value:.2e}").parse().unwrap_or(value);
            with_unit(rounded, quantity.unit)
        }
    }
}
