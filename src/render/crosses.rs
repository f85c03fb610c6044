//! Principal stresses as crosses of three lines: where they stand, how long they are, and their triangles.

use crate::frame::{BodyFrame, BodyRole, Frame, StressCross};
use crate::math::symmetric_eigen;
use crate::render::color_map::to_byte;
use crate::render::geometry::{NO_VALUE, SurfaceVertex, to_signed_normalized};
use crate::render::range::{round_up, stress_above_round_off_pa};
use crate::render::section::{Cut, Opened, open_body};
use glam::{DMat3, DVec3, Vec3};
use std::collections::BTreeMap;

/// Crosses stand at least this share of the picture's extent apart.
const ROOM_SHARE: f32 = 0.035;
/// Length of the longest line over the room of its cross.
const LENGTH_SHARE: f32 = 1.4;
/// Width of the lines over the room, and how far they are lifted off the surface, in widths.
const WIDTH_SHARE: f32 = 0.08;
const LIFT_WIDTHS: f32 = 0.7;
/// Lines shorter than this share of the longest are left out.
const SHORTEST_SHARE: f32 = 0.03;
/// Pull and push, sRGB: apart for those who do not tell red from green, too.
pub(crate) const TENSION_SRGB: [f32; 3] = [0.92, 0.18, 0.12];
pub(crate) const COMPRESSION_SRGB: [f32; 3] = [0.10, 0.38, 0.92];

/// The room of a stress cross in the picture of a frame, m. Frames that are shown one after the other need the same one:
/// the lines' length hangs on it.
#[must_use]
pub fn cross_room_m(frame: &Frame) -> f32 {
    let bounds_m = frame.near_bounds_m();
    bounds_m.map_or(0.0, |(low, high)| ROOM_SHARE * (Vec3::from(high) - Vec3::from(low)).length())
}

/// The frame as it is looked into: cut open, and with stress crosses of this room (on the section where there is a cut,
/// else on the surface) if these are wanted. The interior is used up.
#[must_use]
pub fn look_inside(frame: &Frame, cut: Option<&Cut>, crosses_room_m: Option<f32>) -> Frame {
    let crosses_room_m = crosses_room_m.filter(|room_m| *room_m > 0.0);
    let mut seen = Frame { crosses: Vec::new(), ..frame.clone() };
    for body in seen.bodies.iter_mut().filter(|body| body.role != BodyRole::Fixed) {
        let interior = body.interior.clone();
        let mut first = 0;
        if let Some(cut) = cut {
            let Opened { body: opened, section_start } = open_body(body, cut);
            (*body, first) = (opened, section_start);
        }
        body.interior = None;
        if let Some((interior, room_m)) = interior.zip(crosses_room_m) {
            let sites = thinned(sites(body, first), room_m);
            let crosses = sites.iter().filter_map(|site| site.cross(body, &interior.stress_pa, room_m));
            seen.crosses.extend(crosses);
        }
    }
    if let Some(cut) = cut {
        seen.contacts.retain(|mark| cut.beyond_m(mark.position_m) <= 0.0);
    }
    seen
}

/// A place where a cross could stand.
struct Site {
    element: u32,
    position_m: Vec3,
    normal: Vec3,
}

impl Site {
    fn cross(&self, body: &BodyFrame, stress_pa: &[[f32; 6]], room_m: f32) -> Option<StressCross> {
        let [xx, yy, zz, xy, yz, zx] = stress_pa.get(self.element as usize)?.map(f64::from);
        let stress = DMat3::from_cols(DVec3::new(xx, xy, zx), DVec3::new(xy, yy, yz), DVec3::new(zx, yz, zz));
        if !stress.is_finite() {
            return None;
        }
        let eigen = symmetric_eigen(&stress);
        let axes = [eigen.directions.x_axis, eigen.directions.y_axis, eigen.directions.z_axis];
        Some(StressCross {
            position_m: self.position_m.to_array(),
            normal: self.normal.to_array(),
            directions: axes.map(|axis| axis.as_vec3().to_array()),
            principal_pa: eigen.values.as_vec3().to_array().map(|s| stress_above_round_off_pa(s, body)),
            room_m,
        })
    }
}

/// The middles of the triangles from `first` on.
fn sites(body: &BodyFrame, first: usize) -> Vec<Site> {
    let surface = &body.surface;
    let site = |index: usize| {
        let [a, b, c] = surface.triangles[index].map(|v| body.positions_m.get(v as usize).copied());
        let [a, b, c] = [Vec3::from(a?), Vec3::from(b?), Vec3::from(c?)];
        let normal = (b - a).cross(c - a).try_normalize()?;
        let element = surface.triangle_element.get(index).copied()?;
        Some(Site { element, position_m: (a + b + c) / 3.0, normal })
    };
    (first..surface.triangles.len()).filter_map(site).collect()
}

/// Some of the places, none nearer to another on the same side of the body than `room_m`. They are asked in an order
/// that hangs on the elements' numbers alone, so that crosses go with a moving body instead of jumping over it.
fn thinned(mut sites: Vec<Site>, room_m: f32) -> Vec<Site> {
    sites.sort_by_key(|site| (scattered(site.element), site.element));
    let mut cells: BTreeMap<[i32; 3], Vec<usize>> = BTreeMap::new();
    let mut kept: Vec<Site> = Vec::new();
    for site in sites {
        let cell = (site.position_m / room_m).to_array().map(|x| x.floor() as i32);
        let is_near = |other: &usize| {
            let other = &kept[*other];
            other.normal.dot(site.normal) > 0.0 && other.position_m.distance(site.position_m) < room_m
        };
        let around = (0..27).map(|k| [k % 3, k / 3 % 3, k / 9].map(|shift| shift - 1));
        let is_crowded = around
            .filter_map(|shift| cells.get(&std::array::from_fn(|i| cell[i].saturating_add(shift[i]))))
            .flatten()
            .any(is_near);
        if !is_crowded {
            cells.entry(cell).or_default().push(kept.len());
            kept.push(site);
        }
    }
    kept
}

/// Numbers in a mixed order; the multiplier is Knuth's, 2^32 over the golden ratio.
fn scattered(number: u32) -> u32 {
    number.wrapping_mul(2_654_435_769).rotate_left(16).wrapping_mul(2_654_435_769)
}

/// The stress of the longest line: a round number that few lines exceed, Pa; `None` without crosses, or without stress.
#[must_use]
pub fn cross_scale_pa<'a>(frames: impl IntoIterator<Item = &'a Frame>) -> Option<f32> {
    let crosses = frames.into_iter().flat_map(|frame| &frame.crosses);
    let size = |cross: &StressCross| cross.principal_pa.iter().fold(0.0, |most: f32, s| most.max(s.abs()));
    let mut sizes: Vec<f32> = crosses.map(size).collect();
    if sizes.is_empty() {
        return None;
    }
    // A few peaks must not make dots of all others.
    let index = (sizes.len() - 1) * 49 / 50;
    Some(*sizes.select_nth_unstable_by(index, f32::total_cmp).1).filter(|size| *size > 0.0).map(round_up)
}

/// Whether lines of crosses are long enough to be drawn, where the longest stands for `scale_pa`.
#[must_use]
pub fn has_visible_lines(crosses: &[StressCross], scale_pa: f32) -> bool {
    crosses
        .iter()
        .flat_map(|cross| cross.principal_pa)
        .any(|stress_pa| is_drawn(length_share(stress_pa, scale_pa)))
}

fn length_share(stress_pa: f32, scale_pa: f32) -> f32 {
    (stress_pa.abs() / scale_pa).min(1.0)
}

fn is_drawn(share: f32) -> bool {
    share >= SHORTEST_SHARE
}

/// The triangles of all crosses; the longest line stands for `scale_pa`.
pub(crate) fn cross_vertices(crosses: &[StressCross], scale_pa: f32) -> Vec<SurfaceVertex> {
    let mut vertices = Vec::new();
    for cross in crosses {
        for (direction, stress_pa) in cross.directions.iter().zip(cross.principal_pa) {
            let share = length_share(stress_pa, scale_pa);
            if is_drawn(share) {
                add_line(&mut vertices, cross, Vec3::from(*direction), (share, stress_pa > 0.0));
            }
        }
    }
    vertices
}

/// A thin bar of square section.
fn add_line(
    vertices: &mut Vec<SurfaceVertex>,
    cross: &StressCross,
    along: Vec3,
    (share, is_tension): (f32, bool),
) {
    let width_m = WIDTH_SHARE * cross.room_m;
    let middle = Vec3::from(cross.position_m) + LIFT_WIDTHS * width_m * Vec3::from(cross.normal);
    let half = 0.5 * LENGTH_SHARE * share * cross.room_m * along;
    let side = 0.5 * width_m * along.any_orthonormal_vector();
    let other = along.cross(side);
    let [r, g, b] = (if is_tension { TENSION_SRGB } else { COMPRESSION_SRGB }).map(to_byte);
    let mut face = |center: Vec3, u: Vec3, v: Vec3| {
        let [x, y, z] = u.cross(v).normalize_or_zero().to_array().map(to_signed_normalized);
        let corner = |du: f32, dv: f32| SurfaceVertex {
            position_m: (center + du * u + dv * v).to_array(),
            normal_and_crack: [x, y, z, 0],
            color_and_gloss: [r, g, b, 0],
            map_position: NO_VALUE,
        };
        let [p, q, s, t] = [corner(-1.0, -1.0), corner(1.0, -1.0), corner(1.0, 1.0), corner(-1.0, 1.0)];
        vertices.extend([p, q, s, p, s, t]);
    };
    face(middle + side, other, half);
    face(middle - side, half, other);
    face(middle + other, half, side);
    face(middle - other, side, half);
    face(middle + half, side, other);
    face(middle - half, other, side);
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::frame::{Interior, SurfaceTopology};
    use std::sync::Arc;

    /// A square plate of 2 times 40 times 40 triangles in the plane z = 0, pulled along x and pushed along y.
    fn plate() -> Frame {
        let cells = 40;
        let vertex = |i: u32, j: u32| i * (cells + 1) + j;
        let mut triangles = Vec::new();
        for i in 0..cells {
            for j in 0..cells {
                let [a, b, c, d] = [vertex(i, j), vertex(i + 1, j), vertex(i + 1, j + 1), vertex(i, j + 1)];
                triangles.extend([[a, b, c], [a, c, d]]);
            }
        }
        let at = |k: u32| [(k / (cells + 1)) as f32 / 40.0, (k % (cells + 1)) as f32 / 40.0, 0.0];
        let count = triangles.len() as u32;
        let surface =
            SurfaceTopology { triangles, triangle_element: (0..count).collect(), ..Default::default() };
        let stress_pa = vec![[2e6, -1e6, 0.0, 0.0, 0.0, 0.0]; count as usize];
        let body = BodyFrame {
            surface: Arc::new(surface),
            positions_m: (0..(cells + 1) * (cells + 1)).map(at).collect(),
            interior: Some(Arc::new(Interior { stress_pa, ..Interior::default() })),
            ..BodyFrame::default()
        };
        Frame { bodies: vec![body], ..Frame::default() }
    }

    #[test]
    fn crosses_are_few_apart_and_point_along_the_principal_stresses() {
        let seen = look_inside(&plate(), None, Some(cross_room_m(&plate())));
        let crosses = &seen.crosses;
        assert!((100..1500).contains(&crosses.len()), "{}", crosses.len());
        for (index, cross) in crosses.iter().enumerate() {
            let place = Vec3::from(cross.position_m);
            let others = crosses[index + 1..].iter().map(|other| Vec3::from(other.position_m));
            assert!(others.map(|other| other.distance(place)).all(|d| d >= cross.room_m));
            assert!((cross.principal_pa[0] - 2e6).abs() < 1.0 && (cross.principal_pa[2] + 1e6).abs() < 1.0);
            assert!((cross.directions[0][0].abs() - 1.0).abs() < 1e-5);
        }
        assert_eq!(cross_scale_pa([&seen]), Some(2e6));
        assert!(has_visible_lines(crosses, 2e6) && !has_visible_lines(crosses, 2e8));
        // Two lines each: the third stress is zero.
        let vertices = cross_vertices(crosses, 2e6);
        assert_eq!(vertices.len(), crosses.len() * 2 * 36);
        let reach = |color: [f32; 3], axis: usize| {
            let of_color = vertices[..72].iter().filter(|v| v.color_and_gloss[..3] == color.map(to_byte));
            of_color.map(|v| v.position_m[axis] - crosses[0].position_m[axis]).fold(0.0, f32::max)
        };
        let (pull, push) = (reach(TENSION_SRGB, 0), reach(COMPRESSION_SRGB, 1));
        assert!(
            (pull / push - 2.0).abs() < 1e-3 && (pull / crosses[0].room_m - 0.5 * LENGTH_SHARE).abs() < 1e-3
        );
    }

    #[test]
    fn a_moved_body_keeps_its_crosses() {
        let elements = |frame: &Frame| -> Vec<[f32; 3]> {
            look_inside(frame, None, Some(cross_room_m(frame))).crosses.iter().map(|c| c.position_m).collect()
        };
        let mut moved = plate();
        moved.bodies[0].positions_m.iter_mut().for_each(|p| p[0] += 0.3);
        let (here, there) = (elements(&plate()), elements(&moved));
        let same = here.iter().zip(&there).filter(|(a, b)| (b[0] - a[0] - 0.3).abs() < 1e-5).count();
        assert!(same as f32 > 0.9 * here.len() as f32, "{same} of {}", here.len());
    }

    #[test]
    fn without_stresses_or_wish_there_are_none() {
        assert!(look_inside(&plate(), None, None).crosses.is_empty());
        let mut hollow = plate();
        hollow.bodies[0].interior = None;
        let seen = look_inside(&hollow, None, Some(cross_room_m(&hollow)));
        assert!(seen.crosses.is_empty() && cross_scale_pa([&seen]).is_none());
        // Stresses that are nothing but round-off.
        let mut resting = plate();
        resting.bodies[0].scales.stiffness_pa = 1e19;
        let seen = look_inside(&resting, None, Some(cross_room_m(&resting)));
        assert!(!seen.crosses.is_empty() && cross_scale_pa([&seen]).is_none());
    }
}
