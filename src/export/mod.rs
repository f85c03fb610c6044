//! Pictures and data as files.

pub mod gif;
mod palette;
pub mod png;
