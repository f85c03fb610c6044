//! The elements of a body, checked and laid out for the force loop.

use super::ElasticConstants;
use super::kernel::BatchShape;
use super::lanes::BATCH;
use super::partition::{ChunkLayout, partition};
use super::slots::NodeSlots;
use super::stable_step::{element_step_s, stiffening};
use crate::mesh::signed_volume_m3;
use glam::DVec3;
use pulp::Arch;
use rayon::prelude::*;

/// Why elements cannot be built.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum FemError {
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
    #[error(
        "element {element} is flat, inverted or not finite: its volume is {volume_m3:e} m3, \
         which must be positive"
    )]
    NoVolume {
        /// Element index.
        element: usize,
        /// Signed volume, m3.
        volume_m3: f64,
    },
    /// Constants out of range.
    #[error("element {element} has impossible elastic constants: {constants:?}")]
    Constants {
        /// Element index.
        element: usize,
        /// The constants.
        constants: ElasticConstants,
    },
    /// One set of constants per element is needed.
    #[error("{constants} sets of elastic constants for {elements} elements")]
    ConstantsCount {
        /// Sets given.
        constants: usize,
        /// Elements.
        elements: usize,
    },
}

/// The elements of one body: shape, material, order of computation.
#[derive(Clone, Debug)]
pub struct ElementBatches {
    pub(super) chunks: Vec<Chunk>,
    /// Chunk of each element.
    pub(super) chunk_of: Vec<u32>,
    pub(super) node_slots: NodeSlots,
    pub(super) tets: Vec<[u32; 4]>,
    pub(super) constants: Vec<ElasticConstants>,
    /// Element masses, kg, in the caller's order.
    pub(super) masses_kg: Vec<f64>,
    /// `2 / omega_max` of each element, s, in the caller's order.
    pub(super) steps_s: Vec<f64>,
    /// `lambda_max(M_e^-1 K_e)` of each element in its reference shape, 1/s2, in the caller's order: with its own mass until
    /// [`Self::share_masses`].
    pub(super) eigenvalues_per_s2: Vec<f64>,
    /// How fast strain may stiffen `green` elements; see `stable_step`.
    pub(super) stiffening: f64,
    pub(super) arch: Arch,
}

/// A chunk of elements, ready to be computed.
#[derive(Clone, Debug)]
pub(super) struct Chunk {
    pub layout: ChunkLayout,
    pub batches: Vec<Batch>,
}

#[derive(Clone, Debug)]
#[repr(C, align(64))]
pub(super) struct Batch {
    pub shape: BatchShape,
    /// Indices into the chunk's nodes, by corner and lane.
    pub(super) corners: [[u16; BATCH]; 4],
}

impl ElementBatches {
    /// Builds the elements of a body from its stress-free shape, right-handed tetrahedra and one set of
    /// constants per element.
    ///
    /// # Errors
    /// [`FemError`] naming the first unsound element.
    pub fn new(
        reference_nodes_m: &[DVec3],
        tets: &[[u32; 4]],
        constants: &[ElasticConstants],
    ) -> Result<Self, FemError> {
        check(reference_nodes_m, tets, constants)?;
        let layouts = partition(reference_nodes_m, tets);
        let node_slots = NodeSlots::of(reference_nodes_m.len(), &layouts);
        let mut chunk_of = vec![0; tets.len()];
        for (chunk, layout) in (0_u32..).zip(&layouts) {
            layout.elements.iter().for_each(|element| chunk_of[*element as usize] = chunk);
        }
        let corners_m = |e: usize| tets[e].map(|node| reference_nodes_m[node as usize]);
        let masses_kg =
            (0..tets.len()).map(|e| constants[e].density_kg_m3 * signed_volume_m3(&corners_m(e))).collect();
        let steps_s: Vec<f64> = (0..tets.len())
            .into_par_iter()
            .map(|e| element_step_s(&gradients_per_m(&corners_m(e)), &constants[e]))
            .collect();
        let eigenvalues_per_s2: Vec<f64> = steps_s.iter().map(|step_s| (2.0 / step_s).powi(2)).collect();
        let given =
            Given { nodes_m: reference_nodes_m, tets, constants, eigenvalues_per_s2: &eigenvalues_per_s2 };
        let chunks = layouts.into_par_iter().map(|layout| Chunk::new(layout, &given)).collect();
        Ok(Self {
            chunks,
            chunk_of,
            node_slots,
            tets: tets.to_vec(),
            constants: constants.to_vec(),
            masses_kg,
            steps_s,
            eigenvalues_per_s2,
            stiffening: constants.iter().map(stiffening).fold(0.0, f64::max),
            arch: Arch::new(),
        })
    }

    /// Number of elements.
    #[must_use]
    pub fn element_count(&self) -> usize {
        self.tets.len()
    }

    /// Number of nodes.
    #[must_use]
    pub fn node_count(&self) -> usize {
        self.node_slots.node_count()
    }
}

/// What chunks are built from, by element but for the nodes.
pub(super) struct Given<'a> {
    pub nodes_m: &'a [DVec3],
    pub tets: &'a [[u32; 4]],
    pub constants: &'a [ElasticConstants],
    pub eigenvalues_per_s2: &'a [f64],
}

impl Chunk {
    pub(super) fn new(layout: ChunkLayout, given: &Given) -> Self {
        let of_batch = |elements: &[u32]| Batch::new(elements, &layout.nodes, given);
        let batches = layout.elements.chunks(BATCH).map(of_batch).collect();
        Self { layout, batches }
    }

    /// Sets `lambda_max(M_e^-1 K_e)` of one of its elements, 1/s2.
    pub(super) fn set_eigenvalue(&mut self, element: u32, eigenvalue_per_s2: f64) {
        if let Some(place) = self.layout.elements.iter().position(|e| *e == element) {
            self.batches[place / BATCH].shape.eigenvalue_per_s2.0[place % BATCH] = eigenvalue_per_s2;
        }
    }
}

impl Batch {
    /// Lanes beyond the last element repeat it with zero stiffness: they add no force and no energy.
    fn new(elements: &[u32], chunk_nodes: &[u32], given: &Given) -> Self {
        let mut batch = Self { shape: BatchShape::ZERO, corners: [[0; BATCH]; 4] };
        for lane in 0..BATCH {
            let element = elements[lane.min(elements.len() - 1)] as usize;
            let tet = given.tets[element];
            for (corner, node) in tet.iter().enumerate() {
                let local = chunk_nodes.binary_search(node);
                batch.corners[corner][lane] = local.expect("a chunk lists every node of its elements") as u16;
            }
            let corners_m = tet.map(|node| given.nodes_m[node as usize]);
            let is_real = if lane < elements.len() { 1.0 } else { 0.0 };
            let volume_m3 = is_real * signed_volume_m3(&corners_m);
            let [_, gradients @ ..] = gradients_per_m(&corners_m);
            batch.shape.set(lane, &gradients, volume_m3, &given.constants[element]);
            batch.shape.eigenvalue_per_s2.0[lane] = is_real * given.eigenvalues_per_s2[element];
        }
        batch
    }
}

/// `grad_X N_a`, a = 0..4, 1/m: `g_1 = (d_2 x d_3) / (6 V)` and so on, `g_0 = -(g_1 + g_2 + g_3)`.
pub(super) fn gradients_per_m(corners_m: &[DVec3; 4]) -> [DVec3; 4] {
    let [d1, d2, d3] = [1, 2, 3].map(|a| corners_m[a] - corners_m[0]);
    let six_volumes = d1.dot(d2.cross(d3));
    let g1 = d2.cross(d3) / six_volumes;
    let g2 = d3.cross(d1) / six_volumes;
    let g3 = d1.cross(d2) / six_volumes;
    [-(g1 + g2 + g3), g1, g2, g3]
}

fn check(nodes_m: &[DVec3], tets: &[[u32; 4]], constants: &[ElasticConstants]) -> Result<(), FemError> {
    if constants.len() != tets.len() {
        return Err(FemError::ConstantsCount { constants: constants.len(), elements: tets.len() });
    }
    for (element, tet) in tets.iter().enumerate() {
        check_element(nodes_m, *tet, element, &constants[element])?;
    }
    Ok(())
}

/// Whether an element is sound.
pub(super) fn check_element(
    nodes_m: &[DVec3],
    tet: [u32; 4],
    element: usize,
    constants: &ElasticConstants,
) -> Result<(), FemError> {
    let nodes = nodes_m.len();
    if let Some(&node) = tet.iter().find(|&&node| node as usize >= nodes) {
        return Err(FemError::NoSuchNode { element, node, nodes });
    }
    let corners_m = tet.map(|node| nodes_m[node as usize]);
    let volume_m3 = signed_volume_m3(&corners_m);
    let is_sound = gradients_per_m(&corners_m).iter().all(|g| g.is_finite());
    if !(volume_m3 > 0.0 && is_sound) {
        return Err(FemError::NoVolume { element, volume_m3 });
    }
    if !constants.is_sound() {
        return Err(FemError::Constants { element, constants: *constants });
    }
    Ok(())
}
