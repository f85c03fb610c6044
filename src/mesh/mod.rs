//! Tetrahedral meshes: data, adjacency, surface, built-in shapes, import from files.

mod tet_mesh;

pub use tet_mesh::{TetMesh, signed_volume_m3};
