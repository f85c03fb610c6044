//! A hammer: a round head with a flat face and a tapered peen, on a handle that goes through it.

use super::lattice::{Axis, cells_along, disc_from_square, even_cells_along, lattice};
use super::{Check, HexSplit, Meshing, ShapeError};
use crate::mesh::{TetMesh, signed_volume_m3};
use glam::DVec3;

/// A hammer about to strike downward: its handle points along -x, its face looks along -z. The
/// origin is its centre of mass (at uniform density); regions `"head"` and `"handle"`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Hammer {
    /// Length of the head along z, m.
    pub head_length_m: f64,
    /// Width of the head, m.
    pub head_width_m: f64,
    /// Length of the handle from the head's axis to its tail, m.
    pub handle_length_m: f64,
    /// Width of the handle, m.
    pub handle_width_m: f64,
}

impl Default for Hammer {
    fn default() -> Self {
        Self { head_length_m: 0.13, head_width_m: 0.045, handle_length_m: 0.32, handle_width_m: 0.022 }
    }
}

/// The lattice of a hammer. Cells left of the head (below `x_head`) belong to the handle.
struct Plan {
    hammer: Hammer,
    /// Along the handle: break 0 the tail, 1 the near side of the head, 2 its far side.
    x: Axis,
    /// Across, as shares of half the head's width.
    y: Axis,
    /// Along the head: face, lower and upper edge of the eye, end of the peen.
    z: Axis,
    /// Whether there are enough cells to make head and handle round.
    round: bool,
}

impl Hammer {
    /// Where the middle of the eye lies along the head, from the face, over its length.
    const EYE: f64 = 0.5;
    /// Thickness of the peen's end over the head's width.
    const PEEN_TAPER: f64 = 0.4;
    /// Width of the bevelled ends over the full width, and length of the bevel over the head's.
    const BEVEL: [f64; 2] = [0.86, 0.06];

    /// Refinement 1 is angular, with one cell across the handle; from 2 on the hammer is round.
    pub(super) fn build(&self, meshing: &Meshing) -> Result<TetMesh, ShapeError> {
        let check = Check("hammer");
        self.check(check)?;
        let element_m = check.element_size_m(meshing.resolution, self.handle_width_m)?;
        let plan = self.plan(element_m);
        let cells = [plan.x.cells(), plan.y.cells(), plan.z.cells()];
        let hexes = lattice(check.0, cells, |cell| plan.region_of(cell), |at| plan.position_m(at))?;
        let split = if plan.round { HexSplit::Six } else { meshing.split };
        let mut mesh = hexes.split(split, &["head", "handle"]);
        centre_on_mass(&mut mesh);
        Ok(mesh)
    }

    fn check(&self, check: Check) -> Result<(), ShapeError> {
        check.lengths(&[
            ("head_length_m", self.head_length_m),
            ("head_width_m", self.head_width_m),
            ("handle_length_m", self.handle_length_m),
            ("handle_width_m", self.handle_width_m),
        ])?;
        check.below(
            "handle_width_m",
            self.handle_width_m,
            0.75 * self.head_width_m,
            "three quarters of `head_width_m`",
        )?;
        check.below(
            "handle_width_m",
            self.handle_width_m,
            0.5 * self.head_length_m,
            "half of `head_length_m`",
        )?;
        check.below("head_width_m", self.head_width_m, self.handle_length_m, "`handle_length_m`")
    }

    fn plan(&self, element_m: f64) -> Plan {
        let round = element_m < 0.75 * self.handle_width_m;
        let cells = |length_m: f64| {
            if round { cells_along(length_m, element_m) } else { 1 }
        };
        let even = |length_m: f64| {
            if round { even_cells_along(length_m, element_m) } else { 1 }
        };
        let (radius_m, half_m) = (self.head_width_m / 2.0, self.handle_width_m / 2.0);
        let share = self.handle_share(round);
        let (side, handle) = (cells((1.0 - share) * radius_m), even(self.handle_width_m));
        let (low_m, high_m) =
            (Self::EYE * self.head_length_m - half_m, Self::EYE * self.head_length_m + half_m);
        Plan {
            hammer: *self,
            x: Axis::new(
                &[-self.handle_length_m, -radius_m, radius_m],
                &[self.handle_cells(element_m, round), even(2.0 * radius_m)],
            ),
            y: Axis::new(&[-1.0, -share, share, 1.0], &[side, handle, side]),
            z: Axis::new(
                &[0.0, low_m, high_m, self.head_length_m],
                &[cells(low_m), handle, cells(self.head_length_m - high_m)],
            ),
            round,
        }
    }

    /// Half the handle's width as a share of half the head's, in lattice coordinates: on a round
    /// head's surface a share `s` lies at the angle `s pi/4`.
    fn handle_share(&self, round: bool) -> f64 {
        let ratio = self.handle_width_m / self.head_width_m;
        let share = if round { ratio.asin() / std::f64::consts::FRAC_PI_4 } else { ratio };
        share.min(0.9)
    }

    /// Cells along the bare handle; they may be longer than wide, twice is harmless. A round head
    /// must begin at an even place of the lattice, or the diagonals miss the corners that its
    /// bending makes flat.
    fn handle_cells(&self, element_m: f64, round: bool) -> u32 {
        let bare_m = self.handle_length_m - self.head_width_m / 2.0;
        if round {
            even_cells_along(bare_m, 2.0 * element_m).max(4)
        } else {
            cells_along(bare_m, 2.5 * element_m).max(3)
        }
    }
}

impl Plan {
    fn region_of(&self, [i, j, k]: [u32; 3]) -> Option<u32> {
        let in_eye = self.y.interval_of(j) == 1 && self.z.interval_of(k) == 1;
        match (self.x.interval_of(i), in_eye) {
            (_, true) => Some(1),
            (0, false) => None,
            _ => Some(0),
        }
    }

    fn position_m(&self, [i, j, k]: [u32; 3]) -> DVec3 {
        if i < self.x.break_at(1) { self.handle_position_m(i, j, k) } else { self.head_position_m(i, j, k) }
    }

    fn head_position_m(&self, i: u32, j: u32, k: u32) -> DVec3 {
        let radius_m = self.hammer.head_width_m / 2.0;
        let (u, v) = (self.x.at(i) / radius_m, self.y.at(j));
        let [x, y] = if self.round { disc_from_square(u, v) } else { [u, v] };
        let z_m = self.z.at(k);
        let (thin, bevel) = (self.peen_scale(z_m), self.bevel_scale(z_m));
        DVec3::new(x * radius_m * thin * bevel, y * radius_m * bevel, z_m)
    }

    /// From the eye to the end, the peen narrows along the handle's direction.
    fn peen_scale(&self, z_m: f64) -> f64 {
        let eye_top_m = self.z.at(self.z.break_at(2));
        let t = (z_m - eye_top_m) / (self.hammer.head_length_m - eye_top_m);
        1.0 - (1.0 - Hammer::PEEN_TAPER) * t.max(0.0)
    }

    fn bevel_scale(&self, z_m: f64) -> f64 {
        let [narrow, share] = Hammer::BEVEL;
        let from_end_m = z_m.min(self.hammer.head_length_m - z_m);
        let t = (from_end_m / (share * self.hammer.head_length_m)).min(1.0);
        narrow + (1.0 - narrow) * t
    }

    fn handle_position_m(&self, i: u32, j: u32, k: u32) -> DVec3 {
        let half_m = self.hammer.handle_width_m / 2.0;
        let middle_m = Hammer::EYE * self.hammer.head_length_m;
        let v = self.y.at(j) / self.y.at(self.y.break_at(2));
        let w = (self.z.at(k) - middle_m) / half_m;
        let [y, z] = if self.round { rounded_square(v, w) } else { [v, w] };
        let grip = self.grip_scale(self.x.at(i));
        DVec3::new(self.x.at(i), y * half_m * grip, middle_m + z * half_m * grip)
    }

    /// The handle is slimmer behind the head and swells towards the tail.
    fn grip_scale(&self, x_m: f64) -> f64 {
        let t = (x_m / self.hammer.handle_length_m + 1.0).clamp(0.0, 1.0);
        1.12 - 0.3 * t * t.sqrt()
    }
}

/// A square with soft corners.
fn rounded_square(u: f64, v: f64) -> [f64; 2] {
    const ROUNDNESS: f64 = 0.65;
    let [x, y] = disc_from_square(u, v);
    [u + ROUNDNESS * (x - u), v + ROUNDNESS * (y - v)]
}

/// Moves a mesh so that its centre of mass, at uniform density, is the origin.
fn centre_on_mass(mesh: &mut TetMesh) {
    let (mut volume_m3, mut moment_m4) = (0.0, DVec3::ZERO);
    for tet in 0..mesh.tets.len() {
        let corners_m = mesh.corners_m(tet);
        let volume = signed_volume_m3(&corners_m);
        volume_m3 += volume;
        moment_m4 += volume * corners_m.iter().sum::<DVec3>() / 4.0;
    }
    let centre_m = moment_m4 / volume_m3;
    for node_m in &mut mesh.nodes_m {
        *node_m -= centre_m;
    }
}
