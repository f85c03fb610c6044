//! Eigenvalues and directions of symmetric 3x3 matrices: `A v_i = s_i v_i`, `s_1 >= s_2 >= s_3`.
//!
//! Cyclic Jacobi in a fixed order (G. H. Golub, C. F. Van Loan, *Matrix Computations*, section 8.5):
//! backward stable, exact on diagonal input, indifferent to repeated eigenvalues, where the closed
//! cubic formula loses half the digits.

use glam::{DMat3, DVec3};

/// Sweeps after which the off-diagonal part is below round-off for any 3x3 input; 6 or 7 are seen.
const MAX_SWEEPS: usize = 16;

/// Eigenvalues, largest first, and the unit directions belonging to them.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SymmetricEigen {
    /// `s_1 >= s_2 >= s_3`.
    pub values: DVec3,
    /// Columns are the directions `v_1, v_2, v_3`: orthonormal and right-handed.
    pub directions: DMat3,
}

impl SymmetricEigen {
    /// `sum_i s_i v_i v_i^T`: the matrix it came from.
    #[must_use]
    pub fn matrix(&self) -> DMat3 {
        self.directions * DMat3::from_diagonal(self.values) * self.directions.transpose()
    }
}

/// Eigenvalues and directions of a symmetric matrix; of `matrix`, the lower triangle is read.
///
/// Input that is not finite gives output that is not finite, never an endless loop.
#[must_use]
pub fn symmetric_eigen(matrix: &DMat3) -> SymmetricEigen {
    let mut work = Jacobi::new(matrix, DMat3::IDENTITY);
    work.run();
    work.sorted()
}

/// The eigenvalues alone, `s_1 >= s_2 >= s_3`.
#[must_use]
pub fn symmetric_eigenvalues(matrix: &DMat3) -> DVec3 {
    symmetric_eigen(matrix).values
}

/// The eigenvalues to about eight digits of the largest, by the closed formula: several times faster than
/// [`symmetric_eigenvalues`]; for looking whether a closer look is worth it. Of `matrix`, the lower triangle is read.
#[must_use]
pub fn symmetric_eigenvalues_estimate(matrix: &DMat3) -> DVec3 {
    let (x, y, z) = (matrix.x_axis, matrix.y_axis, matrix.z_axis);
    let mean = (x.x + y.y + z.z) / 3.0;
    let diagonal = DVec3::new(x.x, y.y, z.z) - mean;
    let off = DVec3::new(x.y, x.z, y.z);
    let size = ((diagonal.length_squared() + 2.0 * off.length_squared()) / 6.0).sqrt();
    if size == 0.0 {
        return DVec3::splat(mean);
    }
    let (d, o) = (diagonal / size, off / size);
    let determinant =
        d.x * (d.y * d.z - o.z * o.z) - o.x * (o.x * d.z - o.z * o.y) + o.y * (o.x * o.z - d.y * o.y);
    let angle = (0.5 * determinant).clamp(-1.0, 1.0).acos() / 3.0;
    let largest = 2.0 * angle.cos();
    let smallest = 2.0 * (angle + std::f64::consts::TAU / 3.0).cos();
    DVec3::splat(mean) + DVec3::new(largest, -largest - smallest, smallest) * size
}

struct Jacobi {
    diagonal: [f64; 3],
    /// Entries (0,1), (0,2), (1,2).
    off: [f64; 3],
    directions: [DVec3; 3],
}

impl Jacobi {
    fn new(matrix: &DMat3, directions: DMat3) -> Self {
        let (x, y, z) = (matrix.x_axis, matrix.y_axis, matrix.z_axis);
        Self {
            diagonal: [x.x, y.y, z.z],
            off: [x.y, x.z, y.z],
            directions: [directions.x_axis, directions.y_axis, directions.z_axis],
        }
    }

    fn run(&mut self) {
        for _ in 0..MAX_SWEEPS {
            if self.off == [0.0; 3] {
                return;
            }
            self.rotate(0, 1);
            self.rotate(0, 2);
            self.rotate(1, 2);
        }
    }

    /// Makes the entry (p, q), p < q, zero.
    fn rotate(&mut self, p: usize, q: usize) {
        let entry = p + q - 1;
        let off = self.off[entry];
        if off == 0.0 {
            return;
        }
        let scale = self.diagonal[p].abs().min(self.diagonal[q].abs());
        if off.abs() <= f64::EPSILON * f64::EPSILON * scale {
            self.off[entry] = 0.0;
            return;
        }
        let theta = (self.diagonal[q] - self.diagonal[p]) / (2.0 * off);
        let tangent = theta.signum() / (theta.abs() + (theta * theta + 1.0).sqrt());
        let cosine = 1.0 / (tangent * tangent + 1.0).sqrt();
        let sine = tangent * cosine;
        self.diagonal[p] -= tangent * off;
        self.diagonal[q] += tangent * off;
        self.off[entry] = 0.0;
        // The third index r couples to p and q through the entries (r, p) and (r, q).
        let r = 3 - p - q;
        let (rp, rq) = (r + p - 1, r + q - 1);
        let (old_rp, old_rq) = (self.off[rp], self.off[rq]);
        self.off[rp] = cosine * old_rp - sine * old_rq;
        self.off[rq] = sine * old_rp + cosine * old_rq;
        let (old_p, old_q) = (self.directions[p], self.directions[q]);
        self.directions[p] = cosine * old_p - sine * old_q;
        self.directions[q] = sine * old_p + cosine * old_q;
    }

    fn sorted(&self) -> SymmetricEigen {
        let mut order = [0, 1, 2];
        order.sort_by(|&a, &b| self.diagonal[b].total_cmp(&self.diagonal[a]));
        let [first, second, third] = order.map(|index| self.diagonal[index]);
        let v1 = self.directions[order[0]].normalize_or(DVec3::X);
        let v2 = self.directions[order[1]];
        // One Gram-Schmidt step takes out the round-off of the products of rotations.
        let v2 = (v2 - v1 * v1.dot(v2)).normalize_or(v1.any_orthonormal_vector());
        SymmetricEigen {
            values: DVec3::new(first, second, third),
            directions: DMat3::from_cols(v1, v2, v1.cross(v2)),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::rotation_from_vector;
    use proptest::prelude::*;

    fn largest_entry(matrix: &DMat3) -> f64 {
        matrix.to_cols_array().iter().fold(0.0, |largest, x| f64::max(largest, x.abs()))
    }

    fn assert_sound(matrix: &DMat3) {
        let eigen = symmetric_eigen(matrix);
        let scale = largest_entry(matrix).max(f64::MIN_POSITIVE);
        assert!(eigen.values.x >= eigen.values.y && eigen.values.y >= eigen.values.z);
        assert!(largest_entry(&(eigen.matrix() - *matrix)) <= 4e-15 * scale, "{matrix:?}");
        let gram = eigen.directions.transpose() * eigen.directions;
        assert!(largest_entry(&(gram - DMat3::IDENTITY)) < 3e-15);
        assert!((eigen.directions.determinant() - 1.0).abs() < 3e-15);
    }

    proptest! {
        #[test]
        fn rebuilds_any_symmetric_matrix(entries in prop::array::uniform6(-1e3..1e3f64), exponent in -200..200i32) {
            let [a, b, c, d, e, f] = entries.map(|x| x * 10f64.powi(exponent));
            assert_sound(&DMat3::from_cols_array(&[a, d, e, d, b, f, e, f, c]));
        }

        #[test]
        fn finds_prescribed_values_even_repeated_or_tiny(
            turn in prop::array::uniform3(-3.0..3.0f64), choice in prop::array::uniform3(0usize..6),
        ) {
            let values = choice.map(|index| [0.0, 1.0, 1.0 + 1e-14, -2.0, 1e-13, 3e8][index]);
            let rotation = DMat3::from_quat(rotation_from_vector(DVec3::from_array(turn)));
            let matrix = rotation * DMat3::from_diagonal(DVec3::from_array(values)) * rotation.transpose();
            let symmetric = (matrix + matrix.transpose()) * 0.5;
            assert_sound(&symmetric);
            let mut expected = values;
            expected.sort_by(|a, b| b.total_cmp(a));
            let scale = expected.iter().fold(0.0, |m, x| f64::max(m, x.abs()));
            let found = symmetric_eigenvalues(&symmetric).to_array();
            for (found, expected) in found.iter().zip(expected) {
                prop_assert!((found - expected).abs() <= 4e-15 * scale);
            }
            let estimate = symmetric_eigenvalues_estimate(&symmetric).to_array();
            for (found, expected) in estimate.iter().zip(expected) {
                prop_assert!((found - expected).abs() <= 1e-7 * scale);
            }
        }
    }

    #[test]
    fn diagonal_input_is_exact_and_sorted() {
        let eigen = symmetric_eigen(&DMat3::from_diagonal(DVec3::new(-1.0, 5.0, 1e-300)));
        assert_eq!(eigen.values, DVec3::new(5.0, 1e-300, -1.0));
        assert_eq!(eigen.directions.x_axis, DVec3::Y);
        assert_eq!(eigen.directions.y_axis, DVec3::Z);
    }

    #[test]
    fn keeps_tiny_values_of_a_graded_matrix() {
        // det = 1e-20 - 1e-24: the small value is 1e-20 (1 - 1e-4) / 1, far below epsilon times the large one.
        let matrix = DMat3::from_cols_array(&[1.0, 1e-12, 0.0, 1e-12, 1e-20, 0.0, 0.0, 0.0, 1.0]);
        let smallest = symmetric_eigenvalues(&matrix).z;
        assert!((smallest / (1e-20 - 1e-24) - 1.0).abs() < 1e-12, "{smallest}");
    }

    #[test]
    fn not_finite_in_not_finite_out() {
        assert!(!symmetric_eigenvalues(&DMat3::from_diagonal(DVec3::NAN)).is_finite());
        assert_eq!(symmetric_eigen(&DMat3::ZERO).values, DVec3::ZERO);
    }
}
