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
    fn closest_points_of_two_skew_lines() {
        let p = [DVec3::new(-1.0, 0.0, 1.0), DVec3::new(1.0, 0.0, 1.0)];
        let q = [DVec3::new(0.0, -1.0, 0.0), DVec3::new(0.0, 3.0, 0.0)];
        let (s, t) = closest_on_lines(p, q).unwrap();
        assert!((s - 0.5).abs() < 1e-15 && (t - 0.25).abs() < 1e-15);
        assert!(closest_on_lines(p, p).is_none());
    }
}
