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

use super::{ElasticConstants, ElementBatches, ElementKinematics, ScaledNodeMasses, scale_masses};
use crate::math::symmetric_eigenvalues;
use glam::{DMat3, DVec3};

/// Ways to share the node masses that are tried: by element mass, by stiffness, and once more by the
/// stiffness that came out. More rounds were seen to gain 1 % with slivers and up to 6 % without; each costs
/// as much as ten to twenty elastic steps.
const SHARING_ROUNDS: usize = 3;

/// A way to share the masses of the nodes among their elements.
pub(super) struct Sharing {
    /// Each node gives its elements mass in proportion to these.
    pub weights: Vec<f64>,
    /// `lambda_max(M_e^-1 K_e)` of each element, 1/s2.
    pub eigenvalues_per_s2: Vec<f64>,
    largest: f64,
}

impl ElasticConstants {
    /// A floor of [`ElementBatches::element_stable_steps_s`], s, for elements of this material whose smallest altitude `h` is not
    /// below `altitude_m`: with a quarter of its mass at each node, an element's `omega^2` is at most
    /// `4 c_p^2 sum_a |g_a|^2 <= 16 c_p^2 / h^2` (a negative lambda counts as none).
    #[must_use]
    pub fn stable_step_floor_s(&self, altitude_m: f64) -> f64 {
        let stiffest = Self { lambda_pa: self.lambda_pa.max(0.0), ..*self };
        altitude_m / (2.0 * stiffest.p_wave_speed_m_s())
    }
}

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

    /// A stable step of the assembled body near its reference shape, s: never above `2 / omega_max`,
    /// and, if `node_masses_kg` are the lumped masses, never below the smallest of
    /// [`Self::element_stable_steps_s`].
    ///
    /// Heavy neighbours of a bad element bear it: on a mesh of 9,683 elements, 19 of them slivers, this was 18 times
    /// longer than the worst sliver by itself allows (and 0.88 of `2 / omega_max`). Held nodes may be given infinite mass. Infinite without elements.
    #[must_use]
    pub fn stable_step_s(&self, node_masses_kg: &[f64]) -> f64 {
        2.0 / self.best_sharing(node_masses_kg).largest.sqrt()
    }

    /// Shares the masses of the nodes as well as is known, for [`super::ElasticState::eigenvalue_per_s2`]; returns the
    /// [`Self::stable_step_s`] that goes with it, s.
    pub fn share_masses(&mut self, node_masses_kg: &[f64]) -> f64 {
        let sharing = self.best_sharing(node_masses_kg);
        self.set_eigenvalues(sharing.eigenvalues_per_s2);
        2.0 / sharing.largest.sqrt()
    }

    /// For a body that is stable in its reference shape at this step (s) by a way to share its masses that is not known
    /// element by element: as if every element asked for it.
    pub fn share_masses_evenly(&mut self, stable_step_s: f64) {
        self.set_eigenvalues(vec![(2.0 / stable_step_s).powi(2); self.element_count()]);
    }

    pub(super) fn set_eigenvalues(&mut self, eigenvalues_per_s2: Vec<f64>) {
        for chunk in &mut self.chunks {
            let places = chunk.batches.iter_mut().flat_map(|batch| &mut batch.shape.eigenvalue_per_s2.0);
            for (place, element) in places.zip(&chunk.layout.elements) {
                *place = eigenvalues_per_s2[*element as usize];
            }
        }
        self.eigenvalues_per_s2 = eigenvalues_per_s2;
    }

    /// Sets `lambda_max(M_e^-1 K_e)` of one element, 1/s2.
    pub(super) fn set_eigenvalue(&mut self, element: u32, eigenvalue_per_s2: f64) {
        self.eigenvalues_per_s2[element as usize] = eigenvalue_per_s2;
        self.chunks[self.chunk_of[element as usize] as usize].set_eigenvalue(element, eigenvalue_per_s2);
    }

    /// Makes nodes heavier so that the step becomes as long as it can with at most `max_share` (not negative) of
    /// the mass added; `node_masses_kg` must be finite.
    ///
    /// To be stable at the step `h`, an element asks its corners for a mass that grows with `h^2`; a node that has what its
    /// elements ask for together is left alone. So the neighbours of a sliver bear it as far as they can, and mass
    /// is added only for the rest, by [`scale_masses`] over the nodes.
    #[must_use]
    pub fn scale_node_masses(&self, node_masses_kg: &[f64], max_share: f64) -> ScaledNodeMasses {
        let asked = self.asked_masses_kg_s2();
        let nodes = || node_masses_kg.iter().zip(&asked);
        let steps_s: Vec<f64> = nodes()
            .map(|(mass, &asked)| if asked > 0.0 { (mass / asked).sqrt() } else { f64::INFINITY })
            .collect();
        let scaling = scale_masses(&steps_s, node_masses_kg, max_share);
        let scaled = node_masses_kg.iter().zip(&scaling.factors);
        let scaled_kg: Vec<f64> = scaled.map(|(mass, factor)| mass * factor).collect();
        let is_heavier = |tet: &&[u32; 4]| tet.iter().any(|&node| scaling.factors[node as usize] > 1.0);
        ScaledNodeMasses {
            step_s: scaling.step_s.max(self.stable_step_s(&scaled_kg)),
            node_masses_kg: scaled_kg,
            added_mass_kg: scaling.added_mass_kg,
            heavier_elements: self.tets.iter().filter(is_heavier).count(),
        }
    }

    /// What the elements of each node ask of it together: mass over the squared step, kg/s2.
    ///
    /// An element may spread what it needs over its corners as it likes. In proportion to the lengths of the gradients, the
    /// trace of its `G` is the smallest for the same mass.
    fn asked_masses_kg_s2(&self) -> Vec<f64> {
        let by_element = self.map_elements(|element, gradients_per_m| {
            let constants = &self.constants[element];
            let volume_m3 = self.masses_kg[element] / constants.density_kg_m3;
            let lengths = gradients_per_m.map(DVec3::length);
            let shares = lengths.map(|length| length / lengths.iter().sum::<f64>());
            let parts = gradients_per_m.iter().zip(shares);
            let gram = parts.fold(DMat3::ZERO, |sum, (&g, share)| sum + outer(g) * share.recip());
            // omega^2 = V_0 Lambda(gram) / mass <= 4 / h^2
            let asked = 0.25 * volume_m3 * stiffness_eigenvalue(&gram, constants);
            shares.map(|share| share * asked)
        });
        let mut at_nodes = vec![0.0; self.node_count()];
        for (tet, asked) in self.tets.iter().zip(by_element) {
            for (&node, asked) in tet.iter().zip(asked) {
                at_nodes[node as usize] += asked;
            }
        }
        at_nodes
    }

    /// The sharing with the lowest largest eigenvalue among those tried.
    pub(super) fn best_sharing(&self, node_masses_kg: &[f64]) -> Sharing {
        let mut best = self.share(node_masses_kg, self.masses_kg.clone());
        for _ in 1..SHARING_ROUNDS {
            // Elements that came out stiff get a larger share of their nodes.
            let stiffer = best.weights.iter().zip(&best.eigenvalues_per_s2);
            let weights = stiffer.map(|(weight, x)| weight * (x / best.largest)).collect();
            let next = self.share(node_masses_kg, weights);
            if next.largest >= best.largest {
                break;
            }
            best = next;
        }
        best
    }

    pub(super) fn share(&self, node_masses_kg: &[f64], weights: Vec<f64>) -> Sharing {
        let mut weights_at_nodes = vec![0.0; self.node_count()];
        for (tet, weight) in self.tets.iter().zip(&weights) {
            for &node in tet {
                weights_at_nodes[node as usize] += weight;
            }
        }
        let eigenvalues_per_s2 = self.map_elements(|element, gradients_per_m| {
            let corner_kg = self.tets[element].map(|node| {
                let share = weights[element] / weights_at_nodes[node as usize];
                node_masses_kg[node as usize] * share
            });
            sharing_eigenvalue(self, element, &gradients_per_m, corner_kg)
        });
        let largest = eigenvalues_per_s2.iter().copied().fold(0.0, f64::max);
        Sharing { weights, eigenvalues_per_s2, largest }
    }

    /// The largest norm of the Cauchy stress of these constants (Pa) where [`super::ElasticState::max_strain`] is `strain`, below
    /// 1/2. Of `green`, with stretches between `sqrt(1 - 2 e)` and `sqrt(1 + 2 e)`,
    /// `|sigma| <= (3 |lambda| + 2 mu) e (1 + 2e)/(1 - 2e)^(3/2)`.
    #[must_use]
    pub fn most_stress_pa(constants: &ElasticConstants, kinematics: ElementKinematics, strain: f64) -> f64 {
        let stiffness_pa = 3.0 * constants.lambda_pa.abs() + 2.0 * constants.mu_pa;
        match kinematics {
            ElementKinematics::Green => {
                stiffness_pa * strain * (1.0 + 2.0 * strain) / (1.0 - 2.0 * strain).powf(1.5)
            }
            ElementKinematics::BodyFrame { .. } => stiffness_pa * strain,
            ElementKinematics::Corotated => super::corotated::most_stress_pa(constants, strain),
            ElementKinematics::NeoHookean => super::neo_hookean::most_stress_pa(constants, strain),
        }
    }
}

/// `lambda_max(M_e^-1 K_e)` of an element with these masses at its corners, 1/s2.
pub(super) fn sharing_eigenvalue(
    elements: &ElementBatches,
    element: usize,
    gradients_per_m: &[DVec3; 4],
    corner_kg: [f64; 4],
) -> f64 {
    let parts = gradients_per_m.iter().zip(corner_kg);
    let gram = parts.fold(DMat3::ZERO, |sum, (&g, kg)| sum + outer(g) * kg.recip());
    let constants = &elements.constants[element];
    let volume_m3 = elements.masses_kg[element] / constants.density_kg_m3;
    volume_m3 * stiffness_eigenvalue(&gram, constants)
}

/// The coefficient of strain in the bound of the squared frequencies of a deformed `green` element.
///
/// With `F` of largest stretch `s` and largest principal stress `p`, the tangent stiffness obeys
/// `omega^2 <= omega_0^2 s^2 + V_0 p^+ c_1` (material and geometric part). With
/// `e = sqrt(E : E)`: `s^2 <= 1 + 2e`, `p <= (sqrt(3) |lambda| + 2 mu) e`, and `omega_0^2 >= V_0 (lambda + 2 mu) c_1`, so
/// `omega^2 / omega_0^2 <= 1 + (2 + (sqrt(3) |lambda| + 2 mu)/(lambda + 2 mu)) e`.
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
