//! What the cell types of the formats mean for us.

/// What is done with cells of a type.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Role {
    /// Used.
    Tetrahedron,
    /// Its first four nodes are used, the others dropped.
    QuadraticTetrahedron,
    /// Points, lines and faces: left out.
    LowerDimension,
    /// Other volume cells: the file is refused.
    Refused,
}

/// A cell type of a file format.
#[derive(Clone, Copy, Debug)]
pub(super) struct CellType {
    pub code: i64,
    pub name: &'static str,
    /// Number of nodes; 0 when it varies.
    pub nodes: u64,
    pub role: Role,
}

const fn cell(code: i64, name: &'static str, nodes: u64, role: Role) -> CellType {
    CellType { code, name, nodes, role }
}

use Role::{LowerDimension as Lower, QuadraticTetrahedron as Quadratic, Refused, Tetrahedron};

/// Element types of Gmsh.
const GMSH: &[CellType] = &[
    cell(1, "line", 2, Lower),
    cell(2, "triangle", 3, Lower),
    cell(3, "quadrangle", 4, Lower),
    cell(4, "tetrahedron", 4, Tetrahedron),
    cell(5, "hexahedron", 8, Refused),
    cell(6, "prism", 6, Refused),
    cell(7, "pyramid", 5, Refused),
    cell(8, "line", 3, Lower),
    cell(9, "triangle", 6, Lower),
    cell(10, "quadrangle", 9, Lower),
    cell(11, "10-node tetrahedron", 10, Quadratic),
    cell(12, "27-node hexahedron", 27, Refused),
    cell(13, "18-node prism", 18, Refused),
    cell(14, "14-node pyramid", 14, Refused),
    cell(15, "point", 1, Lower),
    cell(16, "quadrangle", 8, Lower),
    cell(17, "20-node hexahedron", 20, Refused),
    cell(18, "15-node prism", 15, Refused),
    cell(19, "13-node pyramid", 13, Refused),
    cell(20, "triangle", 9, Lower),
    cell(21, "triangle", 10, Lower),
    cell(22, "triangle", 12, Lower),
    cell(23, "triangle", 15, Lower),
    cell(24, "triangle", 15, Lower),
    cell(25, "triangle", 21, Lower),
    cell(26, "line", 4, Lower),
    cell(27, "line", 5, Lower),
    cell(28, "line", 6, Lower),
    cell(29, "20-node tetrahedron", 20, Refused),
    cell(30, "35-node tetrahedron", 35, Refused),
    cell(31, "56-node tetrahedron", 56, Refused),
    cell(92, "64-node hexahedron", 64, Refused),
    cell(93, "125-node hexahedron", 125, Refused),
];

/// Cell types of VTK.
const VTK: &[CellType] = &[
    cell(0, "empty cell", 0, Lower),
    cell(1, "point", 1, Lower),
    cell(2, "point set", 0, Lower),
    cell(3, "line", 2, Lower),
    cell(4, "polyline", 0, Lower),
    cell(5, "triangle", 3, Lower),
    cell(6, "triangle strip", 0, Lower),
    cell(7, "polygon", 0, Lower),
    cell(8, "pixel", 4, Lower),
    cell(9, "quadrangle", 4, Lower),
    cell(10, "tetrahedron", 4, Tetrahedron),
    cell(11, "voxel", 8, Refused),
    cell(12, "hexahedron", 8, Refused),
    cell(13, "prism", 6, Refused),
    cell(14, "pyramid", 5, Refused),
    cell(15, "pentagonal prism", 10, Refused),
    cell(16, "hexagonal prism", 12, Refused),
    cell(21, "line", 3, Lower),
    cell(22, "triangle", 6, Lower),
    cell(23, "quadrangle", 8, Lower),
    cell(24, "10-node tetrahedron", 10, Quadratic),
    cell(25, "20-node hexahedron", 20, Refused),
    cell(26, "15-node prism", 15, Refused),
    cell(27, "13-node pyramid", 13, Refused),
    cell(28, "quadrangle", 9, Lower),
    cell(29, "27-node hexahedron", 27, Refused),
    cell(42, "polyhedron", 0, Refused),
    cell(71, "Lagrange tetrahedron", 0, Refused),
];

/// The element type that Gmsh numbers `code`.
pub(super) fn gmsh(code: i64) -> Option<CellType> {
    GMSH.iter().copied().find(|cell| cell.code == code)
}

/// The cell type that VTK numbers `code`.
pub(super) fn vtk(code: i64) -> Option<CellType> {
    VTK.iter().copied().find(|cell| cell.code == code)
}

/// A section of cells of MEDIT.
#[derive(Clone, Copy, Debug)]
pub(super) struct MeditSection {
    pub keyword: &'static str,
    pub cell: CellType,
}

const fn section(keyword: &'static str, name: &'static str, nodes: u64, role: Role) -> MeditSection {
    MeditSection { keyword, cell: cell(0, name, nodes, role) }
}

/// Sections of cells, each line ending in a reference number.
pub(super) const MEDIT: &[MeditSection] = &[
    section("Edges", "line", 2, Lower),
    section("EdgesP2", "line", 3, Lower),
    section("Triangles", "triangle", 3, Lower),
    section("TrianglesP2", "triangle", 6, Lower),
    section("Quadrilaterals", "quadrangle", 4, Lower),
    section("Tetrahedra", "tetrahedron", 4, Tetrahedron),
    section("TetrahedraP2", "10-node tetrahedron", 10, Quadratic),
    section("Hexahedra", "hexahedron", 8, Refused),
    section("Prisms", "prism", 6, Refused),
    section("Pyramids", "pyramid", 5, Refused),
];
