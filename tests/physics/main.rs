//! Physics against theory: conservation laws, closed forms, contact and rest.

mod build;
mod rods;
