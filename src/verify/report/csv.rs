//! The findings as CSV: numbers with the fewest digits that read back as the same `f64`.

use super::CaseReport;
use crate::verify::{Outcome, Plot};
use std::fmt::Write as _;

/// Name of the table of all quantities.
const QUANTITIES_FILE: &str = "quantities.csv";

/// Files with their content: `quantities.csv`, and one for each plot, named after it.
#[must_use]
pub fn csv_files(reports: &[CaseReport]) -> Vec<(String, String)> {
    let outcomes = reports.iter().filter_map(|report| report.outcome.as_ref().ok());
    let plots = outcomes.flat_map(|Outcome { plots, .. }| plots);
    let of_plots = plots.map(|plot| (format!("{}.csv", plot.id), curves(plot)));
    std::iter::once((QUANTITIES_FILE.to_owned(), quantities(reports))).chain(of_plots).collect()
}

fn quantities(reports: &[CaseReport]) -> String {
    let mut text = String::from("case,quantity,unit,value,reference,error,bound,verdict,source,reason\n");
    for report in reports {
        for q in report.quantities() {
            let bound = q.bound.map_or_else(String::new, |bound| bound.to_string());
            let words = [q.source, q.reason].map(quoted);
            let _ = writeln!(
                text,
                "{},{},{},{},{},{},{bound},{},{},{}",
                report.case.id,
                quoted(&q.name),
                q.unit,
                q.value,
                q.reference,
                q.error(),
                q.verdict(),
                words[0],
                words[1]
            );
        }
    }
    text
}

/// A line a point: curve, x, y. The axes stand in the header.
fn curves(plot: &Plot) -> String {
    let [x, y] = plot.labels.map(quoted);
    let mut text = format!("curve,{x},{y}\n");
    for curve in &plot.curves {
        let name = quoted(&curve.name);
        for [x, y] in &curve.points {
            let _ = writeln!(text, "{name},{x},{y}");
        }
    }
    text
}

/// A field in quotes where it needs them (RFC 4180).
fn quoted(field: &str) -> String {
    if field.contains([',', '"', '\n']) {
        format!("\"{}\"", field.replace('"', "\"\""))
    } else {
        field.to_owned()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn commas_and_quotes_stay_within_their_field() {
        assert_eq!(quoted("a"), "a");
        assert_eq!(quoted("a, \"b\""), "\"a, \"\"b\"\"\"");
    }
}
