//! The equations of one batch of elements (METHOD 1).
//!
//! With edges `d_a = x_a - x_0` and gradients `g_a = grad_X N_a` (the rows of `D_m^-1`), a = 1, 2, 3:
//!
//! ```text
//! F = sum_a d_a g_a^T
//! green:       E = (F^T F - I)/2    S = lambda tr(E) I + 2 mu E    f_a = -V_0 F S g_a
//! body frame:  e = sym(F) - I       s = lambda tr(e) I + 2 mu e    f_a = -V_0 s g_a
//!              (x already turned into the body's frame)
//! f_0 = -(f_1 + f_2 + f_3)          W = V_0/2 S : E
//! ```
//!
//! `lambda` and `mu` are stored times `V_0`, so neither volume nor stress appears by itself. The laws for large
//! deformation have files of their own: `corotated`, `neo_hookean`.

use super::lanes::{BATCH, Lanes, Lanes3, Row, dot, subtract};
use crate::fem::ElasticConstants;
use glam::DVec3;
use pulp::Simd;

/// What never changes of `BATCH` elements.
#[derive(Clone, Debug)]
#[repr(C)]
pub(super) struct BatchShape {
    /// `g_1, g_2, g_3`, each x, y, z; 1/m.
    pub gradients_per_m: [Row; 9],
    /// `V_0 lambda`, J.
    pub lambda_volume_j: Row,
    /// `V_0 mu`, J.
    pub mu_volume_j: Row,
    /// `lambda_max(M_e^-1 K_e)` in the reference shape with the element's shares of its nodes' masses, 1/s2.
    pub eigenvalue_per_s2: Row,
}

impl BatchShape {
    pub(super) const ZERO: Self = Self {
        gradients_per_m: [Row::ZERO; 9],
        lambda_volume_j: Row::ZERO,
        mu_volume_j: Row::ZERO,
        eigenvalue_per_s2: Row::ZERO,
    };

    /// Fills one lane from `g_1, g_2, g_3`, the volume and the material.
    pub(super) fn set(
        &mut self,
        lane: usize,
        gradients_per_m: &[DVec3; 3],
        volume_m3: f64,
        constants: &ElasticConstants,
    ) {
        for (a, gradient) in gradients_per_m.iter().enumerate() {
            for axis in 0..3 {
                self.gradients_per_m[3 * a + axis].0[lane] = gradient[axis];
            }
        }
        self.lambda_volume_j.0[lane] = volume_m3 * constants.lambda_pa;
        self.mu_volume_j.0[lane] = volume_m3 * constants.mu_pa;
    }

    /// `g_1, g_2, g_3` of one lane, 1/m.
    pub(super) fn gradients_per_m(&self, lane: usize) -> [DVec3; 3] {
        [0, 3, 6].map(|row| {
            let [x, y, z] = [0, 1, 2].map(|axis| self.gradients_per_m[row + axis].0[lane]);
            DVec3::new(x, y, z)
        })
    }
}

/// Corner positions on the way in (m), corner forces on the way out (N):
/// row `3 * corner + axis`.
pub(super) type CornerRows = [Row; 12];

/// Sums over batches, lane by lane, so that the order of summation does not depend on register width.
#[derive(Clone, Copy, Debug)]
pub(super) struct LaneTotals {
    /// Strain energy, J.
    pub energy_j: Row,
    /// Largest `E : E`.
    pub strain_squared: Row,
    /// Largest bound of `lambda_max(M_e^-1 K_e)` in the deformed shape, 1/s2.
    pub eigenvalue_per_s2: Row,
}

impl LaneTotals {
    pub(super) const ZERO: Self =
        Self { energy_j: Row::ZERO, strain_squared: Row::ZERO, eigenvalue_per_s2: Row::ZERO };

    /// Takes note of elements whose squared frequencies are at most `factor` times those of the reference shape.
    #[inline(always)]
    pub(super) fn add_eigenvalues<S: Simd>(&mut self, shape: &BatchShape, factor: Lanes<S>, group: usize) {
        let simd = factor.simd();
        let eigenvalue = shape.eigenvalue_per_s2.load(simd, group) * factor;
        let most = self.eigenvalue_per_s2.load(simd, group).max(eigenvalue);
        self.eigenvalue_per_s2.store(group, most);
    }
}

/// Symmetric matrix per lane: xx, yy, zz, xy, xz, yz.
pub(super) type Symmetric<S> = [Lanes<S>; 6];

/// Replaces the corner positions of a batch by the corner forces, Green-Lagrange strain; `stiffening` is the coefficient of
/// strain in the bound of the squared frequencies (see `stable_step`).
#[inline(always)]
pub(super) fn green_batch<S: Simd>(
    simd: S,
    shape: &BatchShape,
    corners: &mut CornerRows,
    totals: &mut LaneTotals,
    stiffening: f64,
) {
    for group in 0..BATCH / S::F64_LANES {
        let gradients = load_gradients(simd, shape, group);
        let f = deformation_gradient(simd, corners, gradients, group);
        let columns = transpose(f);
        // C - I = 2 E
        let twice_strain = product_less_identity(simd, columns, columns);
        let half = Lanes::splat(simd, 0.5);
        let strain = scale(twice_strain, half);
        let stress = hooke(simd, shape, strain, group);
        add_totals(group, totals, strain, stress);
        let size = contract(strain, strain).sqrt();
        let factor = Lanes::splat(simd, 1.0) + Lanes::splat(simd, stiffening) * size;
        totals.add_eigenvalues(shape, factor, group);
        let first_piola =
            [symmetric_times(stress, f[0]), symmetric_times(stress, f[1]), symmetric_times(stress, f[2])];
        store_forces(corners, first_piola, gradients, group);
    }
}

/// Replaces the corner positions of a batch, in the body's frame, by the corner forces, small strain.
#[inline(always)]
pub(super) fn body_frame_batch<S: Simd>(
    simd: S,
    shape: &BatchShape,
    corners: &mut CornerRows,
    totals: &mut LaneTotals,
) {
    for group in 0..BATCH / S::F64_LANES {
        let gradients = load_gradients(simd, shape, group);
        let f = deformation_gradient(simd, corners, gradients, group);
        let (one, half) = (Lanes::splat(simd, 1.0), Lanes::splat(simd, 0.5));
        let strain = [
            f[0][0] - one,
            f[1][1] - one,
            f[2][2] - one,
            (f[0][1] + f[1][0]) * half,
            (f[0][2] + f[2][0]) * half,
            (f[1][2] + f[2][1]) * half,
        ];
        let [xx, yy, zz, xy, xz, yz] = hooke(simd, shape, strain, group);
        add_totals(group, totals, strain, [xx, yy, zz, xy, xz, yz]);
        // Its stiffness is constant.
        totals.add_eigenvalues(shape, one, group);
        let stress = [[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]];
        store_forces(corners, stress, gradients, group);
    }
}

#[inline(always)]
pub(super) fn load_gradients<S: Simd>(simd: S, shape: &BatchShape, group: usize) -> [Lanes3<S>; 3] {
    let g = &shape.gradients_per_m;
    [
        load3(simd, [&g[0], &g[1], &g[2]], group),
        load3(simd, [&g[3], &g[4], &g[5]], group),
        load3(simd, [&g[6], &g[7], &g[8]], group),
    ]
}

#[inline(always)]
pub(super) fn load3<S: Simd>(simd: S, rows: [&Row; 3], group: usize) -> Lanes3<S> {
    [rows[0].load(simd, group), rows[1].load(simd, group), rows[2].load(simd, group)]
}

/// Rows of `F = sum_a d_a g_a^T`.
#[inline(always)]
pub(super) fn deformation_gradient<S: Simd>(
    simd: S,
    corners: &CornerRows,
    g: [Lanes3<S>; 3],
    group: usize,
) -> [Lanes3<S>; 3] {
    let x0 = load3(simd, [&corners[0], &corners[1], &corners[2]], group);
    let x1 = load3(simd, [&corners[3], &corners[4], &corners[5]], group);
    let x2 = load3(simd, [&corners[6], &corners[7], &corners[8]], group);
    let x3 = load3(simd, [&corners[9], &corners[10], &corners[11]], group);
    let edges = transpose([subtract(x1, x0), subtract(x2, x0), subtract(x3, x0)]);
    let columns = transpose(g);
    [dots(edges[0], columns), dots(edges[1], columns), dots(edges[2], columns)]
}

#[inline(always)]
fn dots<S: Simd>(a: Lanes3<S>, b: [Lanes3<S>; 3]) -> Lanes3<S> {
    [dot(a, b[0]), dot(a, b[1]), dot(a, b[2])]
}

#[inline(always)]
pub(super) fn transpose<S: Simd>(m: [Lanes3<S>; 3]) -> [Lanes3<S>; 3] {
    [[m[0][0], m[1][0], m[2][0]], [m[0][1], m[1][1], m[2][1]], [m[0][2], m[1][2], m[2][2]]]
}

#[inline(always)]
pub(super) fn scale<S: Simd>(m: Symmetric<S>, by: Lanes<S>) -> Symmetric<S> {
    [m[0] * by, m[1] * by, m[2] * by, m[3] * by, m[4] * by, m[5] * by]
}

/// `A^T B - I` of the columns of two matrices whose product is symmetric.
#[inline(always)]
pub(super) fn product_less_identity<S: Simd>(simd: S, a: [Lanes3<S>; 3], b: [Lanes3<S>; 3]) -> Symmetric<S> {
    let one = Lanes::splat(simd, 1.0);
    [
        dot(a[0], b[0]) - one,
        dot(a[1], b[1]) - one,
        dot(a[2], b[2]) - one,
        dot(a[0], b[1]),
        dot(a[0], b[2]),
        dot(a[1], b[2]),
    ]
}

/// `V_0 (lambda tr(e) I + 2 mu e)`.
#[inline(always)]
pub(super) fn hooke<S: Simd>(simd: S, shape: &BatchShape, e: Symmetric<S>, group: usize) -> Symmetric<S> {
    let mu = shape.mu_volume_j.load(simd, group);
    let stress = scale(e, mu + mu);
    let pressure = shape.lambda_volume_j.load(simd, group) * (e[0] + e[1] + e[2]);
    [stress[0] + pressure, stress[1] + pressure, stress[2] + pressure, stress[3], stress[4], stress[5]]
}

/// `a : b`.
#[inline(always)]
pub(super) fn contract<S: Simd>(a: Symmetric<S>, b: Symmetric<S>) -> Lanes<S> {
    let off_diagonal = dot([a[3], a[4], a[5]], [b[3], b[4], b[5]]);
    dot([a[0], a[1], a[2]], [b[0], b[1], b[2]]) + (off_diagonal + off_diagonal)
}

#[inline(always)]
pub(super) fn add_totals<S: Simd>(
    group: usize,
    totals: &mut LaneTotals,
    strain: Symmetric<S>,
    stress: Symmetric<S>,
) {
    let simd = strain[0].simd();
    let half = Lanes::splat(simd, 0.5);
    let energy = totals.energy_j.load(simd, group) + contract(stress, strain) * half;
    totals.energy_j.store(group, energy);
    let strain_squared = totals.strain_squared.load(simd, group);
    totals.strain_squared.store(group, strain_squared.max(contract(strain, strain)));
}

#[inline(always)]
pub(super) fn symmetric_times<S: Simd>(m: Symmetric<S>, v: Lanes3<S>) -> Lanes3<S> {
    [dot([m[0], m[3], m[4]], v), dot([m[3], m[1], m[5]], v), dot([m[4], m[5], m[2]], v)]
}

/// `f_a = -stress g_a` for a = 1, 2, 3, and `f_0` balances them.
#[inline(always)]
pub(super) fn store_forces<S: Simd>(
    corners: &mut CornerRows,
    stress: [Lanes3<S>; 3],
    gradients: [Lanes3<S>; 3],
    group: usize,
) {
    for axis in 0..3 {
        let pulls = dots(stress[axis], gradients);
        corners[axis].store(group, pulls[0] + pulls[1] + pulls[2]);
        corners[3 + axis].store(group, -pulls[0]);
        corners[6 + axis].store(group, -pulls[1]);
        corners[9 + axis].store(group, -pulls[2]);
    }
}
