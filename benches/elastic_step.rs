//! One elastic step, forces and central-difference update, of a box of about 1k to 1M tetrahedra.

use crate::machine::sample_shortly;
use criterion::{BenchmarkId, Criterion, Throughput};
use glam::{DMat3, DVec3};
use hammerfall::fem::{ElasticConstants, ElementBatches, ElementKinematics, ForceScratch};
use rayon::prelude::*;

/// Boxes along each side; six tetrahedra each: 1,296, 10,368, 105,456 and 998,250.
const CELLS: [usize; 4] = [6, 12, 26, 55];

/// Every size, kinematics, and one and two threads; the throughput is in elements a second.
pub fn elastic_step(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("elastic_step");
    sample_shortly(&mut group);
    let body_frame = ElementKinematics::BodyFrame { rotation: DMat3::from_rotation_x(0.3) };
    for cells in CELLS {
        for (name, kinematics) in [
            ("green", ElementKinematics::Green),
            ("body-frame", body_frame),
            ("corotated", ElementKinematics::Corotated),
            ("neo-hookean", ElementKinematics::NeoHookean),
        ] {
            // Built by the first measurement that wants it: the largest takes seconds.
            let mut built: Option<Body> = None;
            let elements = 6 * cells.pow(3);
            group.throughput(Throughput::Elements(elements as u64));
            for threads in [1, 2] {
                let pool = rayon::ThreadPoolBuilder::new()
                    .num_threads(threads)
                    .build()
                    .expect("threads can be started");
                let id = BenchmarkId::new(format!("{name}/{threads}-threads"), elements);
                group.bench_function(id, |bencher| {
                    let body = built.get_or_insert_with(|| Body::new(cells));
                    pool.install(|| bencher.iter(|| body.step(kinematics)));
                });
            }
        }
    }
    group.finish();
}

struct Body {
    elements: ElementBatches,
    scratch: ForceScratch,
    positions_m: Vec<DVec3>,
    velocities_m_s: Vec<DVec3>,
    forces_n: Vec<DVec3>,
    inverse_masses_per_kg: Vec<f64>,
    step_s: f64,
}

impl Body {
    fn new(cells: usize) -> Self {
        let (nodes_m, tets) = unit_box(cells);
        let rubber = ElasticConstants::new(1e6, 0.3, 1000.0).expect("rubber is possible");
        let elements =
            ElementBatches::new(&nodes_m, &tets, &vec![rubber; tets.len()]).expect("the box is sound");
        let masses_kg = elements.lumped_masses_kg(None);
        let step_s = 0.5 * elements.element_stable_steps_s()[0];
        Self {
            scratch: ForceScratch::default(),
            velocities_m_s: nodes_m.iter().map(|x| DVec3::X.cross(*x) * 0.1).collect(),
            forces_n: vec![DVec3::ZERO; nodes_m.len()],
            inverse_masses_per_kg: masses_kg.iter().map(|mass| 1.0 / mass).collect(),
            positions_m: nodes_m,
            elements,
            step_s,
        }
    }

    /// Forces, then `v += h f / m`, `x += h v`.
    fn step(&mut self, kinematics: ElementKinematics) -> f64 {
        let state =
            self.elements.forces(&mut self.scratch, &self.positions_m, kinematics, &mut self.forces_n);
        let step_s = self.step_s;
        // One piece a thread: nodes stay in the cache of the core that had them in the last step.
        let task_nodes = self.positions_m.len().div_ceil(rayon::current_num_threads());
        let chunks = self
            .positions_m
            .par_chunks_mut(task_nodes)
            .zip(self.velocities_m_s.par_chunks_mut(task_nodes))
            .zip(self.forces_n.par_chunks(task_nodes))
            .zip(self.inverse_masses_per_kg.par_chunks(task_nodes));
        chunks.for_each(|(((positions, velocities), forces), inverse_masses)| {
            let nodes = positions.iter_mut().zip(velocities).zip(forces).zip(inverse_masses);
            for (((x, v), f), inverse_mass) in nodes {
                *v += *f * (step_s * inverse_mass);
                *x += *v * step_s;
            }
        });
        state.strain_energy_j
    }
}

/// The unit cube in `cells` boxes along each side, each cut into six tetrahedra about its diagonal (Kuhn).
pub fn unit_box(cells: usize) -> (Vec<DVec3>, Vec<[u32; 4]>) {
    let along = cells + 1;
    let place = |index: usize| {
        DVec3::new((index / along / along) as f64, (index / along % along) as f64, (index % along) as f64)
    };
    let nodes_m = (0..along.pow(3)).map(|index| place(index) / cells as f64).collect();
    let strides = [along * along, along, 1];
    let even = [[0, 1, 2], [1, 2, 0], [2, 0, 1]];
    let mut tets = Vec::new();
    for cell in 0..cells.pow(3) {
        let first = cell / cells / cells * strides[0] + cell / cells % cells * strides[1] + cell % cells;
        let last = first + strides.iter().sum::<usize>();
        for [a, b, _] in even {
            let (one, two) = (first + strides[a], first + strides[a] + strides[b]);
            tets.push([first, one, two, last].map(|node| node as u32));
            let other = first + strides[b];
            tets.push([first, two, other, last].map(|node| node as u32));
        }
    }
    (nodes_m, tets)
}
