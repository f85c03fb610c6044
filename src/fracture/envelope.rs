//! The failure surface in the space of principal stresses, for drawing (thesis Fig. 6.2).
//!
//! A state is `p (1,1,1) + r (cos t e_1 + sin t e_2)`: mean stress p, distance r from the
//! hydrostatic axis and angle t around it, counted from the projection of the s1 axis, with
//! `e_1 = (2,-1,-1)/sqrt6`, `e_2 = (0,1,-1)/sqrt2`. Surfaces are found along rays of constant p and
//! t from the axis outward; the first crossing counts.

use super::criterion::{Criterion, CriterionError};
use super::stress::StressMeasures;
use glam::{DVec2, DVec3};
use std::f64::consts::TAU;

/// Steps in which a ray is searched for its first crossing, and halvings that pin it down.
const RAY_STEPS: u32 = 64;
const HALVINGS: u32 = 50;
/// No material bears more, Pa.
const FARTHEST_PA: f64 = 1e13;

/// Part of the principal stress space to draw.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DrawnRange {
    /// Lowest and highest mean stress, Pa.
    pub mean_pa: [f64; 2],
    /// How far from the hydrostatic axis to look, Pa.
    pub reach_pa: f64,
}

/// A failure surface as a mesh.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct EnvelopeMesh {
    /// Points `(s1, s2, s3)` in any order of size, Pa.
    pub points_pa: Vec<DVec3>,
    /// Triangles, the safe side behind them.
    pub triangles: Vec<[u32; 3]>,
}

/// The point at mean stress, distance from the axis and angle around it, Pa and radians.
#[must_use]
pub fn principal_point_pa(mean_pa: f64, distance_pa: f64, angle_rad: f64) -> DVec3 {
    let first = DVec3::new(2.0, -1.0, -1.0) / 6.0_f64.sqrt();
    let second = DVec3::new(0.0, 1.0, -1.0) / 2.0_f64.sqrt();
    let (sin, cos) = angle_rad.sin_cos();
    DVec3::splat(mean_pa) + distance_pa * (cos * first + sin * second)
}

/// Coordinates of a point across the hydrostatic axis, right and up, Pa: the projection of the s1 axis points up, that
/// of the s2 axis to the lower left.
#[must_use]
pub fn deviatoric_place_pa(point_pa: DVec3) -> DVec2 {
    DVec2::new(
        point_pa.dot(DVec3::new(0.0, -1.0, 1.0)) / 2.0_f64.sqrt(),
        point_pa.dot(DVec3::new(2.0, -1.0, -1.0)) / 6.0_f64.sqrt(),
    )
}

/// Mean stress and distance from the hydrostatic axis, Pa, and the angle around it, radians: where
/// [`principal_point_pa`] has a point. For `s1 >= s2 >= s3` the angle lies in `[0, pi/3]`.
#[must_use]
pub fn principal_place(point_pa: DVec3) -> (f64, f64, f64) {
    let flat_pa = deviatoric_place_pa(point_pa);
    (point_pa.element_sum() / 3.0, flat_pa.length(), (-flat_pa.x).atan2(flat_pa.y))
}

/// Mohr's envelope: the line in the plane of normal and shear stress, `[sigma, tau]` with `tau >= 0`, Pa, that all
/// circles of failing states touch whose stresses lie at an angle around the hydrostatic axis.
///
/// The circles `(s1, s3)` along the meridian have middles c and radii R(c); their envelope is
/// `sigma = c - R R'`, `tau = R sqrt(1 - R'^2)` where `|R'| <= 1` (O. Mohr, 1900; any text on envelopes of circles).
/// For criteria that look at s1 and s3 alone it does not hang on the angle.
///
/// # Errors
/// As for [`deviatoric_section`].
pub fn mohr_envelope(
    criterion: &Criterion,
    angle_rad: f64,
    count: u32,
    range: &DrawnRange,
) -> Result<Vec<[f64; 2]>, CriterionError> {
    let points_pa = meridian(criterion, angle_rad, count, range)?;
    let circle = |[mean_pa, distance_pa]: [f64; 2]| {
        let point_pa = principal_point_pa(mean_pa, distance_pa, angle_rad);
        let (high, low) = (point_pa.max_element(), point_pa.min_element());
        [0.5 * (high + low), 0.5 * (high - low)]
    };
    let circles: Vec<[f64; 2]> = points_pa.into_iter().map(circle).collect();
    // The angle from the sigma axis at which two neighbours are touched, `cos t = -R'`.
    let touch = |pair: &[[f64; 2]]| {
        let slope = (pair[1][1] - pair[0][1]) / (pair[1][0] - pair[0][0]);
        // Where they lie inside each other circles have no line to touch.
        (slope.abs() <= 1.0 + SLOPE_ROUND_OFF).then(|| (-slope).clamp(-1.0, 1.0).acos())
    };
    let touches: Vec<Option<f64>> = circles.windows(2).map(touch).collect();
    let mut line = Vec::new();
    for (index, pair) in circles.windows(2).enumerate() {
        let Some(touch_rad) = touches[index] else { continue };
        // Around a corner of the meridian it follows the circle there.
        let before_rad = index.checked_sub(1).and_then(|before| touches[before]);
        if let Some(turn_rad) = before_rad.map(|before_rad| before_rad - touch_rad) {
            let steps = (turn_rad / LARGEST_TURN_RAD).floor().max(0.0) as u32;
            let on_arc = |step: u32| touch_rad + turn_rad * f64::from(step) / f64::from(steps + 1);
            line.extend((1..=steps).rev().map(|step| on_circle(pair[0], on_arc(step))));
        }
        let between = [0, 1].map(|k| f64::midpoint(pair[0][k], pair[1][k]));
        line.push(on_circle(between, touch_rad));
    }
    Ok(line)
}

/// How far beyond 1 a slope of radii may lie by round-off: circles that all touch in one point have just 1.
const SLOPE_ROUND_OFF: f64 = 1e-9;
/// Largest turn of Mohr's envelope from a point to the next, radians.
const LARGEST_TURN_RAD: f64 = 0.08;

/// The point of a circle of middle and radius, at an angle from the sigma axis.
fn on_circle([middle, radius]: [f64; 2], angle_rad: f64) -> [f64; 2] {
    [middle + radius * angle_rad.cos(), radius * angle_rad.sin()]
}

/// Deviatoric section at a mean stress: distance from the axis, Pa, at `count` equally spaced
/// angles from 0 on. `None` where the surface is farther than `reach_pa`; zero where the axis
/// itself fails.
///
/// # Errors
/// A formula that cannot be evaluated somewhere on the way.
pub fn deviatoric_section(
    criterion: &Criterion,
    mean_pa: f64,
    count: u32,
    reach_pa: f64,
) -> Result<Vec<Option<f64>>, CriterionError> {
    let angle = |index: u32| TAU * f64::from(index) / f64::from(count);
    (0..count).map(|index| distance_to_failure_pa(criterion, mean_pa, angle(index), reach_pa)).collect()
}

/// Section by the plane `s3 = 0`: the points `(s1, s2, 0)` of the surface, Pa, at `count` equally spaced angles
/// `atan2(s2, s1)` from 0 on. `None` where the surface is farther than `reach_pa` from the unstressed state.
///
/// # Errors
/// As for [`deviatoric_section`].
pub fn plane_stress_section(
    criterion: &Criterion,
    count: u32,
    reach_pa: f64,
) -> Result<Vec<Option<DVec3>>, CriterionError> {
    let direction = |index: u32| {
        let (sin, cos) = (TAU * f64::from(index) / f64::from(count)).sin_cos();
        DVec3::new(cos, sin, 0.0)
    };
    let point = |index: u32| -> Result<Option<DVec3>, CriterionError> {
        let along = direction(index);
        let found = first_crossing(reach_pa, |distance_pa| excess_at(criterion, distance_pa * along))?;
        Ok(found.map(|distance_pa| distance_pa * along))
    };
    (0..count).map(point).collect()
}

/// How far failure is from a state in a direction, of whatever size: for choosing a reach. It is looked for
/// at distances that double each time, so islands of failure may be stepped over. `None` beyond 10 TPa.
///
/// # Errors
/// As for [`deviatoric_section`].
pub fn distance_along_pa(
    criterion: &Criterion,
    from_pa: DVec3,
    along: DVec3,
) -> Result<Option<f64>, CriterionError> {
    let at = |distance_pa: f64| excess_at(criterion, from_pa + distance_pa * along);
    let mut reach_pa = 1.0;
    while reach_pa < FARTHEST_PA {
        if at(reach_pa)? >= 0.0 {
            return first_crossing(reach_pa, at);
        }
        reach_pa *= 2.0;
    }
    Ok(None)
}

/// Meridian at an angle around the axis: `[mean stress, distance from the axis]`, Pa, at
/// `count >= 2` equally spaced mean stresses, without the points that are out of reach.
///
/// # Errors
/// As for [`deviatoric_section`].
pub fn meridian(
    criterion: &Criterion,
    angle_rad: f64,
    count: u32,
    range: &DrawnRange,
) -> Result<Vec<[f64; 2]>, CriterionError> {
    let mut points = Vec::new();
    for mean_pa in means_pa(criterion, count, range)? {
        let distance_pa = distance_to_failure_pa(criterion, mean_pa, angle_rad, range.reach_pa)?;
        points.extend(distance_pa.map(|distance_pa| [mean_pa, distance_pa]));
    }
    Ok(points)
}

/// The surface over a range, `sections >= 2` sections of `around >= 3` points; open where it is
/// out of reach, closed at its apex if the range holds it.
///
/// # Errors
/// As for [`deviatoric_section`].
pub fn envelope_mesh(
    criterion: &Criterion,
    [sections, around]: [u32; 2],
    range: &DrawnRange,
) -> Result<EnvelopeMesh, CriterionError> {
    let mut mesh = EnvelopeMesh::default();
    let mut before: Option<Vec<Option<u32>>> = None;
    for mean_pa in means_pa(criterion, sections, range)? {
        let distances_pa = deviatoric_section(criterion, mean_pa, around, range.reach_pa)?;
        let mut row = Vec::with_capacity(around as usize);
        for (index, distance_pa) in (0_u32..).zip(distances_pa) {
            let angle_rad = TAU * f64::from(index) / f64::from(around);
            row.push(distance_pa.map(|distance_pa| {
                mesh.points_pa.push(principal_point_pa(mean_pa, distance_pa, angle_rad));
                mesh.points_pa.len() as u32 - 1
            }));
        }
        if let Some(before) = before {
            mesh.add_band(&before, &row);
        }
        before = Some(row);
    }
    Ok(mesh)
}

impl EnvelopeMesh {
    fn add_band(&mut self, low: &[Option<u32>], high: &[Option<u32>]) {
        for index in 0..low.len() {
            let next = (index + 1) % low.len();
            if let (Some(a), Some(b), Some(c), Some(d)) = (low[index], low[next], high[next], high[index]) {
                self.triangles.extend([[a, b, c], [a, c, d]]);
            }
        }
    }
}

/// Equally spaced mean stresses of the range, which ends at the apex if that comes first.
fn means_pa(criterion: &Criterion, count: u32, range: &DrawnRange) -> Result<Vec<f64>, CriterionError> {
    let [low_pa, high_pa] = range.mean_pa;
    let apex = first_crossing(high_pa - low_pa, |above_pa| excess(criterion, low_pa + above_pa, 0.0, 0.0))?;
    let height_pa = apex.unwrap_or(high_pa - low_pa);
    let last = count.max(2) - 1;
    Ok((0..=last).map(|index| low_pa + height_pa * f64::from(index) / f64::from(last)).collect())
}

/// Distance from the hydrostatic axis at which failure begins, Pa.
fn distance_to_failure_pa(
    criterion: &Criterion,
    mean_pa: f64,
    angle_rad: f64,
    reach_pa: f64,
) -> Result<Option<f64>, CriterionError> {
    first_crossing(reach_pa, |distance_pa| excess(criterion, mean_pa, distance_pa, angle_rad))
}

fn excess(
    criterion: &Criterion,
    mean_pa: f64,
    distance_pa: f64,
    angle_rad: f64,
) -> Result<f64, CriterionError> {
    excess_at(criterion, principal_point_pa(mean_pa, distance_pa, angle_rad))
}

fn excess_at(criterion: &Criterion, point_pa: DVec3) -> Result<f64, CriterionError> {
    let stress = StressMeasures::of(point_pa);
    // The index less one has the sign of the failure function, whatever rule governs.
    Ok(criterion.assess(&stress)?.index - 1.0)
}

/// Smallest `x` in `[0, reach]` where the function is no longer negative.
fn first_crossing<E>(reach: f64, f: impl Fn(f64) -> Result<f64, E>) -> Result<Option<f64>, E> {
    let mut safe = 0.0;
    if f(safe)? >= 0.0 {
        return Ok(Some(0.0));
    }
    for step in 1..=RAY_STEPS {
        let mut failed = reach * f64::from(step) / f64::from(RAY_STEPS);
        if f(failed)? < 0.0 {
            safe = failed;
            continue;
        }
        for _ in 0..HALVINGS {
            let middle = f64::midpoint(safe, failed);
            if f(middle)? < 0.0 { safe = middle } else { failed = middle }
        }
        return Ok(Some(failed));
    }
    Ok(None)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fracture::Strength;
    use std::f64::consts::{FRAC_PI_3, FRAC_PI_6};

    const K: f64 = 1e6;
    const RANGE: DrawnRange = DrawnRange { mean_pa: [-5.0 * K, 5.0 * K], reach_pa: 50.0 * K };

    fn criterion(strength: Strength) -> Criterion {
        Criterion::single(strength).unwrap()
    }

    fn section(strength: Strength, mean_pa: f64) -> Vec<f64> {
        let found = deviatoric_section(&criterion(strength), mean_pa, 12, RANGE.reach_pa).unwrap();
        found.into_iter().map(|distance| distance.unwrap() / K).collect()
    }

    #[test]
    fn sections_are_circle_hexagon_and_triangle() {
        let root2 = 2.0_f64.sqrt();
        // r = sqrt(2 J2): a circle for von Mises.
        let mises = section(Strength::VonMises { shear_strength_pa: K }, -K);
        assert!(mises.iter().all(|r| (r - root2).abs() < 1e-9), "{mises:?}");
        // Tresca: a regular hexagon around it that touches it in pure shear (30 degrees).
        let tresca = section(Strength::Tresca { shear_strength_pa: K }, -K);
        for (index, r) in tresca.iter().enumerate() {
            let expected = if index % 2 == 0 { root2 / FRAC_PI_6.cos() } else { root2 };
            assert!((r - expected).abs() < 1e-9, "{tresca:?}");
        }
        // Rankine: a triangle; s1 = p + r sqrt(2/3) along the s1 axis, half of that behind it.
        let tensile = section(Strength::Tensile { tensile_strength_pa: K }, 0.0);
        assert!((tensile[0] - 1.5_f64.sqrt()).abs() < 1e-9);
        assert!((tensile[2] - 6.0_f64.sqrt()).abs() < 1e-9, "{tensile:?}");
    }

    #[test]
    fn plane_stress_meets_the_uniaxial_strengths_and_is_open_where_nothing_fails() {
        let friction_angle_rad = FRAC_PI_6;
        let cone = criterion(Strength::MohrCoulomb { cohesion_pa: K, friction_angle_rad });
        let points = plane_stress_section(&cone, 8, 10.0 * K).unwrap();
        let (tension, compression) = (2.0 * K / 3.0_f64.sqrt(), 2.0 * K * 3.0_f64.sqrt());
        let expected = [
            (0, tension, 0.0),
            (1, tension, tension),
            (4, -compression, 0.0),
            (5, -compression, -compression),
        ];
        for (index, s1, s2) in expected {
            let found = points[index].unwrap() - DVec3::new(s1, s2, 0.0);
            assert!(found.length() < 1e-6, "{index}: {found}");
        }
        let tensile = criterion(Strength::Tensile { tensile_strength_pa: K });
        let open = plane_stress_section(&tensile, 8, 10.0 * K).unwrap();
        assert_eq!(
            open.iter().map(Option::is_some).collect::<Vec<_>>(),
            [true, true, true, true, false, false, false, true]
        );
        let found = distance_along_pa(&cone, DVec3::ZERO, DVec3::NEG_X).unwrap().unwrap();
        assert!((found - compression).abs() < 1e-6);
        assert_eq!(distance_along_pa(&tensile, DVec3::ZERO, DVec3::NEG_X).unwrap(), None);
    }

    #[test]
    fn meridians_are_straight_and_end_at_the_apex() {
        let friction_angle_rad = 0.5;
        let cone = criterion(Strength::MohrCoulomb { cohesion_pa: K, friction_angle_rad });
        for angle_rad in [0.0, FRAC_PI_3] {
            let points = meridian(&cone, angle_rad, 9, &RANGE).unwrap();
            let [apex_pa, at_apex_pa] = *points.last().unwrap();
            assert!((apex_pa - K / friction_angle_rad.tan()).abs() < 1e-3, "{apex_pa}");
            assert!(at_apex_pa < 1e-3);
            let [first, middle] = [points[0][1], points[4][1]];
            assert!((first - 2.0 * middle).abs() < 1e-6 * first);
        }
    }

    #[test]
    fn places_in_stress_space_read_back() {
        for (mean_pa, distance_pa, angle_rad) in [(0.0, 2.0, 0.3), (-3.0, 1.0, 0.0), (5.0, 4.0, FRAC_PI_3)] {
            let point_pa = principal_point_pa(mean_pa, distance_pa, angle_rad);
            assert!(point_pa.x >= point_pa.y - 1e-12 && point_pa.y >= point_pa.z - 1e-12);
            let found = principal_place(point_pa);
            for (found, put) in [(found.0, mean_pa), (found.1, distance_pa), (found.2, angle_rad)] {
                assert!((found - put).abs() < 1e-12, "{found} {put}");
            }
        }
    }

    #[test]
    fn the_envelope_of_circles_is_mohr_coulombs_line_and_level_for_von_mises() {
        let friction_angle_rad = FRAC_PI_6;
        let cone = criterion(Strength::MohrCoulomb { cohesion_pa: K, friction_angle_rad });
        for angle_rad in [0.0, 0.4, FRAC_PI_3] {
            let line = mohr_envelope(&cone, angle_rad, 30, &RANGE).unwrap();
            assert!(line.len() > 20);
            for [sigma, tau] in line {
                let expected = K - sigma * friction_angle_rad.tan();
                assert!((tau - expected).abs() < 1e-6 * expected.abs().max(K), "{sigma} {tau} {expected}");
            }
        }
        // Pure shear of k fails von Mises; all its circles at that angle have this radius.
        let mises = criterion(Strength::VonMises { shear_strength_pa: K });
        let level = mohr_envelope(&mises, FRAC_PI_6, 10, &RANGE).unwrap();
        assert!(level.len() == 9 && level.iter().all(|[_, tau]| (tau - K).abs() < 1e-3), "{level:?}");
    }

    /// A formula with a corner: level as von Mises is, then around the last circle that tension allows, to its strength.
    #[test]
    fn the_envelope_goes_around_corners_on_the_circle_there() {
        use crate::fracture::Formula;
        let formula = Formula::new("max(s1 - F, sqrt(J2) - K)", &[("F", 0.5 * K), ("K", K)]).unwrap();
        let line = mohr_envelope(&criterion(Strength::Formula(formula)), FRAC_PI_6, 200, &RANGE).unwrap();
        // At this angle s2 lies in the middle: the corner's circle has radius k and ends at the tensile strength.
        let corner = -0.5 * K;
        let (mut is_level, mut on_arc) = (false, 0);
        for [sigma, tau] in line {
            if sigma < corner - 0.1 * K {
                assert!((tau - K).abs() < 1e-6 * K);
                is_level = true;
            } else if sigma > corner + 0.1 * K {
                assert!(((sigma - corner).hypot(tau) / K - 1.0).abs() < 0.06, "{sigma} {tau}");
                on_arc += u32::from(tau > 0.1 * K);
            }
        }
        assert!(is_level && on_arc > 5, "{on_arc}");
        // By tension alone all circles touch in one point.
        let formula = Formula::new("s1 - F", &[("F", K)]).unwrap();
        let line = mohr_envelope(&criterion(Strength::Formula(formula)), 0.3, 30, &RANGE).unwrap();
        assert!(line.len() > 20);
        assert!(line.iter().all(|[sigma, tau]| (sigma - K).hypot(*tau) < 1e-3 * K), "{line:?}");
    }

    #[test]
    fn meshes_look_outward_and_leave_out_what_is_out_of_reach() {
        let mesh =
            envelope_mesh(&criterion(Strength::VonMises { shear_strength_pa: K }), [3, 24], &RANGE).unwrap();
        assert_eq!((mesh.points_pa.len(), mesh.triangles.len()), (72, 96));
        for triangle in &mesh.triangles {
            let [a, b, c] = triangle.map(|index| mesh.points_pa[index as usize]);
            let outward = (a + b + c) / 3.0 - DVec3::splat((a + b + c).element_sum() / 9.0);
            assert!((b - a).cross(c - a).dot(outward) > 0.0);
        }
        let near = DrawnRange { reach_pa: 0.5 * K, ..RANGE };
        let none =
            envelope_mesh(&criterion(Strength::Tresca { shear_strength_pa: K }), [3, 24], &near).unwrap();
        assert!(none.triangles.is_empty());
    }
}
