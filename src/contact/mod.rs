//! Contact: broad phase, atomic cases, time of impact, response, friction (METHOD 4 and 5).
//!
//! [`candidates`] finds features that may meet, [`mod@detect`] makes [`constraint`]s of those that touch, and
//! [`response`] solves them, [`impact`] keeps the energy of their impacts. [`time_of_impact`] and [`atomic`] decide when and whether a collision begins.

pub mod atomic;
mod boxes;
pub mod candidates;
pub mod close;
pub mod collision_list;
pub mod constraint;
mod deep;
pub mod detect;
mod first_guess;
mod follow;
mod geometry;
mod groups;
pub mod impact;
mod near;
pub mod nodes;
pub mod own;
mod passes;
pub mod response;
pub mod surface;
mod thrown;
pub mod time_of_impact;
mod twins;
mod ways;

pub use boxes::SurfaceBoxes;
pub use close::CloseList;
pub use collision_list::CollisionList;
pub use constraint::Constraint;
pub use detect::{BodyView, PairDepths, PairView};
pub use near::Near;
pub use own::OwnFeatures;
pub use response::{CHANGES_KEPT, Settling};
pub use surface::{ContactSurface, CrackSide};
pub use thrown::ThrownNodes;
