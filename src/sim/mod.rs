//! The world and its two-interval step.
//!
//! [`WorldSetup`] (plain data, what a scene builds) goes into [`World::new`]; [`World::step`] advances;
//! [`World::sample`] gives the balances; [`World::publish`] writes a frame.
//!
//! The stages of a step are the files: `step` is the recipe, `touch` finds the exact first touch of bodies in
//! free travel (`rigid`), `broad` keeps track of what is near, `collide` responds, `elastic` integrates a
//! deforming `body`, `breaking` lets it crack, `rest` lets it travel freely or sleep again.

mod arrival;
mod body;
mod breaking;
mod broad;
mod collide;
mod contact_change;
mod contact_log;
mod elastic;
mod follow;
mod own_boxes;
mod publish;
mod pull;
mod release;
mod report;
mod rest;
mod rigid;
mod round_off;
mod setup;
mod step;
mod step_factor;
mod touch;
mod world;

pub use arrival::raise_clear;
pub use body::MassScaling;
pub use contact_change::{ContactChange, Entrance};
pub use contact_log::ContactEpisode;
pub use pull::{PathPoint, Pull};
pub use report::{PhaseTimes, Sample, Stage, StepReport};
pub use round_off::RoundOff;
pub use setup::*;
pub use world::{ElementStress, NEVER_FAILED_S, SimError, World};
