//! Fracture of boxes of about 1k, 10k and 100k tetrahedra in which the same number of elements fails: the work goes with
//! what fails, so the times should hardly grow.
//!
//! `world` takes the time of the whole phase from a running world: beside looking and cutting, what is kept of the surface and of
//! its contact with itself follows. That is copied where it did not change, so this time grows with the surface.

use crate::contact_step::take_steps;
use crate::elastic_step::unit_box;
use crate::machine::sample_shortly;
use criterion::{BatchSize, BenchmarkId, Criterion};
use glam::DVec3;
use hammerfall::fem::{ElasticConstants, ElementBatches, ElementKinematics, ForceScratch};
use hammerfall::fracture::{
    Criterion as FailureCriterion, Failure, FractureLimits, NodeState, PrincipalStress, Propagation, Solid,
    Strength,
};
use hammerfall::mesh::TetMesh;
use hammerfall::sim::{BodySetup, BoundaryAction, BoundaryCondition, Material, World, WorldSetup};
use std::hint::black_box;
use std::time::Duration;

/// Boxes along each side; six tetrahedra each.
const CELLS: [usize; 3] = [6, 12, 26];
/// Elements that fail at once, around the middle of the box.
const FAILING: usize = 32;
const DENSITY_KG_M3: f64 = 1000.0;
const YOUNGS_MODULUS_PA: f64 = 1e6;
const ALTITUDE_SHARE: f64 = 0.25;

/// One call of [`Solid::propagate`] on a fresh body, one look for failures around a displaced node, the whole phase in a world.
pub fn fracture_step(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("fracture_step");
    sample_shortly(&mut group);
    for cells in CELLS {
        let mesh = box_mesh(cells);
        let elements = mesh.tets.len();
        let middle_m = middle_m(&mesh);
        let failures = failures_near(middle_m, &mesh);
        let elsewhere = failures_near(middle_m / 3.0, &mesh);
        let solid =
            Solid::new(&mesh, &vec![DENSITY_KG_M3; elements], ALTITUDE_SHARE).expect("the box is sound");
        let limits = FractureLimits { smallest_fragment_kg: 0.0, ..FractureLimits::for_body(&solid) };
        let settings = Propagation { limits, ..Propagation::default() };
        group.bench_function(BenchmarkId::new("propagate", elements), |bencher| {
            let fresh = || {
                let mut knife = Knife::new(&solid, &mesh);
                // The first cut makes full lists move to larger places, which later ones seldom do.
                knife.cut(&elsewhere, &settings);
                knife
            };
            bencher.iter_batched_ref(fresh, |knife| knife.cut(&failures, &settings), BatchSize::PerIteration);
        });
        let looker = Looker::new(&mesh);
        assert!(looker.look() > 0, "the displaced node makes elements fail");
        group.bench_function(BenchmarkId::new("look", elements), |bencher| bencher.iter(|| looker.look()));
        let mut built: Option<World> = None;
        group.bench_function(BenchmarkId::new("world", elements), |bencher| {
            let world = built.get_or_insert_with(|| cracking_world(&mesh));
            bencher.iter_custom(|rounds| (0..rounds).map(|_| time_of_cracking(world)).sum());
        });
    }
    group.finish();
}

fn box_mesh(cells: usize) -> TetMesh {
    let (nodes_m, tets) = unit_box(cells);
    // One size of elements, whatever their number: the body grows, what fails stays as it is.
    TetMesh::with_one_region(nodes_m.into_iter().map(|x| x * cells as f64).collect(), tets)
}

fn middle_m(mesh: &TetMesh) -> DVec3 {
    mesh.nodes_m.iter().copied().reduce(DVec3::max).unwrap_or_default() / 2.0
}

fn middle_node(mesh: &TetMesh) -> u32 {
    let middle_m = middle_m(mesh).floor();
    let node = (0_u32..).zip(&mesh.nodes_m).find(|(_, x)| x.distance(middle_m) < 0.1);
    node.expect("a node in the middle").0
}

/// Tears at half a percent of strain.
fn chalk_criterion() -> FailureCriterion {
    let strength = Strength::Tensile { tensile_strength_pa: 0.005 * YOUNGS_MODULUS_PA };
    FailureCriterion::single(strength).expect("a sound strength")
}

/// The elements nearest to a place, torn nearly along x.
fn failures_near(place_m: DVec3, mesh: &TetMesh) -> Vec<Failure> {
    let distance_m = |tet: &[u32; 4]| {
        let centroid_m = tet.iter().map(|node| mesh.nodes_m[*node as usize]).sum::<DVec3>() / 4.0;
        centroid_m.distance(place_m)
    };
    let mut nearest: Vec<(f64, u32)> = mesh.tets.iter().map(distance_m).zip(0..).collect();
    nearest.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
    let failing = nearest.into_iter().take(FAILING);
    failing.map(|(_, element)| Failure { element, normal: DVec3::new(0.96, 0.28, 0.0), index: 1.0 }).collect()
}

/// A box with a node in its middle that is pulled along x: it has cracked, and goes on to crack in the next step.
fn cracking_world(mesh: &TetMesh) -> World {
    let fracture = Some(chalk_criterion());
    let elastic = Material::elastic("chalk", DENSITY_KG_M3, YOUNGS_MODULUS_PA, 0.3);
    let pulled = BoundaryAction::Velocity { velocity_m_s: DVec3::X, axes: [true; 3] };
    let body = BodySetup {
        boundary: vec![BoundaryCondition { nodes: vec![middle_node(mesh)], action: pulled }],
        ..BodySetup::at_rest("box", mesh.clone(), Material { fracture, ..elastic })
    };
    let mut setup = WorldSetup { bodies: vec![body], ..WorldSetup::default() };
    setup.fracture.smallest_fragment_elements = 0.0;
    let mut world = World::new(setup).expect("a sound world");
    loop {
        let before = world.clone();
        if crack_step(&mut world) && before.sample().crack_area_m2 > 0.0 {
            return before;
        }
    }
}

/// Whether the next step cracks something.
fn crack_step(world: &mut World) -> bool {
    let before_m2 = world.sample().crack_area_m2;
    take_steps(world, 1);
    world.sample().crack_area_m2 > before_m2
}

/// Of the fracture phase of the step that cracks something after the next one: the first cut makes full lists move to larger places,
/// which later ones seldom do.
fn time_of_cracking(world: &World) -> Duration {
    let mut world = world.clone();
    assert!(crack_step(&mut world), "the step cracks something");
    loop {
        let before_s = world.phase_times().fracture_s;
        if crack_step(&mut world) {
            return Duration::from_secs_f64(world.phase_times().fracture_s - before_s);
        }
    }
}

/// A body to be cut once.
struct Knife {
    solid: Solid,
    positions_m: Vec<DVec3>,
    velocities_m_s: Vec<DVec3>,
}

impl Knife {
    fn new(solid: &Solid, mesh: &TetMesh) -> Self {
        let positions_m = mesh.nodes_m.clone();
        Self { solid: solid.clone(), velocities_m_s: vec![DVec3::ZERO; positions_m.len()], positions_m }
    }

    fn cut(&mut self, failures: &[Failure], settings: &Propagation) {
        let nodes =
            NodeState { positions_m: &mut self.positions_m, velocities_m_s: &mut self.velocities_m_s };
        let changes = self.solid.propagate(nodes, failures, settings, |_, _| true);
        assert!(!black_box(changes).is_empty(), "what fails is cut");
    }
}

/// A body with one node out of its place, its forces computed.
struct Looker {
    elements: ElementBatches,
    scratch: ForceScratch,
    positions_m: Vec<DVec3>,
    criterion: FailureCriterion,
}

impl Looker {
    /// Of the displaced node, m; elements are a metre in size.
    const DISPLACED_M: f64 = 0.02;
    const SAFE_STRAIN: f64 = 1e-3;

    fn new(mesh: &TetMesh) -> Self {
        let stuff =
            ElasticConstants::new(YOUNGS_MODULUS_PA, 0.3, DENSITY_KG_M3).expect("a possible material");
        let elements = ElementBatches::new(&mesh.nodes_m, &mesh.tets, &vec![stuff; mesh.tets.len()]);
        let elements = elements.expect("the box is sound");
        let mut positions_m = mesh.nodes_m.clone();
        positions_m[middle_node(mesh) as usize].x += Self::DISPLACED_M;
        let mut scratch = ForceScratch::default();
        let mut forces_n = vec![DVec3::ZERO; positions_m.len()];
        elements.forces(&mut scratch, &positions_m, ElementKinematics::Green, &mut forces_n);
        Self { elements, scratch, positions_m, criterion: chalk_criterion() }
    }

    /// How many elements fail.
    fn look(&self) -> usize {
        let kinematics = ElementKinematics::Green;
        let fails = |element: u32, cauchy_pa: &_| {
            let measures = PrincipalStress::of(cauchy_pa).measures();
            self.criterion.assess(&measures).is_ok_and(|found| found.fails()).then_some(element)
        };
        let failed = self.elements.judge_strained(
            &self.scratch,
            &self.positions_m,
            kinematics,
            Self::SAFE_STRAIN,
            fails,
        );
        failed.len()
    }
}
