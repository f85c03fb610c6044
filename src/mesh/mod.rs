//! Tetrahedral meshes: data, adjacency, surface, built-in shapes, import from files.

pub mod boxes;
pub mod import;
mod overlap;
mod quality;
mod renumbering;
pub mod shapes;
mod surface;
mod tet_mesh;

pub use overlap::{Overlap, TOUCHING_SHARE, overlap};
pub use quality::{ElementShape, MeshReport, SLIVER_QUALITY, WorstElement};
pub use renumbering::Renumbering;
pub use surface::{Pieces, Surface, SurfaceEdge, TET_FACES};
pub use tet_mesh::{TetMesh, bounds_m, signed_volume_m3};
