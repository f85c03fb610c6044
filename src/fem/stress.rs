//! Stress and energy element by element, and the search for what is not finite. Plain code: it runs when a
//! picture or a row of data is asked for, not in every step; the tests hold the fast kernel against it.

use super::elements::{Chunk, gradients_per_m};
use super::lanes::BATCH;
use super::{ElementBatches, ElementKinematics, ForceScratch, corotated, neo_hookean};
use glam::{DMat3, DVec3};
use rayon::prelude::*;

/// Where a number stopped being finite.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum NotFinitePlace {
    /// Position of this node.
    Node(usize),
    /// Stress or energy of this element, all nodes being finite.
    Element(usize),
}

/// Stress of one element: `P = frame stress`.
struct ElementStress {
    /// Deformation gradient.
    gradient: DMat3,
    /// `F` for `green`, the rotation of the body or of the element, none for `neo-hookean`.
    frame: DMat3,
    /// Second Piola-Kirchhoff stress, stress seen from the frame, or `P` itself, Pa.
    stress_pa: DMat3,
    /// Energy per volume of the reference shape, Pa.
    energy_pa: f64,
}

impl ElementStress {
    fn cauchy_pa(&self, kinematics: ElementKinematics) -> DMat3 {
        let turned = self.frame * self.stress_pa;
        match kinematics {
            ElementKinematics::BodyFrame { rotation } => turned * rotation.transpose(),
            _ => turned * self.gradient.transpose() * self.gradient.determinant().recip(),
        }
    }
}

/// `W = stress : strain / 2`.
fn linear_energy_pa(stress_pa: &DMat3, strain: &DMat3) -> f64 {
    let work = |axis: usize| stress_pa.col(axis).dot(strain.col(axis));
    0.5 * (work(0) + work(1) + work(2))
}

impl ElementBatches {
    /// Cauchy stress of each element, Pa, tension positive, world axes, in the caller's order:
    /// `P F^T / J` (not finite if the element is exactly flat), but `R s R^T` for `body-frame`.
    #[must_use]
    pub fn cauchy_stresses_pa(&self, positions_m: &[DVec3], kinematics: ElementKinematics) -> Vec<DMat3> {
        self.map_elements(|element, gradients_per_m| {
            let at = self.stress_of(element, &gradients_per_m, positions_m, kinematics);
            at.cauchy_pa(kinematics)
        })
    }

    /// What `judge` makes of the index and the Cauchy stress (as [`Self::cauchy_stresses_pa`]) of the elements that
    /// may be strained by `sqrt(E : E) >= strain`, found in the chunks where the last call of [`Self::forces`] met such a
    /// strain; in the order of the chunks, not of the elements. Costs nothing where it met none.
    #[must_use]
    pub fn judge_strained<R: Send>(
        &self,
        scratch: &ForceScratch,
        positions_m: &[DVec3],
        kinematics: ElementKinematics,
        strain: f64,
        judge: impl Fn(u32, &DMat3) -> Option<R> + Sync,
    ) -> Vec<R> {
        let is_strained = |index: usize| scratch.largest_strain(index).is_none_or(|most| most >= strain);
        let of_chunk = |(_, chunk): (usize, &Chunk)| -> Vec<R> {
            let judged = chunk.elements().filter_map(|(element, gradients)| {
                let at = self.stress_of(element, &gradients, positions_m, kinematics);
                judge(element as u32, &at.cauchy_pa(kinematics))
            });
            judged.collect()
        };
        let chunks = self.chunks.par_iter().enumerate().filter(|(index, _)| is_strained(*index));
        chunks.flat_map_iter(of_chunk).collect()
    }

    /// Strain energy of each element, J, in the caller's order.
    #[must_use]
    pub fn element_energies_j(&self, positions_m: &[DVec3], kinematics: ElementKinematics) -> Vec<f64> {
        self.map_elements(|element, gradients_per_m| {
            let at = self.stress_of(element, &gradients_per_m, positions_m, kinematics);
            let volume_m3 = self.masses_kg[element] / self.constants[element].density_kg_m3;
            volume_m3 * at.energy_pa
        })
    }

    /// Strain energy of the body, J; equal to that of [`Self::forces`] up to round-off.
    #[must_use]
    pub fn strain_energy_j(&self, positions_m: &[DVec3], kinematics: ElementKinematics) -> f64 {
        let energies_j = self.element_energies_j(positions_m, kinematics);
        energies_j.iter().fold(0.0, |sum, energy| sum + energy)
    }

    /// Elastic force of one element on its corners, `-V_0 P grad_X N_a`, N; with its reference corners, m. What
    /// [`Self::forces`] adds up, element by element.
    #[must_use]
    pub fn element_forces_n(
        &self,
        element: u32,
        reference_m: &[DVec3; 4],
        positions_m: &[DVec3],
        kinematics: ElementKinematics,
    ) -> [DVec3; 4] {
        let element = element as usize;
        let gradients_per_m = gradients_per_m(reference_m);
        let at = self.stress_of(element, &gradients_per_m, positions_m, kinematics);
        let volume_m3 = self.masses_kg[element] / self.constants[element].density_kg_m3;
        gradients_per_m.map(|g| at.frame * (at.stress_pa * g) * -volume_m3)
    }

    /// The first node, else the first element, that is not finite. To be asked only once
    /// [`super::ElasticState::strain_energy_j`] is not finite: it looks at everything.
    #[must_use]
    pub fn first_not_finite(
        &self,
        positions_m: &[DVec3],
        kinematics: ElementKinematics,
    ) -> Option<NotFinitePlace> {
        if let Some(node) = positions_m.iter().position(|x| !x.is_finite()) {
            return Some(NotFinitePlace::Node(node));
        }
        let energies_j = self.element_energies_j(positions_m, kinematics);
        let element = energies_j.iter().position(|energy| !energy.is_finite());
        element.map(NotFinitePlace::Element)
    }

    fn stress_of(
        &self,
        element: usize,
        gradients_per_m: &[DVec3; 4],
        positions_m: &[DVec3],
        kinematics: ElementKinematics,
    ) -> ElementStress {
        let corners_m = self.tets[element].map(|node| positions_m[node as usize]);
        let mut gradient = DMat3::ZERO;
        for (corner_m, g) in corners_m.iter().zip(gradients_per_m).skip(1) {
            let edge_m = *corner_m - corners_m[0];
            gradient += DMat3::from_cols(edge_m * g.x, edge_m * g.y, edge_m * g.z);
        }
        let constants = &self.constants[element];
        let (frame, strain) = match kinematics {
            ElementKinematics::Green => (gradient, (gradient.transpose() * gradient - DMat3::IDENTITY) * 0.5),
            ElementKinematics::BodyFrame { rotation } => (rotation, corotated::strain(&gradient, &rotation)),
            ElementKinematics::Corotated => {
                let rotation = corotated::rotation_of(&gradient);
                (rotation, corotated::strain(&gradient, &rotation))
            }
            ElementKinematics::NeoHookean => {
                let stress_pa = neo_hookean::first_piola_pa(&gradient, constants);
                let energy_pa = neo_hookean::energy_pa(&gradient, constants);
                return ElementStress { gradient, frame: DMat3::IDENTITY, stress_pa, energy_pa };
            }
        };
        let stress_pa = constants.stress_pa(&strain);
        ElementStress { gradient, frame, stress_pa, energy_pa: linear_energy_pa(&stress_pa, &strain) }
    }

    /// A value for each element from its index and its gradients (1/m), in the caller's order.
    pub(super) fn map_elements<T: Clone + Default + Send>(
        &self,
        value: impl Fn(usize, [DVec3; 4]) -> T + Sync,
    ) -> Vec<T> {
        let of_chunk = |chunk: &Chunk| -> Vec<T> {
            chunk.elements().map(|(element, gradients)| value(element, gradients)).collect()
        };
        let by_chunk: Vec<Vec<T>> = self.chunks.par_iter().map(of_chunk).collect();
        let mut values = vec![T::default(); self.element_count()];
        for (chunk, chunk_values) in self.chunks.iter().zip(by_chunk) {
            for (&element, value) in chunk.layout.elements.iter().zip(chunk_values) {
                values[element as usize] = value;
            }
        }
        values
    }
}

impl Chunk {
    /// Index and gradients `g_0 .. g_3` (1/m) of each element.
    fn elements(&self) -> impl Iterator<Item = (usize, [DVec3; 4])> {
        self.layout.elements.iter().enumerate().map(|(place, &element)| {
            let shape = &self.batches[place / BATCH].shape;
            let [g1, g2, g3] = shape.gradients_per_m(place % BATCH);
            (element as usize, [-(g1 + g2 + g3), g1, g2, g3])
        })
    }
}
