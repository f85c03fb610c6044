//! Finite elements: material law, element forces, mass, stable step (METHOD 1 and 2).
//!
//! [`ElementBatches`] holds what never changes of a body's tetrahedra, ordered for speed;
//! [`ElementBatches::forces`] is the inner loop of the whole program. The files, from the bottom up:
//! `lanes` (numbers of several elements at once), `kernel` (the equations), `partition` (which elements
//! go together), `elements` (the loop over all of them), beside it `stress`, `stable_step` and `mass`.

mod elements;
mod kernel;
mod lanes;
mod mass;
mod material;
mod partition;
mod stable_step;
mod stress;
#[cfg(test)]
mod test_support;

pub use elements::{ElasticState, ElementBatches, ElementKinematics, FemError, ForceScratch};
pub use mass::{MassScaling, scale_masses};
pub use material::{ElasticConstants, MaterialError};
pub use stable_step::{damped_step_s, green_step_factor};
pub use stress::NotFinitePlace;
