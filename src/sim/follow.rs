//! Following cuts: what a body keeps per node and element is brought up to date where it changed. What it keeps of its surface
//! is copied where it did not change, at a cost that goes with the surface.

use super::SimError;
use super::body::{Body, PrescribedNode};
use super::breaking::Breaking;
use super::elastic::StepContext;
use crate::contact::CrackSide;
use crate::fem::{CutBody, ElementChanges, FemError, StepBound};
use crate::fracture::{Changes, Face, NodeBirth, Solid};
use crate::math::inertia_of_point_kg_m2;
use crate::mesh::{Renumbering, Surface};
use glam::{BVec3, DVec3};

/// Time in which a crack opens over the time in which it runs past the elements around its node.
const RELEASE_SHARE: f64 = 0.5;

impl Body {
    /// Brings everything that is kept per node or element up to date with the cuts; tells what became of the numbers of
    /// its surface.
    ///
    /// # Errors
    /// [`SimError::Setup`] for an unsound element, which cuts do not make.
    pub(super) fn follow(
        &mut self,
        context: &StepContext,
        changes: &Changes,
    ) -> Result<Renumbering, SimError> {
        self.follow_nodes(changes);
        let numbers = self.follow_elements_and_surface(changes)?;
        self.follow_supports(changes);
        self.follow_loads(changes);
        self.follow_grips(changes);
        self.ledger.dropped_j += changes.kinetic_energy_lost_j;
        self.force_n.resize(self.reference_m.len(), DVec3::ZERO);
        self.hold_crack_faces(context, changes);
        Ok(numbers)
    }

    /// Takes over the nodes, their masses and the corners of the elements.
    fn follow_nodes(&mut self, changes: &Changes) {
        let (Some(breaking), Some(elasticity)) = (&mut self.breaking, &mut self.elasticity) else {
            return;
        };
        let elements = &mut elasticity.elements;
        // From the masses before the cut.
        breaking.step_bound.get_or_insert_with(|| StepBound::new(elements, &self.mass_kg));
        let solid = &breaking.solid;
        self.reference_m.extend_from_slice(&solid.reference_m()[self.reference_m.len()..]);
        for &element in &changes.changed_elements {
            self.tets[element as usize] = solid.tets()[element as usize];
        }
        self.tets.extend_from_slice(&solid.tets()[self.tets.len()..]);
        let centre_m = self.reference.centre_m;
        // Cuts do not move the centre: that of an element is the middle of its corners.
        self.arms_m.extend(self.reference_m[self.arms_m.len()..].iter().map(|x| *x - centre_m));
        self.mass_kg.resize(self.reference_m.len(), 0.0);
        for &node in &changes.touched_nodes {
            let mass_kg = &mut self.mass_kg[node as usize];
            let change_kg = solid.node_mass_kg(node) - *mass_kg;
            self.reference.inertia_kg_m2 += inertia_of_point_kg_m2(change_kg, self.arms_m[node as usize]);
            *mass_kg += change_kg;
        }
    }

    fn follow_elements_and_surface(&mut self, changes: &Changes) -> Result<Renumbering, SimError> {
        let (Some(Breaking { solid, step_bound: Some(bound), .. }), Some(elasticity)) =
            (&mut self.breaking, &mut self.elasticity)
        else {
            return Ok(Renumbering::default());
        };
        let (solid, tets, reference_m) = (&*solid, &self.tets, &self.reference_m);
        let elements = &mut elasticity.elements;
        let cut_from: Vec<u32> = changes.new_elements.iter().map(|new| new.cut_from).collect();
        let of_elements = ElementChanges { changed: &changes.changed_elements, cut_from: &cut_from };
        let follow_elements = || {
            elements.follow(reference_m, tets, of_elements)?;
            let node_masses_kg = &self.mass_kg;
            let elements_at = |node| solid.elements_at(node);
            let mut body = CutBody { elements, reference_m, node_masses_kg, elements_at };
            bound.follow(&mut body, &changes.touched_nodes, of_elements);
            Ok(bound.step_s())
        };
        let (before, surface_before) = (&self.boundary, &self.surface);
        let follow_surface = || {
            let touched = touched_elements(solid, changes);
            let boundary = before.after_cut(tets, &touched, |tet, face| behind(solid, tet, face));
            let numbers = Renumbering::between(before, &boundary, reference_m.len());
            let surface = surface_before.after_cut(&boundary, &numbers, reference_m);
            let surface = surface.with_cracks(crack_sides(solid, &boundary), reference_m);
            (boundary, surface, numbers)
        };
        let (step_s, (boundary, surface, numbers)) = rayon::join(follow_elements, follow_surface);
        let unsound = |e: FemError| SimError::Setup(format!("body `{}` after fracture: {e}", self.name));
        elasticity.critical_step_s = step_s.map_err(unsound)?;
        self.mean_size_m = surface.mean_size_m();
        (self.boundary, self.surface) = (boundary, surface);
        Ok(numbers)
    }

    /// New nodes are held as their parents are: twins as the node they were one with, nodes on an edge as far as both of
    /// its ends are.
    fn follow_supports(&mut self, changes: &Changes) {
        for (node, birth) in (changes.first_node..).zip(&changes.new_nodes) {
            let of = |node: u32| self.prescribed_at(node).iter().copied();
            let inherited: Vec<_> = match *birth {
                NodeBirth::TwinOf(parent) => of(parent).collect(),
                NodeBirth::OnEdge { ends: [a, b], .. } => of(a)
                    .filter_map(|mut p| {
                        let other = of(b).find(|q| q.velocity_m_s == p.velocity_m_s)?;
                        p.axes = std::array::from_fn(|i| p.axes[i] && other.axes[i]);
                        p.axes.contains(&true).then_some(p)
                    })
                    .collect(),
            };
            self.prescribed.extend(inherited.into_iter().map(|p| PrescribedNode { node, ..p }));
        }
        self.inverse_mass_per_kg.resize(self.mass_kg.len(), DVec3::ZERO);
        for &node in &changes.touched_nodes {
            let mut inverse = DVec3::splat(self.mass_kg[node as usize].recip());
            for p in self.prescribed_at(node) {
                inverse = DVec3::select(BVec3::from_array(p.axes), DVec3::ZERO, inverse);
            }
            self.inverse_mass_per_kg[node as usize] = inverse;
        }
    }

    /// A force on a node that has been doubled is shared by mass with its twin. Where a node parts into more than two, each twin in
    /// turn takes its share of what is left.
    fn follow_loads(&mut self, changes: &Changes) {
        for (twin, birth) in (changes.first_node..).zip(&changes.new_nodes) {
            let NodeBirth::TwinOf(parent) = *birth else { continue };
            let [twin_kg, parent_kg] = [twin, parent].map(|n| self.mass_kg[n as usize]);
            let share = twin_kg / (twin_kg + parent_kg);
            if let Some(breaking) = &mut self.breaking {
                breaking.releases.share_with_twin(parent, twin, share);
            }
            for load in &mut self.loads {
                let Some(at) = load.node_forces_n.iter().position(|(n, _)| *n == parent) else { continue };
                let force_n = load.node_forces_n[at].1;
                load.node_forces_n[at].1 = force_n * (1.0 - share);
                load.node_forces_n.push((twin, force_n * share));
            }
        }
    }

    /// Holds the nodes of the changed elements as they were before the cuts; see [`super::release`].
    fn hold_crack_faces(&mut self, context: &StepContext, changes: &Changes) {
        let inherit = |of_nodes: &mut Vec<DVec3>| {
            for birth in &changes.new_nodes {
                of_nodes.push(match *birth {
                    NodeBirth::TwinOf(parent) => of_nodes[parent as usize],
                    NodeBirth::OnEdge { ends: [a, b], weight } => {
                        of_nodes[a as usize].lerp(of_nodes[b as usize], weight)
                    }
                });
            }
        };
        inherit(&mut self.acceleration_m_s2);
        let damping = self.elasticity.as_mut().map(|e| &mut e.damping_m_s2);
        damping.filter(|damping| !damping.is_empty()).into_iter().for_each(inherit);
        let touched = || changes.touched_nodes.iter().copied();
        let free_m_s2: Vec<(u32, DVec3)> = touched().map(|n| (n, self.acceleration_of(n, context))).collect();
        let reach_m = changes.cuts.iter().map(|cut| cut.reach_m).fold(f64::INFINITY, f64::min);
        let Some(breaking) = &mut self.breaking else { return };
        let duration_s = RELEASE_SHARE * reach_m / breaking.crack_speed_m_s;
        if !duration_s.is_finite() {
            free_m_s2.into_iter().for_each(|(node, free)| self.acceleration_m_s2[node as usize] = free);
            return;
        }
        let held_n = |(node, free): (u32, DVec3)| {
            let is_free = self.inverse_mass_per_kg[node as usize].cmpgt(DVec3::ZERO);
            let change = self.acceleration_m_s2[node as usize] - free;
            (node, DVec3::select(is_free, change, DVec3::ZERO) * self.mass_kg[node as usize])
        };
        let held_n = free_m_s2.into_iter().map(held_n).collect();
        breaking.releases.add(context.time_s, duration_s, held_n);
    }

    /// Acceleration of one node of a body that can break by all forces that act on it now, m/s2. That by damping of
    /// stiffness is the one from before the cut, so that nothing of it is held: its sum over the nodes of a cut is not
    /// zero, and what is held with it would push the body.
    fn acceleration_of(&self, node: u32, context: &StepContext) -> DVec3 {
        let (Some(breaking), Some(elasticity)) = (&self.breaking, &self.elasticity) else {
            return DVec3::ZERO;
        };
        let solid = &breaking.solid;
        let mut force_n = breaking.releases.force_n(node);
        for &element in solid.elements_at(node) {
            let forces_n = elasticity.elements.element_forces_n(
                element,
                &solid.corners_m(element),
                &self.position_m,
                self.element_kinematics(),
            );
            let corners = self.tets[element as usize].iter().zip(forces_n);
            force_n += corners.filter(|(corner, _)| **corner == node).map(|(_, f)| f).sum::<DVec3>();
        }
        for load in &self.loads {
            let at_node = load.node_forces_n.iter().filter(|(n, _)| *n == node);
            force_n += at_node.map(|(_, full_n)| *full_n * load.share(context.time_s)).sum::<DVec3>();
        }
        force_n += self.pulled_n(node);
        let damping_m_s2 = elasticity.damping_m_s2.get(node as usize).copied().unwrap_or_default();
        force_n / self.mass_kg[node as usize] + damping_m_s2 + context.gravity_m_s2
    }
}

/// The element behind a face of another. The two sides of a cracked face whose corners have not parted are still one face.
fn behind(solid: &Solid, tet: u32, face: usize) -> Option<u32> {
    match solid.faces()[tet as usize][face] {
        Face::Inner(other) => Some(other),
        Face::Boundary => None,
        Face::Crack { .. } => {
            let nodes = solid.face_nodes(tet, face);
            let is_behind = |other: &&u32| {
                **other != tet && nodes.iter().all(|n| solid.tets()[**other as usize].contains(n))
            };
            solid.elements_at(nodes[0]).iter().find(is_behind).copied()
        }
    }
}

/// The elements, ascending, whose faces may have come to the surface, gone from it or changed their corners: the faces of a crack come
/// to the surface when one of their nodes parts.
fn touched_elements(solid: &Solid, changes: &Changes) -> Vec<u32> {
    let at_nodes = changes.touched_nodes.iter().flat_map(|node| solid.elements_at(*node));
    let mut touched: Vec<u32> = at_nodes.chain(&changes.changed_elements).copied().collect();
    touched.extend(changes.new_elements.iter().map(|new| new.element));
    touched.sort_unstable();
    touched.dedup();
    touched
}

/// What of a crack each triangle of the boundary is.
fn crack_sides(solid: &Solid, boundary: &Surface) -> Vec<Option<CrackSide>> {
    let side = |(triangle, tet): (&[u32; 3], &u32)| {
        let corners = solid.tets()[*tet as usize];
        let face = corners.iter().position(|corner| !triangle.contains(corner))?;
        match solid.faces()[*tet as usize][face] {
            Face::Crack { pair, above } => Some(CrackSide { pair, above }),
            Face::Boundary | Face::Inner(_) => None,
        }
    };
    boundary.triangles.iter().zip(&boundary.triangle_tet).map(side).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::contact::candidates::{Candidates, between, within};
    use crate::contact::{CloseList, ContactSurface, OwnFeatures, SurfaceBoxes};
    use crate::fracture::{NodeState, Propagation};
    use crate::mesh::shapes::block;

    fn assert_same(followed: &Candidates, searched: &Candidates) {
        assert_eq!(followed.node_on_second, searched.node_on_second);
        assert_eq!(followed.node_on_first, searched.node_on_first);
        assert_eq!(followed.edge_pairs, searched.edge_pairs);
    }

    #[test]
    fn surface_and_candidates_follow_a_crack_that_runs_through() {
        let mesh = block([4, 3, 3]);
        let mut solid = Solid::new(&mesh, &vec![1.0; mesh.tets.len()], 0.25).unwrap();
        let mut positions_m = mesh.nodes_m.clone();
        let mut velocities_m_s = vec![DVec3::ZERO; positions_m.len()];
        let normal = DVec3::new(1.0, 0.2, 0.1).normalize();
        let mut boundary = Surface::of(solid.tets());
        let mut surface = ContactSurface::new(&boundary, solid.reference_m());
        let mut boxes = SurfaceBoxes::around(&surface, &positions_m, 0.3);
        let own =
            OwnFeatures { surface: &surface, reference_m: solid.reference_m(), positions_m: &positions_m };
        let (mut followed, mut close) = (within(&own, &boxes), CloseList::default());
        // Another body beside it, which stays whole.
        let other_m: Vec<DVec3> = mesh.nodes_m.iter().map(|x| *x + DVec3::new(0.2, 3.1, 0.3)).collect();
        let other = ContactSurface::new(&boundary, &other_m);
        let other_boxes = SurfaceBoxes::around(&other, &other_m, 0.3);
        let beside = |surface: &ContactSurface, boxes: &SurfaceBoxes| {
            between((&other, &other_boxes), (surface, boxes), false)
        };
        let (mut followed_beside, mut close_beside) = (beside(&surface, &boxes), CloseList::default());
        let (mut cracked, mut parted) = (0, 0);
        for node in 0..positions_m.len() as u32 {
            if positions_m[node as usize].dot(normal).abs() > 0.5 {
                continue;
            }
            let nodes = NodeState { positions_m: &mut positions_m, velocities_m_s: &mut velocities_m_s };
            let changes = solid.cut_node(nodes, node, normal, &Propagation::default());
            cracked += changes.crack_faces.len();
            parted += changes.new_nodes.iter().filter(|b| matches!(b, NodeBirth::TwinOf(_))).count();
            let touched = touched_elements(&solid, &changes);
            let now = boundary.after_cut(solid.tets(), &touched, |tet, face| behind(&solid, tet, face));
            assert_eq!(now, Surface::of(solid.tets()));
            let numbers = Renumbering::between(&boundary, &now, solid.node_count());
            boundary = now;
            surface = surface.after_cut(&boundary, &numbers, solid.reference_m());
            let searched = ContactSurface::new(&boundary, solid.reference_m());
            assert_eq!(surface.edges, searched.edges);
            assert_eq!(surface.triangle_size_m, searched.triangle_size_m);
            surface = surface.with_cracks(crack_sides(&solid, &boundary), solid.reference_m());
            boxes.follow(&surface, &numbers, &changes.parents());
            let own = OwnFeatures {
                surface: &surface,
                reference_m: solid.reference_m(),
                positions_m: &positions_m,
            };
            close.follow_within(&mut followed, (&own, &boxes), &numbers);
            assert_same(&followed, &within(&own, &boxes));
            let boxed = [(&other, &other_boxes), (&surface, &boxes)];
            let at_m = [other_m.as_slice(), positions_m.as_slice()];
            close_beside.follow_between(&mut followed_beside, boxed, at_m, [None, Some(&numbers)]);
            assert_same(&followed_beside, &beside(&surface, &boxes));
        }
        assert!(cracked > 20 && parted > 5, "{cracked} faces, {parted} nodes");
        // What the boxes have become serves as well as new ones where the body goes.
        let swing = |x: &DVec3| *x + 0.3 * DVec3::new((2.0 * x.y).sin(), (3.0 * x.z).cos(), x.x * x.y);
        positions_m = positions_m.iter().map(swing).collect();
        boxes.move_to(&surface, &positions_m, |_| DVec3::splat(0.2));
        let fresh = SurfaceBoxes::around(&surface, &positions_m, 0.2);
        let own =
            OwnFeatures { surface: &surface, reference_m: solid.reference_m(), positions_m: &positions_m };
        assert_same(&within(&own, &boxes), &within(&own, &fresh));
        assert_same(&beside(&surface, &boxes), &beside(&surface, &fresh));
        assert_eq!(boxes.bounds(), fresh.bounds());
        // Boxes of nodes that went on, many or few, are moved alone: what was found without them, and what is near them now, is
        // what a search of everything finds.
        followed = within(&own, &boxes);
        for every in [7, 97] {
            let flew = |n: usize| n % every == 3;
            let flight =
                |n: usize| if flew(n) { DVec3::new(0.3, -0.5, 0.1) * (n % 4) as f64 } else { DVec3::ZERO };
            positions_m = positions_m.iter().enumerate().map(|(n, x)| *x + flight(n)).collect();
            let edges = surface.edges.iter().map(|edge| edge.nodes);
            let numbers =
                Renumbering::unchanged(&surface.triangles, edges, (0..positions_m.len()).map(flew).collect());
            let margin_m = |n: u32| DVec3::new(0.1, 0.2, 0.3) + 0.1 * f64::from(n % 3);
            boxes.move_affected(&surface, &numbers, |n| (positions_m[n as usize], margin_m(n)));
            let own = OwnFeatures {
                surface: &surface,
                reference_m: solid.reference_m(),
                positions_m: &positions_m,
            };
            let before = followed.clone();
            close.follow_within(&mut followed, (&own, &boxes), &numbers);
            assert_same(&followed, &within(&own, &boxes));
            assert_ne!(followed.node_on_second, before.node_on_second);
        }
        let counts = [&followed, &followed_beside].map(|c| [c.node_on_second.len(), c.edge_pairs.len()]);
        assert!(counts.as_flattened().iter().all(|count| *count > 20), "{counts:?}");
    }
}
