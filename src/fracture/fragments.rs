//! The pieces a body is in: elements connected across uncracked faces.
//!
//! Pieces that would touch only along an edge or at a node are pieces of their own: nodes are
//! doubled wherever no face connects. (A mesh that is given with such a hinge keeps it, counted
//! as two fragments, until a crack comes by.)
//!
//! After a cut, searches start from both sides of every new crack face and take turns; those that
//! meet join. The work ends when all but one have run dry, so that it grows with the piece that
//! came off, or with the way around the crack's tip, not with the body.

use super::changes::NewFragment;
use super::cut::CrackedFace;
use super::propagate::Surgery;
use super::solid::{Face, Solid};

/// Pieces whose masses differ by less than this share of the larger one are equally large: then
/// the piece that was searched last, else the one with the lowest element, keeps the id.
const EQUAL_MASS: f64 = 1e-9;
const NOBODY: u32 = u32::MAX;

/// A piece.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Fragment {
    /// Number of elements.
    pub elements: u32,
    /// Mass, kg.
    pub mass_kg: f64,
    /// The fragment it came off; `None` for those the body began with.
    pub parent: Option<u32>,
}

/// The pieces of a body. Ids count up in order of birth and are never given again; when a piece
/// breaks, its heaviest part keeps the id.
#[derive(Clone, Debug, PartialEq)]
pub struct Fragments {
    of_element: Vec<u32>,
    list: Vec<Fragment>,
    /// Scratch: which search found an element; `NOBODY` between searches.
    found_by: Vec<u32>,
}

impl Fragments {
    /// Finds the pieces of a body, numbered by their lowest elements.
    pub(super) fn of(faces: &[[Face; 4]], masses_kg: &[f64]) -> Self {
        let mut fragments = Self {
            of_element: vec![NOBODY; faces.len()],
            list: Vec::new(),
            found_by: vec![NOBODY; faces.len()],
        };
        for element in (0_u32..).take(faces.len()) {
            if fragments.of_element[element as usize] == NOBODY {
                let id = fragments.list.len() as u32;
                let members = flood(faces, element);
                members.iter().for_each(|&member| fragments.of_element[member as usize] = id);
                let mass_kg = members.iter().map(|&member| masses_kg[member as usize]).sum();
                fragments.list.push(Fragment { elements: members.len() as u32, mass_kg, parent: None });
            }
        }
        fragments
    }

    /// Id of the fragment of each element.
    #[must_use]
    pub fn of_element(&self) -> &[u32] {
        &self.of_element
    }

    /// The fragments, by id.
    #[must_use]
    pub fn list(&self) -> &[Fragment] {
        &self.list
    }

    /// A bisection cut `element` in two; the new one is the last.
    pub(super) fn add_part_of(&mut self, element: u32) {
        let id = self.of_element[element as usize];
        self.of_element.push(id);
        self.found_by.push(NOBODY);
        self.list[id as usize].elements += 1;
    }
}

/// Elements connected to `start`, ascending.
fn flood(faces: &[[Face; 4]], start: u32) -> Vec<u32> {
    let mut found = std::collections::BTreeSet::from([start]);
    let mut stack = vec![start];
    while let Some(element) = stack.pop() {
        for face in faces[element as usize] {
            if let Face::Inner(neighbour) = face
                && found.insert(neighbour)
            {
                stack.push(neighbour);
            }
        }
    }
    found.into_iter().collect()
}

/// A part of a fragment, as far as it was searched.
struct Part {
    /// What was found; all of it if `is_whole`.
    elements: Vec<u32>,
    is_whole: bool,
    count: u32,
    mass_kg: f64,
}

impl Surgery<'_> {
    /// Cracks these faces of a cut at a node, unless that would set free a fragment that is too small; tells new
    /// fragments apart. Returns the faces that did crack.
    pub(super) fn crack(&mut self, node: u32, mut faces: Vec<CrackedFace>) -> Vec<CrackedFace> {
        let fragment_of = &self.solid.fragments.of_element;
        let fragment = |face: &CrackedFace| fragment_of[face.above.0 as usize];
        faces.sort_by_key(fragment);
        // More than one only where the mesh was given with a hinge.
        let groups: Vec<Vec<CrackedFace>> =
            faces.chunk_by(|a, b| fragment(a) == fragment(b)).map(<[CrackedFace]>::to_vec).collect();
        groups.into_iter().flat_map(|group| self.crack_fragment(node, group)).collect()
    }

    /// The same for faces of one fragment.
    fn crack_fragment(&mut self, node: u32, mut faces: Vec<CrackedFace>) -> Vec<CrackedFace> {
        let first_pair = self.solid.crack_pairs;
        for (pair, face) in (first_pair..).zip(&faces) {
            self.set_face(face.above, Face::Crack { pair, above: true });
            self.set_face(face.below, Face::Crack { pair, above: false });
        }
        while !faces.is_empty() {
            let parts = self.parts(&faces);
            let too_small: Vec<bool> = parts.iter().map(|part| self.is_too_small(part)).collect();
            if parts.len() == 1 || !too_small.contains(&true) {
                self.divide(parts);
                break;
            }
            self.leave_whole(node);
            self.heal(&mut faces, &parts, &too_small);
        }
        self.number_pairs(first_pair, &faces);
        for face in &faces {
            self.mark_changed(face.above.0);
            self.mark_changed(face.below.0);
        }
        faces
    }

    fn set_face(&mut self, (element, face): (u32, usize), kind: Face) {
        self.solid.faces[element as usize][face] = kind;
    }

    /// Numbers the pairs again without gaps.
    fn number_pairs(&mut self, first_pair: u32, faces: &[CrackedFace]) {
        for (pair, face) in (first_pair..).zip(faces) {
            self.set_face(face.above, Face::Crack { pair, above: true });
            self.set_face(face.below, Face::Crack { pair, above: false });
        }
        self.solid.crack_pairs = first_pair + faces.len() as u32;
    }

    fn is_too_small(&self, part: &Part) -> bool {
        let limits = &self.settings.limits;
        part.count < limits.smallest_fragment_elements || part.mass_kg < limits.smallest_fragment_kg
    }

    /// Closes the faces around parts that are too small.
    fn heal(&mut self, faces: &mut Vec<CrackedFace>, parts: &[Part], too_small: &[bool]) {
        let small_parts = || parts.iter().zip(too_small).filter(|(_, small)| **small);
        // A part that was not searched through is the rest: whatever no other part holds.
        let rest_is_small = small_parts().any(|(part, _)| !part.is_whole);
        let is_within = |part: &Part, element: u32| part.elements.contains(&element);
        let in_small = |element: u32| {
            small_parts().any(|(part, _)| is_within(part, element))
                || rest_is_small && !parts.iter().any(|part| is_within(part, element))
        };
        let (healed, kept): (Vec<CrackedFace>, Vec<CrackedFace>) =
            faces.iter().partition(|face| in_small(face.above.0) || in_small(face.below.0));
        for face in healed {
            self.set_face(face.above, Face::Inner(face.below.0));
            self.set_face(face.below, Face::Inner(face.above.0));
        }
        *faces = kept;
    }

    /// The parts that the fragment of these faces is in now.
    fn parts(&mut self, faces: &[CrackedFace]) -> Vec<Part> {
        let mut seeds: Vec<u32> = faces.iter().flat_map(|face| [face.above.0, face.below.0]).collect();
        seeds.sort_unstable();
        seeds.dedup();
        let mut search = Search::new(self.solid, &seeds);
        search.run();
        let groups = search.finish();
        let whole = self.solid.fragments.list[self.solid.fragments.of_element[seeds[0] as usize] as usize];
        let mut parts: Vec<Part> = groups
            .into_iter()
            .map(|(elements, is_whole)| {
                let mass_kg = elements.iter().map(|&element| self.solid.masses_kg[element as usize]).sum();
                Part { count: elements.len() as u32, elements, is_whole, mass_kg }
            })
            .collect();
        let (count, mass_kg) = parts
            .iter()
            .filter(|part| part.is_whole)
            .fold((0, 0.0), |(count, mass_kg), part| (count + part.count, mass_kg + part.mass_kg));
        for rest in parts.iter_mut().filter(|part| !part.is_whole) {
            rest.count = whole.elements - count;
            rest.mass_kg = whole.mass_kg - mass_kg;
        }
        parts
    }

    /// The heaviest part keeps the id, the others get new ones by their lowest elements.
    fn divide(&mut self, mut parts: Vec<Part>) {
        if parts.len() < 2 {
            return;
        }
        let heaviest_kg = parts.iter().map(|part| part.mass_kg).fold(0.0, f64::max);
        let keeps = (0..parts.len())
            .filter(|&index| parts[index].mass_kg >= heaviest_kg * (1.0 - EQUAL_MASS))
            .min_by_key(|&index| (parts[index].is_whole, parts[index].elements.first().copied()))
            .unwrap_or(0);
        let kept = parts.swap_remove(keeps);
        for part in parts.iter_mut().filter(|part| !part.is_whole) {
            part.elements = flood(&self.solid.faces, part.elements[0]);
        }
        parts.sort_by_key(|part| part.elements[0]);
        let parent = self.solid.fragments.of_element[kept.elements[0] as usize];
        let fragments = &mut self.solid.fragments;
        fragments.list[parent as usize].elements = kept.count;
        fragments.list[parent as usize].mass_kg = kept.mass_kg;
        for part in parts {
            let id = fragments.list.len() as u32;
            part.elements.iter().for_each(|&element| fragments.of_element[element as usize] = id);
            let Part { count, mass_kg, elements, .. } = part;
            fragments.list.push(Fragment { elements: count, mass_kg, parent: Some(parent) });
            self.changes.new_fragments.push(NewFragment { id, parent, elements });
        }
    }
}

/// Searches that take turns until all but one have run dry.
struct Search<'a> {
    faces: &'a [[Face; 4]],
    found_by: &'a mut [u32],
    /// What each search found, and how far it has looked.
    found: Vec<Vec<u32>>,
    looked: Vec<usize>,
    /// The search that each has joined, or itself; never a later one.
    joined: Vec<u32>,
}

impl<'a> Search<'a> {
    fn new(solid: &'a mut Solid, seeds: &[u32]) -> Self {
        let found_by = &mut solid.fragments.found_by[..];
        for (index, &seed) in (0_u32..).zip(seeds) {
            found_by[seed as usize] = index;
        }
        Self {
            faces: &solid.faces,
            found_by,
            found: seeds.iter().map(|&seed| vec![seed]).collect(),
            looked: vec![0; seeds.len()],
            joined: (0_u32..).take(seeds.len()).collect(),
        }
    }

    fn root(&self, mut search: u32) -> u32 {
        while self.joined[search as usize] != search {
            search = self.joined[search as usize];
        }
        search
    }

    fn run(&mut self) {
        while self.several_are_looking() {
            for search in 0..self.found.len() {
                self.look_once(search);
            }
        }
    }

    fn is_looking(&self, search: usize) -> bool {
        self.looked[search] < self.found[search].len()
    }

    fn several_are_looking(&self) -> bool {
        let mut roots = (0..self.found.len()).filter(|&search| self.is_looking(search));
        let Some(first) = roots.next() else { return false };
        let root = self.root(first as u32);
        roots.any(|search| self.root(search as u32) != root)
    }

    fn look_once(&mut self, search: usize) {
        let Some(&element) = self.found[search].get(self.looked[search]) else { return };
        self.looked[search] += 1;
        for face in self.faces[element as usize] {
            let Face::Inner(neighbour) = face else { continue };
            match self.found_by[neighbour as usize] {
                NOBODY => {
                    self.found_by[neighbour as usize] = search as u32;
                    self.found[search].push(neighbour);
                }
                other => {
                    let [a, b] = [self.root(search as u32), self.root(other)];
                    self.joined[a.max(b) as usize] = a.min(b);
                }
            }
        }
    }

    /// The groups of searches that joined: their elements, ascending, and whether that is all.
    fn finish(self) -> Vec<(Vec<u32>, bool)> {
        let mut groups: Vec<(Vec<u32>, bool)> = Vec::new();
        let mut group_of_root = vec![usize::MAX; self.found.len()];
        for search in 0..self.found.len() {
            let root = self.root(search as u32) as usize;
            if group_of_root[root] == usize::MAX {
                group_of_root[root] = groups.len();
                groups.push((Vec::new(), true));
            }
            let (elements, is_whole) = &mut groups[group_of_root[root]];
            elements.extend(&self.found[search]);
            *is_whole &= !self.is_looking(search);
        }
        for (elements, _) in &mut groups {
            elements.sort_unstable();
            elements.iter().for_each(|&element| self.found_by[element as usize] = NOBODY);
        }
        groups
    }
}
