//! Fracture: when an element fails, where it is cut, and what becomes of the body (METHOD 6, 7).

pub mod criterion;
pub mod formula;
pub mod plane;
pub mod stress;

pub use criterion::{Assessment, Criterion, CriterionError, FailureRule, Strength};
pub use formula::{Formula, FormulaError, FormulaProblem};
pub use plane::PlaneRule;
pub use stress::{PrincipalStress, StressMeasures};
