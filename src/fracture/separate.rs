//! Topology second: a node whose elements no longer hang together across uncracked faces is
//! doubled, once for each group beyond the first. Crack tips, branching, merging and full
//! separation all come out of this one rule.

use super::changes::NodeBirth;
use super::propagate::Surgery;
use super::solid::{Face, Solid};

impl Surgery<'_> {
    /// Doubles a node as often as its elements ask for. The group of the lowest element keeps it.
    pub(super) fn separate(&mut self, node: u32) {
        let elements = self.solid.node_elements[node as usize].clone();
        let groups = groups_at(self.solid, &elements);
        let count = groups.iter().max().map_or(1, |last| last + 1);
        for group in 1..count {
            let members = elements.iter().zip(&groups).filter(|(_, of)| **of == group);
            let members: Vec<u32> = members.map(|(&element, _)| element).collect();
            self.give_twin(node, members);
        }
        if count > 1 {
            let mut kept = groups.iter().map(|&of| of == 0);
            self.solid.node_elements[node as usize].retain(|_| kept.next().unwrap_or(true));
            self.touched_nodes.push(node);
        }
    }

    fn give_twin(&mut self, node: u32, elements: Vec<u32>) {
        let solid = &mut *self.solid;
        let twin = solid.reference_m.len() as u32;
        solid.reference_m.push(solid.reference_m[node as usize]);
        self.nodes.positions_m.push(self.nodes.positions_m[node as usize]);
        self.nodes.velocities_m_s.push(self.nodes.velocities_m_s[node as usize]);
        for &element in &elements {
            let tet = &mut solid.tets[element as usize];
            *tet = tet.map(|corner| if corner == node { twin } else { corner });
        }
        for &element in &elements {
            self.mark_changed(element);
        }
        self.solid.node_elements.push(elements);
        self.solid.vain_call.push(0);
        self.changes.new_nodes.push(NodeBirth::TwinOf(node));
        self.touched_nodes.push(twin);
    }
}

/// Group of each of the elements at a node (ascending), connected across uncracked faces; groups
/// are counted in the order of their lowest elements.
fn groups_at(solid: &Solid, elements: &[u32]) -> Vec<u32> {
    let mut groups = vec![u32::MAX; elements.len()];
    let mut next_group = 0;
    let mut stack = Vec::new();
    for start in 0..elements.len() {
        if groups[start] != u32::MAX {
            continue;
        }
        groups[start] = next_group;
        stack.push(start);
        while let Some(place) = stack.pop() {
            for face in solid.faces[elements[place] as usize] {
                let Face::Inner(neighbour) = face else { continue };
                let Ok(other) = elements.binary_search(&neighbour) else { continue };
                if groups[other] == u32::MAX {
                    groups[other] = next_group;
                    stack.push(other);
                }
            }
        }
        next_group += 1;
    }
    groups
}
