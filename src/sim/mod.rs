//! The world and its two-interval step.
//!
//! [`WorldSetup`] (plain data, what a scene builds) goes into [`World::new`]; [`World::step`]
//! advances; [`World::sample`] gives the balances; [`World::publish`] writes a frame.

mod report;
mod setup;
mod world;

pub use report::{PhaseTimes, Sample, Stage, StepReport};
pub use setup::*;
pub use world::{ElementStress, SimError, World};
