//! Tetrahedral meshes: data, adjacency, surface, built-in shapes, import from files.

mod surface;
mod tet_mesh;

pub use surface::{NodeTets, Pieces, Surface, SurfaceEdge, TET_FACES};
pub use tet_mesh::{TetMesh, signed_volume_m3};
