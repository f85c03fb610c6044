//! What glam has not: symmetric 3x3 eigenvalues, rotations, mass properties, disjoint sets; loops shared out among threads.

mod digits;
mod disjoint_sets;
pub(crate) mod in_parts;
mod mass_properties;
mod rotation;
mod rows;
mod symmetric_eigen;

pub use digits::{to_digits, to_digits_of, vector_to_digits_of};
pub(crate) use disjoint_sets::DisjointSets;
pub use mass_properties::{MassProperties, inertia_of_point_kg_m2, solve_inertia};
pub use rotation::{best_fit_rotation, rotation_from_vector, skew};
pub(crate) use rows::in_rows;
pub use symmetric_eigen::{
    SymmetricEigen, symmetric_eigen, symmetric_eigenvalues, symmetric_eigenvalues_estimate,
};
