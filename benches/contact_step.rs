//! One contact step of two boxes pressed on each other, in pieces and inside a world.
//!
//! The boxes are cubes of the same size, one upon the other, the upper one a cell finer along each side, so that
//! no nodes meet but those of the corners. About 1k to 1M tetrahedra in both together; what contact sees of them
//! is their surface, and of that one face in six.
//!
//! `contact_step` calls the public functions of `contact` on a fixed state, so that every round does the same
//! work; `world_step` takes the times of the phases from a running world, which also renews its boxes,
//! looks for self-collision and solves again until nothing penetrates.

use crate::machine::sample_shortly;
use criterion::{BenchmarkGroup, BenchmarkId, Criterion, Throughput, measurement::WallTime};
use glam::DVec3;
use hammerfall::contact::candidates::{Candidates, between};
use hammerfall::contact::constraint::Feature;
use hammerfall::contact::nodes::{ContactNode, NodeTable};
use hammerfall::contact::response::{ResponseParameters, ResponseReport, set_targets, solve, sort_by_place};
use hammerfall::contact::{
    BodyView, CloseList, CollisionList, Constraint, ContactSurface, Near, PairDepths, PairView, SurfaceBoxes,
    ThrownNodes,
};
use hammerfall::mesh::shapes::{BoxShape, HexSplit, Meshing, Resolution, Shape};
use hammerfall::mesh::{Surface, TetMesh};
use hammerfall::sim::{
    BodySetup, BoundaryAction, BoundaryCondition, Material, PhaseTimes, StepReport, World, WorldSetup,
};
use std::time::Duration;

/// Cells along each side of the lower box; the upper one has one more. Six tetrahedra each: 1,134, 10,374,
/// 103,566 and 988,146 in both.
pub const CELLS: [u32; 4] = [4, 9, 20, 43];

/// Tetrahedra in both boxes.
pub fn elements_of(cells: u32) -> u32 {
    6 * (cells.pow(3) + (cells + 1).pow(3))
}
/// Speed at which the boxes are pressed together over that of sound: strains stay small for as long as it takes.
const PRESSING: f64 = 1e-5;
const YOUNGS_MODULUS_PA: f64 = 1e6;
const DENSITY_KG_M3: f64 = 1000.0;

/// Longer than any step, s.
const FAR_S: f64 = 1.0;

fn speed_m_s() -> f64 {
    PRESSING * (YOUNGS_MODULUS_PA / DENSITY_KG_M3).sqrt()
}

/// The cube of side 1 that stands on `z = low_m`.
fn cube(cells: u32, low_m: f64) -> TetMesh {
    let meshing = Meshing { resolution: Resolution::Cells([cells; 3]), split: HexSplit::Six };
    let mut mesh = Shape::Box(BoxShape { size_m: DVec3::ONE }).build(&meshing).expect("a sound box");
    mesh.nodes_m.iter_mut().for_each(|x| x.z += low_m + 0.5);
    mesh
}

/// The pieces of a contact step: search, detection, response.
pub fn contact_step(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("contact_step");
    sample_shortly(&mut group);
    for cells in CELLS {
        let press = Press::new(cells);
        let candidates = press.candidates();
        let found = press.find(&candidates);
        let count =
            candidates.node_on_first.len() + candidates.node_on_second.len() + candidates.edge_pairs.len();
        let (enforced, report) = press.respond(&found);
        println!(
            "{} elements: {count} candidates, {} pairs, {} enforced, {} passes",
            press.elements,
            found.len(),
            enforced.len(),
            report.settling.passes
        );
        let surface: usize = press.bodies.iter().map(|b| b.surface.triangles.len()).sum();
        measure(&mut group, &press, ("search-per-triangle", surface), |press| press.candidates());
        measure(&mut group, &press, ("detect-per-candidate", count), |press| press.find(&candidates));
        measure(&mut group, &press, ("respond-per-pair", enforced.len()), |press| press.respond(&found));
    }
    group.finish();
}

fn measure<Output>(
    group: &mut BenchmarkGroup<WallTime>,
    press: &Press,
    (name, things): (&str, usize),
    mut work: impl FnMut(&Press) -> Output,
) {
    group.throughput(Throughput::Elements(things as u64));
    group.bench_function(BenchmarkId::new(name, press.elements), |bencher| bencher.iter(|| work(press)));
}

struct PressedBody {
    surface: ContactSurface,
    positions_m: Vec<DVec3>,
    velocities_m_s: Vec<DVec3>,
    size_m: f64,
}

/// The lower box and the finer upper one that closes in on it.
struct Press {
    bodies: [PressedBody; 2],
    elements: usize,
    step_s: f64,
}

impl Press {
    fn new(cells: u32) -> Self {
        let meshes = [cube(cells, 0.0), cube(cells + 1, 1.0)];
        let elements = meshes.iter().map(|m| m.tets.len()).sum();
        let size_m = 1.0 / f64::from(cells + 1);
        let step_s = 0.3 * size_m / (YOUNGS_MODULUS_PA / DENSITY_KG_M3).sqrt();
        let bodies = meshes.map(|mesh| {
            let surface = ContactSurface::new(&Surface::of(&mesh.tets), &mesh.nodes_m);
            let is_upper = mesh.nodes_m.iter().all(|x| x.z >= 1.0);
            // Uneven speeds, as waves make them: even ones would leave the response nothing to do.
            let uneven = |x: &DVec3| 1.0 + 0.3 * (7.0 * x.x).sin() * (5.0 * x.y).cos();
            let closing = |x: &DVec3| DVec3::NEG_Z * speed_m_s() * uneven(x) * f64::from(u8::from(is_upper));
            let velocities_m_s = mesh.nodes_m.iter().map(closing).collect();
            PressedBody { surface, velocities_m_s, positions_m: mesh.nodes_m, size_m }
        });
        Self { bodies, elements, step_s }
    }

    /// Boxes around both surfaces and what may meet: renewed only when a node has moved far.
    fn candidates(&self) -> Candidates {
        let [lower, upper] =
            self.bodies.each_ref().map(|b| SurfaceBoxes::around(&b.surface, &b.positions_m, 0.2 * b.size_m));
        between((&self.bodies[0].surface, &lower), (&self.bodies[1].surface, &upper), false)
    }

    fn find(&self, candidates: &Candidates) -> Vec<Constraint> {
        let views = self.bodies.each_ref().map(|b| BodyView {
            surface: &b.surface,
            reference_m: &b.positions_m,
            positions_m: &b.positions_m,
            velocities_m_s: &b.velocities_m_s,
        });
        let list = CollisionList::default();
        let step_s = self.step_s;
        let pair = PairView {
            bodies: [0, 1],
            views,
            friction_coefficient: 0.3,
            step_s,
            list: &list,
            depths: PairDepths::CONSTRAINED,
        };
        let mut found = Vec::new();
        let mut close = CloseList::default();
        close.renew(&pair, candidates, 0.0);
        Near::of_close(&pair, &close, &ThrownNodes::none(0.0)).find(&pair, &mut found);
        found
    }

    /// Solves what a world would enforce: the finer body's nodes, and edges.
    fn respond(&self, found: &[Constraint]) -> (Vec<Constraint>, ResponseReport) {
        let is_enforced = |c: &&Constraint| match c.feature {
            Feature::NodeOnPatch { .. } => c.bodies[0] == 1,
            Feature::EdgeOnEdge { .. } => true,
        };
        let mut pairs: Vec<Constraint> = found.iter().filter(is_enforced).copied().collect();
        sort_by_place(&mut pairs);
        let mut table = NodeTable::new(&pairs, |id| {
            let body = &self.bodies[id.0 as usize];
            let velocity_m_s = body.velocities_m_s[id.1 as usize];
            let inverse_mass = 1.0 / (DENSITY_KG_M3 * body.size_m.powi(3));
            ContactNode::new(id, [velocity_m_s; 2], DVec3::splat(inverse_mass))
        });
        let parameters = ResponseParameters {
            step_s: self.step_s,
            passes: 3,
            tolerance: 1e-4,
            conserve_impact_energy: true,
            rest_speed_m_s: 0.0,
        };
        set_targets(&mut pairs, &table, &parameters);
        let report = solve(&mut pairs, &mut table, &parameters);
        (pairs, report)
    }
}

/// Seconds that a world spent in a phase.
type PhaseOf = fn(&PhaseTimes) -> f64;

/// The phases of a step of a whole world in which the two boxes press on each other.
pub fn world_step(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("world_step");
    sample_shortly(&mut group);
    for cells in CELLS {
        // Built by the first measurement that wants it: `cargo bench -- elastic` need not wait.
        let mut built: Option<World> = None;
        let elements = elements_of(cells);
        group.throughput(Throughput::Elements(elements as u64));
        for threads in [1, 2] {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build();
            let pool = pool.expect("threads can be started");
            let phases: [(&str, PhaseOf); 2] =
                [("elastic", |t| t.elastic_s), ("contact", |t| t.detection_s + t.response_s)];
            for (name, time_of) in phases {
                let id = BenchmarkId::new(format!("{name}/{threads}-threads"), elements);
                group.bench_function(id, |bencher| {
                    let world = built.get_or_insert_with(|| pressed_world(cells));
                    bencher.iter_custom(|steps| pool.install(|| phase_time(world, steps, time_of)));
                });
            }
        }
        if let Some(world) = built {
            let StepReport { contact_pairs, settling, .. } = world.sample().step;
            println!("{elements} elements: {contact_pairs} pairs press, {} passes", settling.passes);
        }
    }
    group.finish();
}

fn phase_time(world: &mut World, steps: u64, time_of: fn(&PhaseTimes) -> f64) -> Duration {
    let before_s = time_of(&world.phase_times());
    take_steps(world, steps);
    Duration::from_secs_f64(time_of(&world.phase_times()) - before_s)
}

/// The lower box stands fixed, the top of the upper one is pressed down.
pub fn pressed_world(cells: u32) -> World {
    let still = (DVec3::ZERO, 0.0);
    let pressed = (DVec3::NEG_Z * speed_m_s(), 2.0);
    let bodies = vec![held("lower", cube(cells, 0.0), still), held("upper", cube(cells + 1, 1.0), pressed)];
    let mut setup = WorldSetup { bodies, ..WorldSetup::default() };
    setup.time.sleeping = false;
    let mut world = World::new(setup).expect("a sound world");
    take_steps(&mut world, 20);
    world
}

pub fn take_steps(world: &mut World, steps: u64) {
    for _ in 0..steps {
        world.step(world.time_s() + FAR_S).expect("the run stays finite");
    }
}

/// A body whose nodes at a height move with a velocity.
fn held(name: &str, mesh: TetMesh, (velocity_m_s, height_m): (DVec3, f64)) -> BodySetup {
    let is_held = |n: &u32| (mesh.nodes_m[*n as usize].z - height_m).abs() < 1e-9;
    let nodes = (0..mesh.nodes_m.len() as u32).filter(is_held).collect();
    let material = Material::elastic("rubber", DENSITY_KG_M3, YOUNGS_MODULUS_PA, 0.3);
    BodySetup {
        velocity_m_s,
        boundary: vec![BoundaryCondition {
            nodes,
            action: BoundaryAction::Velocity { velocity_m_s, axes: [true; 3] },
        }],
        ..BodySetup::at_rest(name, mesh, material)
    }
}
