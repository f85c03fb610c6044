//! Pictures and data as files.

pub mod gif;
pub mod png;
