//! Shapes made of lattice cells: some cells of a three-dimensional lattice, its nodes put
//! anywhere.

use super::hex_mesh::HexMesh;
use super::{ELEMENT_LIMIT, ShapeError};
use glam::DVec3;

/// Builds the hexahedra of a lattice of `cells` cells.
///
/// `region_of` names the region of a cell, or `None` where there is no solid; `position_m` places
/// a lattice node. Lattice axes must map to right-handed axes.
pub(super) fn lattice(
    shape: &'static str,
    cells: [u32; 3],
    region_of: impl Fn([u32; 3]) -> Option<u32>,
    position_m: impl Fn([u32; 3]) -> DVec3,
) -> Result<HexMesh, ShapeError> {
    check_size(shape, cells, &region_of)?;
    let node_counts = cells.map(|n| n as usize + 1);
    let mut node_at = vec![u32::MAX; node_counts.iter().product()];
    let mut mesh = HexMesh::default();
    for cell in all(cells) {
        let Some(region) = region_of(cell) else {
            continue;
        };
        let corners = std::array::from_fn(|corner| {
            let at = corner_of(cell, corner);
            let slot = &mut node_at[flat_index(at, node_counts)];
            if *slot == u32::MAX {
                *slot = mesh.add_node(position_m(at), odd_count(at));
            }
            *slot
        });
        mesh.add_hex(corners, region);
    }
    Ok(mesh)
}

/// Refuses before anything large is allocated. A lattice may be mostly empty (a table is), so the
/// solid cells are counted unless there are so many cells that no shape is as empty.
fn check_size(
    shape: &'static str,
    cells: [u32; 3],
    region_of: &impl Fn([u32; 3]) -> Option<u32>,
) -> Result<(), ShapeError> {
    let lattice_cells: f64 = cells.iter().map(|&n| f64::from(n)).product();
    if lattice_cells > LEAST_SOLID * f64::from(ELEMENT_LIMIT) {
        return check_count(shape, lattice_cells);
    }
    let solid = all(cells).filter(|&cell| region_of(cell).is_some()).count();
    check_count(shape, solid as f64)
}

/// Lattice cells for each allowed element above which nothing is counted any more; a large, thin
/// table fills one cell in twenty.
const LEAST_SOLID: f64 = 4.0;

/// Refuses more hexahedra than the element limit allows.
pub(super) fn check_count(shape: &'static str, hexes: f64) -> Result<(), ShapeError> {
    let elements = 6.0 * hexes;
    if elements > f64::from(ELEMENT_LIMIT) {
        return Err(ShapeError::TooManyElements { shape, elements });
    }
    Ok(())
}

fn all([nx, ny, nz]: [u32; 3]) -> impl Iterator<Item = [u32; 3]> {
    (0..nz).flat_map(move |k| (0..ny).flat_map(move |j| (0..nx).map(move |i| [i, j, k])))
}

fn corner_of([i, j, k]: [u32; 3], corner: usize) -> [u32; 3] {
    [i + u32::from(corner & 1 != 0), j + u32::from(corner & 2 != 0), k + u32::from(corner & 4 != 0)]
}

fn flat_index(at: [u32; 3], counts: [usize; 3]) -> usize {
    let [i, j, k] = at.map(|n| n as usize);
    (k * counts[1] + j) * counts[0] + i
}

pub(super) fn odd_count(at: [u32; 3]) -> u8 {
    at.iter().map(|&n| u8::from(n % 2 == 1)).sum()
}

/// Points along one axis: the given breaks, each interval cut into equal cells.
#[derive(Clone, Debug)]
pub(super) struct Axis {
    points_m: Vec<f64>,
    /// Index in `points_m` of each break.
    break_index: Vec<u32>,
}

impl Axis {
    /// `breaks_m` ascending, one more than `cells`.
    pub fn new(breaks_m: &[f64], cells: &[u32]) -> Self {
        let mut axis = Self { points_m: vec![breaks_m[0]], break_index: vec![0] };
        let mut index = 0;
        for (interval, &count) in breaks_m.windows(2).zip(cells) {
            for step in 1..=count {
                let t = f64::from(step) / f64::from(count);
                axis.points_m.push(interval[0] * (1.0 - t) + interval[1] * t);
            }
            index += count;
            axis.break_index.push(index);
        }
        axis
    }

    /// Cells along the axis.
    pub fn cells(&self) -> u32 {
        self.break_index[self.break_index.len() - 1]
    }

    /// Coordinate of a lattice node, m.
    pub fn at(&self, index: u32) -> f64 {
        self.points_m[index as usize]
    }

    /// Which interval between breaks a cell lies in.
    pub fn interval_of(&self, cell: u32) -> usize {
        self.break_index.partition_point(|&start| start <= cell) - 1
    }

    /// Index of the node at a break.
    pub fn break_at(&self, which: usize) -> u32 {
        self.break_index[which]
    }
}

/// Cells of about `size_m` along `length_m`: at least one.
pub(super) fn cells_along(length_m: f64, size_m: f64) -> u32 {
    rounded(length_m / size_m)
}

/// An even number of cells of about `size_m` along `length_m`: at least two.
pub(super) fn even_cells_along(length_m: f64, size_m: f64) -> u32 {
    2 * rounded(length_m / (2.0 * size_m))
}

/// Nearest whole number, from 1 up to just too many hexahedra along one axis alone.
#[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "clamped to a range that fits")]
fn rounded(value: f64) -> u32 {
    value.round().clamp(1.0, f64::from(ELEMENT_LIMIT / 5)) as u32
}

/// Maps the square [-1, 1]^2 to the unit disc: concentric squares become concentric circles, and
/// equal steps along a side become equal angles.
pub(super) fn disc_from_square(u: f64, v: f64) -> [f64; 2] {
    use std::f64::consts::FRAC_PI_4;
    if u == 0.0 && v == 0.0 {
        return [0.0, 0.0];
    }
    if u.abs() >= v.abs() {
        let angle = FRAC_PI_4 * v / u;
        [u * angle.cos(), u * angle.sin()]
    } else {
        let angle = FRAC_PI_4 * u / v;
        [v * angle.sin(), v * angle.cos()]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_axis_keeps_its_breaks() {
        let axis = Axis::new(&[0.0, 1.0, 4.0], &[2, 3]);
        assert_eq!(axis.points_m, [0.0, 0.5, 1.0, 2.0, 3.0, 4.0]);
        assert_eq!((axis.cells(), axis.break_at(1)), (5, 2));
        let intervals: Vec<_> = (0..5).map(|cell| axis.interval_of(cell)).collect();
        assert_eq!(intervals, [0, 0, 1, 1, 1]);
    }

    #[test]
    fn squares_become_circles() {
        for (u, v) in [(1.0, 1.0), (-1.0, 0.3), (0.5, -1.0), (-1.0, -1.0)] {
            let [x, y] = disc_from_square(u, v);
            assert!((x.hypot(y) - 1.0).abs() < 1e-12, "{u} {v}");
        }
        assert!(disc_from_square(-0.4, 0.1)[0] < 0.0);
    }
}
