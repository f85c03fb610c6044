//! Physics against theory: conservation laws, closed forms, contact and rest.

mod build;
mod cuts;
mod fracture;
mod fracture_theory;
mod pull;
mod random;
mod rest;
mod rods;
mod verify;
