//! A table lamp: a swept disc whose core is the stem.

use super::lathe::{Disc, DiscNode, DiscSize, Sweep};
use super::lattice::{Axis, cells_along, check_count, even_cells_along};
use super::{Check, HexSplit, Meshing, ShapeError};
use crate::mesh::TetMesh;
use glam::DVec3;
use std::f64::consts::TAU;

/// A table lamp that stands on z = 0: a round foot, a thin stem and a shade open at the bottom;
/// regions `"foot"`, `"stem"` and `"shade"`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Lamp {
    /// Height, m.
    pub height_m: f64,
    /// Radius of the foot, m.
    pub foot_radius_m: f64,
    /// Radius of the stem, m.
    pub stem_radius_m: f64,
    /// Radius of the shade at its lower rim, m.
    pub shade_radius_m: f64,
    /// Height of the shade, m.
    pub shade_height_m: f64,
}

impl Default for Lamp {
    fn default() -> Self {
        Self {
            height_m: 0.45,
            foot_radius_m: 0.1,
            stem_radius_m: 0.018,
            shade_radius_m: 0.14,
            shade_height_m: 0.18,
        }
    }
}

/// Layers and rings of a lamp: the core is the stem; the inner rings bridge the gap between stem
/// and shade; the outer ones are the shade's wall. The foot fills all of them.
struct LampPlan {
    lamp: Lamp,
    disc: Disc,
    gap_rings: u32,
    wall_rings: u32,
    /// Breaks: floor, top of the foot, lower rim of the shade, lower face of its cap, top.
    z: Axis,
}

impl Lamp {
    /// Radius of the shade at the top over that at the rim.
    const SHADE_TAPER: f64 = 0.6;
    /// Thickness of the shade's wall and cap over its radius.
    const WALL_RATIO: f64 = 0.12;
    /// Thickness of the foot at the stem over its radius.
    const FOOT_RATIO: f64 = 0.34;
    /// Thickness of the foot at its rim over that at the stem.
    const RIM_RATIO: f64 = 0.5;
    /// How much longer than wide the stem's cells may be.
    const STEM_STRETCH: f64 = 4.0;

    /// Refinement 1 has four sides, refinement 4 sixteen.
    pub(super) fn build(&self, meshing: &Meshing) -> Result<TetMesh, ShapeError> {
        let check = Check("lamp");
        self.check(check)?;
        let element_m = check.element_size_m(meshing.resolution, TAU * self.shade_radius_m / 4.0)?;
        let plan = self.plan(check, element_m)?;
        let sweep = Sweep::new(
            &plan.disc,
            plan.z.cells(),
            |ring, level| plan.region_of(ring, level),
            |node, level| plan.position_m(node, level),
        );
        let split = plan.split(meshing.split);
        Ok(sweep.mesh.split(split, &["foot", "stem", "shade"]))
    }

    fn check(&self, check: Check) -> Result<(), ShapeError> {
        check.lengths(&[
            ("height_m", self.height_m),
            ("foot_radius_m", self.foot_radius_m),
            ("stem_radius_m", self.stem_radius_m),
            ("shade_radius_m", self.shade_radius_m),
            ("shade_height_m", self.shade_height_m),
        ])?;
        let narrowest_m = (0.9 * self.foot_radius_m)
            .min((Self::SHADE_TAPER - Self::WALL_RATIO) * 0.8 * self.shade_radius_m);
        check.below(
            "stem_radius_m",
            self.stem_radius_m,
            narrowest_m,
            "what foot and shade leave room for",
        )?;
        check.below(
            "shade_height_m",
            self.shade_height_m,
            self.height_m - Self::FOOT_RATIO * self.foot_radius_m,
            "the height above the foot",
        )?;
        let cap_m = Self::WALL_RATIO * self.shade_radius_m;
        if self.shade_height_m <= 1.5 * cap_m {
            let expected = format!("more than {} m, or the shade has no inside", 1.5 * cap_m);
            return Err(check.error("shade_height_m", self.shade_height_m, expected));
        }
        Ok(())
    }

    fn plan(&self, check: Check, element_m: f64) -> Result<LampPlan, ShapeError> {
        let side_m = TAU * self.shade_radius_m / 4.0;
        let core = match cells_along(side_m, element_m) {
            1 => 1,
            _ => even_cells_along(side_m, element_m),
        };
        let wall_m = Self::WALL_RATIO * self.shade_radius_m;
        let gap_rings = cells_along(self.foot_radius_m - self.stem_radius_m - wall_m, element_m);
        let wall_rings = cells_along(wall_m, element_m);
        let foot_m = Self::FOOT_RATIO * self.foot_radius_m;
        let breaks_m =
            [0.0, foot_m, self.height_m - self.shade_height_m, self.height_m - wall_m, self.height_m];
        let stem_cell_m = TAU * self.stem_radius_m / f64::from(4 * core);
        let stem_element_m = element_m.min(Self::STEM_STRETCH * stem_cell_m);
        let levels = [
            cells_along(foot_m, element_m),
            cells_along(breaks_m[2] - foot_m, stem_element_m),
            cells_along(breaks_m[3] - breaks_m[2], stem_element_m),
            cells_along(wall_m, element_m),
        ];
        let size = DiscSize { core, rings: gap_rings + wall_rings };
        check_count(check.0, lamp_cells(size, wall_rings, levels))?;
        Ok(LampPlan {
            lamp: *self,
            disc: Disc::new(size),
            gap_rings,
            wall_rings,
            z: Axis::new(&breaks_m, &levels),
        })
    }
}

/// Hexahedra of a lamp; `levels` counts those of foot, stem, shade and cap.
fn lamp_cells(size: DiscSize, wall_rings: u32, levels: [u32; 4]) -> f64 {
    let [core, rings] = size.core_and_ring_cells();
    let wall = f64::from(size.around()) * f64::from(wall_rings);
    let [foot, stem, shade, cap] = levels.map(f64::from);
    (core + rings) * (foot + cap) + core * stem + (core + wall) * shade
}

impl LampPlan {
    fn split(&self, wanted: HexSplit) -> HexSplit {
        if self.disc.around() > 4 { HexSplit::Six } else { wanted }
    }

    fn region_of(&self, ring: u32, level: u32) -> Option<u32> {
        match self.z.interval_of(level) {
            0 => Some(0),
            _ if ring == 0 => Some(1),
            1 => None,
            2 => (ring > self.gap_rings).then_some(2),
            _ => Some(2),
        }
    }

    fn position_m(&self, node: &DiscNode, level: u32) -> DVec3 {
        let z_m = self.z.at(level);
        let radius_m = self.circle_radius_m(node.ring, z_m);
        let height_m = if level <= self.z.break_at(1) { z_m * self.foot_slope(radius_m) } else { z_m };
        (node.unit * radius_m).extend(height_m)
    }

    /// The foot gets thinner towards its rim.
    fn foot_slope(&self, radius_m: f64) -> f64 {
        let lamp = &self.lamp;
        let outward = (radius_m - lamp.stem_radius_m) / (lamp.foot_radius_m - lamp.stem_radius_m);
        1.0 - (1.0 - Lamp::RIM_RATIO) * outward
    }

    fn circle_radius_m(&self, ring: u32, z_m: f64) -> f64 {
        let lamp = &self.lamp;
        let (gap, wall) = (f64::from(self.gap_rings), f64::from(self.wall_rings));
        let ring = f64::from(ring);
        if z_m <= self.z.at(self.z.break_at(1)) {
            let t = ring / (gap + wall);
            return lamp.stem_radius_m * (1.0 - t) + lamp.foot_radius_m * t;
        }
        let up = (z_m - (lamp.height_m - lamp.shade_height_m)) / lamp.shade_height_m;
        let outer_m = lamp.shade_radius_m * (1.0 - (1.0 - Lamp::SHADE_TAPER) * up);
        let inner_m = outer_m - Lamp::WALL_RATIO * lamp.shade_radius_m;
        if ring <= gap {
            let t = ring / gap;
            lamp.stem_radius_m * (1.0 - t) + inner_m * t
        } else {
            let t = (ring - gap) / wall;
            inner_m * (1.0 - t) + outer_m * t
        }
    }
}
