//! Finite elements: material law, element forces, mass, stable step (METHOD 1 and 2).
//!
//! [`ElementBatches`] holds what never changes of a body's tetrahedra, ordered for speed;
//! [`ElementBatches::forces`] is the inner loop of the whole program. The files, from the bottom up:
//! `lanes` (numbers of several elements at once), `kernel` (the equations), `partition` (which elements
//! go together), `elements` (their data), `prefetch`, `forces` (the loop), beside it `stress`, `stable_step`, `mass`.

mod elements;
mod forces;
mod kernel;
mod lanes;
mod mass;
mod material;
mod partition;
mod prefetch;
mod stable_step;
mod stress;
#[cfg(test)]
mod test_support;
#[cfg(test)]
mod tests;

pub use elements::{ElementBatches, FemError};
pub use forces::{ElasticState, ElementKinematics, ForceScratch};
pub use mass::{MassScaling, ScaledNodeMasses, scale_masses};
pub use material::{ElasticConstants, MaterialError};
pub use stable_step::damped_step_s;
pub use stress::NotFinitePlace;
