//! Two steel rods collide head-on, against one-dimensional wave theory (METHOD 8, V1).

use crate::build::{body, box_mesh, material, quiet_world, run};
use glam::DVec3;
use hammerfall::sim::{BodyMotion, Kinematics, World, WorldSetup};

const LENGTH_M: f64 = 0.254;
const WIDTH_M: f64 = 0.0254;
const HEIGHTS_M: [f64; 2] = [0.0254, 0.0224];
const GAP_M: f64 = 2.54e-5;
const SPEED_M_S: f64 = 5.1359;
const DENSITY: f64 = 7844.0;
const YOUNG_PA: f64 = 206.82e9;

fn setup(cells: [[u32; 3]; 2], kinematics: Kinematics, cfl: f64) -> WorldSetup {
    let bodies = [0, 1].map(|i| {
        let side = [-1.0, 1.0][i];
        let centre = DVec3::X * side * 0.5 * (LENGTH_M + GAP_M);
        let mesh = box_mesh(DVec3::new(LENGTH_M, WIDTH_M, HEIGHTS_M[i]), cells[i], centre);
        let mut rod = body(["left", "right"][i], mesh, material(DENSITY, YOUNG_PA, 0.0));
        rod.velocity_m_s = DVec3::X * -side * SPEED_M_S;
        rod.motion = BodyMotion::Deformable(kinematics);
        rod
    });
    let mut setup = quiet_world(bodies.into());
    setup.time.cfl = cfl;
    setup
}

#[derive(Debug)]
struct Outcome {
    /// Of the collision's length: the rectangular pulse with the force's spread in time.
    length_error: f64,
    /// Of the time from the first impulse to the last.
    last_impulse_error: f64,
    momentum_error: f64,
    energy_error: f64,
    impulse_errors: [f64; 2],
    /// Of the velocities after the collision, over the closing speed.
    velocity_errors: [f64; 2],
    /// Share of the steps in contact whose multipliers settled within three passes.
    settled_in_three: f64,
    last_change: f64,
}

fn collide(setup: WorldSetup) -> Outcome {
    let mut world = World::new(setup).unwrap();
    let start = world.sample();
    let before: Vec<DVec3> = (0..2).map(|b| world.body_momentum_kg_m_s(b)).collect();
    let (mut momentum_error, mut energy_error, mut last_change) = (0.0_f64, 0.0_f64, 0.0_f64);
    let (mut steps, mut settled) = (0, 0);
    let scale = before[0].length();
    run(&mut world, 2.0e-4, |_, sample| {
        let momentum = (sample.linear_momentum_kg_m_s - start.linear_momentum_kg_m_s).length() / scale;
        momentum_error = momentum_error.max(momentum);
        let energy = (sample.kinetic_j + sample.strain_j) / start.kinetic_j - 1.0;
        energy_error = energy_error.max(energy.abs());
        last_change = last_change.max(sample.step.last_change);
        steps += u32::from(sample.step.passes > 0);
        settled += u32::from((1..=3).contains(&sample.step.passes) && sample.step.last_change < 1e-4);
    });
    let episodes = world.contact_episodes();
    let theory_s = 2.0 * LENGTH_M * (DENSITY / YOUNG_PA).sqrt();
    let impulse: DVec3 = episodes.iter().map(|e| e.impulse_n_s).sum();
    let changes: Vec<DVec3> = (0..2).map(|b| world.body_momentum_kg_m_s(b) - before[b]).collect();
    Outcome {
        length_error: episodes[0].pulse_length_s / theory_s - 1.0,
        last_impulse_error: (episodes.last().unwrap().end_s - episodes[0].begin_s) / theory_s - 1.0,
        momentum_error,
        energy_error,
        impulse_errors: [
            (impulse - changes[0]).length() / impulse.length(),
            (impulse + changes[1]).length() / impulse.length(),
        ],
        velocity_errors: [0, 1].map(|b| {
            let velocity_m_s = world.body_momentum_kg_m_s(b).x / world.mass_kg(b);
            (velocity_m_s - velocities_after_m_s()[b]) / (2.0 * SPEED_M_S)
        }),
        settled_in_three: f64::from(settled) / f64::from(steps),
        last_change,
    }
}

/// One-dimensional wave theory: `v_i' = 2 v_c - v_i`, `v_c = (Z1 v1 + Z2 v2) / (Z1 + Z2)`, `Z = A sqrt(rho E)`.
fn velocities_after_m_s() -> [f64; 2] {
    let common_m_s = SPEED_M_S * (HEIGHTS_M[0] - HEIGHTS_M[1]) / (HEIGHTS_M[0] + HEIGHTS_M[1]);
    [2.0 * common_m_s - SPEED_M_S, 2.0 * common_m_s + SPEED_M_S]
}

/// Checks an outcome against wave theory: bounds of the collision's length, of the energy, and of the velocities after it.
fn check(outcome: &Outcome, [length, energy, velocity]: [f64; 3]) {
    assert!(outcome.length_error.abs() < length, "{outcome:?}");
    assert!(outcome.momentum_error < 1e-9, "{outcome:?}");
    assert!(outcome.energy_error < energy, "{outcome:?}");
    assert!(outcome.impulse_errors.iter().all(|e| *e < 1e-3), "{outcome:?}");
    assert!(outcome.velocity_errors.iter().all(|e| e.abs() < velocity), "{outcome:?}");
    assert!(outcome.last_impulse_error.abs() < 0.1, "{outcome:?}");
    assert!(outcome.settled_in_three == 1.0 && outcome.last_change < 1e-4, "{outcome:?}");
}

/// With ten elements along. The thesis's own collision was 2.27 % too long.
const COARSE: [f64; 3] = [0.0227, 0.01, 0.025];
/// With forty.
const FINE: [f64; 3] = [0.015, 0.005, 0.0125];

#[test]
fn ten_elements_along_agree_with_wave_theory() {
    for kinematics in [Kinematics::Green, Kinematics::BodyFrame] {
        for cfl in [0.2, 0.45] {
            check(&collide(setup([[10, 2, 2], [10, 2, 2]], kinematics, cfl)), COARSE);
            check(&collide(setup([[10, 1, 1], [10, 1, 1]], kinematics, cfl)), COARSE);
        }
    }
}

#[test]
fn meshes_whose_nodes_do_not_meet_do_as_well() {
    for kinematics in [Kinematics::Green, Kinematics::BodyFrame] {
        for cells in [[[10, 2, 2], [10, 3, 3]], [[10, 1, 1], [8, 2, 3]], [[10, 3, 2], [12, 3, 4]]] {
            check(&collide(setup(cells, kinematics, 0.3)), COARSE);
        }
    }
}

#[test]
fn forty_elements_along_agree_better() {
    check(&collide(setup([[40, 4, 4], [40, 5, 5]], Kinematics::Green, 0.3)), FINE);
    check(&collide(setup([[40, 2, 2], [40, 2, 2]], Kinematics::BodyFrame, 0.3)), FINE);
}
