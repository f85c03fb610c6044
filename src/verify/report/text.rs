//! Tables for a terminal and for README.

use super::{CaseReport, deviation, with_unit};
use crate::verify::Quantity;
use std::fmt::Write as _;

pub(super) const HEADINGS: [&str; 6] = ["quantity", "ours", "reference", "error", "bound", ""];

pub(super) fn cells(quantity: &Quantity) -> [String; 6] {
    [
        quantity.name.clone(),
        with_unit(quantity.value, quantity.unit),
        with_unit(quantity.reference, quantity.unit),
        deviation(quantity.error(), quantity),
        quantity.bound.map_or_else(|| "-".to_owned(), |bound| deviation(bound, quantity)),
        quantity.verdict().to_owned(),
    ]
}

/// The table of one case; below each row where its reference comes from and why its bound is what it is.
#[must_use]
pub fn table(report: &CaseReport) -> String {
    let mut text = format!("{}: {}\n", report.case.id, report.case.title);
    let outcome = match &report.outcome {
        Ok(outcome) => outcome,
        Err(reason) => {
            let _ = writeln!(text, "  falls short: it could not be measured: {reason}");
            return text;
        }
    };
    let rows: Vec<[String; 6]> = outcome.quantities.iter().map(cells).collect();
    let headings = HEADINGS.map(str::to_owned);
    let widths: [usize; 6] = std::array::from_fn(|column| {
        rows.iter().chain([&headings]).map(|row| row[column].chars().count()).max().unwrap_or(0)
    });
    let line = |row: &[String; 6]| {
        let padded = row.iter().zip(widths).map(|(cell, width)| format!("{cell:width$}"));
        format!("  {}", padded.collect::<Vec<_>>().join("  ")).trim_end().to_owned()
    };
    let _ = writeln!(text, "{}", line(&headings));
    for (row, quantity) in rows.iter().zip(&outcome.quantities) {
        let _ = writeln!(text, "{}", line(row));
        let reason =
            if quantity.reason.is_empty() { String::new() } else { format!("; bound: {}", quantity.reason) };
        let _ = writeln!(text, "      {}{reason}", quantity.source);
    }
    text
}

/// All quantities as one Markdown table.
#[must_use]
pub fn markdown(reports: &[CaseReport]) -> String {
    let mut text = String::from(
        "| case | quantity | ours | reference | error | bound | |\n|---|---|---|---|---|---|---|\n",
    );
    for report in reports {
        for quantity in report.quantities() {
            let _ = writeln!(text, "| `{}` | {} |", report.case.id, cells(quantity).join(" | "));
        }
        if let Err(reason) = &report.outcome {
            let _ = writeln!(
                text,
                "| `{}` | could not be measured: {reason} | | | | | falls short |",
                report.case.id
            );
        }
    }
    text
}
