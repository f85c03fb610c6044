//! Small geometry shared by detection and response.

use glam::DVec3;

/// Barycentric coordinates `(t0, t1, t2)` of the foot of the perpendicular from `p` on the plane of
/// the triangle; they sum to one and may lie outside [0, 1]. `None` for a triangle without area.
#[must_use]
pub fn barycentric(p: DVec3, triangle: [DVec3; 3]) -> Option<[f64; 3]> {
    let [a, b, c] = triangle;
    let (ab, ac, ap) = (b - a, c - a, p - a);
    let normal = ab.cross(ac);
    let area2 = normal.length_squared();
    if area2 <= 0.0 || !area2.is_finite() {
        return None;
    }
    let t1 = ap.cross(ac).dot(normal) / area2;
    let t2 = ab.cross(ap).dot(normal) / area2;
    Some([1.0 - t1 - t2, t1, t2])
}

/// Outward unit normal of a counter-clockwise triangle; zero for one without area.
#[must_use]
pub fn unit_normal(triangle: [DVec3; 3]) -> DVec3 {
    let [a, b, c] = triangle;
    (b - a).cross(c - a).normalize_or_zero()
}

/// Parameters `(s, t)` of the closest points of the lines `p0 + s (p1-p0)` and `q0 + t (q1-q0)`;
/// `None` for lines that are parallel within about 1e-5 rad, where the points are not unique.
#[must_use]
pub fn closest_on_lines(p: [DVec3; 2], q: [DVec3; 2]) -> Option<(f64, f64)> {
    let (d1, d2, r) = (p[1] - p[0], q[1] - q[0], p[0] - q[0]);
    let (a, b, e) = (d1.dot(d1), d1.dot(d2), d2.dot(d2));
    let denominator = a * e - b * b;
    if denominator <= 1e-10 * a * e {
        return None;
    }
    let (c, f) = (d1.dot(r), d2.dot(r));
    Some(((b * f - c * e) / denominator, (a * f - b * c) / denominator))
}

/// Distance of two segments from each other, of any length but zero; that of nearly parallel ones, as in
/// [`closest_on_lines`], may be too large by 1e-5 of their length.
#[must_use]
pub fn distance_of_segments(p: [DVec3; 2], q: [DVec3; 2]) -> f64 {
    let inside = 0.0..=1.0;
    if let Some((s, t)) = closest_on_lines(p, q)
        && inside.contains(&s)
        && inside.contains(&t)
    {
        return p[0].lerp(p[1], s).distance(q[0].lerp(q[1], t));
    }
    let from_ends = |ends: [DVec3; 2], [a, b]: [DVec3; 2]| {
        let along = b - a;
        ends.map(|x| {
            let share = (x - a).dot(along) / along.length_squared();
            x.distance_squared(a + along * share.clamp(0.0, 1.0))
        })
    };
    let [[a, b], [c, d]] = [from_ends(p, q), from_ends(q, p)];
    a.min(b).min(c).min(d).sqrt()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn barycentric_of_a_point_above_a_triangle() {
        let triangle = [DVec3::ZERO, DVec3::X * 2.0, DVec3::Y * 4.0];
        let [t0, t1, t2] = barycentric(DVec3::new(0.5, 1.0, 7.0), triangle).unwrap();
        assert!((t0 - 0.5).abs() < 1e-15 && (t1 - 0.25).abs() < 1e-15 && (t2 - 0.25).abs() < 1e-15);
        assert!(barycentric(DVec3::X, [DVec3::ZERO, DVec3::X, DVec3::X * 2.0]).is_none());
    }

    #[test]
    fn segments_are_as_far_apart_as_their_nearest_points() {
        let p = [DVec3::ZERO, DVec3::X];
        let at = |a: [f64; 3], b: [f64; 3]| distance_of_segments(p, [a, b].map(DVec3::from_array));
        assert!((at([0.5, -1.0, 0.3], [0.5, 1.0, 0.3]) - 0.3).abs() < 1e-15, "crossing");
        assert!((at([0.25, 0.2, 0.0], [0.75, 0.2, 0.0]) - 0.2).abs() < 1e-15, "side by side");
        assert!((at([4.0, 4.0, 0.0], [9.0, 4.0, 0.0]) - 5.0).abs() < 1e-15, "parallel, one behind the other");
        assert!(
            (at([0.5, 0.1, 0.0], [0.5, 3.0, 0.0]) - 0.1).abs() < 1e-15,
            "an end beside the other's middle"
        );
        assert!((at([1.3, -1.0, 0.4], [1.3, 1.0, 0.4]) - 0.5).abs() < 1e-15, "beyond an end");
    }

    #[test]
    fn closest_points_of_two_skew_lines() {
        let p = [DVec3::new(-1.0, 0.0, 1.0), DVec3::new(1.0, 0.0, 1.0)];
        let q = [DVec3::new(0.0, -1.0, 0.0), DVec3::new(0.0, 3.0, 0.0)];
        let (s, t) = closest_on_lines(p, q).unwrap();
        assert!((s - 0.5).abs() < 1e-15 && (t - 0.25).abs() < 1e-15);
        assert!(closest_on_lines(p, p).is_none());
    }
}
