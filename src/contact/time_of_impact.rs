//! When do four moving points become coplanar? The exact beginning of a collision.
//!
//! Node-triangle and edge-edge contact both begin when four points that move along straight lines
//! during a step lie in one plane (METHOD 4.2, pattern 2; pattern 1, a patch at rest, is the special
//! case in which three of them stand still). The volume `(x1-x0) x (x2-x0) . (x3-x0)` is a cubic in
//! the fraction tau of the step; its roots in [0, 1] are bracketed between its turning points and
//! closed in by bisection-safeguarded Newton iteration to about 1e-15 of the step.

use super::geometry::{barycentric, closest_on_lines};
use glam::DVec3;

/// Share of a feature by which its border still counts as inside; keeps nodes that run exactly along
/// an edge from falling between two patches by round-off.
pub const BORDER: f64 = 1e-6;

/// A point that moves on a straight line: where it starts and by how much it moves.
#[derive(Clone, Copy, Debug)]
pub struct Moving {
    /// Position at the start, m.
    pub start_m: DVec3,
    /// Displacement over the step, m.
    pub move_m: DVec3,
}

impl Moving {
    /// From the two ends of the path.
    #[must_use]
    pub fn between(start_m: DVec3, end_m: DVec3) -> Self {
        Self { start_m, move_m: end_m - start_m }
    }

    /// Position at fraction `tau` of the step, m.
    #[must_use]
    pub fn at(&self, tau: f64) -> DVec3 {
        self.start_m + self.move_m * tau
    }
}

/// Coefficients `c0 + c1 tau + c2 tau^2 + c3 tau^3` of the volume spanned by four moving points.
fn coplanarity_cubic(points: &[Moving; 4]) -> [f64; 4] {
    let [o, p, q, r] = points;
    let edge = |m: &Moving| (m.start_m - o.start_m, m.move_m - o.move_m);
    let ((a, da), (b, db), (c, dc)) = (edge(p), edge(q), edge(r));
    let triple = |x: DVec3, y: DVec3, z: DVec3| x.cross(y).dot(z);
    [
        triple(a, b, c),
        triple(da, b, c) + triple(a, db, c) + triple(a, b, dc),
        triple(da, db, c) + triple(da, b, dc) + triple(a, db, dc),
        triple(da, db, dc),
    ]
}

fn value(c: &[f64; 4], tau: f64) -> f64 {
    ((c[3] * tau + c[2]) * tau + c[1]) * tau + c[0]
}

fn slope(c: &[f64; 4], tau: f64) -> f64 {
    (3.0 * c[3] * tau + 2.0 * c[2]) * tau + c[1]
}

/// Turning points of the cubic inside (0, 1), ascending.
fn turning_points(c: &[f64; 4]) -> impl Iterator<Item = f64> {
    let (a, b, k) = (3.0 * c[3], 2.0 * c[2], c[1]);
    let discriminant = b * b - 4.0 * a * k;
    let mut roots = [f64::NAN; 2];
    if discriminant >= 0.0 {
        // The form without cancellation; a = 0 or q = 0 gives an infinite or NaN root, dropped below.
        let q = -0.5 * (b + discriminant.sqrt().copysign(b));
        roots = [q / a, k / q];
        if roots[0] > roots[1] {
            roots.swap(0, 1);
        }
    }
    roots.into_iter().filter(|t| *t > 0.0 && *t < 1.0)
}

/// Root in a bracket whose ends differ in sign.
fn close_in(c: &[f64; 4], mut low: f64, mut high: f64) -> f64 {
    let rising = value(c, high) > value(c, low);
    let mut tau = 0.5 * (low + high);
    for _ in 0..80 {
        let f = value(c, tau);
        if f == 0.0 || high - low <= 1e-16 {
            break;
        }
        if (f > 0.0) == rising {
            high = tau;
        } else {
            low = tau;
        }
        let newton = tau - f / slope(c, tau);
        let next = if newton > low && newton < high { newton } else { 0.5 * (low + high) };
        if (next - tau).abs() <= 1e-16 {
            break;
        }
        tau = next;
    }
    tau
}

/// All fractions of the step at which the four points are coplanar, ascending; none when they stay
/// coplanar throughout.
#[must_use]
pub fn coplanar_fractions(points: &[Moving; 4]) -> Vec<f64> {
    let c = coplanarity_cubic(points);
    let mut knots = vec![0.0];
    knots.extend(turning_points(&c));
    knots.push(1.0);
    let mut roots: Vec<f64> = Vec::new();
    for pair in knots.windows(2) {
        let (low, high) = (pair[0], pair[1]);
        let (f_low, f_high) = (value(&c, low), value(&c, high));
        if f_low == 0.0 && c[1..].iter().any(|k| *k != 0.0) {
            roots.push(low);
        } else if f_low * f_high < 0.0 {
            roots.push(close_in(&c, low, high));
        }
    }
    if value(&c, 1.0) == 0.0 && c.iter().any(|k| *k != 0.0) {
        roots.push(1.0);
    }
    roots
}

/// First fraction of the step at which the node goes through the triangle from outside.
///
/// `triangle` is counter-clockwise seen from outside. Returns the fraction and the barycentric
/// coordinates of the meeting point.
#[must_use]
pub fn node_meets_triangle(node: Moving, triangle: [Moving; 3]) -> Option<(f64, [f64; 3])> {
    let [a, b, c] = triangle;
    coplanar_fractions(&[a, b, c, node]).into_iter().find_map(|tau| {
        let corners = [a.at(tau), b.at(tau), c.at(tau)];
        let weights = barycentric(node.at(tau), corners)?;
        let normal = (corners[1] - corners[0]).cross(corners[2] - corners[0]);
        let patch_move = a.move_m * weights[0] + b.move_m * weights[1] + c.move_m * weights[2];
        let closing = (node.move_m - patch_move).dot(normal) < 0.0;
        (closing && weights.iter().all(|w| *w >= -BORDER)).then_some((tau, weights))
    })
}

/// First fraction of the step at which two edges meet, with the parameters along both.
///
/// Which side is outside is the caller's to know: any crossing is reported.
#[must_use]
pub fn edge_meets_edge(p: [Moving; 2], q: [Moving; 2]) -> Option<(f64, f64, f64)> {
    coplanar_fractions(&[p[0], p[1], q[0], q[1]]).into_iter().find_map(|tau| {
        let ends_p = [p[0].at(tau), p[1].at(tau)];
        let ends_q = [q[0].at(tau), q[1].at(tau)];
        let (s, t) = closest_on_lines(ends_p, ends_q)?;
        let inside = |k: f64| (-BORDER..=1.0 + BORDER).contains(&k);
        (inside(s) && inside(t)).then_some((tau, s, t))
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn still(x: DVec3) -> Moving {
        Moving { start_m: x, move_m: DVec3::ZERO }
    }

    fn floor() -> [Moving; 3] {
        [still(DVec3::ZERO), still(DVec3::X), still(DVec3::Y)]
    }

    #[test]
    fn falling_node_meets_the_floor_where_and_when_it_must() {
        let node = Moving::between(DVec3::new(0.25, 0.25, 3.0), DVec3::new(0.25, 0.25, -1.0));
        let (tau, weights) = node_meets_triangle(node, floor()).unwrap();
        assert!((tau - 0.75).abs() < 1e-15);
        assert!((weights[0] - 0.5).abs() < 1e-12);
    }

    #[test]
    fn node_that_leaves_or_passes_beside_does_not_meet() {
        let leaving = Moving::between(DVec3::new(0.2, 0.2, -1.0), DVec3::new(0.2, 0.2, 1.0));
        assert!(node_meets_triangle(leaving, floor()).is_none());
        let beside = Moving::between(DVec3::new(0.8, 0.8, 1.0), DVec3::new(0.8, 0.8, -1.0));
        assert!(node_meets_triangle(beside, floor()).is_none());
    }

    #[test]
    fn roots_of_random_motions_are_roots_and_none_is_lost() {
        // Against a dense sampling of the sign of the volume; fixed seed.
        let mut state = 0x9E37_79B9_7F4A_7C15_u64;
        let mut random = move || {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            ((state >> 11) as f64) / ((1_u64 << 53) as f64) * 2.0 - 1.0
        };
        let mut found = 0;
        for _ in 0..500 {
            let mut point = || Moving {
                start_m: DVec3::new(random(), random(), random()),
                move_m: DVec3::new(random(), random(), random()) * 3.0,
            };
            let points = [point(), point(), point(), point()];
            let c = coplanarity_cubic(&points);
            let roots = coplanar_fractions(&points);
            let scale: f64 = c.iter().map(|k| k.abs()).sum();
            assert!(roots.iter().all(|tau| value(&c, *tau).abs() < 1e-13 * scale));
            let n = 2000;
            let changes = (0..n)
                .filter(|i| {
                    let at = |i: i32| value(&c, f64::from(i) / f64::from(n));
                    at(*i) * at(i + 1) < 0.0
                })
                .count();
            assert_eq!(changes, roots.len(), "cubic {c:?}");
            found += changes;
        }
        assert!(found > 200, "the sample must contain roots: {found}");
    }

    #[test]
    fn fast_spinning_triangle_catches_a_still_node() {
        // The triangle sweeps past the node within one step: only the moving-patch form sees it.
        let node = still(DVec3::new(0.2, 0.2, 0.0));
        let moving = floor().map(|m| Moving { start_m: m.start_m - DVec3::Z * 5.0, move_m: DVec3::Z * 10.0 });
        let (tau, _) = node_meets_triangle(node, moving).unwrap();
        assert!((tau - 0.5).abs() < 1e-15);
    }

    #[test]
    fn crossing_edges_meet_in_the_middle() {
        let p = [DVec3::new(-1.0, 0.0, 1.0), DVec3::new(1.0, 0.0, 1.0)]
            .map(|x| Moving::between(x, x - DVec3::Z * 2.0));
        let q = [still(DVec3::new(0.0, -1.0, 0.0)), still(DVec3::new(0.0, 1.0, 0.0))];
        let (tau, s, t) = edge_meets_edge(p, q).unwrap();
        assert!((tau - 0.5).abs() < 1e-14 && (s - 0.5).abs() < 1e-14 && (t - 0.5).abs() < 1e-14);
    }
}
