//! The cases, by what they are about. Functions that tests use beside the command are public.

pub mod beams;
pub mod criteria;
pub mod fracture;
pub mod impact;
pub mod incline;
pub mod kinematics;
pub mod patch;
pub mod penalty;
pub mod pile;
pub mod plates;
pub mod rods;
pub mod scenes;
pub mod spin;
pub mod squeeze;
pub mod sweep;
pub mod waves;
