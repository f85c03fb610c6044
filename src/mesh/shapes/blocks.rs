//! Shapes with flat sides: box, rod, plate, pile, notched beam.

use super::lattice::{Axis, cells_along, lattice};
use super::{Check, Meshing, Resolution, ShapeError};
use crate::mesh::TetMesh;
use glam::DVec3;
use std::f64::consts::FRAC_PI_4;

/// A box centred at the origin.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BoxShape {
    /// Lengths along x, y and z, m.
    pub size_m: DVec3,
}

impl Default for BoxShape {
    fn default() -> Self {
        Self { size_m: DVec3::splat(0.1) }
    }
}

impl BoxShape {
    pub(super) fn build(&self, meshing: &Meshing) -> Result<TetMesh, ShapeError> {
        let [x, y, z] = self.size_m.to_array();
        Block {
            check: Check("box"),
            arguments: [("size_m[0]", x), ("size_m[1]", y), ("size_m[2]", z)],
            low_m: -self.size_m / 2.0,
        }
        .build(meshing)
    }
}

/// A prism along x, centred at the origin.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Rod {
    /// Length along x, m.
    pub length_m: f64,
    /// Width along y, m.
    pub width_m: f64,
    /// Height along z, m.
    pub height_m: f64,
}

impl Default for Rod {
    fn default() -> Self {
        Self { length_m: 0.254, width_m: 0.0254, height_m: 0.0254 }
    }
}

impl Rod {
    pub(super) fn build(&self, meshing: &Meshing) -> Result<TetMesh, ShapeError> {
        let size_m = DVec3::new(self.length_m, self.width_m, self.height_m);
        Block {
            check: Check("rod"),
            arguments: [("length_m", size_m.x), ("width_m", size_m.y), ("height_m", size_m.z)],
            low_m: -size_m / 2.0,
        }
        .build(meshing)
    }
}

/// A plate in the xy plane, centred at the origin.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Plate {
    /// Length along x, m.
    pub length_m: f64,
    /// Width along y, m.
    pub width_m: f64,
    /// Thickness along z, m.
    pub thickness_m: f64,
}

impl Default for Plate {
    fn default() -> Self {
        Self { length_m: 1.0, width_m: 1.0, thickness_m: 0.1 }
    }
}

impl Plate {
    pub(super) fn build(&self, meshing: &Meshing) -> Result<TetMesh, ShapeError> {
        let size_m = DVec3::new(self.length_m, self.width_m, self.thickness_m);
        Block {
            check: Check("plate"),
            arguments: [("length_m", size_m.x), ("width_m", size_m.y), ("thickness_m", size_m.z)],
            low_m: -size_m / 2.0,
        }
        .build(meshing)
    }
}

/// A rectangular column that stands on z = 0.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Pile {
    /// Width along x, m.
    pub width_m: f64,
    /// Depth along y, m.
    pub depth_m: f64,
    /// Height along z, m.
    pub height_m: f64,
}

impl Default for Pile {
    fn default() -> Self {
        Self { width_m: 0.4, depth_m: 0.4, height_m: 1.0 }
    }
}

impl Pile {
    pub(super) fn build(&self, meshing: &Meshing) -> Result<TetMesh, ShapeError> {
        let size_m = DVec3::new(self.width_m, self.depth_m, self.height_m);
        Block {
            check: Check("pile"),
            arguments: [("width_m", size_m.x), ("depth_m", size_m.y), ("height_m", size_m.z)],
            low_m: DVec3::new(-size_m.x / 2.0, -size_m.y / 2.0, 0.0),
        }
        .build(meshing)
    }
}

/// A box under whichever name: its sizes along x, y, z with their argument names, and its lowest
/// corner.
struct Block {
    check: Check,
    arguments: [(&'static str, f64); 3],
    low_m: DVec3,
}

impl Block {
    /// Refinement 1 has one cell along the shortest side.
    fn build(&self, meshing: &Meshing) -> Result<TetMesh, ShapeError> {
        self.check.lengths(&self.arguments)?;
        let size_m = self.arguments.map(|(_, length_m)| length_m);
        let cells = self.cells(size_m, meshing.resolution)?;
        let position_m = |at: [u32; 3]| {
            self.low_m
                + DVec3::from_array(std::array::from_fn(|axis| {
                    size_m[axis] * f64::from(at[axis]) / f64::from(cells[axis])
                }))
        };
        let hexes = lattice(self.check.0, cells, |_| Some(0), position_m)?;
        Ok(hexes.split(meshing.split, &["all"]))
    }

    fn cells(&self, size_m: [f64; 3], resolution: Resolution) -> Result<[u32; 3], ShapeError> {
        if let Resolution::Cells(cells) = resolution {
            return match cells.iter().position(|&n| n == 0) {
                Some(axis) => Err(self.check.error(
                    ["cells[0]", "cells[1]", "cells[2]"][axis],
                    0.0,
                    "a whole number from 1",
                )),
                None => Ok(cells),
            };
        }
        let shortest_m = size_m.into_iter().fold(f64::INFINITY, f64::min);
        let element_m = self.check.element_size_m(resolution, shortest_m)?;
        Ok(size_m.map(|length_m| cells_along(length_m, element_m)))
    }
}

/// Which face of a beam is notched.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum NotchSide {
    /// The upper one (+z).
    #[default]
    Top,
    /// The lower one (-z).
    Bottom,
}

/// A beam along x, centred at the origin, with a U-shaped notch across its middle.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Beam {
    /// Length along x, m.
    pub length_m: f64,
    /// Width along y, m.
    pub width_m: f64,
    /// Height along z, m.
    pub height_m: f64,
    /// Width of the notch along x, m.
    pub notch_width_m: f64,
    /// Depth of the notch along z, m.
    pub notch_depth_m: f64,
    /// Radius of the notch's two inner corners, m; 0 for sharp ones, at which an elastic beam has
    /// infinite stress.
    pub notch_radius_m: f64,
    /// Face that is notched.
    pub notch_side: NotchSide,
}

impl Default for Beam {
    fn default() -> Self {
        Self {
            length_m: 1.0,
            width_m: 0.2,
            height_m: 0.3,
            notch_width_m: 0.1,
            notch_depth_m: 0.15,
            notch_radius_m: 0.0,
            notch_side: NotchSide::Top,
        }
    }
}

impl Beam {
    /// Refinement 1 has one cell across the beam and beside, below and along the notch.
    pub(super) fn build(&self, meshing: &Meshing) -> Result<TetMesh, ShapeError> {
        let check = Check("beam");
        self.check(check)?;
        let arm_m = (self.length_m - self.notch_width_m) / 2.0;
        let element_m =
            check.element_size_m(meshing.resolution, arm_m.max(self.width_m).max(self.height_m))?;
        let cells = |length_m| cells_along(length_m, element_m);
        let (half_m, notch_m) = (self.length_m / 2.0, self.notch_width_m / 2.0);
        let x = Axis::new(
            &[-half_m, -notch_m, notch_m, half_m],
            &[cells(arm_m), cells(self.notch_width_m), cells(arm_m)],
        );
        let y = Axis::new(&[-self.width_m / 2.0, self.width_m / 2.0], &[cells(self.width_m)]);
        let (z, notch_layer) = self.height_axis(cells);
        let round = RoundedCorners::of(self);
        let hexes = lattice(
            check.0,
            [x.cells(), y.cells(), z.cells()],
            |[i, _, k]| {
                let in_notch = x.interval_of(i) == 1 && z.interval_of(k) == notch_layer;
                (!in_notch).then_some(0)
            },
            |[i, j, k]| round.place(DVec3::new(x.at(i), y.at(j), z.at(k))),
        )?;
        Ok(hexes.split(meshing.split, &["all"]))
    }

    fn check(&self, check: Check) -> Result<(), ShapeError> {
        check.lengths(&[
            ("length_m", self.length_m),
            ("width_m", self.width_m),
            ("height_m", self.height_m),
            ("notch_width_m", self.notch_width_m),
            ("notch_depth_m", self.notch_depth_m),
        ])?;
        check.below("notch_width_m", self.notch_width_m, self.length_m, "`length_m`")?;
        check.below("notch_depth_m", self.notch_depth_m, self.height_m, "`height_m`")?;
        self.check_radius(check)
    }

    /// A corner must fit into the notch.
    fn check_radius(&self, check: Check) -> Result<(), ShapeError> {
        let radius_m = self.notch_radius_m;
        if radius_m.is_nan() || radius_m < 0.0 {
            return Err(check.error("notch_radius_m", radius_m, "a length in metres, 0 or above"));
        }
        check.below("notch_radius_m", radius_m, self.notch_depth_m, "`notch_depth_m`")?;
        check.below("notch_radius_m", radius_m, self.notch_width_m / 2.0, "half of `notch_width_m`")
    }

    /// The axis along z and which of its two intervals holds the notch.
    fn height_axis(&self, cells: impl Fn(f64) -> u32) -> (Axis, usize) {
        let half_m = self.height_m / 2.0;
        let web_m = self.height_m - self.notch_depth_m;
        match self.notch_side {
            NotchSide::Top => {
                let breaks_m = [-half_m, -half_m + web_m, half_m];
                (Axis::new(&breaks_m, &[cells(web_m), cells(self.notch_depth_m)]), 1)
            }
            NotchSide::Bottom => {
                let breaks_m = [-half_m, half_m - web_m, half_m];
                (Axis::new(&breaks_m, &[cells(self.notch_depth_m), cells(web_m)]), 0)
            }
        }
    }
}

/// Moves the nodes around a notch so that its inner corners become arcs.
struct RoundedCorners {
    radius_m: f64,
    /// Of the corner, off the middle of the beam, m.
    corner_x_m: f64,
    /// Of the corner, with the notch on top, m.
    corner_z_m: f64,
    /// Distances from the corner, into the beam, at which the move has died out, m.
    reach_m: [f64; 2],
    /// -1 for a notch below.
    up: f64,
}

impl RoundedCorners {
    fn of(beam: &Beam) -> Self {
        let half_m = beam.height_m / 2.0;
        let web_m = beam.height_m - beam.notch_depth_m;
        let arm_m = (beam.length_m - beam.notch_width_m) / 2.0;
        Self {
            radius_m: beam.notch_radius_m,
            corner_x_m: beam.notch_width_m / 2.0,
            corner_z_m: half_m - beam.notch_depth_m,
            reach_m: [arm_m.min(web_m), web_m],
            up: if beam.notch_side == NotchSide::Top { 1.0 } else { -1.0 },
        }
    }

    fn place(&self, node_m: DVec3) -> DVec3 {
        if self.radius_m == 0.0 {
            return node_m;
        }
        // From the corner towards the middle of the notch, and out of its floor.
        let inward_m = self.corner_x_m - node_m.x.abs();
        let outward_m = node_m.z * self.up - self.corner_z_m;
        let weight = |distance_m: f64, reach_m: f64| (1.0 - (-distance_m).max(0.0) / reach_m).max(0.0);
        let share = weight(inward_m, self.reach_m[0]) * weight(outward_m, self.reach_m[1]);
        let [dx_m, dz_m] = self.move_of_outline_m(inward_m.max(0.0), outward_m.max(0.0)).map(|d| d * share);
        let towards_middle = if node_m.x < 0.0 { 1.0 } else { -1.0 };
        node_m + DVec3::new(towards_middle * dx_m, 0.0, self.up * dz_m)
    }

    /// What takes a point of the sharp outline to the arc: half of it to the floor, half to the wall.
    fn move_of_outline_m(&self, along_floor_m: f64, along_wall_m: f64) -> [f64; 2] {
        let r = self.radius_m;
        let share = |along_m: f64| (1.0 - along_m / r).max(0.0);
        if along_floor_m >= r || along_wall_m >= r {
            return [0.0, 0.0];
        }
        let angle = if along_wall_m > 0.0 {
            FRAC_PI_4 * (2.0 - share(along_wall_m))
        } else {
            FRAC_PI_4 * share(along_floor_m)
        };
        [r - r * angle.sin() - along_floor_m, r - r * angle.cos() - along_wall_m]
    }
}
