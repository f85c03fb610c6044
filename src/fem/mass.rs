//! Lumped mass, and mass scaling.

use super::ElementBatches;

impl ElementBatches {
    /// Mass of each element, kg, in the caller's order.
    #[must_use]
    pub fn element_masses_kg(&self) -> &[f64] {
        &self.masses_kg
    }

    /// Lumped node masses, kg: a quarter of each element's mass at each corner, times the element's
    /// factor if `factors` (one per element, from [`scale_masses`]) are given. Nodes of no element have none.
    #[must_use]
    pub fn lumped_masses_kg(&self, factors: Option<&[f64]>) -> Vec<f64> {
        let mut node_masses_kg = vec![0.0; self.node_count()];
        for (element, tet) in self.tets.iter().enumerate() {
            let factor = factors.map_or(1.0, |factors| factors[element]);
            for &node in tet {
                node_masses_kg[node as usize] += 0.25 * factor * self.masses_kg[element];
            }
        }
        node_masses_kg
    }
}

/// Which elements are made heavier, and what that gains.
#[derive(Clone, Debug, PartialEq)]
pub struct MassScaling {
    /// Factor on each element's mass, 1 or more.
    pub factors: Vec<f64>,
    /// Mass added in all, kg.
    pub added_mass_kg: f64,
    /// Smallest element step with the factors, s.
    pub step_s: f64,
}

/// Node masses after mass scaling, and what that gained.
#[derive(Clone, Debug, PartialEq)]
pub struct ScaledNodeMasses {
    /// Mass of each node, kg, none lighter than before.
    pub node_masses_kg: Vec<f64>,
    /// Mass added in all, kg.
    pub added_mass_kg: f64,
    /// How many elements gave reason to add mass.
    pub heavier_elements: usize,
    /// Stable step with the new masses, s.
    pub step_s: f64,
}

/// Makes the worst elements heavier so that the smallest element step becomes as long as it can with at most
/// `max_share` (not negative) of the total mass added.
///
/// An element's step grows with the root of its mass, so reaching the step `h` costs
/// `sum_e m_e ((h/h_e)^2 - 1)` over the elements with `h_e < h`. Taken from the smallest step up, this is a quadratic
/// equation between two neighbouring steps: the answer is exact, not searched for.
#[must_use]
pub fn scale_masses(steps_s: &[f64], masses_kg: &[f64], max_share: f64) -> MassScaling {
    let mut order: Vec<usize> = (0..steps_s.len()).collect();
    order.sort_by(|&a, &b| steps_s[a].total_cmp(&steps_s[b]));
    let budget_kg = max_share * masses_kg.iter().sum::<f64>();
    let mut step_s = f64::INFINITY;
    // Of the elements made heavier: their mass, and the mass per squared step that they need.
    let (mut own_kg, mut needed_kg_s2) = (0.0, 0.0);
    for (rank, &element) in order.iter().enumerate() {
        own_kg += masses_kg[element];
        needed_kg_s2 += masses_kg[element] / (steps_s[element] * steps_s[element]);
        // The budget never buys less than the step that is there already.
        step_s = f64::max(((budget_kg + own_kg) / needed_kg_s2).sqrt(), steps_s[order[0]]);
        let next = order.get(rank + 1).map_or(f64::INFINITY, |&next| steps_s[next]);
        if step_s <= next {
            break;
        }
    }
    let factors: Vec<f64> = steps_s.iter().map(|&own_s| f64::max(1.0, (step_s / own_s).powi(2))).collect();
    let added = factors.iter().zip(masses_kg);
    let added_mass_kg = added.map(|(factor, mass)| (factor - 1.0) * mass).sum();
    MassScaling { factors, added_mass_kg, step_s }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn no_share_changes_nothing() {
        let scaling = scale_masses(&[2.0, 1.0, 3.0], &[1.0; 3], 0.0);
        assert_eq!(scaling.factors, [1.0; 3]);
        assert_eq!((scaling.added_mass_kg, scaling.step_s), (0.0, 1.0));
        assert_eq!(scale_masses(&[], &[], 0.1).step_s, f64::INFINITY);
    }

    #[test]
    fn one_sliver_is_lifted_as_far_as_the_share_goes() {
        // Mass 100, 3 % = 3 kg more on the 1 kg sliver: four times its mass, twice its step.
        let scaling = scale_masses(&[1.0, 10.0], &[1.0, 99.0], 0.03);
        assert_eq!(scaling.factors, [4.0, 1.0]);
        assert_eq!(scaling.step_s, 2.0);
    }

    proptest! {
        #[test]
        fn spends_the_share_and_no_cheaper_way_is_left(
            elements in prop::collection::vec((1e-8..1e-4f64, 0.1..10.0f64), 1..40), share in 0.0..0.5f64,
        ) {
            let (steps, masses): (Vec<f64>, Vec<f64>) = elements.into_iter().unzip();
            let scaling = scale_masses(&steps, &masses, share);
            let budget = share * masses.iter().sum::<f64>();
            prop_assert!((scaling.added_mass_kg - budget).abs() <= 1e-9 * masses.iter().sum::<f64>());
            for (factor, own) in scaling.factors.iter().zip(&steps) {
                let step = own * factor.sqrt();
                prop_assert!(step >= scaling.step_s * (1.0 - 1e-12));
                // Nobody above the target was made heavier.
                prop_assert!(*factor == 1.0 || step <= scaling.step_s * (1.0 + 1e-12));
            }
        }
    }
}
