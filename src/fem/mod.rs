//! Finite elements: material law, element forces, mass, stable step (METHOD 1 and 2).
//!
//! [`ElementBatches`] holds what never changes of a body's tetrahedra, ordered for speed;
//! [`ElementBatches::forces`] is the inner loop of the whole program. The files, from the bottom up:
//! `lanes` (numbers of several elements at once), `kernel`, `corotated` and `neo_hookean` (the equations), `partition` (which elements
//! go together), `slots` (where their forces are added up), `elements` (their data), `follow` (after cuts), `prefetch`, `forces`
//! (the loop), beside it `stress`, `stable_step`, `step_bound` (the same after cuts), `mass`.

mod corotated;
mod elements;
mod follow;
mod forces;
mod kernel;
mod lanes;
mod mass;
mod material;
mod neo_hookean;
mod partition;
mod prefetch;
mod slots;
mod stable_step;
mod step_bound;
mod stress;
#[cfg(test)]
mod test_support;
#[cfg(test)]
mod tests;

pub use elements::{ElementBatches, FemError};
pub use follow::ElementChanges;
pub use forces::{ElasticState, ElementKinematics, ForceScratch};
pub use mass::{MassScaling, ScaledNodeMasses, scale_masses};
pub use material::{ElasticConstants, MaterialError};
pub use stable_step::damped_step_s;
pub use step_bound::{CutBody, StepBound};
pub use stress::NotFinitePlace;
