//! hammerfall: deformable solids collide and break.
//!
//! ```text
//!   scene file ──scene──▶ WorldSetup ──sim──▶ World ──step──▶ Frame ──render──▶ window | PNG | GIF
//!   (TOML)                                     │ ▲                 └─export───▶ CSV | JSON | VTU
//!                             mesh, fem, contact ┘ └ commands (viewer)
//! ```
//!
//! Imports point one way: [`math`], [`mesh`]; then [`fem`], [`contact`] and [`fracture`], which do not
//! know each other; then [`sim`], [`scene`]; [`frame`] is the seam that `sim` writes and [`render`] reads;
//! [`verify`] compares with known answers; [`export`], [`viewer`] and [`cli`] stand on top. A test checks these arrows.

pub mod cli;
pub mod contact;
pub mod export;
pub mod fem;
pub mod fracture;
pub mod frame;
pub mod io_reason;
pub mod math;
pub mod mesh;
pub mod render;
pub mod scene;
pub mod sim;
pub mod verify;
pub mod viewer;
