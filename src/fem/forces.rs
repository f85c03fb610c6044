//! Elastic forces of a whole body: fetch, compute, add up.

use super::corotated::corotated_batch;
use super::elements::{Batch, Chunk, ElementBatches};
use super::kernel::{CornerRows, LaneTotals, body_frame_batch, green_batch};
use super::lanes::{BATCH, Row};
use super::neo_hookean::neo_hookean_batch;
use super::partition::CHUNK_NODES;
use super::prefetch::Ahead;
use glam::{DMat3, DVec3};
use pulp::{Simd, WithSimd};
use rayon::prelude::*;

/// Batches whose corners are fetched together before any is computed: a register filled from
/// numbers stored a moment ago has to wait for them.
const BLOCK_BATCHES: usize = 4;
/// Chunks from which work is shared among threads: below, waking them costs more than it saves.
const PARALLEL_CHUNKS: usize = 8;
/// Chunks from which memory is asked ahead of use: 25 MB, more than a core's own cache.
const PREFETCH_CHUNKS: usize = 512;
/// Nodes that one task sums.
const TASK_NODES: usize = 1024;

/// The loops that are compiled: one for each of [`ElementKinematics`].
const GREEN: u8 = 0;
const BODY_FRAME: u8 = 1;
const COROTATED: u8 = 2;
const NEO_HOOKEAN: u8 = 3;

/// Strain measure of the force.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum ElementKinematics {
    /// Green-Lagrange strain of the total displacement.
    Green,
    /// Small strain in the body's frame: the constant stiffness of the reference shape, turned.
    BodyFrame {
        /// The body's orientation `R`: world from body.
        rotation: DMat3,
    },
    /// Small strain in each element's own rotated frame; see `corotated`.
    Corotated,
    /// Stable neo-Hookean law for large, soft deformation; see `neo_hookean`.
    NeoHookean,
}

/// What the force loop finds on its way.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct ElasticState {
    /// Strain energy, J; not finite as soon as any node position is not.
    pub strain_energy_j: f64,
    /// Largest `sqrt(E : E)` over the elements, `E` being the strain of the kinematics (Green-Lagrange for `NeoHookean`,
    /// with 1 added to its square where an element is inverted).
    pub max_strain: f64,
    /// Bound of the largest squared frequency in the deformed shape, 1/s2: over the elements, each with its shares of its
    /// nodes' masses (see [`ElementBatches::share_masses`]). Not a bound with an element that is not finite.
    pub eigenvalue_per_s2: f64,
}

impl ElasticState {
    /// A stable step of the body as it is deformed, s. Infinite without elements.
    #[must_use]
    pub fn stable_step_s(&self) -> f64 {
        2.0 / self.eigenvalue_per_s2.sqrt()
    }
}

/// Memory that [`ElementBatches::forces`] works in; keep it from step to step.
#[derive(Clone, Debug, Default)]
pub struct ForceScratch {
    /// Force of each chunk on each of its nodes, N.
    slots: Vec<DVec3>,
    totals: Vec<ChunkTotals>,
}

/// Sums and extremes over a chunk's elements.
#[derive(Clone, Copy, Debug, Default)]
struct ChunkTotals {
    energy_j: f64,
    strain_squared: f64,
    eigenvalue_per_s2: f64,
}

impl ForceScratch {
    /// Largest `sqrt(E : E)` that the last call met in a chunk; `None` before the first.
    pub(super) fn largest_strain(&self, chunk: usize) -> Option<f64> {
        self.totals.get(chunk).map(|totals| totals.strain_squared.sqrt())
    }
}

impl ElementBatches {
    /// Elastic force on every node, written (not added) to `forces_n`, and the strain energy.
    ///
    /// Positions and forces are in world axes, one per node. The result is the same to the last bit
    /// whatever the number of threads or the instruction set.
    ///
    /// # Panics
    /// If the two slices are not one entry per node.
    pub fn forces(
        &self,
        scratch: &mut ForceScratch,
        positions_m: &[DVec3],
        kinematics: ElementKinematics,
        forces_n: &mut [DVec3],
    ) -> ElasticState {
        assert_eq!(positions_m.len(), self.node_count(), "one position per node");
        assert_eq!(forces_n.len(), self.node_count(), "one force per node");
        scratch.slots.resize(self.chunks.len() * CHUNK_NODES, DVec3::ZERO);
        scratch.totals.resize(self.chunks.len(), ChunkTotals::default());
        let is_large = self.chunks.len() >= PREFETCH_CHUNKS;
        let slots = scratch.slots.chunks_mut(CHUNK_NODES);
        let work = self.chunks.iter().enumerate().zip(slots).zip(scratch.totals.iter_mut());
        let pieces = work.map(|(((index, chunk), slots), totals)| {
            let slots = &mut slots[..chunk.layout.nodes.len()];
            let ahead = is_large.then(|| Ahead { next: self.chunks.get(index + 1), positions_m });
            let stiffening = self.stiffening;
            (ChunkForces { chunk, positions_m, kinematics, stiffening, ahead, slots }, totals)
        });
        let run = |(forces, totals): (ChunkForces, &mut ChunkTotals)| *totals = self.arch.dispatch(forces);
        if self.runs_parallel() {
            pieces.collect::<Vec<_>>().into_par_iter().for_each(run);
        } else {
            pieces.for_each(run);
        }
        self.sum_slots(&scratch.slots, forces_n);
        let zero = ElasticState::default();
        let squared = scratch.totals.iter().fold(zero, |sum, chunk| ElasticState {
            strain_energy_j: sum.strain_energy_j + chunk.energy_j,
            max_strain: sum.max_strain.max(chunk.strain_squared),
            eigenvalue_per_s2: sum.eigenvalue_per_s2.max(chunk.eigenvalue_per_s2),
        });
        ElasticState { max_strain: squared.max_strain.sqrt(), ..squared }
    }

    fn runs_parallel(&self) -> bool {
        self.chunks.len() >= PARALLEL_CHUNKS && rayon::current_num_threads() > 1
    }

    fn sum_slots(&self, slots: &[DVec3], forces_n: &mut [DVec3]) {
        let run = |(task, forces_n): (usize, &mut [DVec3])| {
            for (force_n, node) in forces_n.iter_mut().zip(task * TASK_NODES..) {
                let of_node = self.node_slots.slots(node).iter();
                *force_n = of_node.fold(DVec3::ZERO, |sum, &slot| sum + slots[slot as usize]);
            }
        };
        if self.runs_parallel() {
            forces_n.par_chunks_mut(TASK_NODES).enumerate().for_each(run);
        } else {
            forces_n.chunks_mut(TASK_NODES).enumerate().for_each(run);
        }
    }
}

/// Positions of a chunk's nodes by axis, m: eight of one axis are fetched by one instruction.
type ChunkPositions = [[f64; CHUNK_NODES]; 3];
/// Forces on a chunk's nodes, N.
type ChunkForceSums = [[f64; 3]; CHUNK_NODES];

impl Batch {
    /// Copies corner positions, m, into rows.
    #[inline(always)]
    fn fetch(&self, positions: &ChunkPositions, rows: &mut CornerRows) {
        for corner in 0..4 {
            for lane in 0..BATCH {
                let local = self.corners[corner][lane] as usize % CHUNK_NODES;
                rows[3 * corner].0[lane] = positions[0][local];
                rows[3 * corner + 1].0[lane] = positions[1][local];
                rows[3 * corner + 2].0[lane] = positions[2][local];
            }
        }
    }

    /// Adds corner forces, N, from rows.
    #[inline(always)]
    fn add_up(&self, rows: &CornerRows, forces: &mut ChunkForceSums) {
        for lane in 0..BATCH {
            for corner in 0..4 {
                let f = &mut forces[self.corners[corner][lane] as usize % CHUNK_NODES];
                f[0] += rows[3 * corner].0[lane];
                f[1] += rows[3 * corner + 1].0[lane];
                f[2] += rows[3 * corner + 2].0[lane];
            }
        }
    }
}

/// One chunk's forces, compiled once per instruction set.
struct ChunkForces<'a> {
    chunk: &'a Chunk,
    positions_m: &'a [DVec3],
    kinematics: ElementKinematics,
    /// Of `green` elements; see [`ElementBatches::stiffening`].
    stiffening: f64,
    /// For bodies that do not fit into caches.
    ahead: Option<Ahead<'a>>,
    /// Out: force of the chunk on its nodes, N.
    slots: &'a mut [DVec3],
}

impl WithSimd for ChunkForces<'_> {
    type Output = ChunkTotals;

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) -> ChunkTotals {
        let nodes = &self.chunk.layout.nodes;
        let mut positions = [[0.0; CHUNK_NODES]; 3];
        let mut forces = [[0.0; 3]; CHUNK_NODES];
        // Turned positions are seen from the first node, so that turning costs no digits far from
        // the origin.
        let (origin_m, body_from_world) = match self.kinematics {
            ElementKinematics::BodyFrame { rotation } => {
                (self.positions_m[nodes[0] as usize], rotation.transpose())
            }
            _ => (DVec3::ZERO, DMat3::IDENTITY),
        };
        for (local, &node) in (0..CHUNK_NODES).zip(nodes) {
            let x = body_from_world * (self.positions_m[node as usize] - origin_m);
            (positions[0][local], positions[1][local], positions[2][local]) = x.into();
        }
        let totals = match self.kinematics {
            ElementKinematics::Green => self.run_batches::<S, GREEN>(simd, &positions, &mut forces),
            ElementKinematics::BodyFrame { .. } => {
                self.run_batches::<S, BODY_FRAME>(simd, &positions, &mut forces)
            }
            ElementKinematics::Corotated => self.run_batches::<S, COROTATED>(simd, &positions, &mut forces),
            ElementKinematics::NeoHookean => {
                self.run_batches::<S, NEO_HOOKEAN>(simd, &positions, &mut forces)
            }
        };
        let world_from_body = body_from_world.transpose();
        for (slot, force) in self.slots.iter_mut().zip(&forces) {
            *slot = world_from_body * DVec3::from_array(*force);
        }
        let most = |row: &Row| row.0.iter().fold(0.0, |most, &x| f64::max(most, x));
        ChunkTotals {
            energy_j: totals.energy_j.0.iter().fold(0.0, |sum, x| sum + x),
            strain_squared: most(&totals.strain_squared),
            eigenvalue_per_s2: most(&totals.eigenvalue_per_s2),
        }
    }
}

impl ChunkForces<'_> {
    #[inline(always)]
    fn run_batches<S: Simd, const KINEMATICS: u8>(
        &self,
        simd: S,
        positions: &ChunkPositions,
        forces: &mut ChunkForceSums,
    ) -> LaneTotals {
        let mut totals = LaneTotals::ZERO;
        let mut block_rows = [[Row::ZERO; 12]; BLOCK_BATCHES];
        for (index, block) in self.chunk.batches.chunks(BLOCK_BATCHES).enumerate() {
            if let Some(ahead) = &self.ahead {
                ahead.prefetch(self.chunk, index, BLOCK_BATCHES);
            }
            for (batch, rows) in block.iter().zip(&mut block_rows) {
                batch.fetch(positions, rows);
            }
            for (batch, rows) in block.iter().zip(&mut block_rows) {
                match KINEMATICS {
                    GREEN => green_batch(simd, &batch.shape, rows, &mut totals, self.stiffening),
                    BODY_FRAME => body_frame_batch(simd, &batch.shape, rows, &mut totals),
                    COROTATED => corotated_batch(simd, &batch.shape, rows, &mut totals),
                    _ => neo_hookean_batch(simd, &batch.shape, rows, &mut totals),
                }
            }
            for (batch, rows) in block.iter().zip(&block_rows) {
                batch.add_up(rows, forces);
            }
        }
        totals
    }
}
