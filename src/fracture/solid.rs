//! A tetrahedral body that can be cut: elements, what lies behind each of their faces, what meets
//! at each node. Kept up to date cut by cut, never rebuilt.
//!
//! Two elements hang together where they share a face that is not cracked. A cracked face is a
//! pair of surface faces; their nodes part only when nothing connects the elements around them
//! any more (see `separate`), so that a crack can end inside the body.

use super::fragments::Fragments;
use crate::mesh::{ElementShape, TET_FACES, TetMesh, signed_volume_m3};
use glam::DVec3;
use std::collections::BTreeSet;

/// What lies behind a face of an element.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Face {
    /// The element with this index.
    Inner(u32),
    /// Nothing: surface of the body as it was given.
    Boundary,
    /// Nothing: a crack opened here.
    Crack {
        /// Faces of the same pair were one face once, or parts of one: they lay on each other when
        /// the crack was born. Counted from 0 in order of birth.
        pair: u32,
        /// Whether the element lay above the cutting plane, on the side its normal points to.
        above: bool,
    },
}

/// Positions and velocities of a body's nodes, lent for the time of a cut. New nodes are appended.
#[derive(Debug)]
pub struct NodeState<'a> {
    /// Current positions, m.
    pub positions_m: &'a mut Vec<DVec3>,
    /// Velocities, m/s.
    pub velocities_m_s: &'a mut Vec<DVec3>,
}

/// Why a body cannot be made ready for cutting.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum SolidError {
    /// A corner index is out of range.
    #[error("element {element} refers to node {node}, but there are only {nodes} nodes")]
    NoSuchNode {
        /// Element index.
        element: usize,
        /// Node index it holds.
        node: u32,
        /// Number of nodes.
        nodes: usize,
    },
    /// Flat, inverted or not finite.
    #[error("element {element} is flat, inverted or not finite: its volume is {volume_m3:e} m3")]
    NoVolume {
        /// Element index.
        element: usize,
        /// Signed volume, m3.
        volume_m3: f64,
    },
    /// More than two elements share a face.
    #[error("element {element} shares a face with more than one other element")]
    OverusedFace {
        /// Element index.
        element: u32,
    },
    /// Densities are missing or impossible.
    #[error("element {element} needs a density above zero, kg/m3")]
    Density {
        /// Element index.
        element: usize,
    },
    /// The floor is no share.
    #[error(
        "the smallest altitude a cut may leave is {share} of the initial one, but it must lie above 0 and at most at 1"
    )]
    AltitudeShare {
        /// The share given.
        share: f64,
    },
}

/// A face on the surface: of the body as it was given, or of a crack.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct SurfaceFace {
    /// Element behind it.
    pub element: u32,
    /// Which of its faces, as in [`TET_FACES`].
    pub face: usize,
    /// Corners, counter-clockwise from outside.
    pub nodes: [u32; 3],
    /// [`Face::Boundary`] or [`Face::Crack`].
    pub kind: Face,
}

/// A body that can be cut. Node and element indices never change and are never given up; cuts only
/// append.
#[derive(Clone, Debug)]
pub struct Solid {
    pub(super) reference_m: Vec<DVec3>,
    /// Elements at each node, ascending.
    pub(super) node_elements: Vec<Vec<u32>>,
    pub(super) tets: Vec<[u32; 4]>,
    /// Behind the face opposite each corner.
    pub(super) faces: Vec<[Face; 4]>,
    pub(super) origins: Vec<u32>,
    pub(super) masses_kg: Vec<f64>,
    /// By origin.
    density_kg_m3: Vec<f64>,
    /// By origin.
    regions: Vec<u32>,
    pub(super) altitude_floor_m: f64,
    pub(super) crack_pairs: u32,
    pub(super) fragments: Fragments,
    /// Calls of `propagate` so far, and the one that last changed each element.
    pub(super) calls: u32,
    pub(super) touched_in_call: Vec<u32>,
    /// The call in which each node was last cut in vain; 0 for never.
    pub(super) vain_call: Vec<u32>,
    /// Nodes at which a cut was left out for the sake of the smallest fragment.
    pub(super) left_whole: BTreeSet<u32>,
    /// Nodes at which a cut was put off since the crack would have been too fast, and at which none started beside another.
    pub(super) too_fast: BTreeSet<u32>,
    pub(super) shielded: BTreeSet<u32>,
}

impl Solid {
    /// Prepares a mesh, in its reference position, with one density per element (kg/m3).
    ///
    /// No cut will leave an element whose smallest altitude is below `altitude_share` (in (0, 1])
    /// of the smallest one in the mesh as given; 0.25 serves well.
    ///
    /// # Errors
    /// [`SolidError`] naming the first unsound element.
    pub fn new(mesh: &TetMesh, density_kg_m3: &[f64], altitude_share: f64) -> Result<Self, SolidError> {
        if !(altitude_share > 0.0 && altitude_share <= 1.0) {
            return Err(SolidError::AltitudeShare { share: altitude_share });
        }
        check_elements(mesh, density_kg_m3)?;
        let faces = faces_of(&mesh.tets)?;
        let elements = 0..mesh.tets.len();
        let altitude_m = |e| ElementShape::of(&mesh.corners_m(e)).min_altitude_m;
        let masses_kg: Vec<f64> =
            elements.clone().map(|e| density_kg_m3[e] * signed_volume_m3(&mesh.corners_m(e))).collect();
        Ok(Self {
            reference_m: mesh.nodes_m.clone(),
            node_elements: elements_at_nodes(&mesh.tets, mesh.nodes_m.len()),
            tets: mesh.tets.clone(),
            fragments: Fragments::of(&faces, &masses_kg),
            faces,
            origins: (0_u32..).take(mesh.tets.len()).collect(),
            masses_kg,
            density_kg_m3: density_kg_m3.to_vec(),
            regions: mesh.regions.clone(),
            altitude_floor_m: altitude_share * elements.map(altitude_m).fold(f64::INFINITY, f64::min),
            crack_pairs: 0,
            calls: 0,
            touched_in_call: vec![0; mesh.tets.len()],
            vain_call: vec![0; mesh.nodes_m.len()],
            left_whole: BTreeSet::new(),
            too_fast: BTreeSet::new(),
            shielded: BTreeSet::new(),
        })
    }

    /// Number of nodes.
    #[must_use]
    pub fn node_count(&self) -> usize {
        self.reference_m.len()
    }

    /// Reference positions of the nodes, m.
    #[must_use]
    pub fn reference_m(&self) -> &[DVec3] {
        &self.reference_m
    }

    /// Corners of the elements.
    #[must_use]
    pub fn tets(&self) -> &[[u32; 4]] {
        &self.tets
    }

    /// What lies behind the face opposite each corner, by element.
    #[must_use]
    pub fn faces(&self) -> &[[Face; 4]] {
        &self.faces
    }

    /// Element of the mesh as given that each element was cut from: where its material is found.
    #[must_use]
    pub fn origins(&self) -> &[u32] {
        &self.origins
    }

    /// Region of an element, as in the mesh.
    #[must_use]
    pub fn region(&self, element: u32) -> u32 {
        self.regions[self.origins[element as usize] as usize]
    }

    /// Masses of the elements, `rho V0`, kg.
    #[must_use]
    pub fn masses_kg(&self) -> &[f64] {
        &self.masses_kg
    }

    /// Lumped mass of a node, a quarter of each element at it, kg.
    #[must_use]
    pub fn node_mass_kg(&self, node: u32) -> f64 {
        let elements = &self.node_elements[node as usize];
        elements.iter().fold(0.0, |sum, &e| sum + 0.25 * self.masses_kg[e as usize])
    }

    /// Elements at a node, ascending.
    #[must_use]
    pub fn elements_at(&self, node: u32) -> &[u32] {
        &self.node_elements[node as usize]
    }

    /// The pieces the body is in.
    #[must_use]
    pub fn fragments(&self) -> &Fragments {
        &self.fragments
    }

    /// No cut leaves an element whose smallest altitude in the reference shape is below this, m.
    ///
    /// With lumped masses `omega^2 <= 4 c_p^2 sum_a 1/h_a^2` over the element's altitudes `h_a`
    /// (lambda >= 0), so the stable step `2 / omega` never falls below half this floor over `c_p`.
    #[must_use]
    pub fn altitude_floor_m(&self) -> f64 {
        self.altitude_floor_m
    }

    /// Reference positions of an element's corners, m.
    #[must_use]
    pub fn corners_m(&self, element: u32) -> [DVec3; 4] {
        self.tets[element as usize].map(|node| self.reference_m[node as usize])
    }

    /// Corners of a face, counter-clockwise from outside.
    #[must_use]
    pub fn face_nodes(&self, element: u32, face: usize) -> [u32; 3] {
        TET_FACES[face].map(|corner| self.tets[element as usize][corner])
    }

    /// The faces of an element that lie on the surface.
    pub fn surface_of(&self, element: u32) -> impl Iterator<Item = SurfaceFace> + '_ {
        let on_surface = move |(face, &kind): (usize, &Face)| {
            let nodes = self.face_nodes(element, face);
            (!matches!(kind, Face::Inner(_))).then_some(SurfaceFace { element, face, nodes, kind })
        };
        self.faces[element as usize].iter().enumerate().filter_map(on_surface)
    }

    /// The whole surface, cracks included, in the order of the elements. A crack that has not
    /// parted its nodes yet is there too, with both its sides.
    pub fn surface(&self) -> impl Iterator<Item = SurfaceFace> + '_ {
        (0_u32..).take(self.tets.len()).flat_map(|element| self.surface_of(element))
    }

    /// Mean unit normal of the cracks at an element's nodes, for the choice between equally good
    /// cutting planes (see [`super::PlaneRule::normal`]); `None` where there is no crack.
    #[must_use]
    pub fn crack_normal_near(&self, element: u32, positions_m: &[DVec3]) -> Option<DVec3> {
        let mut sum_m2 = DVec3::ZERO;
        for &node in &self.tets[element as usize] {
            for face in self.crack_faces_at(node) {
                let area_m2 = area_vector_m2(face.nodes, positions_m);
                sum_m2 += if area_m2.dot(sum_m2) < 0.0 { -area_m2 } else { area_m2 };
            }
        }
        sum_m2.try_normalize()
    }

    /// Crack faces that have `node` as a corner.
    pub(super) fn crack_faces_at(&self, node: u32) -> impl Iterator<Item = SurfaceFace> + '_ {
        self.surface_at(node).filter(|face| matches!(face.kind, Face::Crack { .. }))
    }

    /// Surface faces that have `node` as a corner.
    pub(super) fn surface_at(&self, node: u32) -> impl Iterator<Item = SurfaceFace> + '_ {
        self.node_elements[node as usize]
            .iter()
            .flat_map(|&element| self.surface_of(element))
            .filter(move |face| face.nodes.contains(&node))
    }

    /// Recomputes the mass of an element from its shape.
    pub(super) fn weigh(&mut self, element: u32) {
        let density_kg_m3 = self.density_kg_m3[self.origins[element as usize] as usize];
        self.masses_kg[element as usize] = density_kg_m3 * signed_volume_m3(&self.corners_m(element));
    }
}

/// Area of a triangle times its unit normal, m2.
pub(super) fn area_vector_m2(nodes: [u32; 3], positions_m: &[DVec3]) -> DVec3 {
    let [a, b, c] = nodes.map(|node| positions_m[node as usize]);
    (b - a).cross(c - a) / 2.0
}

fn check_elements(mesh: &TetMesh, density_kg_m3: &[f64]) -> Result<(), SolidError> {
    let nodes = mesh.nodes_m.len();
    for (element, tet) in mesh.tets.iter().enumerate() {
        if let Some(&node) = tet.iter().find(|&&node| node as usize >= nodes) {
            return Err(SolidError::NoSuchNode { element, node, nodes });
        }
        let volume_m3 = signed_volume_m3(&mesh.corners_m(element));
        if !(volume_m3 > 0.0 && volume_m3.is_finite()) {
            return Err(SolidError::NoVolume { element, volume_m3 });
        }
        if !density_kg_m3.get(element).is_some_and(|density| *density > 0.0 && density.is_finite()) {
            return Err(SolidError::Density { element });
        }
    }
    Ok(())
}

fn elements_at_nodes(tets: &[[u32; 4]], nodes: usize) -> Vec<Vec<u32>> {
    let mut elements = vec![Vec::new(); nodes];
    for (element, tet) in (0_u32..).zip(tets) {
        for &node in tet {
            elements[node as usize].push(element);
        }
    }
    elements
}

fn faces_of(tets: &[[u32; 4]]) -> Result<Vec<[Face; 4]>, SolidError> {
    let mut keys: Vec<([u32; 3], u32, usize)> = Vec::with_capacity(4 * tets.len());
    for (element, tet) in (0_u32..).zip(tets) {
        for (face, corners) in TET_FACES.iter().enumerate() {
            let mut nodes = corners.map(|corner| tet[corner]);
            nodes.sort_unstable();
            keys.push((nodes, element, face));
        }
    }
    keys.sort_unstable();
    let mut faces = vec![[Face::Boundary; 4]; tets.len()];
    for group in keys.chunk_by(|a, b| a.0 == b.0) {
        match *group {
            [_] => {}
            [(_, a, i), (_, b, j)] => {
                faces[a as usize][i] = Face::Inner(b);
                faces[b as usize][j] = Face::Inner(a);
            }
            _ => return Err(SolidError::OverusedFace { element: group[0].1 }),
        }
    }
    Ok(faces)
}
