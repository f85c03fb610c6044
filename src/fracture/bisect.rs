//! The one geometric operation: an edge is bisected in every element around it at once, so that
//! no node is ever left hanging.
//!
//! The element `(a, b, c, d)` becomes `(a, m, c, d)`, which keeps its index, and `(m, b, c, d)`.

use super::changes::{NewElement, NodeBirth};
use super::propagate::Surgery;
use super::solid::Face;
use crate::mesh::ElementShape;
use glam::DVec3;

impl Surgery<'_> {
    /// Smallest altitude that bisecting the edge would leave around it, m.
    pub(super) fn altitude_after_m(&self, ends: [u32; 2], weight: f64) -> f64 {
        let solid = &self.solid;
        let middle_m = blend(&solid.reference_m, ends, weight);
        let part_m = |element: u32, replaced: u32| {
            let corners_m = solid.tets[element as usize]
                .map(|node| if node == replaced { middle_m } else { solid.reference_m[node as usize] });
            let shape = ElementShape::of(&corners_m);
            if shape.volume_m3 > 0.0 { shape.min_altitude_m } else { 0.0 }
        };
        let ring = self.ring(ends);
        ring.iter().flat_map(|&element| ends.map(|end| part_m(element, end))).fold(f64::INFINITY, f64::min)
    }

    /// The elements around an edge, ascending.
    pub(super) fn ring(&self, [a, b]: [u32; 2]) -> Vec<u32> {
        let at_b = self.solid.elements_at(b);
        let at_a = self.solid.elements_at(a).iter().copied();
        at_a.filter(|element| at_b.binary_search(element).is_ok()).collect()
    }

    /// Bisects the edge at `(1 - weight) a + weight b`; returns the new node.
    pub(super) fn bisect(&mut self, ends: [u32; 2], weight: f64) -> u32 {
        let ring = self.ring(ends);
        let middle = self.add_node_on_edge(ends, weight);
        let first_new = self.solid.tets.len() as u32;
        for &element in &ring {
            self.split_element(element, ends, middle);
        }
        for (new, &old) in (first_new..).zip(&ring) {
            self.link_parts(old, new, ends, &ring, first_new);
        }
        let [a, b] = ends;
        let new = first_new..first_new + ring.len() as u32;
        self.solid.node_elements[b as usize].retain(|element| ring.binary_search(element).is_err());
        self.solid.node_elements[b as usize].extend(new.clone());
        self.solid.node_elements[middle as usize] = ring.iter().copied().chain(new).collect();
        self.book_losses(&ring, [a, b], weight);
        for &element in &ring {
            self.mark_changed(element);
        }
        middle
    }

    fn add_node_on_edge(&mut self, ends: [u32; 2], weight: f64) -> u32 {
        let middle = self.solid.reference_m.len() as u32;
        let reference_m = blend(&self.solid.reference_m, ends, weight);
        let position_m = blend(self.nodes.positions_m, ends, weight);
        let velocity_m_s = blend(self.nodes.velocities_m_s, ends, weight);
        self.solid.reference_m.push(reference_m);
        self.nodes.positions_m.push(position_m);
        self.nodes.velocities_m_s.push(velocity_m_s);
        self.solid.node_elements.push(Vec::new());
        self.solid.vain_call.push(0);
        self.changes.new_nodes.push(NodeBirth::OnEdge { ends, weight });
        middle
    }

    /// Makes `element` the part at the first end and appends the part at the second end.
    fn split_element(&mut self, element: u32, [a, b]: [u32; 2], middle: u32) {
        let solid = &mut *self.solid;
        let old = element as usize;
        let new = solid.tets.len() as u32;
        let tet = solid.tets[old];
        solid.tets[old] = tet.map(|node| if node == b { middle } else { node });
        solid.tets.push(tet.map(|node| if node == a { middle } else { node }));
        solid.faces.push(solid.faces[old]);
        let origin = solid.origins[old];
        solid.origins.push(origin);
        solid.masses_kg.push(0.0);
        solid.weigh(element);
        solid.weigh(new);
        solid.fragments.add_part_of(element);
        for node in tet.into_iter().filter(|node| ![a, b].contains(node)) {
            solid.node_elements[node as usize].push(new);
            self.touched_nodes.push(node);
        }
        self.touched_nodes.extend([a, b, middle]);
        self.solid.touched_in_call.push(self.solid.calls);
        self.changes.new_elements.push(NewElement { element: new, cut_from: element, origin });
    }

    /// Sets the faces of the two parts of an element, once all elements of the ring are split.
    fn link_parts(&mut self, old: u32, new: u32, [a, b]: [u32; 2], ring: &[u32], first_new: u32) {
        let solid = &mut *self.solid;
        let corners = solid.tets[old as usize];
        let Some(at_a) = corners.iter().position(|&node| node == a) else { return };
        let Some(at_b) = solid.tets[new as usize].iter().position(|&node| node == b) else { return };
        // The face behind `a` went with the part at `b`.
        if let Face::Inner(neighbour) = solid.faces[new as usize][at_a] {
            for face in &mut solid.faces[neighbour as usize] {
                if *face == Face::Inner(old) {
                    *face = Face::Inner(new);
                }
            }
        }
        for corner in (0..4).filter(|&corner| corner != at_a && corner != at_b) {
            // The neighbour across a face of the edge is in the ring too; its own new part is next.
            if let Face::Inner(neighbour) = solid.faces[old as usize][corner]
                && let Ok(place) = ring.binary_search(&neighbour)
            {
                solid.faces[new as usize][corner] = Face::Inner(first_new + place as u32);
            }
        }
        solid.faces[old as usize][at_a] = Face::Inner(new);
        solid.faces[new as usize][at_b] = Face::Inner(old);
    }

    fn book_losses(&mut self, ring: &[u32], [a, b]: [u32; 2], weight: f64) {
        let masses = &self.solid.masses_kg;
        let new = self.solid.tets.len() - ring.len()..;
        let mass_kg: f64 = ring.iter().map(|&element| masses[element as usize]).sum::<f64>()
            + masses[new].iter().sum::<f64>();
        let difference = |values: &[DVec3]| values[a as usize] - values[b as usize];
        let (x, v) = (difference(self.nodes.positions_m), difference(self.nodes.velocities_m_s));
        let share_kg = mass_kg * weight * (1.0 - weight);
        self.changes.kinetic_energy_lost_j += share_kg / 8.0 * v.length_squared();
        self.changes.angular_momentum_lost_kg_m2_s += share_kg / 4.0 * x.cross(v);
    }
}

fn blend(values: &[DVec3], [a, b]: [u32; 2], weight: f64) -> DVec3 {
    values[a as usize] * (1.0 - weight) + values[b as usize] * weight
}
