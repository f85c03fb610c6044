//! Verification: cases with known answers, each quantity beside its reference and its bound (METHOD 8, 9).
//!
//! [`CASES`] lists them; [`Case::run`] measures one. A [`Quantity`] holds its value, the reference with its source, and
//! the bound of the error with its reason; [`Plot`]s hold the curves of the report. Nothing here reads or writes a
//! file, and nothing depends on the clock or on the number of threads.

mod balance;
mod case;
pub mod cases;
mod cracks;
mod effort;
mod plot;
mod quantity;
pub mod report;
mod specimen;

pub use case::{CASES, Case, Outcome, Turn, find, sweep_runs};
pub use effort::{CaseError, Effort};
pub use plot::{Curve, Plot, Scale};
pub use quantity::{Measure, Quantity};
