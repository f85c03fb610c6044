//! `corotated`: small strain in each element's own rotated frame.
//!
//! With the rotation `R` that maximises `R : F` over all rotations (the polar factor; of an inverted `F`, too) and
//! `S = R^T F`, which is symmetric, the energy of a unit of volume, first Piola-Kirchhoff and Cauchy stress are
//!
//! ```text
//! W = mu |F - R|^2 + lambda/2 tr(S - I)^2
//! T = 2 mu (S - I) + lambda tr(S - I) I      P = dW/dF = R T      sigma = P F^T / J
//! ```
//!
//! (`R` may be held in the derivative: `F - R` and `R` are normal to every turn of `R`.) The rotation has a closed form
//! (F. L. Markley, J. Astronaut. Sci. 41, 1993): `s = tr S` is the largest root of
//! `(s^2 - |F|^2)^2 - 8 J s - 4 |cof F|^2`, which Newton's method meets from `sqrt(3) |F|` above; then
//!
//! ```text
//! k = (s^2 - |F|^2)/2    z = k s - J = (s1 + s2)(s2 + s3)(s3 + s1)
//! R = ((k + |F|^2) F + s cof F - F F^T F) / z
//! ```
//!
//! Where `z` is small or Newton is not there in time, [`best_fit_rotation`] takes over, element by element.
//!
//! Stable step: in the frame of `R` the tangent is that of Hooke's law, and turning modes have
//! `tau_ij = 2 mu + 2 (lambda tr(S - I) - 2 mu)/(s_i + s_j)` besides. With `c_1` of `stable_step`, `|dF|^2 <= c_1 sum_a m_a |d_a|^2`
//! and `omega_0^2 >= V_0 (lambda + 2 mu) c_1`, so `omega^2 / omega_0^2 <= 1 + max(tau, 0)/(lambda + 2 mu)`.

use super::ElasticConstants;
use super::kernel::{
    BatchShape, CornerRows, LaneTotals, Symmetric, add_totals, contract, deformation_gradient, hooke,
    load_gradients, load3, product_less_identity, store_forces, symmetric_times, transpose,
};
use super::lanes::{BATCH, Lanes, Lanes3, Row, cross, dot};
use crate::math::best_fit_rotation;
use glam::{DMat3, DQuat};
use pulp::Simd;

/// Newton's steps towards `tr S`: enough up to strains of about a half.
const NEWTON_STEPS: usize = 5;
/// Largest last step of Newton's, of the first guess, from which the next would change nothing.
const SETTLED: f64 = 1e-9;
/// `z` over the cube of the first guess (8/27 without strain) from which the closed form keeps its digits.
const DISTINCT: f64 = 4e-3;
/// Smallest sum of two stretches that the stable step follows. Below, the rotation is about to be undefined and the energy
/// has a kink, which no step resolves; its force is bounded.
const SMALLEST_PAIR: f64 = 0.05;

type Rows9 = [Row; 9];

/// Replaces the corner positions of a batch by the corner forces.
#[inline(always)]
pub(super) fn corotated_batch<S: Simd>(
    simd: S,
    shape: &BatchShape,
    corners: &mut CornerRows,
    totals: &mut LaneTotals,
) {
    let (mut f_rows, mut r_rows) = ([Row::ZERO; 9], [Row::ZERO; 9]);
    let (mut last_step, mut distinct) = (Row::ZERO, Row::ZERO);
    for group in 0..BATCH / S::F64_LANES {
        let f = deformation_gradient(simd, corners, load_gradients(simd, shape, group), group);
        let (r, step, z) = closed_form(simd, f);
        for (i, (f, r)) in f.iter().zip(&r).enumerate() {
            for axis in 0..3 {
                f_rows[3 * i + axis].store(group, f[axis]);
                r_rows[3 * i + axis].store(group, r[axis]);
            }
        }
        last_step.store(group, step);
        distinct.store(group, z);
    }
    for lane in 0..BATCH {
        if !(last_step.0[lane] <= SETTLED && distinct.0[lane] >= DISTINCT) {
            turn_lane(&f_rows, &mut r_rows, lane);
        }
    }
    for group in 0..BATCH / S::F64_LANES {
        let (f, r) = (load9(simd, &f_rows, group), load9(simd, &r_rows, group));
        let strain = product_less_identity(simd, transpose(r), transpose(f));
        let stress = hooke(simd, shape, strain, group);
        add_totals(group, totals, strain, stress);
        let stiffer = Lanes::splat(simd, 1.0) + stiffening(simd, shape, strain, group);
        totals.add_eigenvalues(shape, stiffer, group);
        let first_piola =
            [symmetric_times(stress, r[0]), symmetric_times(stress, r[1]), symmetric_times(stress, r[2])];
        store_forces(corners, first_piola, load_gradients(simd, shape, group), group);
    }
}

#[inline(always)]
fn load9<S: Simd>(simd: S, rows: &Rows9, group: usize) -> [Lanes3<S>; 3] {
    [
        load3(simd, [&rows[0], &rows[1], &rows[2]], group),
        load3(simd, [&rows[3], &rows[4], &rows[5]], group),
        load3(simd, [&rows[6], &rows[7], &rows[8]], group),
    ]
}

/// Rows of `R`, the last step of Newton's over the first guess, and `z` over its cube.
#[inline(always)]
fn closed_form<S: Simd>(simd: S, f: [Lanes3<S>; 3]) -> ([Lanes3<S>; 3], Lanes<S>, Lanes<S>) {
    let splat = |number: f64| Lanes::splat(simd, number);
    let cofactor = [cross(f[1], f[2]), cross(f[2], f[0]), cross(f[0], f[1])];
    let j = dot(f[0], cofactor[0]);
    let size = dot(f[0], f[0]) + dot(f[1], f[1]) + dot(f[2], f[2]);
    let cofactor_size =
        dot(cofactor[0], cofactor[0]) + dot(cofactor[1], cofactor[1]) + dot(cofactor[2], cofactor[2]);
    let (eight_j, last) = (j * splat(8.0), cofactor_size * splat(4.0));
    let guess = (size * splat(3.0)).sqrt();
    let (mut s, mut step) = (guess, guess);
    for _ in 0..NEWTON_STEPS {
        let over = s * s - size;
        step = (over * over - eight_j * s - last) / (splat(4.0) * s * over - eight_j);
        s = s - step;
    }
    let k = (s * s - size) * splat(0.5);
    let z = k * s - j;
    let (inverse_z, both) = (splat(1.0) / z, k + size);
    // F F^T, symmetric.
    let gram = [
        dot(f[0], f[0]),
        dot(f[1], f[1]),
        dot(f[2], f[2]),
        dot(f[0], f[1]),
        dot(f[0], f[2]),
        dot(f[1], f[2]),
    ];
    let columns = transpose(f);
    // (F F^T) F column by column.
    let cubed = transpose([
        symmetric_times(gram, columns[0]),
        symmetric_times(gram, columns[1]),
        symmetric_times(gram, columns[2]),
    ]);
    let row = |i: usize| -> Lanes3<S> {
        let entry = |axis: usize| (both * f[i][axis] + s * cofactor[i][axis] - cubed[i][axis]) * inverse_z;
        [entry(0), entry(1), entry(2)]
    };
    ([row(0), row(1), row(2)], step.abs() / guess, z / (guess * guess * guess))
}

/// The rotation of one lane without conditions.
fn turn_lane(f_rows: &Rows9, r_rows: &mut Rows9, lane: usize) {
    let entries: [f64; 9] = std::array::from_fn(|i| f_rows[i].0[lane]);
    // Rows as columns.
    let rotation = rotation_of(&DMat3::from_cols_array(&entries).transpose()).transpose();
    for (row, entry) in r_rows.iter_mut().zip(rotation.to_cols_array()) {
        row.0[lane] = entry;
    }
}

/// `max(tau, 0) / (lambda + 2 mu)` of `S - I`.
#[inline(always)]
fn stiffening<S: Simd>(simd: S, shape: &BatchShape, strain: Symmetric<S>, group: usize) -> Lanes<S> {
    let splat = |number: f64| Lanes::splat(simd, number);
    let (one, zero) = (splat(1.0), splat(0.0));
    let mu = shape.mu_volume_j.load(simd, group);
    let lambda = shape.lambda_volume_j.load(simd, group);
    let trace = strain[0] + strain[1] + strain[2];
    let pull = lambda * trace - (mu + mu);
    // Bounds of s_i + s_j.
    let spread = (contract(strain, strain) * splat(2.0)).sqrt();
    let [xx, yy, zz] = [strain[0] + one, strain[1] + one, strain[2] + one];
    let [xy, xz, yz] = [strain[3], strain[4], strain[5]];
    let (s, size) = (trace + splat(3.0), contract([xx, yy, zz, xy, xz, yz], [xx, yy, zz, xy, xz, yz]));
    let determinant = dot([xx, xy, xz], cross([xy, yy, yz], [xz, yz, zz]));
    let k = (s * s - size) * splat(0.5);
    let least = ((k * s - determinant) / (size + k)).max(splat(2.0) - spread).max(splat(SMALLEST_PAIR));
    let pair = pull.if_positive(least, splat(2.0) + spread);
    let tau = (mu + pull / pair) * splat(2.0);
    // Lanes without an element have neither.
    tau.max(zero) / (lambda + mu + mu).max(splat(f64::MIN_POSITIVE))
}

/// The rotation that maximises `R : F`; of several the one nearest to none.
pub(super) fn rotation_of(gradient: &DMat3) -> DMat3 {
    DMat3::from_quat(best_fit_rotation(gradient, DQuat::IDENTITY))
}

/// `S - I` in the frame of `rotation`.
pub(super) fn strain(gradient: &DMat3, rotation: &DMat3) -> DMat3 {
    let stretch = rotation.transpose() * *gradient;
    (stretch + stretch.transpose()) * 0.5 - DMat3::IDENTITY
}

/// The most that the norm of the Cauchy stress can be at `|S - I| = strain` below 1/2, Pa.
///
/// `|T| <= (3 |lambda| + 2 mu) e`, and with stretches between `1 - e` and `1 + e` `|sigma| <= |T| (1 + e)/(1 - e)^3`.
pub(super) fn most_stress_pa(constants: &ElasticConstants, strain: f64) -> f64 {
    let stiffness_pa = 3.0 * constants.lambda_pa.abs() + 2.0 * constants.mu_pa;
    stiffness_pa * strain * (1.0 + strain) / (1.0 - strain).powi(3)
}
