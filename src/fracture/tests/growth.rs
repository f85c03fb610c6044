//! Crack growth.
