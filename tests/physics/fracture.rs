//! Fracture in a running world: balances, fragments, limits, determinism.

use crate::build::{body, box_mesh, fixed, material, quiet_world};
use glam::DVec3;
use hammerfall::fracture::{Criterion, Strength};
use hammerfall::mesh::TetMesh;
use hammerfall::mesh::shapes::{Beam, HexSplit, Meshing, Resolution, Shape};
use hammerfall::scene::Scene;
use hammerfall::sim::{
    BodySetup, BoundaryAction, BoundaryCondition, ContactMethod, Material, Sample, World, WorldSetup,
};

const STRENGTH_PA: f64 = 2e5;

fn tensile(tensile_strength_pa: f64) -> Criterion {
    Criterion::single(Strength::Tensile { tensile_strength_pa }).unwrap()
}

fn plaster(fracture: Criterion) -> Material {
    Material { damping_per_s: 60.0, fracture: Some(fracture), ..material(1200.0, 1e8, 0.2) }
}

fn notched_bar() -> TetMesh {
    let beam = Beam {
        length_m: 0.8,
        width_m: 0.2,
        height_m: 0.2,
        notch_width_m: 0.1,
        notch_depth_m: 0.1,
        ..Beam::default()
    };
    let meshing = Meshing { resolution: Resolution::Refinement(1), split: HexSplit::Five };
    Shape::Beam(beam).build(&meshing).expect("a sound beam")
}

fn ends(mesh: &TetMesh, speed_m_s: f64) -> Vec<BoundaryCondition> {
    let side = |sign: f64| {
        let at_end = |(_, x): &(u32, &DVec3)| sign * x.x > 0.4 - 1e-9;
        let nodes = (0_u32..).zip(&mesh.nodes_m).filter(at_end).map(|(node, _)| node).collect();
        let velocity_m_s = DVec3::X * (sign * speed_m_s);
        BoundaryCondition {
            nodes,
            action: BoundaryAction::Velocity { velocity_m_s, axes: [true, false, false] },
        }
    };
    vec![side(-1.0), side(1.0)]
}

fn pulled_bar() -> WorldSetup {
    let mesh = notched_bar();
    let boundary = ends(&mesh, 0.05);
    let mut setup =
        quiet_world(vec![BodySetup { boundary, ..body("bar", mesh, plaster(tensile(STRENGTH_PA))) }]);
    setup.fracture.smallest_fragment_elements = 2.0;
    setup
}

/// A plate thrown at a fixed block.
fn thrown_plate(criterion: Criterion) -> WorldSetup {
    let mesh = box_mesh(DVec3::new(0.3, 0.3, 0.1), [3, 3, 1], DVec3::new(0.0, 0.0, 0.051));
    let plate =
        BodySetup { velocity_m_s: DVec3::new(0.3, 0.0, -6.0), ..body("plate", mesh, plaster(criterion)) };
    let block = fixed("block", box_mesh(DVec3::new(0.1, 2.0, 0.2), [1, 1, 1], DVec3::new(0.03, 0.0, -0.1)));
    let mut setup = quiet_world(vec![block, plate]);
    setup.time.cfl = 0.4;
    setup.fracture.smallest_fragment_elements = 2.0;
    setup
}

/// Runs to `end_s`; the largest change of the energy balance over all steps.
fn run(world: &mut World, end_s: f64) -> f64 {
    let start = world.sample();
    let mut error_j = 0.0_f64;
    while world.time_s() < end_s {
        world.step(end_s).expect("the run stays finite");
        error_j = error_j.max((world.sample().balance_j() - start.balance_j()).abs());
    }
    error_j
}

#[test]
fn a_bar_pulled_apart_breaks_at_its_notch_and_balances_hold() {
    let mut world = World::new(pulled_bar()).unwrap();
    let error_j = run(&mut world, 0.05);
    let end = world.sample();
    assert_eq!(end.fragments, 2, "{end:?}");
    let positions_m = world.reference_positions_m(0);
    for face in world.crack_faces(0) {
        let middle = face.nodes.iter().map(|n| positions_m[*n as usize]).sum::<DVec3>() / 3.0;
        assert!(middle.x.abs() < 0.12, "a crack far from the notch: {middle}");
    }
    assert!(error_j < 0.01 * end.external_work_j, "{error_j} of {}", end.external_work_j);
    assert!(end.crack_area_m2 > 0.015, "{end:?}");
}

#[test]
fn momentum_is_kept_when_a_flying_body_breaks() {
    let mut setup = thrown_plate(tensile(1.0));
    setup.bodies.remove(0);
    setup.bodies[0].spin_rad_s = DVec3::new(0.0, 20.0, 5.0);
    setup.time.free_travel = false;
    let mut world = World::new(setup).unwrap();
    let start = world.sample();
    let error_j = run(&mut world, 0.01);
    let end = world.sample();
    assert!(end.fragments > 1, "{end:?}");
    let change = (end.linear_momentum_kg_m_s - start.linear_momentum_kg_m_s).length();
    assert!(change < 1e-10 * start.linear_momentum_kg_m_s.length(), "{change}");
    assert!(error_j < 0.01 * start.kinetic_j, "{error_j}");
}

#[test]
fn pieces_come_to_lie_on_the_ground() {
    let mut setup = thrown_plate(tensile(STRENGTH_PA));
    setup.gravity_m_s2 = DVec3::NEG_Z * 9.81;
    setup.contact.friction_coefficient = 0.5;
    setup.contact.method =
        ContactMethod::Lagrange { passes: 3, tolerance: 1e-4, conserve_impact_energy: false };
    // Wide enough for the fastest piece: one that slides over its edge would fall, too.
    let ground = box_mesh(DVec3::new(40.0, 40.0, 1.0), [1, 1, 1], DVec3::NEG_Z * 0.7);
    setup.bodies.push(fixed("ground", ground));
    let mut world = World::new(setup).unwrap();
    let start = world.sample();
    // The pieces slide off the block, one after the other.
    run(&mut world, 2.0);
    let end = world.sample();
    assert!(end.fragments > 1, "{end:?}");
    let lowest_m = world.positions_m(1).iter().map(|x| x.z).fold(f64::INFINITY, f64::min);
    assert!(lowest_m > -0.21, "fell through the ground: {lowest_m}");
    assert!(end.kinetic_j < 0.05 * start.kinetic_j, "{end:?}");
}

#[test]
fn limits_reached_are_told() {
    let mut setup = thrown_plate(tensile(STRENGTH_PA / 4.0));
    setup.fracture.max_elements = Some(60);
    let mut world = World::new(setup).unwrap();
    run(&mut world, 0.01);
    assert!(world.sample().elements <= 60);
    assert!(world.fracture_limits_reached().elements > 0);
}

#[test]
fn every_criterion_runs_to_its_end_at_a_tenth_and_ten_times_its_strength() {
    for share in [0.1, 1.0, 10.0] {
        let k = share * STRENGTH_PA;
        let strengths = [
            Strength::Tensile { tensile_strength_pa: k },
            Strength::Tresca { shear_strength_pa: k },
            Strength::VonMises { shear_strength_pa: k },
            Strength::MohrCoulomb { cohesion_pa: k, friction_angle_rad: 0.5 },
            Strength::DruckerPrager { cohesion_pa: k, friction_angle_rad: 0.5 },
        ];
        for strength in strengths {
            let mut world = World::new(thrown_plate(Criterion::single(strength.clone()).unwrap())).unwrap();
            let start = world.sample();
            let error_j = run(&mut world, 0.03);
            let end: Sample = world.sample();
            assert!(end.kinetic_j <= 1.01 * start.kinetic_j, "{strength:?}: {end:?}");
            assert!(error_j < 0.01 * start.kinetic_j, "{strength:?}: {error_j} of {}", start.kinetic_j);
            let depth = world.largest_penetration_ratio();
            assert!(depth < 1e-3, "{strength:?}: pressed into each other by {depth} of an element");
        }
    }
}

#[test]
fn threads_do_not_matter() {
    let run_on = |threads| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| {
            let mut world = World::new(thrown_plate(tensile(STRENGTH_PA))).unwrap();
            run(&mut world, 0.02);
            (world.positions_m(1).to_vec(), world.tets(1).to_vec())
        })
    };
    let (one, two) = (run_on(1), run_on(2));
    assert_eq!(one, two);
    assert!(one.1.len() > 54, "nothing broke");
}

/// So many elements, nodes and pairs of features that every loop that may be shared out among threads is.
#[test]
fn threads_do_not_matter_where_loops_are_shared_out() {
    let run_on = |threads| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| {
            let mut world = World::new(Scene::load("pane-shot", &[]).unwrap().setup).unwrap();
            run(&mut world, 7e-4);
            let cracks = world.sample().crack_area_m2;
            (cracks, world.positions_m(1).to_vec(), world.velocities_m_s(1).to_vec(), world.tets(1).to_vec())
        })
    };
    let one = run_on(1);
    assert!(one.0 > 0.02, "{} m2 of cracks", one.0);
    for threads in [2, 3] {
        assert!(run_on(threads) == one, "{threads} threads make a difference");
    }
}

/// However slowly cracks may run: what begins to break is seen.
#[test]
fn a_blow_cracks_what_may_crack_slowly_only() {
    let area_m2 = |crack_speed_m_s| {
        let mut setup = thrown_plate(tensile(STRENGTH_PA));
        setup.fracture.crack_speed_m_s = crack_speed_m_s;
        let mut world = World::new(setup).unwrap();
        run(&mut world, 0.02);
        world.sample().crack_area_m2
    };
    let (slow_m2, usual_m2) = (area_m2(Some(1e-3)), area_m2(None));
    assert!(slow_m2 > 0.0 && slow_m2 < 0.5 * usual_m2, "{slow_m2} and {usual_m2} m2");
}

#[test]
fn a_body_breaks_in_the_same_way_however_often_somebody_looks() {
    let state_after = |look_every_s: f64| {
        let mut setup = thrown_plate(tensile(STRENGTH_PA));
        // A spinning flight first.
        setup.bodies[1].mesh.nodes_m.iter_mut().for_each(|x| x.z += 0.05);
        setup.bodies[1].spin_rad_s = DVec3::new(1.0, 9.0, 3.0);
        let mut world = World::new(setup).unwrap();
        let mut looks = 1.0;
        while world.time_s() < 0.02 {
            world.step(looks * look_every_s).expect("the run stays finite");
            if world.time_s() >= looks * look_every_s {
                std::hint::black_box((world.sample(), world.publish()));
                looks += 1.0;
            }
        }
        assert!(world.sample().crack_area_m2 > 0.0, "nothing broke");
        // The last step ends where it ends, so that the clock is the same, too.
        let bits = |x: &DVec3| x.to_array().map(f64::to_bits);
        (world.time_s().to_bits(), world.positions_m(1).iter().map(bits).collect::<Vec<_>>())
    };
    let once = state_after(0.02);
    assert!(once == state_after(3.1e-4) && once == state_after(1e-6), "looking changed what happened");
}

#[test]
fn the_small_breaking_scenes_break_and_nothing_goes_into_anything() {
    for name in ["beam-notch", "cube-wall", "plate-tensile", "plate-mohr-coulomb", "plate-tresca"] {
        let scene = Scene::load(name, &[]).unwrap();
        let mut world = World::new(scene.setup).unwrap();
        run(&mut world, scene.description.duration_s);
        assert!(world.sample().crack_area_m2 > 0.0, "{name} did not break");
        let depth = world.largest_penetration_ratio();
        assert!(depth < 1e-3, "{name}: pressed into each other by {depth} of an element");
    }
}
