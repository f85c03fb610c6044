//! A ball: a cube of cells bent round, so that no element is a sliver.

use super::lattice::{even_cells_along, lattice};
use super::{Check, HexSplit, Meshing, ShapeError};
use crate::mesh::TetMesh;
use glam::DVec3;
use std::f64::consts::{FRAC_PI_2, FRAC_PI_4};

/// A ball centred at the origin.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Ball {
    /// Radius, m.
    pub radius_m: f64,
}

impl Default for Ball {
    fn default() -> Self {
        Self { radius_m: 0.05 }
    }
}

impl Ball {
    /// Refinement 1 is a cube of two cells a side, bent round.
    pub(super) fn build(&self, meshing: &Meshing) -> Result<TetMesh, ShapeError> {
        let check = Check("ball");
        check.length("radius_m", self.radius_m)?;
        let quarter_m = self.radius_m * FRAC_PI_2;
        let element_m = check.element_size_m(meshing.resolution, quarter_m / 2.0)?;
        let cells = even_cells_along(quarter_m, element_m);
        let hexes = lattice(
            check.0,
            [cells; 3],
            |_| Some(0),
            |at| {
                let cube = at.map(|n| 2.0 * f64::from(n) / f64::from(cells) - 1.0);
                self.radius_m * ball_from_cube(DVec3::from_array(cube))
            },
        )?;
        Ok(hexes.split(HexSplit::Six, &["all"]))
    }
}

/// Size of the innermost cubes over cubes spaced evenly to the surface: a compromise, by trial,
/// between the worst quality (better when larger) and the smallest altitude (better when smaller).
const BALL_CORE_SCALE: f64 = 0.7;

/// Maps the cube [-1, 1]^3 to the unit ball: cubes near the centre stay cubes, outer ones become
/// spheres whose points lie at equal angles.
fn ball_from_cube(cube: DVec3) -> DVec3 {
    let depth = cube.abs().max_element();
    if depth == 0.0 {
        return DVec3::ZERO;
    }
    let on_cube = cube / depth;
    let on_sphere = (on_cube * FRAC_PI_4).map(f64::tan).normalize();
    depth * (on_cube * BALL_CORE_SCALE).lerp(on_sphere, depth)
}
