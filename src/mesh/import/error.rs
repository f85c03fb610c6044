//! Why a mesh file was refused.

use crate::io_reason::io_reason;
use std::fmt;
use std::path::PathBuf;

/// Why a mesh file was refused, and where in it.
#[derive(Debug, thiserror::Error)]
#[error("cannot use mesh `{}`{place}: {problem}", file.display())]
pub struct ImportError {
    /// The file.
    pub file: PathBuf,
    /// Where in the file; empty when it concerns the file as a whole.
    pub place: Place,
    /// What is wrong.
    pub problem: Problem,
}

/// A place in a mesh file.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Place {
    /// Line from 1, or offset in bytes in a binary part.
    pub position: Option<Position>,
    /// Section, as the format names it.
    pub section: Option<String>,
    /// Which of how many things was being read: `("element", 24, 24)`, counted from 1.
    pub item: Option<(&'static str, u64, u64)>,
}

/// A line or a byte.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Position {
    /// Line, from 1.
    Line(usize),
    /// Offset in bytes, from 0.
    Byte(usize),
}

impl fmt::Display for Place {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self.position {
            Some(Position::Line(line)) => write!(f, ", line {line}")?,
            Some(Position::Byte(byte)) => write!(f, ", byte {byte}")?,
            None => {}
        }
        if let Some(section) = &self.section {
            write!(f, ", section {section}")?;
        }
        if let Some((what, index, count)) = self.item {
            write!(f, ", {what} {index} of {count}")?;
        }
        Ok(())
    }
}

/// What is wrong with a mesh file.
#[derive(Debug, thiserror::Error)]
pub enum Problem {
    /// The file cannot be opened or read.
    #[error("{}", io_reason(.0))]
    Io(#[from] std::io::Error),
    /// Not a plain file, or too large.
    #[error("{0}")]
    NotAFile(String),
    /// A format that is known by its looks but not read.
    #[error("{format} files are not read; {advice}. Formats read: {FORMATS_READ}")]
    UnsupportedFormat {
        /// Name of the format.
        format: &'static str,
        /// What to do.
        advice: &'static str,
    },
    /// A format that is not recognised.
    #[error(
        "the format is not recognised (the file begins with `{begins}`). Formats read: \
         {FORMATS_READ}"
    )]
    UnknownFormat {
        /// First characters.
        begins: String,
    },
    /// A version or variant of a readable format that is not read.
    #[error("{what} is not read; {advice}")]
    UnsupportedVariant {
        /// Format and version.
        what: String,
        /// What to do.
        advice: &'static str,
    },
    /// Something else than what should stand there.
    #[error("found `{found}` where {wanted} should stand")]
    Unexpected {
        /// What should stand there.
        wanted: &'static str,
        /// What stands there.
        found: String,
    },
    /// The file is shorter than it should be.
    #[error("the file ends here, but {wanted} should follow; is it complete?")]
    Ended {
        /// What should follow.
        wanted: &'static str,
    },
    /// A section that stops before all announced items.
    #[error("the section ends here (`{found}`), but {wanted} should follow: items are missing")]
    SectionEnded {
        /// What should follow.
        wanted: &'static str,
        /// The word that ends the section.
        found: String,
    },
    /// A section that goes on after all announced items.
    #[error("found `{found}` where {wanted} should stand: more items than announced")]
    SectionGoesOn {
        /// What should follow.
        wanted: &'static str,
        /// What stands there.
        found: String,
    },
    /// A count that the file cannot hold.
    #[error(
        "{announced} {items} are announced, but the rest of the file has room for {room} at most; \
         is it complete?"
    )]
    Announced {
        /// The count.
        announced: u64,
        /// What is counted.
        items: &'static str,
        /// Most that can follow.
        room: u64,
    },
    /// Anything else that contradicts the format.
    #[error("{0}")]
    Malformed(String),
    /// A coordinate is not a number or infinite.
    #[error("node {node} lies at ({}, {}, {}), which is not a finite place", at[0], at[1], at[2])]
    NotFinite {
        /// Number of the node in the file.
        node: u64,
        /// Its coordinates.
        at: [f64; 3],
    },
    /// Two nodes with the same number.
    #[error("node {node} is given twice")]
    NodeTwice {
        /// Number of the node.
        node: u64,
    },
    /// An element refers to a node that is not there.
    #[error("element {element} refers to node {node}, which the file does not have")]
    MissingNode {
        /// Number of the element in the file.
        element: u64,
        /// Number of the node.
        node: u64,
    },
    /// A volume cell that is not a tetrahedron.
    #[error(
        "element {element} is a {kind}, and only tetrahedra can be used; mesh the volume with \
         tetrahedra (in Gmsh: Mesh.RecombineAll = 0, Mesh.ElementOrder = 1)"
    )]
    CellKind {
        /// Number of the element in the file.
        element: u64,
        /// Its kind.
        kind: String,
    },
    /// Triangles or lines, but no tetrahedra.
    #[error("there are no tetrahedra in it ({found}): a body needs its volume meshed; in Gmsh: `gmsh -3`")]
    NoTetrahedra {
        /// What there is instead.
        found: String,
    },
    /// Elements that cannot be simulated.
    #[error(
        "element {element} is {fault}; {bad} of {total} elements are inverted, flat or doubled. \
         Repair the mesh, or set `drop_bad_elements = true` to leave them out"
    )]
    BadElement {
        /// Number of the first bad element in the file.
        element: u64,
        /// What is wrong with it.
        fault: String,
        /// Bad elements in all.
        bad: usize,
        /// Elements in all.
        total: usize,
    },
    /// Nothing is left after dropping bad elements.
    #[error("all {total} elements are inverted, flat or doubled: nothing is left to use")]
    NothingLeft {
        /// Elements in all.
        total: usize,
    },
    /// More than two elements at one face.
    #[error(
        "{faces} faces belong to more than two elements: the mesh overlaps itself and has no \
         inside there"
    )]
    Overlap {
        /// How many faces.
        faces: usize,
    },
}

/// For messages.
pub(super) const FORMATS_READ: &str = "Gmsh MSH 2.2 and 4.1, legacy VTK (unstructured grid), MEDIT .mesh";
