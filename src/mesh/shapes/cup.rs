//! A cup: a swept disc whose upper levels keep only the wall, with a bow for a handle.

use super::hex_mesh::HexMesh;
use super::lathe::{Disc, DiscNode, DiscSize, Sweep};
use super::lattice::{Axis, cells_along, check_count, disc_from_square, even_cells_along, odd_count};
use super::{Check, HexSplit, Meshing, ShapeError};
use crate::mesh::TetMesh;
use glam::DVec3;
use std::f64::consts::{FRAC_PI_2, FRAC_PI_4, PI, TAU};

/// A round cup, open at the top, that stands on z = 0 with its handle towards +x; regions
/// `"bowl"` and `"handle"`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Cup {
    /// Outer radius at the rim, m.
    pub radius_m: f64,
    /// Height, m.
    pub height_m: f64,
    /// Thickness of the wall, m.
    pub wall_m: f64,
}

impl Default for Cup {
    fn default() -> Self {
        Self { radius_m: 0.042, height_m: 0.095, wall_m: 0.005 }
    }
}

/// Layers and cells of a cup.
struct CupPlan {
    cup: Cup,
    disc: Disc,
    wall_rings: u32,
    z: Axis,
    element_m: f64,
}

impl Cup {
    /// Outer radius at the foot over that at the rim.
    const FOOT_RATIO: f64 = 0.76;
    /// Thickness of the bottom over that of the wall.
    const BOTTOM_RATIO: f64 = 1.4;
    /// Where the handle's middle line leaves the wall, over the cup's height.
    const HANDLE_ENDS: [f64; 2] = [0.27, 0.78];
    /// How far the handle stands out, over the distance between its ends.
    const HANDLE_REACH: f64 = 0.62;
    /// Greatest thickness of the handle over the cup's height: its ends must stay apart.
    const HANDLE_SHARE: f64 = 0.16;
    /// Width of the handle as an angle seen from the cup's axis, radians.
    const HANDLE_ANGLE: f64 = 0.36;

    /// Refinement 1 has 16 cells around and one across the wall.
    pub(super) fn build(&self, meshing: &Meshing) -> Result<TetMesh, ShapeError> {
        let check = Check("cup");
        self.check(check)?;
        let around_m = TAU * self.radius_m;
        let element_m = check.element_size_m(meshing.resolution, around_m / 16.0)?;
        let plan = self.plan(check, element_m)?;
        let mut sweep = plan.sweep();
        plan.add_handle(&mut sweep);
        Ok(sweep.mesh.split(HexSplit::Six, &["bowl", "handle"]))
    }

    fn check(&self, check: Check) -> Result<(), ShapeError> {
        check.lengths(&[
            ("radius_m", self.radius_m),
            ("height_m", self.height_m),
            ("wall_m", self.wall_m),
        ])?;
        check.below("wall_m", self.wall_m, 0.5 * self.radius_m, "half of `radius_m`")?;
        check.below("wall_m", self.wall_m, 0.25 * self.height_m, "a quarter of `height_m`")
    }

    fn plan(&self, check: Check, element_m: f64) -> Result<CupPlan, ShapeError> {
        let core = even_cells_along(TAU * self.radius_m / 4.0, element_m).max(4);
        let wall_rings = cells_along(self.wall_m, element_m);
        let bottom_m = Self::BOTTOM_RATIO * self.wall_m;
        let bottom = cells_along(bottom_m, element_m);
        let wall = cells_along(self.height_m - bottom_m, 0.75 * element_m).max(6);
        let size = DiscSize { core, rings: wall_rings };
        let [core_cells, ring_cells] = size.core_and_ring_cells();
        let hexes = (core_cells + ring_cells) * f64::from(bottom) + ring_cells * f64::from(wall);
        check_count(check.0, hexes)?;
        Ok(CupPlan {
            cup: *self,
            disc: Disc::new(size),
            wall_rings,
            z: Axis::new(&[0.0, bottom_m, self.height_m], &[bottom, wall]),
            element_m,
        })
    }

    /// Outer radius at height `z_m`: narrow at the foot, upright at the rim.
    fn outer_radius_m(&self, z_m: f64) -> f64 {
        let down = 1.0 - z_m / self.height_m;
        self.radius_m * (1.0 - (1.0 - Self::FOOT_RATIO) * down * down)
    }
}

impl CupPlan {
    fn sweep(&self) -> Sweep {
        Sweep::new(
            &self.disc,
            self.z.cells(),
            |ring, level| (ring > 0 || self.z.interval_of(level) == 0).then_some(0),
            |node, level| self.position_m(node, level),
        )
    }

    fn position_m(&self, node: &DiscNode, level: u32) -> DVec3 {
        let z_m = self.z.at(level);
        let mut outer_m = self.cup.outer_radius_m(z_m);
        let inner_m = outer_m - self.cup.wall_m;
        if level == 0 {
            // A bevel around the foot.
            outer_m -= 0.4 * self.cup.wall_m;
        }
        let t = f64::from(node.ring) / f64::from(self.wall_rings);
        let flat = node.unit.rotate(self.turn()) * (inner_m * (1.0 - t) + outer_m * t);
        flat.extend(z_m)
    }

    /// Turns the disc so that the middle of the handle looks along +x.
    fn turn(&self) -> glam::DVec2 {
        let cell_angle = TAU / f64::from(self.disc.around());
        let middle = f64::from(self.handle_width_cells()) / 2.0;
        glam::DVec2::from_angle(3.0 * FRAC_PI_4 - middle * cell_angle)
    }

    fn handle_width_cells(&self) -> u32 {
        cells_along(Cup::HANDLE_ANGLE, TAU / f64::from(self.disc.around()))
    }

    fn handle_thickness_cells(&self) -> u32 {
        let width_m = Cup::HANDLE_ANGLE * self.cup.radius_m;
        let thickness_m = (0.8 * width_m).min(Cup::HANDLE_SHARE * self.cup.height_m);
        cells_along(thickness_m, self.level_m())
    }

    fn level_m(&self) -> f64 {
        (self.cup.height_m - self.z.at(self.z.break_at(1))) / f64::from(self.z.cells() - self.z.break_at(1))
    }

    /// Lowest level of the handle's end nearest to `share` of the cup's height.
    fn handle_level(&self, share: f64) -> u32 {
        let thick = self.handle_thickness_cells();
        let (lowest, highest) = (self.z.break_at(1), self.z.cells() - thick);
        let middle_m = share * self.cup.height_m;
        (lowest..=highest)
            .min_by(|&a, &b| {
                let off =
                    |level: u32| (f64::midpoint(self.z.at(level), self.z.at(level + thick)) - middle_m).abs();
                off(a).total_cmp(&off(b))
            })
            .unwrap_or(lowest)
    }

    /// The outer wall's nodes where an end of the handle sits, `[across][inner to outer side of
    /// the bow]`.
    fn end_nodes(&self, sweep: &Sweep, share: f64, upper: bool) -> Vec<Vec<u32>> {
        let (low, thick) = (self.handle_level(share), self.handle_thickness_cells());
        (0..=self.handle_width_cells())
            .map(|p| {
                (0..=thick)
                    .map(|q| {
                        let level = low + if upper { q } else { thick - q };
                        sweep.node_on(self.disc.outer_node(p), level)
                    })
                    .collect()
            })
            .collect()
    }

    /// A bow from the upper to the lower end: half an ellipse in the xz plane.
    fn add_handle(&self, sweep: &mut Sweep) {
        let [lower, upper] = Cup::HANDLE_ENDS;
        let first = self.end_nodes(sweep, upper, true);
        let last = self.end_nodes(sweep, lower, false);
        let bow = Bow::between(&sweep.mesh, &first, &last);
        let steps = cells_along(bow.length_m(), self.element_m).max(6);
        let mut section = first;
        for step in 1..=steps {
            let next = if step == steps {
                last.clone()
            } else {
                let angle = FRAC_PI_2 - PI * f64::from(step) / f64::from(steps);
                bow.add_section(&mut sweep.mesh, angle, step, &section)
            };
            add_bridge(&mut sweep.mesh, &section, &next, 1);
            section = next;
        }
    }
}

/// Fills the space between two grids of nodes, `[y][z]`, with hexahedra.
fn add_bridge(mesh: &mut HexMesh, from: &[Vec<u32>], to: &[Vec<u32>], region: u32) {
    for p in 0..from.len() - 1 {
        for q in 0..from[p].len() - 1 {
            let corners = std::array::from_fn(|c| {
                let grid = if c & 1 == 0 { from } else { to };
                grid[p + (c >> 1 & 1)][q + (c >> 2)]
            });
            mesh.add_hex(corners, region);
        }
    }
}

/// The bow of a cup's handle.
struct Bow {
    /// Middle of the ellipse in the xz plane, m.
    centre_m: DVec3,
    /// Half axes along x and z, m.
    reach_m: f64,
    rise_m: f64,
    /// How much further out the upper end starts than the lower one, m, over the sine.
    lean_m: f64,
    /// Half of the section, m.
    half_width_m: f64,
    half_thickness_m: f64,
}

impl Bow {
    fn between(mesh: &HexMesh, upper: &[Vec<u32>], lower: &[Vec<u32>]) -> Self {
        let [low, high] = [lower, upper].map(|grid| {
            let nodes: Vec<DVec3> = grid.iter().flatten().map(|&n| mesh.position_m(n)).collect();
            nodes.iter().sum::<DVec3>() / nodes.len() as f64
        });
        let corner = |grid: &[Vec<u32>], last: bool| {
            let column = if last { &grid[grid.len() - 1] } else { &grid[0] };
            mesh.position_m(column[if last { column.len() - 1 } else { 0 }])
        };
        let diagonal_m = corner(upper, true) - corner(upper, false);
        Self {
            centre_m: low.midpoint(high).with_y(0.0),
            reach_m: Cup::HANDLE_REACH * (high.z - low.z),
            rise_m: (high.z - low.z) / 2.0,
            lean_m: (high.x - low.x) / 2.0,
            half_width_m: 0.45 * diagonal_m.y.abs(),
            half_thickness_m: 0.42 * diagonal_m.z.abs(),
        }
    }

    fn length_m(&self) -> f64 {
        PI * f64::midpoint(self.reach_m, self.rise_m)
    }

    /// Adds the nodes of the section at `angle` (pi/2 at the upper end, -pi/2 at the lower one).
    fn add_section(&self, mesh: &mut HexMesh, angle: f64, step: u32, like: &[Vec<u32>]) -> Vec<Vec<u32>> {
        let (sin, cos) = angle.sin_cos();
        let middle_m =
            self.centre_m + DVec3::new(self.reach_m * cos + self.lean_m * sin, 0.0, self.rise_m * sin);
        let outward = DVec3::new(cos / self.reach_m, 0.0, sin / self.rise_m).normalize();
        let (across, through) = (like.len() as u32 - 1, like[0].len() as u32 - 1);
        (0..=across)
            .map(|p| {
                (0..=through)
                    .map(|q| {
                        let [u, v] = rounded_section(p, across, q, through);
                        let at_m = middle_m
                            + DVec3::Y * (u * self.half_width_m)
                            + outward * (v * self.half_thickness_m);
                        mesh.add_node(at_m, odd_count([p, q, step]))
                    })
                    .collect()
            })
            .collect()
    }
}

/// Section coordinates in [-1, 1]^2 of a grid node, with rounded corners where the grid is fine
/// enough for them.
fn rounded_section(p: u32, across: u32, q: u32, through: u32) -> [f64; 2] {
    let [u, v] = [(p, across), (q, through)].map(|(i, n)| 2.0 * f64::from(i) / f64::from(n) - 1.0);
    if across < 2 || through < 2 {
        return [u, v];
    }
    let [x, y] = disc_from_square(u, v);
    [f64::midpoint(u, x), f64::midpoint(v, y)]
}
