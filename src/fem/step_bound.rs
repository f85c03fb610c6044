//! The stable step of a body that is being cut: followed cut by cut, at a cost that goes with what changes.

use super::elements::gradients_per_m;
use super::stable_step::{Sharing, sharing_eigenvalue};
use super::{ElementBatches, ElementChanges};
use glam::DVec3;

/// Elements whose extremes are kept together.
const BLOCK: usize = 128;
/// How often, after a cut, the stiffest element is given more of its nodes,
const RELIEFS: usize = 24;
/// and how much more.
const RELIEF: f64 = 1.3;

/// A stable step near the reference shape, from a way to share the masses of the nodes among their elements (see
/// `stable_step`): any way gives a bound. What each element comes to is kept with the elements.
#[derive(Clone, Debug)]
pub struct StepBound {
    /// What each element asks of its nodes, for its mass.
    weights_per_kg: Vec<f64>,
    weights_at_nodes: Vec<f64>,
    /// The largest eigenvalue (1/s2) and the smallest step of an element by itself (s), block by block.
    blocks: Vec<(f64, f64)>,
}

/// What a bound looks at when a body has been cut.
pub struct CutBody<'a, At> {
    /// Its elements, which have followed already; those near the cut get other shares of their nodes.
    pub elements: &'a mut ElementBatches,
    /// Reference positions, m.
    pub reference_m: &'a [DVec3],
    /// Lumped masses, kg.
    pub node_masses_kg: &'a [f64],
    /// The elements at each node.
    pub elements_at: At,
}

impl<'a, At: Fn(u32) -> &'a [u32]> CutBody<'a, At> {
    /// The elements at these nodes, in order.
    fn around(&self, nodes: &[u32]) -> Vec<u32> {
        let mut around: Vec<u32> = nodes.iter().flat_map(|n| (self.elements_at)(*n)).copied().collect();
        around.sort_unstable();
        around.dedup();
        around
    }

    fn eigenvalue(&self, element: u32) -> f64 {
        self.elements.eigenvalues_per_s2[element as usize]
    }
}

impl StepBound {
    /// The bound of [`ElementBatches::stable_step_s`], to be followed; shares the masses among the elements by it.
    #[must_use]
    pub fn new(elements: &mut ElementBatches, node_masses_kg: &[f64]) -> Self {
        let Sharing { weights, eigenvalues_per_s2, .. } = elements.best_sharing(node_masses_kg);
        elements.set_eigenvalues(eigenvalues_per_s2);
        Self::of_weights(elements, &weights)
    }

    fn of_weights(elements: &ElementBatches, weights: &[f64]) -> Self {
        let mut weights_at_nodes = vec![0.0; elements.node_count()];
        for (tet, weight) in elements.tets.iter().zip(weights) {
            tet.iter().for_each(|node| weights_at_nodes[*node as usize] += weight);
        }
        let weights_per_kg = weights.iter().zip(&elements.masses_kg).map(|(w, kg)| w / kg).collect();
        let mut bound = Self { weights_per_kg, weights_at_nodes, blocks: Vec::new() };
        bound.renew_blocks(elements, (0..elements.element_count()).step_by(BLOCK).map(|e| e as u32));
        bound
    }

    /// A stable step, s: never below the smallest of [`ElementBatches::element_stable_steps_s`]. Infinite without elements.
    #[must_use]
    pub fn step_s(&self) -> f64 {
        2.0 / self.extremes().0.sqrt()
    }

    /// The largest eigenvalue, 1/s2, and the smallest step of an element by itself, s.
    fn extremes(&self) -> (f64, f64) {
        self.blocks.iter().fold((0.0, f64::INFINITY), |a, b| (a.0.max(b.0), a.1.min(b.1)))
    }

    /// Follows a cut, after which `touched_nodes` have other elements or masses than before.
    pub fn follow<'a, At: Fn(u32) -> &'a [u32]>(
        &mut self,
        body: &mut CutBody<'a, At>,
        touched_nodes: &[u32],
        changes: ElementChanges,
    ) {
        let first_new = self.weights_per_kg.len() as u32;
        for parent in changes.cut_from {
            self.weights_per_kg.push(self.weights_per_kg[*parent as usize]);
        }
        let count = self.weights_per_kg.len() as u32;
        self.weights_at_nodes.resize(body.node_masses_kg.len(), 0.0);
        let cut: Vec<u32> = changes.changed.iter().copied().chain(first_new..count).collect();
        let mut nodes: Vec<u32> = cut.iter().flat_map(|e| body.elements.tets[*e as usize]).collect();
        nodes.extend_from_slice(touched_nodes);
        nodes.sort_unstable();
        nodes.dedup();
        let around = body.around(&nodes);
        let plain = self.share(body, &nodes, &around);
        // A part that came out stiffer than what it was cut from gets more of its nodes.
        let weights: Vec<f64> = cut.iter().map(|e| self.weights_per_kg[*e as usize]).collect();
        for e in &cut {
            self.weights_per_kg[*e as usize] *= (plain.of(*e) / body.eigenvalue(*e)).max(1.0);
        }
        let stiffer = self.share(body, &nodes, &around);
        let kept = if stiffer.largest() < plain.largest() {
            stiffer
        } else {
            cut.iter().zip(weights).for_each(|(e, weight)| self.weights_per_kg[*e as usize] = weight);
            self.add_up(body, &nodes);
            plain
        };
        self.keep(body.elements, &kept);
        for _ in 0..RELIEFS {
            if !self.relieve_stiffest(body) {
                break;
            }
        }
        let (largest, shortest_s) = self.extremes();
        if 2.0 / largest.sqrt() < shortest_s * (1.0 - 1e-9) {
            // To each element what is its own: the step of the worst by itself.
            let of_masses = body.elements.share(body.node_masses_kg, body.elements.masses_kg.clone());
            body.elements.set_eigenvalues(of_masses.eigenvalues_per_s2);
            *self = Self::of_weights(body.elements, &of_masses.weights);
        }
    }

    /// Gives the stiffest element more of its nodes, where that leaves none as stiff as it was.
    fn relieve_stiffest<'a, At: Fn(u32) -> &'a [u32]>(&mut self, body: &mut CutBody<'a, At>) -> bool {
        let stiffest = self.stiffest(body.elements);
        let most = body.eigenvalue(stiffest);
        let nodes = body.elements.tets[stiffest as usize];
        let around = body.around(&nodes);
        let weight_per_kg = self.weights_per_kg[stiffest as usize];
        self.weights_per_kg[stiffest as usize] = RELIEF * weight_per_kg;
        let relieved = self.share(body, &nodes, &around);
        let is_better = relieved.largest() < most;
        if is_better {
            self.keep(body.elements, &relieved);
        } else {
            self.weights_per_kg[stiffest as usize] = weight_per_kg;
            self.add_up(body, &nodes);
        }
        is_better
    }

    /// The first element with the largest eigenvalue.
    fn stiffest(&self, elements: &ElementBatches) -> u32 {
        let first_largest = |of: &mut dyn Iterator<Item = f64>| {
            let larger = |a: (usize, f64), b: (usize, f64)| if b.1 > a.1 { b } else { a };
            of.enumerate().fold((0, 0.0), larger).0
        };
        let block = first_largest(&mut self.blocks.iter().map(|block| block.0));
        let of_block = elements.eigenvalues_per_s2[block * BLOCK..].iter().take(BLOCK);
        (block * BLOCK + first_largest(&mut of_block.copied())) as u32
    }

    fn keep(&mut self, elements: &mut ElementBatches, of: &Eigenvalues) {
        of.0.iter().for_each(|(e, eigenvalue_per_s2)| elements.set_eigenvalue(*e, *eigenvalue_per_s2));
        self.renew_blocks(elements, of.0.iter().map(|x| x.0));
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
        let eigenvalues_per_s2 = &elements.eigenvalues_per_s2;
        self.blocks.resize(eigenvalues_per_s2.len().div_ceil(BLOCK), (0.0, 0.0));
        let mut blocks: Vec<usize> = of.map(|e| e as usize / BLOCK).collect();
        blocks.dedup();
        for block in blocks {
            let range = block * BLOCK..((block + 1) * BLOCK).min(eigenvalues_per_s2.len());
            let largest = eigenvalues_per_s2[range.clone()].iter().copied().fold(0.0, f64::max);
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
