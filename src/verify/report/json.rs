//! The findings as JSON.

use super::{CaseReport, counts};
use crate::verify::{Measure, Quantity};
use serde_json::{Value, json};

fn quantity(quantity: &Quantity) -> Value {
    json!({
        "name": quantity.name,
        "unit": quantity.unit,
        "value": quantity.value,
        "reference": quantity.reference,
        "source": quantity.source,
        "measure": match quantity.measure {
            Measure::Relative => "relative",
            Measure::Absolute => "absolute",
        },
        "error": quantity.error(),
        "bound": quantity.bound,
        "reason": quantity.reason,
        "verdict": quantity.verdict(),
    })
}

/// All cases with their quantities. Numbers that are not finite become `null`.
#[must_use]
pub fn to_json(reports: &[CaseReport], is_quick: bool) -> Value {
    let [pass, short, shown] = counts(reports);
    let cases = reports.iter().map(|report| {
        json!({
            "id": report.case.id,
            "title": report.case.title,
            "passes": report.passes(),
            "failure": report.outcome.as_ref().err(),
            "quantities": report.quantities().iter().map(quantity).collect::<Vec<_>>(),
        })
    });
    json!({
        "program": "hammerfall",
        "version": env!("CARGO_PKG_VERSION"),
        "quick": is_quick,
        "pass": pass,
        "falls_short": short,
        "shown": shown,
        "cases": cases.collect::<Vec<_>>(),
    })
}
