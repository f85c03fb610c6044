//! Pulling at bodies by a spring.

use crate::build::{body, box_mesh, quiet_world, rubber, run, steel};
use glam::DVec3;
use hammerfall::scene::Scene;
use hammerfall::sim::{Change, PathPoint, PlannedChange, Pull, World, WorldSetup};
use std::path::Path;

const G: f64 = 9.81;
/// Time in which bodies follow, s.
const FOLLOW_S: f64 = 0.02;

fn pull(body: &str, at_m: DVec3, path: &[(f64, DVec3)], until_s: f64) -> PlannedChange {
    let path = path.iter().map(|&(time_s, point_m)| PathPoint { time_s, point_m }).collect();
    let pull = Pull { body: body.to_owned(), at_m, follow_s: FOLLOW_S, path, until_s };
    PlannedChange { time_s: pull.begins_s(), change: Change::Pull(Box::new(pull)) }
}

/// A rubber block of 1.1 kg by the origin.
fn block() -> WorldSetup {
    quiet_world(vec![body("block", box_mesh(DVec3::splat(0.1), [3, 3, 3], DVec3::ZERO), rubber())])
}

#[test]
fn momentum_is_the_impulse_of_spring_and_drag_and_energy_their_work() {
    let mut setup = block();
    // A crooked path by a corner, so that the block turns as well.
    let (at_m, there) = (DVec3::new(0.04, 0.045, 0.03), DVec3::new(0.07, 0.0, 0.07));
    setup.changes =
        vec![pull("block", at_m, &[(0.01, at_m), (0.05, there), (0.09, at_m + there), (0.2, there)], 0.2)];
    // The drag is that of half a step ago.
    setup.time.max_step_s = 1e-5;
    let mut world = World::new(setup).unwrap();
    let mass_kg = world.mass_kg(0);
    let force_n = |world: &World| match world.pulls_m().as_slice() {
        [[from, to]] => {
            let momentum = world.body_momentum_kg_m_s(0);
            (*to - *from) * (mass_kg / FOLLOW_S.powi(2)) - momentum * (2.0 / FOLLOW_S)
        }
        _ => DVec3::ZERO,
    };
    let start = world.sample();
    let (mut impulse, mut before_n, mut worst_j, mut work_j, mut fastest) =
        (DVec3::ZERO, DVec3::ZERO, 0.0_f64, 0.0_f64, 0.0_f64);
    run(&mut world, 0.3, |world, sample| {
        let now_n = force_n(world);
        impulse += (before_n + now_n) * (0.5 * sample.step.step_s);
        before_n = now_n;
        let off = (impulse - sample.linear_momentum_kg_m_s).length();
        fastest = fastest.max(sample.linear_momentum_kg_m_s.length());
        assert!(off < 2e-3 * fastest.max(0.1), "{off} at {}", world.time_s());
        worst_j = worst_j.max((sample.balance_j() - start.balance_j()).abs());
        work_j = work_j.max(sample.kinetic_j + sample.strain_j);
    });
    assert!(fastest > 1.0 && work_j > 0.5, "{fastest} {work_j}");
    assert!(worst_j < 1e-3 * work_j, "the balance is off by {worst_j} J of {work_j} J");
    // Let go in motion it flies on, freely again once its vibration has died down or is kept.
    let after = world.sample();
    assert!((after.linear_momentum_kg_m_s - impulse).length() < 2e-3 * fastest);
}

#[test]
fn what_is_held_hangs_below_the_hand_whatever_its_mass_and_stiffness() {
    for (material, size_m, way_m) in [(rubber(), 0.1, 0.1), (steel(), 0.3, 0.02)] {
        let mut block = body("block", box_mesh(DVec3::splat(size_m), [2, 2, 2], DVec3::ZERO), material);
        block.materials[0].damping_per_s = 50.0;
        let mut setup = quiet_world(vec![block]);
        setup.gravity_m_s2 = DVec3::NEG_Z * G;
        // By the middle of an element beside the axis, so that it need not swing far.
        let at_m = DVec3::new(0.01, 0.02, 0.45) * size_m;
        let hand_m = at_m + DVec3::Z * way_m;
        let path = [(0.0, at_m), (0.02, hand_m)];
        setup.changes = vec![pull("block", at_m, &path, f64::INFINITY)];
        setup.time.max_step_s = 1e-4;
        let mut world = World::new(setup).unwrap();
        let start_j = world.sample().balance_j();
        run(&mut world, 0.3, |_, _| {});
        let [[from, to]] = world.pulls_m()[..] else { panic!("it is held") };
        assert_eq!(to, hand_m);
        let sag_m = (to - from).z;
        let expected_m = G * FOLLOW_S * FOLLOW_S;
        assert!((sag_m / expected_m - 1.0).abs() < 0.05, "{sag_m} {expected_m}");
        let sample = world.sample();
        let off_j = (sample.balance_j() - start_j).abs();
        assert!(off_j < 2e-3 * sample.potential_j.abs(), "{off_j} of {}", sample.potential_j);
    }
}

#[test]
fn a_pull_wakes_what_sleeps_and_keeps_it_awake_until_it_lets_go() {
    let scene = Scene::load("stack", &[]).unwrap();
    let mut setup = scene.setup.clone();
    let top = setup.bodies.iter().position(|body| body.name.ends_with("dark-5")).unwrap();
    let name = setup.bodies[top].name.clone();
    let (low, high) = setup.bodies[top].mesh.bounds_m().unwrap();
    let at_m = low.midpoint(high) + DVec3::splat(0.01 * (high - low).x);
    let up = at_m + DVec3::Z * (high - low).z;
    setup.changes = vec![pull(&name, at_m, &[(1.0, at_m), (1.1, up)], 1.3)];
    let mut world = World::new(setup).unwrap();
    run(&mut world, 1.0, |_, _| {});
    assert_eq!(world.publish().status.sleeping_bodies, 10);
    let start_j = world.sample().balance_j();
    run(&mut world, 1.29, |_, _| {});
    let lifted_m = world.body_pose(top).1.z - low.midpoint(high).z;
    assert!(lifted_m > 0.7 * (high - low).z, "{lifted_m}");
    let sample = world.sample();
    let off_j = (sample.balance_j() - start_j).abs();
    assert!(off_j < 0.02 * sample.external_work_j.abs(), "{off_j} J of {} J", sample.external_work_j);
    // It falls back on the pile.
    run(&mut world, 1.6, |_, _| {});
    assert!(world.pulls_m().is_empty());
    assert!(world.body_pose(top).1.z < low.midpoint(high).z + 0.5 * lifted_m);
}

/// A brittle rod that is held at one end and pulled apart at the other.
fn torn_rod() -> World {
    let text = r#"
        title = "torn"
        gravity = [0, 0, -9.81]
        [materials.rod]
        density = 1000
        youngs_modulus = 2e6
        poisson_ratio = 0.3
        damping = 20
        fracture = { criterion = "tensile", tensile_strength = 4e4 }
        [[bodies]]
        name = "rod"
        shape = { type = "box", size = [0.4, 0.1, 0.1], cells = [8, 2, 2] }
        material = "rod"
        position = [0, 0, 0]
        boundary = [{ at = { box = { min = [-0.3, -1, -1], max = [-0.19, 1, 1] } }, fixed = true }]
        [[pulls]]
        body = "rod"
        at = [0.19, 0.01, 0.02]
        follow = 0.02
        path = [{ time = 0, point = [0.19, 0.01, 0.02] }, { time = 0.15, point = [0.6, 0.1, 0.3] }]
        until = 1
        [time]
        duration = 1
        "#;
    World::new(Scene::from_text("torn", text, Path::new("."), &[]).unwrap().setup).unwrap()
}

#[test]
fn the_grabbed_point_stays_with_its_fragment_and_all_threads_agree() {
    let ends = [1, 2].map(|threads| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| {
            let mut world = torn_rod();
            let start_j = world.sample().balance_j();
            let (mut worst_j, mut most_j, mut last, mut fragments) = (0.0_f64, 0.0_f64, None, 1);
            run(&mut world, 0.3, |world, sample| {
                worst_j = worst_j.max((sample.balance_j() - start_j).abs());
                most_j = most_j.max(sample.external_work_j);
                fragments = sample.fragments;
                let [[from, _]] = world.pulls_m()[..] else { panic!("it is held") };
                // The point never jumps to another fragment.
                let way_m = last.map_or(0.0, |last: DVec3| (from - last).length());
                assert!(way_m < 0.01, "{way_m} m");
                last = Some(from);
            });
            assert!(fragments > 1, "nothing broke");
            assert!(worst_j < 0.02 * most_j, "{worst_j} J of {most_j} J");
            let [[from, to]] = world.pulls_m()[..] else { panic!("it is held") };
            assert!((to - from).length() < 0.02, "it does not follow: {from} {to}");
            world.positions_m(0).to_vec()
        })
    });
    assert_eq!(ends[0], ends[1]);
}

#[test]
fn unsound_pulls_are_told_with_their_place() {
    let scene = Scene::load("bounce", &[]).unwrap();
    let name = scene.setup.bodies.last().unwrap().name.clone();
    let told = |pull: &str| {
        let text = format!("{}\n[[pulls]]\n{pull}\n", scene.to_toml());
        Scene::from_text("bad", &text, Path::new("."), &[]).map(drop).unwrap_err().to_string()
    };
    let path = "path = [{ time = 0.1, point = [0, 0, 1] }, { time = 0.2, point = [0, 0, 2] }]";
    let at = "at = [0, 0, 0]";
    assert!(told(&format!("body = \"grund\"\n{at}\n{path}")).contains("no body called `grund`"));
    assert!(told(&format!("body = \"ground\"\n{at}\n{path}")).contains("that moves"));
    assert!(told(&format!("body = {name:?}\n{path}")).contains("`at` is missing"));
    assert!(told(&format!("body = {name:?}\n{at}")).contains("`path` is missing"));
    assert!(told(&format!("body = {name:?}\n{at}\npath = []")).contains("at least one point"));
    let back = path.replace("0.2", "0.05");
    assert!(told(&format!("body = {name:?}\n{at}\n{back}")).contains("must ascend"));
    assert!(told(&format!("body = {name:?}\n{at}\n{path}\nuntil = 0.1")).contains("let go at 0.1 s"));
    assert!(told(&format!("body = {name:?}\n{at}\n{path}\nfollow = 0")).contains("follow"));
    let change = format!("{}\n[[contact_changes]]\nat = 1\npasses = 3\n", scene.to_toml());
    let error = Scene::from_text("bad", &change, Path::new("."), &[]).map(drop).unwrap_err().to_string();
    assert!(error.contains("needs `method`"), "{error}");
}
