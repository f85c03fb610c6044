//! `neo-hookean`: the stable neo-Hookean law (B. Smith, F. de Goes, T. Kim, ACM Trans. Graph. 37, 2018, equation 14).
//!
//! Its own constants `mu' = 4/3 mu`, `lambda' = lambda + 5/6 mu` make it agree with Hooke's law at small strain. With
//! `t = tr(F^T F) - 3`, `J = det F`, a unit of volume has
//!
//! ```text
//! W = mu'/2 (t - log(1 + t/4)) + lambda'/2 (J - 1)^2 - 3/4 mu' (J - 1)
//! P = mu (F - cof F) + mu t/(3 (4 + t)) F + lambda' (J - 1) cof F      sigma = P F^T / J
//! ```
//!
//! which is theirs less its value at rest. There is no logarithm of `J` and no inverse of `F`, so that flat and inverted
//! elements have finite forces, which drive them back. So that an element at rest has no energy but round-off, with
//! `q = F^T F - I` and its invariants `W = 2/3 mu (u - log(1 + u)) + mu g + lambda'/2 (J - 1)^2`, `u = t/4`,
//! `g = t/2 - (J - 1) = (t/2 (J - 1) - I_2(q) - I_3(q))/(J + 1)`.
//!
//! Stable step: with singular values `s`, `c = (s2 s3, s3 s1, s1 s2)`, `x = s - 1`, `b = lambda' (J - 1) - mu`, the second
//! derivative of `W` is `mu' (1 - 1/(4 + t)) I + 2 mu'/(4 + t)^2 s s^T + lambda' c c^T + b K(s)`, where the second derivative `K`
//! of `J` has no eigenvalue beyond `sqrt(4/3) |s|`. It is bounded as it stands, and by what is there more than at rest: the
//! largest eigenvalue of `u u^T - v v^T` is `(|u|^2 - |v|^2 + |u - v| |u + v|)/2`, `|c - 1| <= 2 |x| + |x|^2/sqrt(3)`, and with
//! `e = |E|`, `|x| <= 2 e/(1 + sqrt(1 - 2 e))`. As in `corotated`, that over `lambda + 2 mu` bounds `omega^2 / omega_0^2 - 1`.

use super::ElasticConstants;
use super::kernel::{
    BatchShape, CornerRows, LaneTotals, Symmetric, contract, deformation_gradient, load_gradients,
    product_less_identity, store_forces, transpose,
};
use super::lanes::{BATCH, Lanes, Lanes3, Row, cross, dot};
use glam::{DMat3, DVec3};
use pulp::Simd;

/// `|z|` up to which the series of the logarithm is used as it is.
const SERIES_REACH: f64 = 0.2;
/// `1/3, 1/5, 1/7, ...` of the series, the last worth less than round-off at `SERIES_REACH`.
const SERIES: [f64; 11] = [
    1.0 / 3.0,
    1.0 / 5.0,
    1.0 / 7.0,
    1.0 / 9.0,
    1.0 / 11.0,
    1.0 / 13.0,
    1.0 / 15.0,
    1.0 / 17.0,
    1.0 / 19.0,
    1.0 / 21.0,
    1.0 / 23.0,
];

/// What both the stress and the bound of the step need.
#[derive(Clone, Copy)]
struct Measures<S: Simd> {
    cofactor: [Lanes3<S>; 3],
    /// `F^T F - I`.
    q: Symmetric<S>,
    t: Lanes<S>,
    jacobian: Lanes<S>,
    mu: Lanes<S>,
    lambda: Lanes<S>,
    /// `lambda'`.
    volumetric: Lanes<S>,
}

/// Replaces the corner positions of a batch by the corner forces.
#[inline(always)]
pub(super) fn neo_hookean_batch<S: Simd>(
    simd: S,
    shape: &BatchShape,
    corners: &mut CornerRows,
    totals: &mut LaneTotals,
) {
    let (mut u_row, mut h_row, mut z_row) = (Row::ZERO, Row::ZERO, Row::ZERO);
    for group in 0..BATCH / S::F64_LANES {
        let splat = |number: f64| Lanes::splat(simd, number);
        let gradients = load_gradients(simd, shape, group);
        let f = deformation_gradient(simd, corners, gradients, group);
        let m = Measures::of(simd, shape, f, group);
        let (j, four_t) = (m.jacobian - splat(1.0), m.t + splat(4.0));
        let stretching = m.mu + m.mu * m.t / (splat(3.0) * four_t);
        let pressing = m.volumetric * j - m.mu;
        let entry = |i: usize, axis: usize| stretching * f[i][axis] + pressing * m.cofactor[i][axis];
        let row = |i: usize| -> Lanes3<S> { [entry(i, 0), entry(i, 1), entry(i, 2)] };
        store_forces(corners, [row(0), row(1), row(2)], gradients, group);
        let energy = m.mu * m.shape_energy(simd, j) + splat(0.5) * m.volumetric * j * j;
        totals.energy_j.store(group, totals.energy_j.load(simd, group) + energy);
        // An inverted element may have no strain, but it is no longer what it was.
        let (zero, one) = (splat(0.0), splat(1.0));
        let strain = contract(m.q, m.q) * splat(0.25);
        let seen = strain + m.jacobian.if_positive(zero, one);
        totals.strain_squared.store(group, totals.strain_squared.load(simd, group).max(seen));
        totals.add_eigenvalues(shape, one + m.stiffening(simd, j, strain), group);
        let u = m.t * splat(0.25);
        let z = u / (u + splat(2.0));
        u_row.store(group, u);
        z_row.store(group, z);
        h_row.store(group, log_defect_near(simd, u, z));
    }
    for lane in 0..BATCH {
        if z_row.0[lane].abs() > SERIES_REACH {
            h_row.0[lane] = log_defect(u_row.0[lane]);
        }
    }
    for group in 0..BATCH / S::F64_LANES {
        let share = shape.mu_volume_j.load(simd, group) * Lanes::splat(simd, 2.0 / 3.0);
        let energy = totals.energy_j.load(simd, group) + share * h_row.load(simd, group);
        totals.energy_j.store(group, energy);
    }
}

impl<S: Simd> Measures<S> {
    #[inline(always)]
    fn of(simd: S, shape: &BatchShape, f: [Lanes3<S>; 3], group: usize) -> Self {
        let columns = transpose(f);
        let q = product_less_identity(simd, columns, columns);
        let cofactor = [cross(f[1], f[2]), cross(f[2], f[0]), cross(f[0], f[1])];
        let mu = shape.mu_volume_j.load(simd, group);
        let lambda = shape.lambda_volume_j.load(simd, group);
        Self {
            t: q[0] + q[1] + q[2],
            jacobian: dot(f[0], cofactor[0]),
            volumetric: lambda + mu * Lanes::splat(simd, 5.0 / 6.0),
            cofactor,
            q,
            mu,
            lambda,
        }
    }

    /// `g`: by the difference itself only where `J + 1` may vanish.
    #[inline(always)]
    fn shape_energy(&self, simd: S, j: Lanes<S>) -> Lanes<S> {
        let half_t = self.t * Lanes::splat(simd, 0.5);
        let [xx, yy, zz, xy, xz, yz] = self.q;
        let second = xx * yy + yy * zz + zz * xx - xy * xy - xz * xz - yz * yz;
        let third = dot([xx, xy, xz], cross([xy, yy, yz], [xz, yz, zz]));
        let exact = (half_t * j - second - third) / (self.jacobian + Lanes::splat(simd, 1.0));
        self.jacobian.if_positive(exact, half_t - j)
    }

    /// Bound of `omega^2 / omega_0^2 - 1`, not below zero; `strain` is `E : E`.
    #[inline(always)]
    fn stiffening(&self, simd: S, j: Lanes<S>, strain: Lanes<S>) -> Lanes<S> {
        let splat = |number: f64| Lanes::splat(simd, number);
        let (zero, one, half, root3) = (splat(0.0), splat(1.0), splat(0.5), splat(3.0_f64.sqrt()));
        let (mu, volumetric) = (self.mu, self.volumetric);
        let shear = mu * splat(4.0 / 3.0);
        let (four_t, size) = (self.t + splat(4.0), self.t + splat(3.0));
        let outer = (shear + shear) / (four_t * four_t);
        let (length, widest) = (size.sqrt(), (size * splat(4.0 / 3.0)).sqrt());
        let [a, b, c] = self.cofactor;
        let areas = dot(a, a) + dot(b, b) + dot(c, c);
        let whole =
            shear * size / four_t + outer * size + volumetric * areas + (volumetric * j - mu).abs() * widest
                - (self.lambda + mu + mu);
        let twice_e = strain.sqrt() * splat(2.0);
        let x = twice_e / (one + (one - twice_e).max(zero).sqrt());
        let change = (shear * self.t / (splat(4.0) * four_t)).max(zero)
            + outer * half * (self.t + x * (length + root3))
            + splat(3.0) * (outer - shear * splat(0.125)).max(zero)
            + volumetric
                * half
                * (areas - splat(3.0)
                    + (x + x + x * x * splat(1.0 / 3.0_f64.sqrt())) * (areas.sqrt() + root3))
            + volumetric * j.abs() * widest
            + mu * x * splat(2.0 / 3.0_f64.sqrt());
        let bound = self.jacobian.if_positive(whole.min(change), whole).max(zero);
        // Lanes without an element have no stiffness.
        bound / (self.lambda + mu + mu).max(splat(f64::MIN_POSITIVE))
    }
}

/// `u - log(1 + u) = u z - 2 z^3 (1/3 + z^2/5 + z^4/7 + ...)`, `z = u/(2 + u)`, for small `z`.
#[inline(always)]
fn log_defect_near<S: Simd>(simd: S, u: Lanes<S>, z: Lanes<S>) -> Lanes<S> {
    let square = z * z;
    let mut sum = Lanes::splat(simd, SERIES[SERIES.len() - 1]);
    for term in (0..SERIES.len() - 1).rev() {
        sum = sum * square + Lanes::splat(simd, SERIES[term]);
    }
    u * z - Lanes::splat(simd, 2.0) * square * z * sum
}

/// `u - log(1 + u)` for any `u > -1`. Roots bring the logarithm near; a library's would not give the same bytes on every
/// processor.
pub(super) fn log_defect(u: f64) -> f64 {
    let series = |z: f64| SERIES.iter().rev().fold(0.0, |sum, term| sum * z * z + term);
    let z = u / (2.0 + u);
    if z.abs() <= SERIES_REACH {
        return u * z - 2.0 * z * z * z * series(z);
    }
    let (mut root, mut factor) = (1.0 + u, 2.0);
    let mut near = z;
    while near.abs() > SERIES_REACH && root.is_finite() {
        root = root.sqrt();
        factor *= 2.0;
        near = (root - 1.0) / (root + 1.0);
    }
    u - factor * (near + near * near * near * series(near))
}

/// `P`, Pa.
pub(super) fn first_piola_pa(gradient: &DMat3, constants: &ElasticConstants) -> DMat3 {
    let (mu, lambda) = (constants.mu_pa, constants.lambda_pa);
    let t = invariant_t(gradient);
    let j = gradient.determinant() - 1.0;
    let stretching = mu + mu * t / (3.0 * (4.0 + t));
    *gradient * stretching + cofactor(gradient) * ((lambda + 5.0 / 6.0 * mu) * j - mu)
}

/// `W`, J/m3.
pub(super) fn energy_pa(gradient: &DMat3, constants: &ElasticConstants) -> f64 {
    let (mu, lambda) = (constants.mu_pa, constants.lambda_pa);
    let q = gradient.transpose() * *gradient - DMat3::IDENTITY;
    let t = q.x_axis.x + q.y_axis.y + q.z_axis.z;
    let jacobian = gradient.determinant();
    let j = jacobian - 1.0;
    let products = q.to_cols_array().iter().map(|x| x * x).sum::<f64>();
    let second = 0.5 * (t * t - products);
    let shape = if jacobian > 0.0 {
        (0.5 * t * j - second - q.determinant()) / (jacobian + 1.0)
    } else {
        0.5 * t - j
    };
    2.0 / 3.0 * mu * log_defect(0.25 * t) + mu * shape + 0.5 * (lambda + 5.0 / 6.0 * mu) * j * j
}

fn invariant_t(gradient: &DMat3) -> f64 {
    let q = gradient.transpose() * *gradient - DMat3::IDENTITY;
    q.x_axis.x + q.y_axis.y + q.z_axis.z
}

/// The matrix of cofactors, `J F^-T` where there is an inverse.
fn cofactor(f: &DMat3) -> DMat3 {
    let (x, y, z): (DVec3, DVec3, DVec3) = (f.x_axis, f.y_axis, f.z_axis);
    DMat3::from_cols(y.cross(z), z.cross(x), x.cross(y))
}

/// The most that the norm of the Cauchy stress of an element that is not inverted can be at `|E| = strain` below 1/2, Pa.
///
/// From `J sigma = mu (B - J I) + mu t/(3 (4 + t)) B + lambda' (J - 1) J I`, `B = F F^T`, `|B - I| = 2 e`, `|t| <= 2 sqrt(3) e`.
/// `J` is largest and, up to `e = 1/4`, smallest when all stretches are equal; beyond, `(1 - 2 e)^(3/2)` is below it.
pub(super) fn most_stress_pa(constants: &ElasticConstants, strain: f64) -> f64 {
    let (mu, root3) = (constants.mu_pa, 3.0_f64.sqrt());
    let most_j = (1.0 + 2.0 * strain / root3).powf(1.5);
    let share = if strain <= 0.25 { 2.0 / root3 } else { 2.0 };
    let least_j = (1.0 - share * strain).powf(1.5);
    let change = (most_j - 1.0).max(1.0 - least_j);
    let t = 2.0 * root3 * strain;
    let pull = mu * (2.0 * strain + root3 * change)
        + mu * t / (3.0 * (4.0 - t)) * root3 * (1.0 + 2.0 * strain)
        + (constants.lambda_pa + 5.0 / 6.0 * mu) * root3 * change * most_j;
    pull / least_j
}
