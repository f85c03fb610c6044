//! Resting, sliding, bouncing, not falling through.

use crate::build::{body, box_mesh, fixed, material, rubber, run, steel};
use glam::{DQuat, DVec3};
use hammerfall::sim::{BodySetup, ContactMethod, Stage, World, WorldSetup};

const G: f64 = 9.81;

fn ground() -> BodySetup {
    fixed("ground", box_mesh(DVec3::new(4.0, 4.0, 0.2), [1, 1, 1], DVec3::Z * -0.1))
}

fn world(bodies: Vec<BodySetup>) -> WorldSetup {
    WorldSetup { bodies, gravity_m_s2: DVec3::NEG_Z * G, ..WorldSetup::default() }
}

#[test]
fn a_dropped_rubber_cube_balances() {
    let mut cube = body("cube", box_mesh(DVec3::splat(0.1), [2, 2, 2], DVec3::Z * 0.3), rubber());
    cube.spin_rad_s = DVec3::new(1.0, 2.0, 0.5);
    let mut setup = world(vec![ground(), cube]);
    setup.time.cfl = 0.2;
    let mut world = World::new(setup).unwrap();
    let start = world.sample().balance_j();
    let fallen_j = 1.1 * G * 0.25;
    let (mut worst, mut contacts) = (0.0_f64, 0);
    run(&mut world, 0.5, |_, s| {
        worst = worst.max((s.balance_j() - start).abs());
        contacts += s.step.contact_pairs;
    });
    assert!(contacts > 0);
    assert!(worst < 0.01 * fallen_j, "the balance is off by {worst} J of {fallen_j} J");
    assert!(world.largest_penetration_ratio() < 1e-3);
}

/// Way down the slope and speed after one second of a block on an incline that is not allowed to sleep: that
/// would make sticking trivial.
fn slide(friction_coefficient: f64, degrees: f64) -> (f64, f64) {
    slide_for(friction_coefficient, degrees, false)
}

/// See [`slide`].
fn slide_for(friction_coefficient: f64, degrees: f64, sleeping: bool) -> (f64, f64) {
    let (mut world, tilt) = incline(friction_coefficient, degrees, sleeping);
    let start = world.body_pose(1).1;
    run(&mut world, 1.0, |_, _| {});
    let down = tilt * DVec3::X;
    let speed = world.body_momentum_kg_m_s(1).dot(down) / world.mass_kg(1);
    ((world.body_pose(1).1 - start).dot(down), speed)
}

/// A block on an incline, and how the incline is turned.
fn incline(friction_coefficient: f64, degrees: f64, sleeping: bool) -> (World, DQuat) {
    let tilt = DQuat::from_rotation_y(degrees.to_radians());
    let mut ramp = fixed("ramp", box_mesh(DVec3::new(40.0, 2.0, 0.2), [1, 1, 1], DVec3::Z * -0.1));
    let place = DVec3::new(-10.0, 0.0, 0.05);
    let mut soft = material(1000.0, 1e7, 0.3);
    soft.damping_per_s = 200.0;
    let mut block = body("block", box_mesh(DVec3::new(0.2, 0.2, 0.1), [2, 2, 1], place), soft);
    for b in [&mut ramp, &mut block] {
        b.mesh.nodes_m.iter_mut().for_each(|x| *x = tilt * *x);
    }
    let mut setup = world(vec![ramp, block]);
    setup.contact.friction_coefficient = friction_coefficient;
    setup.time.sleeping = sleeping;
    (World::new(setup).unwrap(), tilt)
}

#[test]
fn a_block_sticks_below_the_friction_angle() {
    let (way_m, _) = slide(0.5, 20.0);
    assert!(way_m.abs() < 1e-4 * 0.2, "crept by {way_m} m");
}

#[test]
fn a_block_slides_above_the_friction_angle_as_coulomb_says() {
    let (_, speed) = slide(0.3, 30.0);
    let angle = 30_f64.to_radians();
    let expected = G * (angle.sin() - 0.3 * angle.cos());
    assert!((speed / expected - 1.0).abs() < 0.01, "{speed} instead of {expected}");
}

#[test]
fn a_stack_stays_standing() {
    // Stiff enough not to buckle: a column of 1e6 Pa, 0.1 m wide, does so at 0.87 m under its own weight.
    let bodies = (0..4).map(|i| {
        let mut m = material(1000.0, 1e7, 0.3);
        m.damping_per_s = 400.0;
        let place = DVec3::Z * (0.05 + 0.1 * f64::from(i));
        body(&format!("cube{i}"), box_mesh(DVec3::splat(0.1), [2, 2, 2], place), m)
    });
    let mut setup = world(std::iter::once(ground()).chain(bodies).collect());
    setup.contact.friction_coefficient = 0.5;
    let mut world = World::new(setup).unwrap();
    run(&mut world, 1.0, |_, _| {});
    let top = world.body_pose(4).1;
    assert!((top - DVec3::Z * 0.35).length() < 1e-3, "the top cube is at {top}");
}

/// Three cubes of one cell each, every next one shifted and turned about z against the one below.
fn single_cell_stack(offset: f64, degrees: f64) -> World {
    let bodies = (0..3).map(|i| {
        let mut m = material(1000.0, 1e7, 0.3);
        m.damping_per_s = 400.0;
        let side = [0.0, 1.0, -0.6][i];
        let mut mesh = box_mesh(DVec3::splat(0.1), [1, 1, 1], DVec3::ZERO);
        let turn = DQuat::from_rotation_z((side * degrees).to_radians());
        let place = DVec3::new(side * offset, -0.5 * side * offset, 0.05 + 0.1 * i as f64);
        mesh.nodes_m.iter_mut().for_each(|x| *x = turn * *x + place);
        body(&format!("cube{i}"), mesh, m)
    });
    let mut setup = world(std::iter::once(ground()).chain(bodies).collect());
    setup.contact.friction_coefficient = 0.5;
    World::new(setup).unwrap()
}

#[test]
fn cubes_of_one_cell_stand_on_each_other() {
    // Flush corners, where a node is on the top and the side of the corner below; and corners that
    // only edges hold.
    for (offset, degrees) in [(0.0, 0.0), (0.003, 0.0), (0.0, 4.0), (0.003, -3.0)] {
        let mut world = single_cell_stack(offset, degrees);
        let start: Vec<DVec3> = (1..4).map(|b| world.body_pose(b).1).collect();
        run(&mut world, 2.0, |_, _| {});
        for (body, start) in (1..4).zip(start) {
            let moved = world.body_pose(body).1 - start;
            assert!(moved.length() < 2e-4, "{offset} {degrees}: cube {body} moved by {moved}");
        }
        assert!(world.largest_penetration_ratio() < 1e-3);
    }
}

#[test]
fn a_stack_beyond_its_base_topples() {
    // Each cube stands safely on the one below, but the two upper ones together do not stand on the first.
    let place = |i: f64| DVec3::new(0.04 * i * (1.0 + 0.1 * i), 0.0, 0.05 + 0.1 * i);
    let bodies = (0..4).map(|i| {
        let mut m = material(1000.0, 1e7, 0.3);
        m.damping_per_s = 400.0;
        body(&format!("cube{i}"), box_mesh(DVec3::splat(0.1), [1, 1, 1], place(f64::from(i))), m)
    });
    let mut setup = world(std::iter::once(ground()).chain(bodies).collect());
    setup.contact.friction_coefficient = 0.8;
    let mut world = World::new(setup).unwrap();
    run(&mut world, 1.5, |_, _| {});
    assert!(world.body_pose(4).1.z < 0.3, "the top cube is still at {}", world.body_pose(4).1);
}

/// Elastic steps that the world takes until `end_s`.
fn elastic_steps(world: &mut World, end_s: f64) -> u64 {
    let mut count = 0;
    run(world, end_s, |_, s| count += u64::from(s.step.elastic_steps));
    count
}

/// A damped cube, 0.1 m wide, that touches the ground at x.
fn standing_cube(name: &str, x: f64) -> BodySetup {
    let mut m = material(1000.0, 1e7, 0.3);
    m.damping_per_s = 400.0;
    body(name, box_mesh(DVec3::splat(0.1), [2, 2, 2], DVec3::new(x, 0.0, 0.05)), m)
}

#[test]
fn what_rests_costs_nothing_until_it_is_touched() {
    let mut ball = standing_cube("falling", 0.5);
    ball.mesh.nodes_m.iter_mut().for_each(|x| x.z += 2.0);
    let mut alone = World::new(world(vec![ground(), ball.clone()])).unwrap();
    let mut world = World::new(world(vec![ground(), ball, standing_cube("standing", 0.0)])).unwrap();
    // It lands after 0.64 s; until then the standing cube has come to rest.
    elastic_steps(&mut world, 0.6);
    elastic_steps(&mut alone, 0.6);
    assert!(!world.is_deforming());
    assert_eq!(elastic_steps(&mut world, 0.62), 0);
    // The landing of a cube half a metre away is not the standing one's affair.
    let landing = elastic_steps(&mut alone, 0.7);
    assert!(landing > 100);
    assert_eq!(elastic_steps(&mut world, 0.7), landing);
}

#[test]
fn a_sleeping_stack_wakes_when_something_lands_on_it() {
    let mut top = standing_cube("top", 0.0);
    top.mesh.nodes_m.iter_mut().for_each(|x| x.z += 0.1);
    let mut falling = standing_cube("falling", 0.02);
    falling.mesh.nodes_m.iter_mut().for_each(|x| x.z += 2.2);
    let bodies = vec![ground(), standing_cube("bottom", 0.0), top, falling];
    let mut world = World::new(world(bodies)).unwrap();
    run(&mut world, 0.63, |_, _| {});
    assert!(!world.is_deforming(), "the stack does not rest");
    let before = world.sample().strain_j;
    let mut most_j = 0.0_f64;
    run(&mut world, 0.66, |world, s| {
        most_j = most_j.max(s.strain_j);
        assert!(world.largest_penetration_ratio() < 1e-3);
    });
    assert!(world.is_deforming() && most_j > 10.0 * before, "{most_j} J after {before} J");
}

#[test]
fn a_sleeping_block_slides_when_friction_is_lowered() {
    let (mut world, tilt) = incline(0.8, 20.0, true);
    run(&mut world, 1.0, |_, _| {});
    assert!(!world.is_deforming());
    let start = world.body_pose(1).1;
    let mut contact = world.setup().contact.clone();
    contact.friction_coefficient = 0.1;
    world.set_contact_parameters(contact).unwrap();
    run(&mut world, 1.5, |_, _| {});
    let way_m = (world.body_pose(1).1 - start).dot(tilt * DVec3::X);
    assert!(way_m > 0.2, "slid by {way_m} m");
}

#[test]
fn a_block_that_slides_slowly_does_not_fall_asleep() {
    // A twentieth of a degree beyond the friction angle: a hundredth of gravity is left to pull.
    let friction_coefficient = 20_f64.to_radians().tan();
    let (way_m, speed) = slide_for(friction_coefficient, 20.05, true);
    let angle = 20.05_f64.to_radians();
    let expected = G * (angle.sin() - friction_coefficient * angle.cos());
    // It slipped a little on landing before friction took hold.
    assert!(speed > 0.8 * expected && way_m > 0.4 * expected, "{way_m} m, {speed} m/s");
    // Below it, it comes to rest.
    let (way_m, speed) = slide_for(friction_coefficient, 19.0, true);
    assert!(way_m.abs() < 1e-3 * 0.2 && speed == 0.0, "{way_m} m, {speed} m/s");
}

#[test]
fn free_fall_costs_no_elastic_step_from_any_height() {
    for height_m in [1.0, 10.0] {
        let place = DVec3::Z * (height_m + 0.06);
        let hammer = body("block", box_mesh(DVec3::splat(0.1), [2, 2, 2], place), steel());
        let mut world = World::new(world(vec![ground(), hammer])).unwrap();
        let mut elastic = 0;
        while world.step(10.0).unwrap().stage != Stage::Beginning {
            elastic += world.sample().step.elastic_steps;
        }
        let expected_s = (2.0 * (height_m + 0.01) / G).sqrt();
        assert_eq!(elastic, 0);
        assert!((world.time_s() / expected_s - 1.0).abs() < 1e-9, "{} s", world.time_s());
    }
}

#[test]
fn a_spinning_cube_at_a_thousand_metres_a_second_does_not_tunnel() {
    let plate = body("plate", box_mesh(DVec3::new(0.4, 0.4, 0.01), [4, 4, 1], DVec3::ZERO), steel());
    let mut cube = body("cube", box_mesh(DVec3::splat(0.05), [1, 1, 1], DVec3::Z * 0.5), steel());
    cube.velocity_m_s = DVec3::NEG_Z * 1000.0;
    cube.spin_rad_s = DVec3::new(900.0, 500.0, 300.0);
    let mut setup = crate::build::quiet_world(vec![plate, cube]);
    setup.time.cfl = 0.3;
    let mut world = World::new(setup).unwrap();
    let momentum = world.body_momentum_kg_m_s(1).length();
    run(&mut world, 4.8e-4, |_, _| {});
    let given = world.body_momentum_kg_m_s(0).length();
    assert!(!world.contact_episodes().is_empty(), "the cube went through");
    assert!(given > 0.1 * momentum, "the plate took {given} of {momentum} kg m/s");
}

#[test]
fn the_same_world_gives_the_same_bytes_on_one_thread_and_two() {
    let history = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| {
            let place = DVec3::Z * 0.16;
            let mut cube = body("cube", box_mesh(DVec3::splat(0.2), [10, 10, 10], place), rubber());
            cube.spin_rad_s = DVec3::new(1.0, 0.3, 0.0);
            let mut world = World::new(world(vec![ground(), cube])).unwrap();
            let mut bits = Vec::new();
            run(&mut world, 0.14, |_, s| {
                bits.extend([s.kinetic_j, s.strain_j, s.step.contact_force_n].map(f64::to_bits));
            });
            bits
        })
    };
    let one = history(1);
    assert!(one.len() > 300);
    assert!(one == history(2) && one == history(1));
}

#[test]
fn penalty_springs_hold_a_dropped_cube() {
    // It goes in by some tenths of an element: v sqrt(m / k) with four springs below it.
    let cube =
        body("cube", box_mesh(DVec3::splat(0.1), [2, 2, 2], DVec3::Z * 0.15), material(1000.0, 1e6, 0.3));
    let mut setup = world(vec![ground(), cube]);
    setup.contact.method = ContactMethod::Penalty { stiffness_n_m: 1e5 };
    let mut world = World::new(setup).unwrap();
    let mut lowest = f64::INFINITY;
    run(&mut world, 0.5, |world, _| lowest = lowest.min(world.body_pose(1).1.z));
    assert!(lowest > 0.03, "the cube's centre came down to {lowest}");
    assert!(world.contact_episodes().iter().any(|e| e.impulse_n_s.length() > 1.0));
}
