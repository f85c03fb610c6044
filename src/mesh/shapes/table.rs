//! A table: a lattice that is solid in the top layer and at four corners below it.

use super::lattice::{Axis, cells_along, lattice};
use super::{Check, Meshing, ShapeError};
use crate::mesh::TetMesh;
use glam::DVec3;

/// A table on four tapered legs that stands on z = 0; regions `"top"` and `"legs"`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Table {
    /// Length along x, m.
    pub length_m: f64,
    /// Width along y, m.
    pub width_m: f64,
    /// Height of the upper face, m.
    pub height_m: f64,
    /// Thickness of the top, m.
    pub top_thickness_m: f64,
    /// Side of the square legs where they meet the top, m.
    pub leg_width_m: f64,
}

impl Default for Table {
    fn default() -> Self {
        Self { length_m: 1.2, width_m: 0.8, height_m: 0.72, top_thickness_m: 0.06, leg_width_m: 0.1 }
    }
}

impl Table {
    /// Side of a leg at the floor over its side at the top.
    pub const LEG_TAPER: f64 = 0.6;

    /// Refinement 1 has two cells along the longest side and three along a leg.
    pub(super) fn build(&self, meshing: &Meshing) -> Result<TetMesh, ShapeError> {
        let check = Check("table");
        self.check(check)?;
        let leg_m = self.height_m - self.top_thickness_m;
        let element_m =
            check.element_size_m(meshing.resolution, self.length_m.max(self.width_m).max(leg_m) / 2.0)?;
        let across = |length_m: f64| {
            let inner_m = length_m / 2.0 - self.leg_width_m;
            let leg = cells_along(self.leg_width_m, element_m);
            Axis::new(
                &[-length_m / 2.0, -inner_m, inner_m, length_m / 2.0],
                &[leg, cells_along(2.0 * inner_m, element_m), leg],
            )
        };
        let (x, y) = (across(self.length_m), across(self.width_m));
        let z = Axis::new(
            &[0.0, leg_m, self.height_m],
            &[cells_along(leg_m, element_m).max(3), cells_along(self.top_thickness_m, element_m)],
        );
        let region_of = |[i, j, k]: [u32; 3]| match z.interval_of(k) {
            1 => Some(0),
            _ => (x.interval_of(i) != 1 && y.interval_of(j) != 1).then_some(1),
        };
        let position_m = |[i, j, k]: [u32; 3]| {
            let taper = Self::LEG_TAPER + (1.0 - Self::LEG_TAPER) * (z.at(k) / leg_m).min(1.0);
            DVec3::new(
                self.tapered(x.at(i), self.length_m, taper),
                self.tapered(y.at(j), self.width_m, taper),
                z.at(k),
            )
        };
        let cells = [x.cells(), y.cells(), z.cells()];
        let hexes = lattice(check.0, cells, region_of, position_m)?;
        Ok(hexes.split(meshing.split, &["top", "legs"]))
    }

    /// Moves a coordinate towards the axis of its leg.
    fn tapered(&self, at_m: f64, length_m: f64, taper: f64) -> f64 {
        let axis_m = (length_m - self.leg_width_m) / 2.0 * at_m.signum();
        axis_m + (at_m - axis_m) * taper
    }

    fn check(&self, check: Check) -> Result<(), ShapeError> {
        check.lengths(&[
            ("length_m", self.length_m),
            ("width_m", self.width_m),
            ("height_m", self.height_m),
            ("top_thickness_m", self.top_thickness_m),
            ("leg_width_m", self.leg_width_m),
        ])?;
        check.below("top_thickness_m", self.top_thickness_m, self.height_m, "`height_m`")?;
        check.below(
            "leg_width_m",
            self.leg_width_m,
            self.length_m.min(self.width_m) / 2.0,
            "half of the table's shorter side",
        )
    }
}
