//! The largest stable step of central differences, `h <= 2 / omega_max`, from provable bounds.
//!
//! For `M = sum_e M_e` and `K = sum_e K_e` the Rayleigh quotient of the whole never exceeds the largest
//! of the parts, `omega_max^2 <= max_e lambda_max(M_e^-1 K_e)` (B. M. Irons, 1971; I. Fried, 1972), for *any*
//! way to share a node's mass among its elements. For one constant-strain tetrahedron with corner masses `m_a` the
//! eigenvalue has a closed form. With `G = sum_a g_a g_a^T / m_a` (a = 0..4) and its eigenvalues
//! `c_1 >= c_2 >= c_3`, the nonzero eigenvalues of `M_e^-1 K_e` are those of the map `E -> D (E G + G E)/2` times `V_0`,
//! which in the axes of G falls apart into three shear modes, `mu (c_i + c_j)`, and the symmetric matrix
//! `2 mu diag(c) + lambda sqrt(c) sqrt(c)^T`.
//!
//! The usual `min altitude / c_p` is larger than the element's `2 / omega_max` in every case
//! (`G` with equal masses gives `omega^2 >= 4 c_p^2 / altitude^2`); it needs the factor `cfl` to be safe, this does not.

use super::{ElasticConstants, ElementBatches};
use crate::math::symmetric_eigenvalues;
use glam::{DMat3, DVec3};

/// Ways to share the node masses that are tried. Each costs about as much as ten elastic steps;
/// later ones were seen to gain less than 2 %.
const SHARING_ROUNDS: usize = 6;

impl ElementBatches {
    /// `2 / omega_max` of each element by itself in its reference shape, s, in the caller's order.
    ///
    /// The smallest of them is a stable step for the whole body; [`Self::stable_step_s`] is longer.
    #[must_use]
    pub fn element_stable_steps_s(&self) -> &[f64] {
        &self.steps_s
    }

    /// Smallest altitude over longitudinal wave speed of each element, s, in the caller's order: the
    /// textbook estimate, for comparison. Not a bound; see the head of this file.
    #[must_use]
    pub fn element_altitude_steps_s(&self) -> Vec<f64> {
        self.map_elements(|element, gradients_per_m| {
            let steepest = gradients_per_m.iter().map(|g| g.length()).fold(0.0, f64::max);
            1.0 / (steepest * self.constants[element].p_wave_speed_m_s())
        })
    }

    /// A stable step of the assembled body near its reference shape, s: never above
    /// `2 / omega_max`, never below the smallest of [`Self::element_stable_steps_s`] when `node_masses_kg`
    /// are the lumped masses.
    ///
    /// Heavy neighbours of a bad element share its burden, so on meshes with slivers this is longer than
    /// any element by itself allows. Held nodes may be given infinite mass. Infinite without elements.
    #[must_use]
    pub fn stable_step_s(&self, node_masses_kg: &[f64]) -> f64 {
        let mut weights = self.masses_kg.clone();
        let mut smallest = f64::INFINITY;
        for _ in 0..SHARING_ROUNDS {
            let eigenvalues = self.shared_eigenvalues(node_masses_kg, &weights);
            let largest = eigenvalues.iter().copied().fold(0.0, f64::max);
            smallest = f64::min(smallest, largest);
            // Elements that came out stiff get a larger share of their nodes in the next round.
            for (weight, eigenvalue) in weights.iter_mut().zip(&eigenvalues) {
                *weight *= (eigenvalue / largest).sqrt().max(f64::MIN_POSITIVE);
            }
        }
        2.0 / smallest.sqrt()
    }

    /// `lambda_max(M_e^-1 K_e)`, 1/s2, with each node's mass shared in proportion to `weights`.
    fn shared_eigenvalues(&self, node_masses_kg: &[f64], weights: &[f64]) -> Vec<f64> {
        let mut weight_at_node = vec![0.0; self.node_count()];
        for (tet, weight) in self.tets.iter().zip(weights) {
            for &node in tet {
                weight_at_node[node as usize] += weight;
            }
        }
        self.map_elements(|element, gradients_per_m| {
            let gram = (0..4).fold(DMat3::ZERO, |sum, corner| {
                let node = self.tets[element][corner] as usize;
                let share = weights[element] / weight_at_node[node];
                sum + outer(gradients_per_m[corner]) * (node_masses_kg[node] * share).recip()
            });
            let constants = &self.constants[element];
            let volume_m3 = self.masses_kg[element] / constants.density_kg_m3;
            volume_m3 * stiffness_eigenvalue(&gram, constants)
        })
    }

    /// By how much the stable step shrinks, at most, when a `green` body is deformed: a factor in (0, 1] for
    /// [`Self::stable_step_s`], from [`super::ElasticState::max_strain`].
    ///
    /// With `F` of largest stretch `s` and largest principal stress `p`, the tangent stiffness obeys
    /// `omega^2 <= omega_0^2 s^2 + (4/rho) p^+ c_1` (material and geometric part). With
    /// `e = sqrt(E : E)`: `s^2 <= 1 + 2e`, `p <= (sqrt(3) |lambda| + 2 mu) e`, and `omega_0^2 >= (4/rho) (lambda + 2 mu) c_1`, so
    /// `omega^2 / omega_0^2 <= 1 + (2 + (sqrt(3) |lambda| + 2 mu)/(lambda + 2 mu)) e`. The stiffness in
    /// `body-frame` kinematics is constant: no factor.
    #[must_use]
    pub fn green_step_factor(&self, max_strain: f64) -> f64 {
        (1.0 + self.stiffening * max_strain).sqrt().recip()
    }
}

/// The coefficient of strain in [`ElementBatches::green_step_factor`].
pub(super) fn stiffening(constants: &ElasticConstants) -> f64 {
    let (lambda, mu) = (constants.lambda_pa, constants.mu_pa);
    2.0 + (3.0_f64.sqrt() * lambda.abs() + 2.0 * mu) / (lambda + 2.0 * mu)
}

/// The stable step, s, that is left of `step_s` with stiffness-proportional damping `C = beta K`,
/// `beta` in s, its force taken from the last half step's velocity: `h^2 + 2 beta h <= step^2`.
///
/// (T. Belytschko et al., *Nonlinear Finite Elements*, section 6.6, `h = 2/omega (sqrt(1 + xi^2) - xi)`, `xi = beta omega / 2`.)
/// Mass-proportional damping treated implicitly costs nothing.
#[must_use]
pub fn damped_step_s(step_s: f64, stiffness_damping_s: f64) -> f64 {
    if step_s == f64::INFINITY {
        return step_s;
    }
    step_s * (step_s / (stiffness_damping_s + stiffness_damping_s.hypot(step_s)))
}

/// `2 / omega_max` of one element with a quarter of its mass at each corner, s.
pub(super) fn element_step_s(gradients_per_m: &[DVec3; 4], constants: &ElasticConstants) -> f64 {
    let gram = gradients_per_m.iter().fold(DMat3::ZERO, |sum, &g| sum + outer(g));
    // omega^2 = V_0 Lambda(G / (rho V_0 / 4)) = 4 Lambda(G) / rho
    (constants.density_kg_m3 / stiffness_eigenvalue(&gram, constants)).sqrt()
}

/// Largest eigenvalue of `E -> D (E G + G E) / 2` for `G = gram`.
fn stiffness_eigenvalue(gram: &DMat3, constants: &ElasticConstants) -> f64 {
    let (lambda, mu) = (constants.lambda_pa, constants.mu_pa);
    let c = symmetric_eigenvalues(gram).max(DVec3::ZERO);
    let root = c.map(f64::sqrt);
    let normal = DMat3::from_diagonal(c * (2.0 * mu)) + outer(root) * lambda;
    let shear = mu * (c.x + c.y);
    symmetric_eigenvalues(&normal).x.max(shear)
}

fn outer(v: DVec3) -> DMat3 {
    DMat3::from_cols(v * v.x, v * v.y, v * v.z)
}
