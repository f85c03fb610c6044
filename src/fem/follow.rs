//! Following cuts: elements that change their corners, and new ones.
//!
//! Only the chunks with such elements are built anew. A new element joins the chunk of the one that it was cut from; a
//! chunk that gets too large falls apart. The work goes with what changes, not with the body.

use super::ElasticConstants;
use super::elements::{Chunk, ElementBatches, FemError, Given, check_element, gradients_per_m};
use super::partition::{CHUNK_ELEMENTS, CHUNK_NODES, ChunkLayout, layouts_of};
use super::stable_step::element_step_s;
use crate::mesh::signed_volume_m3;
use glam::DVec3;

/// What has become of a body's elements.
#[derive(Clone, Copy, Debug)]
pub struct ElementChanges<'a> {
    /// Elements that were there before and have other corners now.
    pub changed: &'a [u32],
    /// For every new element the one it was cut from, which may be new, too, but is numbered lower.
    pub cut_from: &'a [u32],
}

impl ElementBatches {
    /// Follows the elements of a body whose mesh has become `tets` with these reference positions. New elements are of the
    /// material of those that they were cut from. Their eigenvalues are those from before until
    /// [`super::StepBound::follow`].
    ///
    /// # Errors
    /// [`FemError`] naming the first unsound element; the batches are as they were then.
    pub fn follow(
        &mut self,
        reference_nodes_m: &[DVec3],
        tets: &[[u32; 4]],
        changes: ElementChanges,
    ) -> Result<(), FemError> {
        let first_new = self.tets.len();
        let touched = || changes.changed.iter().copied().chain(first_new as u32..tets.len() as u32);
        let constants: Vec<ElasticConstants> = self.constants_with_new(changes.cut_from);
        let constant = |e: u32| constants[(e as usize).saturating_sub(first_new)];
        for e in touched() {
            let of = if (e as usize) < first_new { self.constants[e as usize] } else { constant(e) };
            check_element(reference_nodes_m, tets[e as usize], e as usize, &of)?;
        }
        self.constants.extend(constants);
        self.tets.extend_from_slice(&tets[first_new..]);
        self.masses_kg.resize(tets.len(), 0.0);
        self.steps_s.resize(tets.len(), 0.0);
        for parent in changes.cut_from {
            self.eigenvalues_per_s2.push(self.eigenvalues_per_s2[*parent as usize]);
        }
        for e in touched() {
            let e = e as usize;
            self.tets[e] = tets[e];
            let corners_m = tets[e].map(|node| reference_nodes_m[node as usize]);
            self.masses_kg[e] = self.constants[e].density_kg_m3 * signed_volume_m3(&corners_m);
            self.steps_s[e] = element_step_s(&gradients_per_m(&corners_m), &self.constants[e]);
        }
        self.follow_in_chunks(reference_nodes_m, changes);
        Ok(())
    }

    fn constants_with_new(&self, cut_from: &[u32]) -> Vec<ElasticConstants> {
        let mut new: Vec<ElasticConstants> = Vec::with_capacity(cut_from.len());
        for &parent in cut_from {
            let parent = parent as usize;
            let first_new = self.constants.len();
            new.push(if parent < first_new { self.constants[parent] } else { new[parent - first_new] });
        }
        new
    }

    fn follow_in_chunks(&mut self, nodes_m: &[DVec3], changes: ElementChanges) {
        for (&parent, element) in changes.cut_from.iter().zip(self.chunk_of.len() as u32..) {
            let chunk = self.chunk_of[parent as usize];
            self.chunk_of.push(chunk);
            self.chunks[chunk as usize].layout.elements.push(element);
        }
        let mut numbers: Vec<usize> = changes
            .changed
            .iter()
            .chain(changes.cut_from)
            .map(|e| self.chunk_of[*e as usize] as usize)
            .collect();
        numbers.sort_unstable();
        numbers.dedup();
        let mut before = Vec::new();
        let mut now = Vec::new();
        for number in numbers {
            let ChunkLayout { elements, nodes } = std::mem::take(&mut self.chunks[number].layout);
            before.push((number, nodes));
            for (part, layout) in layouts_of(nodes_m, &self.tets, elements).into_iter().enumerate() {
                let place = if part == 0 { number } else { self.chunks.len() };
                layout.elements.iter().for_each(|e| self.chunk_of[*e as usize] = place as u32);
                let given = Given {
                    nodes_m,
                    tets: &self.tets,
                    constants: &self.constants,
                    eigenvalues_per_s2: &self.eigenvalues_per_s2,
                };
                let chunk = Chunk::new(layout, &given);
                if part == 0 {
                    self.chunks[place] = chunk
                } else {
                    self.chunks.push(chunk)
                }
                now.push(place);
            }
        }
        let now: Vec<(usize, &ChunkLayout)> =
            now.iter().map(|place| (*place, &self.chunks[*place].layout)).collect();
        debug_assert!(
            now.iter().all(|(_, l)| l.elements.len() <= CHUNK_ELEMENTS && l.nodes.len() <= CHUNK_NODES)
        );
        self.node_slots.follow(nodes_m.len(), &before, &now);
    }
}
