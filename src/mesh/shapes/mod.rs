//! Built-in shapes: conforming, right-handed tetrahedral meshes with named regions.
//!
//! Where the origin lies: box, rod, plate, beam and ball at their centre; table, lamp, cup and
//! pile stand on z = 0 with their axis at x = y = 0; the hammer at its centre of mass. All shapes
//! are made of hexahedra (see [`HexSplit`] for how those are cut).

mod ball;
mod blocks;
mod cup;
mod hammer;
mod hex_mesh;
mod lamp;
mod lathe;
mod lattice;
mod table;

use super::TetMesh;
pub use ball::Ball;
pub use blocks::{Beam, BoxShape, NotchSide, Pile, Plate, Rod};
pub use cup::Cup;
pub use hammer::Hammer;
pub use hex_mesh::HexSplit;
pub use lamp::Lamp;
pub use table::Table;

/// Most tetrahedra a built-in shape may have.
pub const ELEMENT_LIMIT: u32 = 5_000_000;

/// Why a shape could not be made.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum ShapeError {
    /// An argument is out of its range.
    #[error("{shape}: `{argument}` is {value}, but it must be {expected}")]
    Argument {
        /// Shape.
        shape: &'static str,
        /// Name of the argument, as in scene files.
        argument: &'static str,
        /// Its value.
        value: f64,
        /// The values it may have.
        expected: String,
    },
    /// The resolution asks for more than [`ELEMENT_LIMIT`] elements.
    #[error(
        "{shape}: this resolution would give about {elements:.1e} elements, and at most 5 million \
         are allowed; choose a larger `element_size_m` or a smaller `refinement`"
    )]
    TooManyElements {
        /// Shape.
        shape: &'static str,
        /// Elements it would have.
        elements: f64,
    },
    /// Cells were counted along the axes of a shape that has none.
    #[error(
        "{shape}: `cells` counts cells along x, y and z, which only box, rod, plate and pile \
         have; give `refinement` or `element_size_m`"
    )]
    NoCells {
        /// Shape.
        shape: &'static str,
    },
}

/// How fine a mesh is.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Resolution {
    /// 1 is the coarsest that shows the shape; `n` makes edges about `n` times shorter.
    Refinement(u32),
    /// Length of an element's edges, roughly, m.
    ElementSize(f64),
    /// Cells along x, y and z, each cut into tetrahedra; for box, rod, plate and pile.
    Cells([u32; 3]),
}

impl Default for Resolution {
    fn default() -> Self {
        Self::Refinement(1)
    }
}

/// How a shape is meshed.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Meshing {
    /// How fine.
    pub resolution: Resolution,
    /// How each hexahedron is cut.
    pub split: HexSplit,
}

/// A built-in shape with its sizes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Shape {
    /// A box.
    Box(BoxShape),
    /// A prism along x.
    Rod(Rod),
    /// A thin box, its thickness along z.
    Plate(Plate),
    /// A standing rectangular column.
    Pile(Pile),
    /// A beam along x with a notch at its middle.
    Beam(Beam),
    /// A table top on four legs.
    Table(Table),
    /// A ball.
    Ball(Ball),
    /// A cup with a handle.
    Cup(Cup),
    /// A table lamp.
    Lamp(Lamp),
    /// A hammer.
    Hammer(Hammer),
}

impl Shape {
    /// Meshes the shape.
    ///
    /// # Errors
    /// [`ShapeError`] when a size or the resolution is impossible; the text names the argument.
    pub fn build(&self, meshing: &Meshing) -> Result<TetMesh, ShapeError> {
        match self {
            Self::Box(shape) => shape.build(meshing),
            Self::Rod(shape) => shape.build(meshing),
            Self::Plate(shape) => shape.build(meshing),
            Self::Pile(shape) => shape.build(meshing),
            Self::Beam(shape) => shape.build(meshing),
            Self::Table(shape) => shape.build(meshing),
            Self::Ball(shape) => shape.build(meshing),
            Self::Cup(shape) => shape.build(meshing),
            Self::Lamp(shape) => shape.build(meshing),
            Self::Hammer(shape) => shape.build(meshing),
        }
    }
}

/// Checks the arguments of one shape, for [`ShapeError`] to name it.
#[derive(Clone, Copy)]
struct Check(&'static str);

impl Check {
    fn error(self, argument: &'static str, value: f64, expected: impl Into<String>) -> ShapeError {
        ShapeError::Argument { shape: self.0, argument, value, expected: expected.into() }
    }

    /// A length must be finite and positive; the limits keep volumes and stiffness in range.
    fn length(self, argument: &'static str, value_m: f64) -> Result<(), ShapeError> {
        if (1e-9..=1e9).contains(&value_m) {
            Ok(())
        } else {
            Err(self.error(argument, value_m, "a length in metres from 1e-9 to 1e9"))
        }
    }

    fn lengths(self, arguments: &[(&'static str, f64)]) -> Result<(), ShapeError> {
        arguments.iter().try_for_each(|&(argument, value_m)| self.length(argument, value_m))
    }

    /// `value_m` must stay below `limit_m`, which `of` describes.
    fn below(self, argument: &'static str, value_m: f64, limit_m: f64, of: &str) -> Result<(), ShapeError> {
        if value_m < limit_m {
            Ok(())
        } else {
            Err(self.error(argument, value_m, format!("less than {of} ({limit_m} m)")))
        }
    }

    /// Element size of a resolution; `coarsest_m` is what refinement 1 stands for.
    fn element_size_m(self, resolution: Resolution, coarsest_m: f64) -> Result<f64, ShapeError> {
        match resolution {
            Resolution::Refinement(0) => Err(self.error("refinement", 0.0, "a whole number from 1")),
            Resolution::Refinement(n) => Ok(coarsest_m / f64::from(n)),
            Resolution::ElementSize(size_m) => {
                self.length("element_size_m", size_m)?;
                Ok(size_m)
            }
            Resolution::Cells(_) => Err(ShapeError::NoCells { shape: self.0 }),
        }
    }
}

/// A box of so many cells of one metre, each of six tetrahedra.
#[cfg(test)]
pub(crate) fn block(cells: [u32; 3]) -> TetMesh {
    let shape = Shape::Box(BoxShape { size_m: glam::DVec3::from_array(cells.map(f64::from)) });
    let meshing = Meshing { resolution: Resolution::Cells(cells), split: HexSplit::Six };
    shape.build(&meshing).expect("a sound box")
}

#[cfg(test)]
mod tests;
