//! Rotation increments and best-fit rotations.

use glam::{DMat3, DQuat, DVec3, DVec4};

/// Gap between quaternion eigenvalues, relative to the largest, under which their directions count
/// as equally good fits: smaller values make a degenerate fit jump with round-off.
const EQUAL_FIT: f64 = 1e-12;
/// Jacobi sweeps of the 4x4 problem; from a warm start 3 or 4 are needed.
const MAX_SWEEPS: usize = 20;

/// The one rotation that equals simultaneous constant-rate sub-rotations by `vector_rad` about the
/// three axes (METHOD 1, Theorem 1): about `vector_rad` by the angle `|vector_rad|`.
///
/// `q = (n sin(t/2), cos(t/2))`. Advance an orientation by `rotation_from_vector(spin * h) * world_from_body`.
#[must_use]
pub fn rotation_from_vector(vector_rad: DVec3) -> DQuat {
    let half = 0.5 * vector_rad.length();
    // sin(x)/x by its series near zero; both branches agree to round-off at the border.
    let half_sinc = if half < 1e-4 { 0.5 * (1.0 - half * half / 6.0) } else { 0.5 * half.sin() / half };
    let axis = vector_rad * half_sinc;
    DQuat::from_xyzw(axis.x, axis.y, axis.z, half.cos()).normalize()
}

/// The matrix `[v]x` with `[v]x a = v x a`.
#[must_use]
pub fn skew(v: DVec3) -> DMat3 {
    DMat3::from_cols(DVec3::new(0.0, v.z, -v.y), DVec3::new(-v.z, 0.0, v.x), DVec3::new(v.y, -v.x, 0.0))
}

/// The rotation `R` that maximises `R : A`, for `A = sum_i m_i x_i X_i^T` the one that fits
/// `x_i = R X_i` best by mass-weighted least squares; for `A = R S` with `S` positive definite, the polar factor.
///
/// Found as the top eigenvector of a symmetric 4x4 matrix (B. K. P. Horn, J. Opt. Soc. Am. A 4, 1987), seen
/// from `warm_start`. This is the maximum over all rotations, inverted `A` included. Where several
/// rotations fit equally well (`A` of rank one or zero, or symmetric and inverted) it is the one nearest to
/// `warm_start`. If `A` is not finite, `warm_start` comes back.
#[must_use]
pub fn best_fit_rotation(matrix: &DMat3, warm_start: DQuat) -> DQuat {
    let seen = DMat3::from_quat(warm_start).transpose() * *matrix;
    let scale = seen.to_cols_array().iter().fold(0.0, |m: f64, x| m.max(x.abs()));
    if !seen.is_finite() || scale == 0.0 {
        return warm_start;
    }
    let (values, vectors) = jacobi4(horn_matrix(&(seen * (1.0 / scale))));
    let top = values.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    // The identity quaternion (x, y, z, w) = (0, 0, 0, 1) projected on the space of best fits.
    let nearest: DVec4 =
        (0..4).filter(|&i| top - values[i] <= EQUAL_FIT).map(|i| vectors[i] * vectors[i].w).sum();
    let best = if nearest.length_squared() > EQUAL_FIT * EQUAL_FIT {
        nearest
    } else {
        // Exactly half a turn away: every sign is equally near.
        (0..4).rev().find(|&i| values[i] == top).map_or(DVec4::W, |i| vectors[i])
    };
    (warm_start * DQuat::from_vec4(best.normalize())).normalize()
}

/// Horn's matrix in the order (x, y, z, w): `q^T N q = R(q) : A`.
fn horn_matrix(a: &DMat3) -> [[f64; 4]; 4] {
    let trace = a.x_axis.x + a.y_axis.y + a.z_axis.z;
    let symmetric = *a + a.transpose() - DMat3::from_diagonal(DVec3::splat(trace));
    let axial = DVec3::new(a.y_axis.z - a.z_axis.y, a.z_axis.x - a.x_axis.z, a.x_axis.y - a.y_axis.x);
    let row = |r: usize| {
        let [x, y, z] = symmetric.col(r).to_array();
        [x, y, z, axial[r]]
    };
    [row(0), row(1), row(2), axial.extend(trace).to_array()]
}

/// Eigenvalues and eigenvectors of a symmetric 4x4 matrix by cyclic Jacobi, unsorted.
fn jacobi4(mut a: [[f64; 4]; 4]) -> ([f64; 4], [DVec4; 4]) {
    let mut vectors = [DVec4::X, DVec4::Y, DVec4::Z, DVec4::W];
    for _ in 0..MAX_SWEEPS {
        let mut still = true;
        for p in 0..3 {
            for q in p + 1..4 {
                still &= !jacobi4_rotate(&mut a, &mut vectors, p, q);
            }
        }
        if still {
            break;
        }
    }
    ([a[0][0], a[1][1], a[2][2], a[3][3]], vectors)
}

/// One Jacobi rotation; false if the entry was zero already.
fn jacobi4_rotate(a: &mut [[f64; 4]; 4], vectors: &mut [DVec4; 4], p: usize, q: usize) -> bool {
    if a[p][q].abs() < 1e-300 {
        return false;
    }
    let theta = (a[q][q] - a[p][p]) / (2.0 * a[p][q]);
    let tangent = theta.signum() / (theta.abs() + theta.hypot(1.0));
    let cosine = 1.0 / tangent.hypot(1.0);
    let sine = tangent * cosine;
    let shift = tangent * a[p][q];
    a[p][p] -= shift;
    a[q][q] += shift;
    a[p][q] = 0.0;
    a[q][p] = 0.0;
    for r in (0..4).filter(|&r| r != p && r != q) {
        let (rp, rq) = (a[r][p], a[r][q]);
        a[r][p] = cosine * rp - sine * rq;
        a[r][q] = sine * rp + cosine * rq;
        a[p][r] = a[r][p];
        a[q][r] = a[r][q];
    }
    let (vp, vq) = (vectors[p], vectors[q]);
    vectors[p] = vp * cosine - vq * sine;
    vectors[q] = vp * sine + vq * cosine;
    true
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn vector(limit: f64) -> impl Strategy<Value = DVec3> {
        prop::array::uniform3(-limit..limit).prop_map(DVec3::from_array)
    }

    fn angle_between_rad(a: DQuat, b: DQuat) -> f64 {
        2.0 * (a.inverse() * b).xyz().length().min(1.0).asin()
    }

    proptest! {
        #[test]
        fn increment_solves_constant_spin(spin in vector(5.0), x in vector(2.0)) {
            // dx/dt = w x x, integrated by many small exact steps, equals one big one.
            let small = rotation_from_vector(spin / 64.0);
            let stepped = (0..64).fold(x, |x, _| small * x);
            prop_assert!((stepped - rotation_from_vector(spin) * x).length() < 1e-13);
            // The derivative at zero is w x x (checks sign and half angle).
            let h = 1e-6;
            let derivative = (rotation_from_vector(spin * h) * x - rotation_from_vector(-spin * h) * x) / (2.0 * h);
            prop_assert!((derivative - spin.cross(x)).length() < 1e-8);
            prop_assert!((skew(spin) * x - spin.cross(x)).length() < 1e-14);
        }

        #[test]
        fn best_fit_recovers_the_polar_rotation(turn in vector(3.0), start in vector(3.0), stretch in vector(1.0), shear in vector(3.0)) {
            let rotation = rotation_from_vector(turn);
            let axes = DMat3::from_quat(rotation_from_vector(shear));
            let stretch = stretch.map(|x| 10f64.powf(x));
            let matrix = DMat3::from_quat(rotation) * axes * DMat3::from_diagonal(stretch) * axes.transpose();
            let found = best_fit_rotation(&matrix, rotation_from_vector(start));
            prop_assert!(angle_between_rad(found, rotation) < 1e-12, "{}", angle_between_rad(found, rotation));
        }

        #[test]
        fn best_fit_beats_other_rotations_for_any_matrix(entries in prop::array::uniform9(-1.0..1.0f64), start in vector(3.0), other in vector(3.0)) {
            let matrix = DMat3::from_cols_array(&entries);
            let fit = |q: DQuat| {
                let r = DMat3::from_quat(q).to_cols_array();
                r.iter().zip(entries).map(|(a, b)| a * b).sum::<f64>()
            };
            let best = best_fit_rotation(&matrix, rotation_from_vector(start));
            prop_assert!(fit(best) >= fit(rotation_from_vector(other)) - 1e-14);
            prop_assert!((best.length() - 1.0).abs() < 1e-15);
        }
    }

    #[test]
    fn degenerate_fits_stay_near_the_warm_start() {
        let start = rotation_from_vector(DVec3::new(0.4, -0.2, 1.0));
        assert_eq!(best_fit_rotation(&DMat3::ZERO, start), start);
        assert_eq!(best_fit_rotation(&DMat3::from_diagonal(DVec3::NAN), start), start);
        // All nodes on the body's x axis, now along y: turn x to y, and no more than that.
        let line = DMat3::from_cols(DVec3::Y, DVec3::ZERO, DVec3::ZERO);
        let turned = best_fit_rotation(&line, start);
        assert!((turned * DVec3::X - DVec3::Y).length() < 1e-14);
        let needed_rad = (start * DVec3::X).angle_between(DVec3::Y);
        assert!((angle_between_rad(turned, start) - needed_rad).abs() < 1e-12);
        // A line turned over by half a turn: any answer that fits is right.
        let over = best_fit_rotation(&DMat3::from_cols(-DVec3::X, DVec3::ZERO, DVec3::ZERO), DQuat::IDENTITY);
        assert!((over * DVec3::X + DVec3::X).length() < 1e-14);
        // A flat set of nodes (rank two) still has one best rotation.
        let flat = DMat3::from_quat(start) * DMat3::from_diagonal(DVec3::new(2.0, 1.0, 0.0));
        assert!(angle_between_rad(best_fit_rotation(&flat, DQuat::IDENTITY), start) < 1e-14);
    }
}
