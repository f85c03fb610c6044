//! Fracture: when an element fails, where it is cut, and what becomes of the body (METHOD 6, 7).
//!
//! [`Criterion`] judges a state of stress and says how the cutting plane stands; [`Solid`] is the
//! body that is cut, [`Solid::propagate`] one step of crack growth, [`Changes`] what it did.
//!
//! ```text
//!   stress ─▶ PrincipalStress ─▶ Criterion::assess ─▶ Failure ─▶ Solid::propagate ─▶ Changes
//!                                  (stress, plane)       propagate ─ cut ─ bisect
//!                                                                     ├─── fragments
//!                                                                     └─── separate
//! ```

mod bisect;
mod candidates;
pub mod changes;
pub mod criterion;
mod cut;
pub mod envelope;
pub mod formula;
mod fragments;
mod pace;
pub mod plane;
mod propagate;
mod separate;
mod solid;
pub mod stress;
#[cfg(test)]
mod tests;

pub use changes::{Changes, LimitsReached, NewElement, NewFragment, NodeBirth, NodeCut};
pub use criterion::{Assessment, Criterion, CriterionError, FailureRule, Strength};
pub use formula::{Formula, FormulaError, FormulaProblem};
pub use fragments::{Fragment, Fragments};
pub use pace::{CrackPace, Growth};
pub use plane::PlaneRule;
pub use propagate::{Failure, FractureLimits, Propagation, PropagationRule, SMALLEST_FRAGMENT_ELEMENTS};
pub use solid::{Face, NodeState, Solid, SolidError, SurfaceFace};
pub use stress::{PrincipalStress, StressMeasures};
