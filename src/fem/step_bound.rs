//! The stable step of a body that is being cut: followed cut by cut, at a cost that goes with what changes.

use super::elements::gradients_per_m;
use super::stable_step::{Sharing, sharing_eigenvalue};
use super::{ElementBatches, ElementChanges};
use glam::DVec3;

/// Elements whose extremes are kept together.
const BLOCK: usize = 128;

/// A stable step near the reference shape, from a way to share the masses of the nodes among their elements (see
/// `stable_step`): any way gives a bound.
#[derive(Clone, Debug)]
pub struct StepBound {
    /// What each element asks of its nodes, for its mass.
    weights_per_kg: Vec<f64>,
    weights_at_nodes: Vec<f64>,
    /// `lambda_max(M_e^-1 K_e)` of each element, 1/s2.
    eigenvalues: Vec<f64>,
    /// The largest eigenvalue (1/s2) and the smallest step of an element by itself (s), block by block.
    blocks: Vec<(f64, f64)>,
}

/// What a bound looks at when a body has been cut.
pub struct CutBody<'a, At> {
    /// Its elements, which have followed already.
    pub elements: &'a ElementBatches,
    /// Reference positions, m.
    pub reference_m: &'a [DVec3],
    /// Lumped masses, kg.
    pub node_masses_kg: &'a [f64],
    /// The elements at each node.
    pub elements_at: At,
}

impl StepBound {
    /// The bound of [`ElementBatches::stable_step_s`], to be followed.
    #[must_use]
    pub fn new(elements: &ElementBatches, node_masses_kg: &[f64]) -> Self {
        let Sharing { weights, eigenvalues, .. } = elements.best_sharing(node_masses_kg);
        let mut weights_at_nodes = vec![0.0; elements.node_count()];
        for (tet, weight) in elements.tets.iter().zip(&weights) {
            tet.iter().for_each(|node| weights_at_nodes[*node as usize] += weight);
        }
        let weights_per_kg = weights.iter().zip(&elements.masses_kg).map(|(w, kg)| w / kg).collect();
        let mut bound = Self { weights_per_kg, weights_at_nodes, eigenvalues, blocks: Vec::new() };
        let count = elements.element_count();
        bound.renew_blocks(elements, (0..count).step_by(BLOCK).map(|e| e as u32));
        bound
    }

    /// A stable step, s: never below the smallest of [`ElementBatches::element_stable_steps_s`]. Infinite without elements.
    #[must_use]
    pub fn step_s(&self) -> f64 {
        let zero = (0.0_f64, f64::INFINITY);
        let (largest, shortest_s) = self.blocks.iter().fold(zero, |a, b| (a.0.max(b.0), a.1.min(b.1)));
        if self.blocks.is_empty() { f64::INFINITY } else { (2.0 / largest.sqrt()).max(shortest_s) }
    }

    /// Follows a cut, after which `touched_nodes` have other elements or masses than before.
    pub fn follow<'a, At: Fn(u32) -> &'a [u32]>(
        &mut self,
        body: &CutBody<'a, At>,
        touched_nodes: &[u32],
        changes: ElementChanges,
    ) {
        let first_new = self.weights_per_kg.len() as u32;
        for parent in changes.cut_from {
            self.weights_per_kg.push(self.weights_per_kg[*parent as usize]);
            self.eigenvalues.push(self.eigenvalues[*parent as usize]);
        }
        let count = self.weights_per_kg.len() as u32;
        self.weights_at_nodes.resize(body.node_masses_kg.len(), 0.0);
        let cut: Vec<u32> = changes.changed.iter().copied().chain(first_new..count).collect();
        let mut nodes: Vec<u32> = cut.iter().flat_map(|e| body.elements.tets[*e as usize]).collect();
        nodes.extend_from_slice(touched_nodes);
        nodes.sort_unstable();
        nodes.dedup();
        let mut around: Vec<u32> = nodes.iter().flat_map(|n| (body.elements_at)(*n)).copied().collect();
        around.sort_unstable();
        around.dedup();
        let before: Vec<f64> = cut.iter().map(|e| self.eigenvalues[*e as usize]).collect();
        let plain = self.share(body, &nodes, &around);
        // A part that came out stiffer than what it was cut from gets more of its nodes.
        let weights: Vec<f64> = cut.iter().map(|e| self.weights_per_kg[*e as usize]).collect();
        for (e, before) in cut.iter().zip(before) {
            self.weights_per_kg[*e as usize] *= (plain.of(*e) / before).max(1.0);
        }
        let stiffer = self.share(body, &nodes, &around);
        let kept = if stiffer.largest() < plain.largest() {
            stiffer
        } else {
            cut.iter().zip(weights).for_each(|(e, weight)| self.weights_per_kg[*e as usize] = weight);
            self.add_up(body, &nodes);
            plain
        };
        kept.0.iter().for_each(|(e, eigenvalue)| self.eigenvalues[*e as usize] = *eigenvalue);
        self.renew_blocks(body.elements, around.into_iter());
    }

    fn weight(&self, elements: &ElementBatches, element: u32) -> f64 {
        self.weights_per_kg[element as usize] * elements.masses_kg[element as usize]
    }

    /// Adds up the weights at these nodes.
    fn add_up<'a, At: Fn(u32) -> &'a [u32]>(&mut self, body: &CutBody<'a, At>, nodes: &[u32]) {
        for node in nodes {
            let at_node = (body.elements_at)(*node).iter();
            self.weights_at_nodes[*node as usize] = at_node.map(|e| self.weight(body.elements, *e)).sum();
        }
    }

    /// The eigenvalues of these elements, which are all that have such nodes, with the weights as they are.
    fn share<'a, At: Fn(u32) -> &'a [u32]>(
        &mut self,
        body: &CutBody<'a, At>,
        nodes: &[u32],
        elements: &[u32],
    ) -> Eigenvalues {
        self.add_up(body, nodes);
        let eigenvalue = |e: &u32| {
            let element = *e as usize;
            let tet = body.elements.tets[element];
            let corner_kg = tet.map(|node| {
                let share = self.weight(body.elements, *e) / self.weights_at_nodes[node as usize];
                body.node_masses_kg[node as usize] * share
            });
            let gradients_per_m = gradients_per_m(&tet.map(|node| body.reference_m[node as usize]));
            (*e, sharing_eigenvalue(body.elements, element, &gradients_per_m, corner_kg))
        };
        Eigenvalues(elements.iter().map(eigenvalue).collect())
    }

    fn renew_blocks(&mut self, elements: &ElementBatches, of: impl Iterator<Item = u32>) {
        self.blocks.resize(self.eigenvalues.len().div_ceil(BLOCK), (0.0, 0.0));
        let mut blocks: Vec<usize> = of.map(|e| e as usize / BLOCK).collect();
        blocks.dedup();
        for block in blocks {
            let range = block * BLOCK..((block + 1) * BLOCK).min(self.eigenvalues.len());
            let largest = self.eigenvalues[range.clone()].iter().copied().fold(0.0, f64::max);
            let shortest_s = elements.steps_s[range].iter().copied().fold(f64::INFINITY, f64::min);
            self.blocks[block] = (largest, shortest_s);
        }
    }
}

/// Eigenvalues of some elements, by ascending element, 1/s2.
struct Eigenvalues(Vec<(u32, f64)>);

impl Eigenvalues {
    fn of(&self, element: u32) -> f64 {
        self.0.binary_search_by_key(&element, |x| x.0).map_or(0.0, |at| self.0[at].1)
    }

    fn largest(&self) -> f64 {
        self.0.iter().map(|x| x.1).fold(0.0, f64::max)
    }
}
